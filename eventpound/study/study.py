"""Studies from Python: a scene and axes in, a table out."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from eventpound.basics.given import Count, checked, positive
from eventpound.basics.told import Counted
from eventpound.case.case import Case, case_of
from eventpound.case.record_options import RecordOptions
from eventpound.case.solver_options import FAST
from eventpound.case.suite import Member, Suite
from eventpound.errors import InputError
from eventpound.scene.scene import Scene
from eventpound.simulation import check_case
from eventpound.study.axes import given_axes
from eventpound.study.base import RECORD, base_of, described, solver_of
from eventpound.study.engine import Batch, Processes
from eventpound.study.forms import SUCCESS
from eventpound.study.large_scales import warn_of_scales
from eventpound.study.plan import planned
from eventpound.study.running import run_study
from eventpound.study.table import read_table
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

_SHOWN = 10


class Study:
    """A scene varied along axes, under one motion or under many records.

    Parameters
    ----------
    case : Case or Scene
        What is varied. A case with a suite is varied under each of its records.
    axes : mapping of str to sequence
        Values of numbers of the scene by their dotted keys, ``"contact.joint.gap"``, or of
        Π-terms, ``"pi.delta"``; SI, or texts with units. The table has a row for each
        combination, the last axis fastest.
    quantities : sequence of str, optional
        What is tabulated (page "quantities" of the docs), by name or path; by default peaks.
        What ``[run]`` of a case asks for comes beside it.
    records : str, optional
        Pattern of files, or a list of them, as for a suite (page "suites"): all axes vary under
        each. Relative to the working directory.
    together : sequence of sequences of str
        Groups of axes that vary together, row by row, by their keys; of the same length.
    solver : str, optional
        Name of the solver, with settings as for `simulate`; by default ``"fast"``, or ``"cvode"``
        for what that does not take.
    rtol : float, optional
        Relative tolerance; by default that of the case, 1e-6 for a scene.
    duration : float or str, optional
        Length of the runs (s); by default that of the case, or as of `simulate` for each motion.

    Raises
    ------
    InputError
        With one line for every problem; nothing is run then.

    Examples
    --------
    >>> ball = Body("ball", "1 kg", velocity="1 m/s")
    >>> wall = Contact("wall", "ball", "barrier", gap="1 m", restitution=0.5)
    >>> axes = {"contact.wall.gap": ["50 cm", "1 m"], "contact.wall.restitution": [0.0, 1.0]}
    >>> study = Study(
    ...     Scene([ball], contacts=[wall]), axes, quantities=["final.ball.u"], duration="2 s"
    ... )
    >>> [round(u, 9) for u in study.run().table["final.ball.u"]]
    [0.5, -1.0, 1.0, 0.0]
    """

    @checked
    def __init__(
        self,
        case: Case | Scene,
        axes: Mapping[str, Iterable[object]],
        *,
        quantities: Sequence[str] = (),
        records: str | None = None,
        together: Sequence[Sequence[str]] = (),
        solver: str | None = None,
        rtol: float | str | None = None,
        duration: float | str | None = None,
    ) -> None:
        options = solver_of(case, rtol, solver)
        length = math.nan if duration is None else positive("duration", duration, Dimension.TIME)
        varied, members = given_axes("axes", axes, together), _members(case, records)
        if records:
            # Each of these sets its own.
            case = case_of(case)
            case = replace(case, run=case.run.lasting(math.nan))
        check_case(case)
        base = described(base_of(case, varied, members, options, length))
        columns = (*([RECORD] if base.records else []), *axes)
        self.plan, problems = planned((base,), columns, quantities, options)
        if problems:
            tables = {"[study]: ": "", "[[study.axis]] ": "axes: "}
            raise InputError([_without(tables, problem) for problem in problems])

    @checked
    def run(
        self,
        folder: str | Path | None = None,
        *,
        progress: Counted | bool = False,
        workers: Count | None = None,
        processes: Count | None = None,
    ) -> StudyTable:
        """Make all runs.

        Parameters
        ----------
        folder : path, optional
            Where the table is kept, as ``eventpound study`` keeps it. A study that was stopped
            goes on there where it was, and one that is done is read.
        progress : bool or callable
            True shows on stderr how far it is; a callable is given the runs that are done and all.
        workers : int, optional
            Threads of the fast solver; as many as there are cores.
        processes : int, optional
            How many processes compute it instead; for other solvers than the fast one, which
            otherwise take one run after the other.

        Returns
        -------
        StudyTable
            A row a run. One that failed has ``success`` false and its reason in ``message``.

        Raises
        ------
        InputError
            Where the folder cannot be written to, or another program makes a study there.

        Warns
        -----
        UserWarning
            Where runs scale their record by more than ``largest_scale``.
        """
        warn_of_scales(self.plan.bases)
        show = _shown if progress is True else progress or None
        engine = Batch(workers if self.plan.solver == FAST else 1)
        with TemporaryDirectory() as scratch:
            out = Path(scratch if folder is None else folder)
            run_study(self.plan, out, Processes(processes) if processes else engine, show)
            table = read_table(out)
        if progress is True:
            print(file=sys.stderr)
        return StudyTable(table, self.plan.columns)

    def __repr__(self) -> str:
        plan = self.plan
        over = ", ".join(plan.columns)
        return f"<Study: {plan.size} runs over {over}; {plan.solver}, rtol {plan.rtol:g}>"


@dataclass(frozen=True)
class StudyTable:
    """What a study found.

    Parameters
    ----------
    table : DataFrame
        A row a run: the axes, the quantities, ``success`` and ``message``.
    axes : tuple of str
        Its first columns.
    """

    table: pd.DataFrame
    axes: tuple[str, ...]

    @property
    def failed(self) -> pd.DataFrame:
        """Rows of the runs that failed."""
        return self.table[~self.table[SUCCESS]]

    def __getitem__(self, key: Any) -> Any:
        """A column or several, as of a DataFrame."""
        return self.table[key]

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        found = [name for name in self.table.columns[:-2] if name not in self.axes]
        over, of = ", ".join(self.axes), ", ".join(found)
        return f"<StudyTable: {len(self)} runs over {over}, {len(self.failed)} failed; {of}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self))}</p>" + str(self.table.to_html(max_rows=_SHOWN))


def _without(tables: Mapping[str, str], problem: str) -> str:
    """A problem without the table of a file that it would stand in."""
    for table, word in tables.items():
        problem = problem.replace(table, word, 1)
    return problem


def _shown(done: int, size: int) -> None:
    """Show how far a study is."""
    print(f"\r{done / size:4.0%}  {done} of {size} runs", end="", file=sys.stderr, flush=True)


def _members(given: Case | Scene, records: str | None) -> tuple[Member, ...]:
    """The records of a pattern, or those of the case."""
    case = case_of(given)
    if records is None:
        return case.members
    own = case.suite or Suite(None, (), RecordOptions())
    chosen = replace(own, pattern=str(Path(records).absolute()), synthetic=(), rest=None)
    return tuple(chosen.members(case.directory))
