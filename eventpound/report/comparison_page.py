"""The page of a comparison: the scene, speed against error, what was missed."""

from __future__ import annotations

from collections.abc import Iterator

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import cells_of, quantity_table, remarks_of
from eventpound.report import html
from eventpound.report.work_precision import timed, work_precision_figure
from eventpound.results.cells import Cells, cell_text
from eventpound.results.manifest import machine, sha256, versions

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
