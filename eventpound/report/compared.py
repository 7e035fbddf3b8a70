"""`compare` as the package offers it: runs judged, and what is written of them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.accuracy.compare import entries
from eventpound.accuracy.compare import judge_entries as compared
from eventpound.accuracy.comparison_tables import run_table, table_files
from eventpound.accuracy.work_precision import STEP
from eventpound.basics.given import Count, checked, number, positive
from eventpound.case.case import Case, case_of
from eventpound.case.solver_options import solver_word
from eventpound.report.comparison_page import comparison_page
from eventpound.report.html import PAGE
from eventpound.report.work_precision import timed, work_precision_png
from eventpound.results import check_writable, write_together
from eventpound.scene import Scene
from eventpound.solvers import name_of
from eventpound.solvers.base import Solver
from eventpound.tolerances import COMPARED, REPEATS
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.accuracy.compare import Comparison


@checked
def compare(
    case: Case | Scene,
    solvers: Sequence[str | Solver],
    *,
    rtol: Sequence[float | str] = COMPARED,
    steps: Sequence[float | str] = (),
    against: Sequence[str | Path] = (),
    columns: Mapping[str, str | int] | None = None,
    repeats: Count = REPEATS,
    restitution: float | str | None = None,
    out: str | os.PathLike[str] | None = None,
) -> pd.DataFrame:
    """Judge solvers, of your own too, by a reference that two methods agree on.

    Parameters
    ----------
    case : Case or Scene
        What they run.
    solvers : sequence of str or Solver
        Names, with settings as ``"cvode:events=sundials"``, or objects (page "your-solver").
    rtol : sequence of float
        Relative tolerances at which each is asked.
    steps : sequence of float
        Time steps (s) of those that take fixed ones.
    against : sequence of str or Path
        Histories of other programs (CSV).
    columns : mapping, optional
        Names or numbers of their columns, by ours: ``{"u.deck": "x1"}``.
    repeats : int
        Runs whose median time is taken.
    restitution : float, optional
        ε of the rigid law that runs are also compared with where contacts have laws of their
        own; by default the ε that each law stands for.
    out : path, optional
        Where the tables, the diagram and the page go, as of the command ``eventpound compare``.

    Returns
    -------
    DataFrame
        A row a run, columns as in ``comparison.csv`` (page "compare" of the docs).

    Raises
    ------
    InputError
        Where a solver cannot be asked this, or files cannot be written to `out`.
    ComputationError
        Where the reference fails.
    """
    case = case_of(case)
    case = replace(case, run=case.run.completed(case.scene))
    words = [solver_word(name_of(s), "solvers", {STEP: "steps"}) for s in solvers]
    tolerances = [positive("rtol", value, Dimension.NUMBER) for value in rtol]
    sizes = [positive("steps", value, Dimension.TIME) for value in steps]
    asked = entries(words, tolerances, sizes)
    e = None if restitution is None else number("restitution", restitution, Dimension.NUMBER)
    paths = [Path(path) for path in against]
    if out is not None:
        check_writable(Path(out))
    comparison = compared(case, asked, paths, columns, repeats=repeats, restitution=e)
    if out is not None:
        write_together(out, comparison_files(comparison))
    return run_table(comparison)


def comparison_files(comparison: Comparison) -> dict[str, bytes]:
    """The tables, the diagram and the page of a comparison, by the names of their files."""
    tables = table_files(comparison)
    diagram = {"work-precision.png": work_precision_png(comparison)} if timed(comparison) else {}
    return diagram | tables | {PAGE: comparison_page(comparison, tables)}
