"""One self-contained HTML page of a comparison: the scene, speed against error, what was missed."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import pandas as pd

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import quantity_table, remarks_of, text_rows
from eventpound.report.html import figure_of, list_of, model_section, page, table_of, text_of
from eventpound.report.work_precision import timed, work_precision_figure
from eventpound.results.input_tables import Cells
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
    title = f"{comparison.case.title}: solvers compared"
    return page(
        title,
        [
            ("Summary", _summary(comparison)),
            ("Speed against error", _diagram(comparison)),
            ("Runs", _runs(comparison)),
            ("Quantities", _quantities(comparison)),
            ("Model", model_section(comparison.case)),
            ("Origin", _origin(files)),
        ],
    )


def _summary(comparison: Comparison) -> Iterator[str]:
    judged = [run for run in comparison.runs if run.errors is not None]
    lines = {"reference": comparison.reference.words}
    if comparison.reference.rigid_words:
        lines["rigid law"] = comparison.reference.rigid_words
    lines |= {
        "runs": f"{len(judged)} of {len(comparison.runs)} judged",
    }
    wrong = [
        f"{run.label} ({run.size})"
        for run in judged
        if run.errors and (run.errors.impacts.missed or run.errors.impacts.extra)
    ]
    lines["impacts"] = (
        f"missed or invented by {', '.join(wrong)}" if wrong else "found by all, none invented"
    )
    yield list_of(lines)


def _diagram(comparison: Comparison) -> Iterator[str]:
    if timed(comparison):
        caption = "Wall time against error; open markers: impacts missed or extra."
        if comparison.laws is not None:
            caption += " Dotted: against the rigid law in the place of the contact laws."
        yield figure_of(work_precision_figure(comparison), caption)


def _runs(comparison: Comparison) -> Iterator[str]:
    headings, *rows = text_rows(comparison)
    words = tuple(i < 2 for i in range(len(headings)))
    yield table_of(Cells(tuple(headings), tuple(tuple(row) for row in rows), words))
    yield from (f"<p>{escape(remark)}</p>\n" for remark in remarks_of(comparison))
    yield "<p>Errors are parts of the largest value (page “compare” of the documentation).</p>\n"


def _quantities(comparison: Comparison) -> Iterator[str]:
    """The worst quantities of every run."""
    table = quantity_table(comparison)
    if table.empty:
        return
    for (solver, size), rows in table.groupby(["solver", "size"], sort=False, dropna=False):
        worst = rows.sort_values("error", ascending=False).head(_MOST_QUANTITIES)
        heads = ("quantity", "value", "reference", "error")
        lines = tuple(
            tuple("" if pd.isna(cell) else text_of(cell) for cell in row)
            for row in worst[list(heads)].itertuples(index=False)
        )
        cells = table_of(Cells(heads, lines, (True, False, False, False)))
        name = escape(f"{solver} {size}")
        yield f"<details><summary>{name}</summary>\n{cells}</details>\n"


def _origin(files: dict[str, bytes]) -> Iterator[str]:
    """Versions, the machine that was timed, and hashes of the tables."""
    lines = {name: version for name, version in versions().items() if version}
    lines |= {name: sha256(content) for name, content in files.items() if name.endswith(".csv")}
    lines["machine"] = ", ".join(map(str, machine().values()))
    yield list_of(lines)
