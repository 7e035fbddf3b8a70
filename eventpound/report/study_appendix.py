"""The appendix of a study: its axes, its figures, its quantities, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from eventpound.report import html
from eventpound.report.many import fractiles, struck
from eventpound.report.study_files import figures_of
from eventpound.report.symbols import dimension_of
from eventpound.results.cells import Cells, cell_text, headed
from eventpound.study.reading import StudyCase
from eventpound.study.stated import stated
from eventpound.study.table import MESSAGE, SUCCESS

_MOST_FAILED, _LISTED = 50, 8
"""Runs that are listed; values of an axis, beyond which only the ends of numbers are."""


def study_sections(
    case: StudyCase, table: pd.DataFrame, manifest: Mapping[str, Any]
) -> list[html.Section]:
    """What stands behind the report of a study.

    Parameters
    ----------
    case : StudyCase
        The study, and what is drawn of it.
    table : DataFrame
        Its table.
    manifest : mapping
        Its manifest.

    Returns
    -------
    list of Section
        Empty ones have nothing to say.
    """
    study = case.study
    done = table[table[SUCCESS]]
    numbers = [n for n in done.select_dtypes("number").columns if n in set(study.quantities)]

    def place(row: int) -> str:
        return ", ".join(f"{name} = {cell_text(done[name][row])}" for name in study.columns)

    same, *parts = (text.replace("$", "").replace("\\,", " ") for text in stated(study, str))
    summary = {"runs": f"{len(done)} of {len(table)}", "in all runs": same}
    summary |= {"parts": "; ".join(parts)} if parts else {}
    first = study.bases[0].at_first().case
    return [
        ("Summary", [html.list_of(summary | struck(done))]),
        ("Axes", [_axes(study.columns, table)]),
        ("Figures", [html.figure_of(figure, said) for _, figure, said in figures_of(case, table)]),
        ("Quantities", [fractiles(done, numbers, "at", place)]),
        ("Failed", _failed(study.columns, table[~table[SUCCESS]])),
        ("Model", [html.text_part("The scene of the first run."), *html.model_of(first)]),
        ("Origin", [html.origin_of(manifest)]),
    ]


def _axes(axes: Sequence[str], table: pd.DataFrame) -> html.Part:
    """What varies: how many values, and which or from where to where."""
    rows = []
    for name in axes:
        values = table[name].drop_duplicates()
        listed = ", ".join(cell_text(value) for value in values[:_LISTED])
        if len(values) > _LISTED:
            listed += " …"
            if values.dtype.kind == "f":
                listed = f"{cell_text(values.min())} to {cell_text(values.max())}"
        rows.append((headed(name, dimension_of(name).unit), str(len(values)), listed))
    return html.table_of(Cells(("axis", "values", ""), tuple(rows), (True, False, True)))


def _failed(axes: Sequence[str], failed: pd.DataFrame) -> Iterator[html.Part]:
    """The runs that were not carried to their end, and why."""
    shown = failed.head(_MOST_FAILED)
    rows = tuple(
        (*(cell_text(row[name]) for name in axes), str(row[MESSAGE])) for _, row in shown.iterrows()
    )
    if rows:
        words = (*(False for _ in axes), True)
        yield html.table_of(Cells((*axes, "why"), rows, words, len(failed) - len(rows)))
