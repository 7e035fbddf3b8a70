"""The page of a study: its axes, its figures, its quantities, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from eventpound.report.html import (
    Part,
    figure_of,
    list_of,
    model_of,
    origin_of,
    page,
    table_of,
    text_part,
)
from eventpound.report.intensity_figure import intensity_figure
from eventpound.report.many import fractiles, struck
from eventpound.report.study_figure import study_figures
from eventpound.report.symbols import dimension_of
from eventpound.results.cells import Cells, headed, text_of
from eventpound.study.intensity import fractile_curves
from eventpound.study.reading import StudyCase
from eventpound.study.stated import stated
from eventpound.study.table import MESSAGE, SUCCESS

_MOST_FAILED, _LISTED = 50, 8
"""Runs that are listed; values of an axis, beyond which only the ends of numbers are."""


def study_page(case: StudyCase, table: pd.DataFrame, manifest: Mapping[str, Any]) -> bytes:
    """The page of a study.

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
    bytes
        HTML, UTF-8.
    """
    study = case.study
    done = table[table[SUCCESS]]
    numbers = [n for n in done.select_dtypes("number").columns if n in set(study.quantities)]

    def place(row: int) -> str:
        return ", ".join(f"{name} = {text_of(done[name][row])}" for name in study.columns)

    same, *parts = (text.replace("$", "").replace("\\,", " ") for text in stated(study, str))
    summary = {"runs": f"{len(done)} of {len(table)}", "in all runs": same}
    summary |= {"parts": "; ".join(parts)} if parts else {}
    first = study.bases[0].at_first().case
    sections = [
        ("Summary", [list_of(summary | struck(done))]),
        ("Axes", [_axes(study.columns, table)]),
        ("Figures", _figures(case, table)),
        ("Quantities", [fractiles(done, numbers, "at", place)]),
        ("Failed", _failed(study.columns, table[~table[SUCCESS]])),
        ("Model", [text_part("The scene of the first run."), *model_of(first)]),
        ("Origin", [origin_of(manifest)]),
    ]
    return page(study.title, sections)


def _axes(axes: Sequence[str], table: pd.DataFrame) -> Part:
    """What varies: how many values, and which or from where to where."""
    rows = []
    for name in axes:
        values = table[name].drop_duplicates()
        listed = ", ".join(text_of(value) for value in values[:_LISTED])
        if len(values) > _LISTED:
            listed += " …"
            if values.dtype.kind == "f":
                listed = f"{text_of(values.min())} to {text_of(values.max())}"
        rows.append((headed(name, dimension_of(name).unit), str(len(values)), listed))
    return table_of(Cells(("axis", "values", ""), tuple(rows), (True, False, True)))


def _figures(case: StudyCase, table: pd.DataFrame) -> Iterator[Part]:
    """Those that the case asks for."""
    for plan in case.figures:
        for _, figure in study_figures(case, plan, table):
            yield figure_of(figure, plan.claim or plan.title or case.study.title)
    for intensity in case.intensities:
        curves = fractile_curves(table, intensity)
        drawn = intensity_figure(case.study, intensity, table, curves)
        yield figure_of(drawn, f"Fractiles of {intensity.demand} over {intensity.measure}.")


def _failed(axes: Sequence[str], failed: pd.DataFrame) -> Iterator[Part]:
    """The runs that were not carried to their end, and why."""
    shown = failed.head(_MOST_FAILED)
    rows = tuple(
        (*(text_of(row[name]) for name in axes), str(row[MESSAGE])) for _, row in shown.iterrows()
    )
    if rows:
        words = (*(False for _ in axes), True)
        yield table_of(Cells((*axes, "why"), rows, words, len(failed) - len(rows)))
