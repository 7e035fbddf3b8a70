"""`compare` as the package offers it: runs judged, and what is written of them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.accuracy.compare import Comparison, entries
from eventpound.accuracy.compare import judge_entries as compared
from eventpound.accuracy.comparison_tables import (
    cells_of,
    quantity_table,
    remarks_of,
    run_table,
    table_files,
)
from eventpound.accuracy.work_precision import STEP
from eventpound.basics.given import Count, checked, number, positive
from eventpound.case.case import Case, case_of
from eventpound.case.solver_options import solver_word
from eventpound.report import html
from eventpound.report.html import PAGE
from eventpound.report.style import png
from eventpound.report.work_precision import timed, work_precision_figure
from eventpound.results import check_writable, write_together
from eventpound.results.manifest import machine, sha256, versions
from eventpound.results.tables import Cells, cell_text
from eventpound.scene import Scene
from eventpound.solvers import name_of
from eventpound.solvers.base import Solver
from eventpound.tolerances import COMPARED, REPEATS
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd


_MOST_QUANTITIES = 12
"""Of a run, the worst first."""


def comparison_page(comparison: Comparison, files: dict[str, bytes]) -> bytes:
    """The page of a comparison.

    Parameters
    ----------
    comparison : Comparison
        What was found.
    files : dict
        Its tables by their names, whose hashes are stated.

    Returns
    -------
    bytes
        HTML, UTF-8.
    """
    hashes = {name: sha256(text) for name, text in files.items() if name.endswith(".csv")}
    manifest = {"versions": versions(), "files": hashes, "machine": machine()}
    said = 'Errors are parts of the largest value, as the page "compare" of the documentation says.'
    remarks = [*remarks_of(comparison), said]
    sections = [
        ("Summary", [_summary(comparison)]),
        ("Speed against error", _diagram(comparison)),
        ("Runs", [html.table_of(cells_of(comparison)), html.text_part(*remarks)]),
        ("Quantities", _quantities(comparison)),
        ("Model", html.model_of(comparison.case)),
        ("Origin", [html.origin_of(manifest)]),
    ]
    return html.page(f"{comparison.case.title}: solvers compared", sections)


def _summary(comparison: Comparison) -> html.Part:
    judged = [run for run in comparison.runs if run.errors is not None]
    lines = {"reference": comparison.reference.words}
    if comparison.reference.rigid_words:
        lines["rigid law"] = comparison.reference.rigid_words
    lines["runs"] = f"{len(judged)} of {len(comparison.runs)} judged"
    wrong = ", ".join(f"{run.label} ({run.size})" for run in judged if run.wrong)
    right = "found by all, none invented"
    return html.list_of(lines | {"impacts": f"missed or invented by {wrong}" if wrong else right})


def _diagram(comparison: Comparison) -> Iterator[html.Part]:
    if timed(comparison):
        caption = "Wall time against error; open markers: impacts missed or extra."
        if comparison.laws is not None:
            caption += " Dotted: against the rigid law in the place of the contact laws."
        yield html.figure_of(work_precision_figure(comparison), caption)


def _quantities(comparison: Comparison) -> Iterator[html.Part]:
    """The worst quantities of every run."""
    table = quantity_table(comparison)
    heads = ("quantity", "value", "reference", "error")
    for (solver, size), rows in table.groupby(["solver", "size"], sort=False, dropna=False):
        worst = rows.sort_values("error", ascending=False).head(_MOST_QUANTITIES)
        lines = tuple(
            tuple(map(cell_text, row)) for row in worst[list(heads)].itertuples(index=False)
        )
        cells = Cells(heads, lines, (True, False, False, False))
        yield html.folded(f"{solver} {size}", html.table_of(cells))


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
    drawn = timed(comparison)
    diagram = {"work-precision.png": png(work_precision_figure(comparison))} if drawn else {}
    return diagram | tables | {PAGE: comparison_page(comparison, tables)}
