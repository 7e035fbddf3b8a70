"""One scene under many records: a row each, and none of them stops the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import TYPE_CHECKING

from eventpound.accuracy.judge import KEEPING
from eventpound.basics.cores import cores
from eventpound.basics.given import Count, checked
from eventpound.basics.told import Counted
from eventpound.case.case import Case, member_case
from eventpound.case.run_options import Way, refuse_options
from eventpound.case.solver_options import FAST, solver_given
from eventpound.case.suite import Member
from eventpound.errors import InputError
from eventpound.motion.record import Record
from eventpound.quantities.base import TakenFrom
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import all_of, quantities_asked
from eventpound.response import Response
from eventpound.results.manifest import case_in_manifest, machine, versions
from eventpound.results.tables import table_csv
from eventpound.simulation import check_solver
from eventpound.study.base import base_of, described
from eventpound.study.engine import Batch
from eventpound.study.forms import SUITE_TABLE, OfSuite
from eventpound.study.large_scales import warn_of_scales
from eventpound.study.plan import Plan
from eventpound.study.records import FAILED, record_columns, sa_of_suite
from eventpound.study.running import run_study
from eventpound.study.suite_statistics import INTENSITY_TABLE, intensity_table
from eventpound.study.table import SUITE_FORMAT, read_table

if TYPE_CHECKING:
    import pandas as pd

Keep = Callable[[str, Case, Response], None]
"""Called with the name of a record, its case and its response."""
_TABLED = (TakenFrom.EXTREMES, TakenFrom.ACCELERATIONS, TakenFrom.CONTACTS, TakenFrom.FORCES)
_LEAST = 3
"""Records that have a rank correlation."""


@checked
def simulate_suite(
    case: Case,
    *,
    solver: str | None = None,
    rtol: float | str | None = None,
    error_estimate: bool | None = None,
    workers: Count | None = None,
    progress: Counted | None = None,
    keep: Keep | None = None,
    intensities: bool = False,
    folder: str | Path | None = None,
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
        Number of threads; by default as many as there are cores for the fast solver, which alone
        runs without Python's global lock, and one for any other.
    progress : callable, optional
        Called with the numbers of records done and of all.
    keep : callable, optional
        Given the response to each record, one at a time but in any order; a history
        has rows only if this is given.
    intensities : bool
        Whether to give PGV (m/s) and Sa(T1) (m/s^2) of each record as scaled, too: columns
        ``PGV`` and ``Sa_T1``, at the ``psa_period`` and ``psa_damping`` of the case, else at the
        longest period of the scene and 5 %.
    folder : path, optional
        Where the table is kept, as ``eventpound run`` keeps it. A suite that was stopped goes on
        there where it was, and one that is done is read, but for `keep`.

    Returns
    -------
    DataFrame
        A row a record, columns as in ``suite.csv`` (page "suites" of the docs). What a
        record that failed has none of is NaN, and ``failed`` says why.

    Raises
    ------
    InputError
        Where the case has no suite, no file matches, or an option is wrong.

    Warns
    -----
    UserWarning
        Where records are scaled by more than ``largest_scale``.
    """
    case = replace(case, solver=solver_given(case.solver, solver, rtol))
    plan = suite_plan(case, error_estimate, intensities)
    warn_of_scales(plan.bases)
    with TemporaryDirectory() as scratch:
        out = Path(scratch if folder is None else folder)
        run_suite(plan, case, out, progress, keep, workers)
        return read_table(out, SUITE_TABLE)


def run_suite(
    plan: Plan,
    case: Case,
    out: Path,
    progress: Counted | None = None,
    keep: Keep | None = None,
    workers: int | None = None,
) -> Path | None:
    """Make what is missing of the table of a suite; where earlier results were moved."""
    started = datetime.now(UTC)

    def details() -> tuple[dict[str, bytes], dict[str, object]]:
        table = read_table(out, SUITE_TABLE)
        orders = orders_of(table, case)
        files = {} if orders.empty else {INTENSITY_TABLE: table_csv(orders)}
        return files, _manifest(table, case, started, plan.size)

    threads = workers or (cores() if plan.solver == FAST else 1)
    engine = Batch(threads, None if keep is None else _handing_on(case, keep))
    return run_study(plan, out, engine, progress, details, again=keep is not None)


def suite_plan(case: Case, error_estimate: bool | None = None, intensities: bool = False) -> Plan:
    """The plan of a suite.

    Raises
    ------
    InputError
        As `simulate_suite` says.
    """
    members, options = case.members, case.solver
    if not members:
        raise InputError("the case has no suite of records; simulate runs it")
    errors = bool(case.run.error_estimate if error_estimate is None else error_estimate)
    scene, quantities = case.scene, []
    if scene.bodies:
        # Options that no run can have are an error of the whole, not of every record.
        check_solver(options, scene, case.run)
        refuse_options(case.run, Way.SUITE)
        if errors and options.name not in KEEPING:
            raise InputError(
                f"error_estimate: the solver {options.name!r} does not keep a tolerance, by "
                f"which a second run could tell; accepted: {', '.join(KEEPING)}"
            )
        tabled = all_of(scene, [q for q in LISTED if q.tabled and q.source in _TABLED])
        quantities = [*(named.name for named in tabled), *quantities_asked([(scene, case.run)])]
    sa = sa_of_suite(case) if intensities else None
    form, base = OfSuite(sa, errors), described(base_of(case, (), members, options))
    names = tuple(dict.fromkeys(quantities))
    columns = record_columns(members, sa is not None)
    return Plan(case.title, (base,), columns, names, options.name, options.rtol, form)


def _handing_on(case: Case, keep: Keep) -> Callable[[Member, Response], None]:
    """What hands on a record, its case and its response, one at a time."""
    keeping = Lock()

    def hand_on(member: Member, response: Response) -> None:
        motion = response.scene.motion
        assert isinstance(motion, Record)
        assert motion.source is not None
        own = member_case(case, member, motion.source)
        with keeping:
            keep(member.name, own, response)

    return hand_on


def orders_of(table: pd.DataFrame, case: Case) -> pd.DataFrame:
    """How well measures of intensity order the peaks of a suite; no rows of a few records."""
    done = table[table[FAILED] == ""]
    bodies = [body.name for body in case.scene.bodies] if len(done) >= _LEAST else []
    return intensity_table(done, bodies)


def _manifest(table: pd.DataFrame, case: Case, started: datetime, total: int) -> dict[str, object]:
    """What is said of the table of a suite."""
    failed = table[table[FAILED] != ""]
    return {
        "format": SUITE_FORMAT,
        "started": started.isoformat(),
        "complete": len(table) == total,
        "records": len(table),
        "records_of_suite": total,
        "failed": dict(zip(failed["record"], failed[FAILED], strict=True)),
        "options": {
            "solver": case.solver.name,
            "rtol": case.solver.rtol,
            "settings": dict(case.solver.settings),
        },
        **case_in_manifest(case),
        "versions": versions(),
        "machine": machine(),
    }
