"""One scene under many records: a row each, and none of them stops the others."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import Lock
from typing import TYPE_CHECKING

from eventpound.case.case import Case
from eventpound.case.member import member_case
from eventpound.case.suite import Member
from eventpound.errors import ComputationError, EventpoundError, InputError
from eventpound.many import cores
from eventpound.response import Response
from eventpound.simulation import SMALLEST_RTOL, simulate
from eventpound.study.suite_row import (
    failed_row,
    identity,
    peak_displacements,
    response_row,
    scales_row,
)

if TYPE_CHECKING:
    import pandas as pd

FINER = 1e-2
"""The tolerance of the run that tells the error of another is this part of its own."""


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


def simulate_suite(
    case: Case,
    *,
    solver: str | None = None,
    rtol: float | None = None,
    error_estimate: bool = False,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    keep: Keep | None = None,
) -> pd.DataFrame:
    """Compute how a scene moves under every record of a suite.

    Parameters
    ----------
    case : Case
        With ``suite`` or ``synthetic`` in its ``[excitation]``.
    solver : str, optional
        Name of a solver instead of the case's own.
    rtol : float, optional
        Relative tolerance instead of the case's own.
    error_estimate : bool
        Whether to run each record again at a hundredth of the tolerance and give
        the largest difference of the peaks, relative to the largest peak.
    workers : int, optional
        Number of threads; as many as there are cores to use for the fast solver,
        which alone leaves Python's lock, one for any other.
    progress : callable, optional
        Called with the numbers of records done and of all.
    keep : callable, optional
        Given the response to each record, one at a time but in any order; a history
        has rows only if this is given.

    Returns
    -------
    DataFrame
        A row a record, columns as in ``suite.csv`` (``docs/suites.md``). What a
        record that failed has none of is NaN, and ``failed`` says why.

    Raises
    ------
    InputError
        Where the case has no suite, no file matches, or an option is wrong.
    SuiteInterrupted
        After Ctrl-C, with the rows that were done; the records that were being run are
        finished before.
    """
    import pandas as pd

    if case.suite is None:
        raise InputError("the case has no suite of records; simulate runs it")
    members = case.suite.members(case.directory)
    runner = Runner(case, solver, rtol, error_estimate, keep)
    pool = ThreadPoolExecutor(workers or (cores() if runner.solver == "fast" else 1))
    futures: list[Future[dict[str, object]]] = []
    try:
        futures += [pool.submit(runner.row, member) for member in members]
        for done, future in enumerate(futures, 1):
            future.result()
            if progress is not None:
                progress(done, len(members))
    except KeyboardInterrupt:
        pool.shutdown(cancel_futures=True)
        finished = [f.result() for f in futures if not f.cancelled() and f.exception() is None]
        raise SuiteInterrupted(pd.DataFrame(finished), len(members)) from None
    finally:
        pool.shutdown(cancel_futures=True)
    return pd.DataFrame([future.result() for future in futures])


class Runner:
    """Makes the row of a record; threads may share it."""

    def __init__(
        self,
        case: Case,
        solver: str | None,
        rtol: float | None,
        error_estimate: bool,
        keep: Keep | None,
    ) -> None:
        self._case, self._keep, self._estimated = case, keep, error_estimate
        self._keeping = Lock()
        self.solver = solver or case.solver.name
        self._rtol = rtol or case.solver.rtol
        if case.scene.bodies:
            # Options that no run can have are an error of the whole, not of every record.
            _check_options(self.solver, self._rtol, case)

    def row(self, member: Member) -> dict[str, object]:
        """The row of one record."""
        row: dict[str, object] = {"record": member.name, "file": member.file, "failed": ""}
        began = time.perf_counter()
        try:
            data = member.read()
            row |= identity(data)
            one = member_case(self._case, member, data, history=self._keep is not None)
            row |= scales_row(one)
            row["seconds.read"] = time.perf_counter() - began
            if one.scene.bodies:
                row |= self._respond(member.name, one)
        except EventpoundError as error:
            row |= failed_row(error, member.file)
        return row

    def _respond(self, name: str, one: Case) -> dict[str, object]:
        """The part of a row that takes a run."""
        try:
            response = simulate(one, self.solver, self._rtol)
        except ComputationError as error:
            if self._keep is not None and error.recording is not None:
                self._keep_incomplete(name, one, error)
            raise
        row = response_row(response)
        if self._estimated:
            row["error_estimate"] = self._error(one, response)
        if self._keep is not None:
            with self._keeping:
                self._keep(name, one, response)
        return row

    def _error(self, one: Case, response: Response) -> float:
        """Difference of the peaks from those of a finer run, relative to the largest."""
        finer = max(FINER * self._rtol, SMALLEST_RTOL)
        better = peak_displacements(simulate(one, self.solver, finer))
        largest = float(better.max())
        if largest == 0.0:
            return 0.0
        return float(abs(peak_displacements(response) - better).max()) / largest

    def _keep_incomplete(self, name: str, one: Case, error: ComputationError) -> None:
        """Hand on what a failed run had computed, marked incomplete."""
        from eventpound.simulation import task_of

        assert self._keep is not None
        assert error.recording is not None
        task = task_of(one, self._rtol)
        with self._keeping:
            self._keep(name, one, Response(task, self.solver, error.recording))


def _check_options(solver: str, rtol: float, case: Case) -> None:
    """Refuse a solver, a setting or a tolerance that there is not."""
    from dataclasses import replace

    from eventpound.case.case import RunOptions
    from eventpound.simulation import task_with

    options = replace(case.solver, name=solver, rtol=rtol)
    task_with(case.scene, RunOptions(0.0, 1.0, 1.0), options, None)
