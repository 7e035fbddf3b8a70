"""One scene under many records: a row each, and none of them stops the others."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from eventpound.accuracy.judge import KEEPING, rtol_of_judge
from eventpound.case.case import Case
from eventpound.case.member import member_case
from eventpound.case.solver_words import solver_instead
from eventpound.case.suite import KEPT, Member
from eventpound.errors import EventpoundError, InputError
from eventpound.given import Count, checked, positive
from eventpound.motion.intensity import peak_velocity
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.motion.scaling import DAMPING, psa_of
from eventpound.numerics.arrays import Floats
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import needs_one, tabled
from eventpound.response import Response
from eventpound.scene.periods import longest_period
from eventpound.simulation import check_solver
from eventpound.solvers.base import Extremes
from eventpound.study.chunk import Refused, parts_of
from eventpound.study.plan import MOST_RECORDS, Base
from eventpound.study.quantities import Results
from eventpound.sweep import FAST, Sweep, Wanted, cores
from eventpound.units import Dimension
from eventpound.ways import Way, quantities_asked, refuse_options

if TYPE_CHECKING:
    import pandas as pd

_T_FINAL = "t_final"


class SuiteInterrupted(KeyboardInterrupt):
    """A suite was stopped by Ctrl-C or termination.

    Parameters
    ----------
    table : DataFrame
        The rows that were done, as `simulate_suite` returns them.
    total : int
        Number of records of the suite.
    """

    def __init__(self, table: pd.DataFrame, total: int) -> None:
        super().__init__("interrupted")
        self.table, self.total = table, total


Keep = Callable[[str, Case, Response], None]
"""Called with the name of a record, its case and its response."""


@checked
def simulate_suite(
    case: Case,
    *,
    solver: str | None = None,
    rtol: float | str | None = None,
    error_estimate: bool | None = None,
    workers: Count | None = None,
    progress: Callable[[int, int], None] | None = None,
    keep: Keep | None = None,
    intensities: bool = False,
) -> pd.DataFrame:
    """Compute how a scene moves under every record of a suite.

    Parameters
    ----------
    case : Case
        With ``suite`` or ``synthetic`` in its ``[excitation]``.
    solver : str, optional
        Name of a solver instead of the case's own, with settings as for `simulate`.
    rtol : float, optional
        Relative tolerance instead of the case's own.
    error_estimate : bool, optional
        Whether to run each record again by the same solver at another tolerance and give
        the largest difference of the peaks, relative to the largest peak; as the case says,
        else not. Not for solvers of fixed steps, which no tolerance changes.
    workers : int, optional
        Number of threads; as many as there are cores to use for the fast solver,
        which alone leaves Python's lock, one for any other.
    progress : callable, optional
        Called with the numbers of records done and of all.
    keep : callable, optional
        Given the response to each record, one at a time but in any order; a history
        has rows only if this is given.
    intensities : bool
        Whether to give PGV (m/s) and Sa(T1) (m/s^2) of each record as scaled, too: columns
        ``PGV`` and ``Sa_T1``, at 5 % damping and the longest period of the scene.

    Returns
    -------
    DataFrame
        A row a record, columns as in ``suite.csv`` (page "suites" of the docs). What a
        record that failed has none of is NaN, and ``failed`` says why.

    Raises
    ------
    InputError
        Where the case has no suite, no file matches, or an option is wrong.
    SuiteInterrupted
        After Ctrl-C, with the rows that were done; the records that were being run are
        finished before.
    """
    number = positive("rtol", rtol, Dimension.NUMBER)
    if case.suite is None:
        raise InputError("the case has no suite of records; simulate runs it")
    members = case.suite.members(case.directory)
    asked = case.run.error_estimate if error_estimate is None else error_estimate
    runner = Runner(case, solver, number, bool(asked), keep, intensities)
    threads = workers or (cores() if runner.wanted.solver == FAST else 1)
    size = runner.at_once(len(members), threads)
    pool = ThreadPoolExecutor(threads)
    futures: list[Future[_Chunk]] = []
    try:
        futures += [
            pool.submit(runner.chunk, members[low : low + size])
            for low in range(0, len(members), size)
        ]
        done = 0
        for future in futures:
            for _ in future.result().rows:
                done += 1
                if progress is not None:
                    progress(done, len(members))
    except KeyboardInterrupt:
        pool.shutdown(cancel_futures=True)
        finished = [f.result() for f in futures if not f.cancelled() and f.exception() is None]
        raise SuiteInterrupted(_table(finished), len(members)) from None
    finally:
        pool.shutdown(cancel_futures=True)
    return _table([future.result() for future in futures])


class _Chunk:
    """Rows of some records: what they are, and columns of numbers."""

    def __init__(self, rows: list[dict[str, object]]) -> None:
        self.rows = rows
        self.columns: dict[str, Floats] = {}

    def put(self, name: str, at: Sequence[int], values: Floats) -> None:
        """Put values of a column into some rows."""
        self.columns.setdefault(name, np.full(len(self.rows), np.nan))[at] = values


class Runner:
    """Makes the rows of records; threads may share it."""

    def __init__(
        self,
        case: Case,
        solver: str | None,
        rtol: float | None,
        error_estimate: bool,
        keep: Keep | None,
        intensities: bool = False,
    ) -> None:
        self._case, self._keep, self._estimated = case, keep, error_estimate
        self._keeping = Lock()
        self._period = (longest_period(case.scene) or math.nan) if intensities else None
        options = replace(case.solver, rtol=rtol or case.solver.rtol)
        if solver is not None:
            options = solver_instead(options, solver, "solver")
        case = replace(case, solver=options)
        own_duration = not math.isnan(case.run.duration)
        self._base = Base(replace(case, suite=None, figure=None), {}, (), own_duration)
        self.wanted = Wanted(options.name, options.rtol, accelerations=True, impacts=True)
        if case.scene.bodies:
            # Options that no run can have are an error of the whole, not of every record.
            check_solver(options, case.scene)
            refuse_options(case, Way.SUITE)
            if error_estimate and options.name not in KEEPING:
                raise InputError(
                    f"error_estimate: the solver {options.name!r} does not keep a tolerance, by "
                    f"which a second run could tell; accepted: {', '.join(KEEPING)}"
                )
            asked = quantities_asked([(case.scene, case.run)])
            self.wanted = replace(self.wanted, quantities=asked)

    def at_once(self, records: int, threads: int) -> int:
        """How many of the records a thread takes at once."""
        scene = self._case.scene
        named = [name for name in self.wanted.quantities if needs_one(scene, name)]
        if self._case.suite is not None and self._case.suite.supports:
            return 1
        if self._keep is not None or not replace(self.wanted, quantities=named).in_one_call(scene):
            return 1
        return max(1, min(MOST_RECORDS, records // (2 * threads)))

    def chunk(self, members: Sequence[Member]) -> _Chunk:
        """The rows of some records."""
        chunk = _Chunk([_row_of(member, self._period) for member in members])
        good = [i for i, row in enumerate(chunk.rows) if not row["failed"]]
        if not good or not self._case.scene.bodies:
            return chunk
        read = [members[i] for i in good]
        base = replace(self._base, records=tuple(read))
        wanted = self.wanted
        if self._keep is not None:
            wanted = replace(wanted, keep=lambda i, response: self._hand_on(read[i], response))
        for part in parts_of(base, 0, len(read), wanted):
            if isinstance(part, Refused):
                row = chunk.rows[good[part.low]]
                row["failed"] = _reason(str(part.error), str(row["file"]))
            else:
                self._fill(chunk, [good[i] for i in part.rows.at], part)
        return chunk

    def _fill(self, chunk: _Chunk, at: list[int], part: Results) -> None:
        """Put the numbers of runs into their rows."""
        many = part.many
        errors = self._errors(part) if self._estimated else None
        columns = {named.name: named.of(many) for named in tabled(many)}
        for name in self.wanted.quantities:
            values = part.quantity(name)
            columns[name] = many.t * np.nan if values is None else values
        columns["seconds.solve"] = part.seconds
        if errors is not None:
            columns["error_estimate"] = errors
        for name, values in columns.items():
            chunk.put(
                name, at, values if name == _T_FINAL else np.where(many.success, values, np.nan)
            )
        for i in np.flatnonzero(~many.success).tolist():
            row = chunk.rows[at[i]]
            row["failed"] = _reason(many.message[i], str(row["file"]))

    def _errors(self, part: Results) -> Floats:
        """Differences of the peaks from those of finer runs, relative to the largest."""
        solver, rtol = self.wanted.solver, self.wanted.rtol
        finer = Wanted(solver, rtol_of_judge(rtol, solver, itself=True))
        better = Sweep(part.rows, finer).run()
        for i in np.flatnonzero(part.many.success & ~better.success).tolist():
            part.many.success[i] = False
            part.many.message[i], part.many.t[i] = better.message[i], better.t[i]
        peaks = peak_displacements(better.displacement)
        largest, error = peaks.max(axis=1), abs(peak_displacements(part.many.displacement) - peaks)
        return np.where(largest == 0.0, 0.0, error.max(axis=1) / np.where(largest, largest, 1.0))

    def _hand_on(self, member: Member, response: Response) -> None:
        """Hand on what was computed of a record."""
        motion = response.scene.motion
        assert self._keep is not None
        assert isinstance(motion, Record)
        assert motion.source is not None
        case = member_case(self._case, member, motion.source)
        with self._keeping:
            self._keep(member.name, case, response)


def peak_displacements(displacement: Extremes) -> Floats:
    """Largest displacement of every body in size (m), of the shape of the extremes."""
    return np.maximum(displacement.maximum, -displacement.minimum)


def _row_of(member: Member, period: float | None) -> dict[str, object]:
    """What a record is, as its file says, and its scales as it is used (SI).

    With PGV and Sa at a period (s) where one is given.
    """
    row: dict[str, object] = {"record": member.name, "file": member.file, "failed": ""}
    began = time.perf_counter()
    try:
        motion = member.motion()
        assert motion.source is not None
        row |= _identity(motion.source)
        scales = motion.scales()
        for name, own in member.supports:
            row[f"file.{name}"] = own.file
            row |= _of_support(name, own)
    except EventpoundError as error:
        row["failed"] = _reason(str(error), member.file)
        with suppress(EventpoundError):
            row |= _identity(member.read())
        return row
    row |= {"PGA": motion.peak, "T_m": motion.mean_period}
    row["omega_g"], row["L_e"] = (
        (math.nan, math.nan) if scales is None else (scales.omega_g, scales.length)
    )
    if period is not None:
        row |= _measures(motion, period)
    row["seconds.read"] = time.perf_counter() - began
    return row


def _of_support(name: str, member: Member) -> dict[str, object]:
    """What the record of a support is."""
    try:
        motion = member.motion()
    except InputError as error:
        raise InputError([f"support '{name}': {each}" for each in error.problems]) from error
    sha = None if motion.source is None else motion.source.sha256
    return {f"sha256.{name}": sha, f"PGA.{name}": motion.peak}


@lru_cache(KEPT)
def _measures(motion: Record, period: float) -> dict[str, float]:
    """PGV (m/s), and Sa (m/s^2) where there is a period."""
    found = {"PGV": peak_velocity(motion)}
    if not math.isnan(period):
        periods = np.array([period])
        found["Sa_T1"] = float(psa_of(motion.values, motion.time_step, periods, DAMPING)[0])
    return found


def _identity(data: RecordData) -> dict[str, object]:
    """What a record is, as its file says."""
    return {
        "event": data.event or "",
        "date": data.date or "",
        "station": data.station or "",
        "component": data.component or "",
        "format": data.format,
        "sha256": data.sha256,
        "samples": data.acceleration.size,
        "time_step": data.time_step,
        "notes": "; ".join(data.notes),
    }


def _reason(message: str, file: str) -> str:
    """Why a record has no numbers; its file is a column of its own."""
    lines = (line.removeprefix(file).lstrip(":, ") for line in message.splitlines())
    return "; ".join(lines)


def _table(chunks: Sequence[_Chunk]) -> pd.DataFrame:
    """All rows as one table, columns in their order, a row a record."""
    import pandas as pd

    rows = [row for chunk in chunks for row in chunk.rows]
    # What is known of one record is the beginning of what is known of another.
    known = max(rows, key=len, default={})
    columns: dict[str, object] = {key: [row.get(key, math.nan) for row in rows] for key in known}
    whole = {quantity.path for quantity in LISTED if quantity.kind is int}
    for name in dict.fromkeys(name for chunk in chunks for name in chunk.columns):
        parts = [chunk.columns.get(name, np.full(len(chunk.rows), np.nan)) for chunk in chunks]
        values = np.concatenate(parts)
        counts = name in whole and not np.isnan(values).any()
        columns[name] = values.astype(np.int64) if counts else values
    return pd.DataFrame(columns)
