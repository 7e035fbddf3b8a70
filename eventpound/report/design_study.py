"""The report of a study: its demands over the axes, the largest of all elements; its model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from eventpound.report import style
from eventpound.report.design_report import limits, model_blocks
from eventpound.report.design_tables import NUMBERS, capacity_words
from eventpound.report.sheets import Block, Head, Picture, Sheet, Words
from eventpound.report.symbols import axis_label, display_unit, value_label
from eventpound.results.manifest import solved_by
from eventpound.results.shown_units import Units
from eventpound.results.tables import Cells, Row, headed
from eventpound.study.base import RECORD
from eventpound.study.design import FRACTILES, MOST_CLOSE
from eventpound.study.large_scales import large_scales_of
from eventpound.study.plan import Plan

_SHOWN = (
    *("separation_needed", "ductility", "max_opening", "seat_used", "max_impulse"),
    *("storey_drift_ratio", "abs_max_force"),
)
"""Demands, by the last words of their quantities."""
_MOST_ROWS, _MOST_CURVES, _MOST_PANELS = 40, 6, 3
_WIDE, _HIGH, _TALL = 7.4, 2.6, 66.0
"""Inches of the figure, and its height on the sheet (mm)."""


def study_cells(study: Plan, design: pd.DataFrame, units: Units) -> Cells:
    """The largest demands of all elements of a kind, a row a point of the study."""
    values, called = _largest(study, design)
    return _table(values, _axes(study), called, units)


def study_workbook(design: pd.DataFrame, units: Units) -> dict[str, list[Row]]:
    """All design numbers of a study as sheets of a workbook, one a kind of elements."""
    sheets: dict[str, list[Row]] = {}
    for kind, part in design.groupby("kind", sort=False) if len(design) else ():
        shown = part.dropna(axis="columns", how="all").drop(columns=["kind"])
        rows = sheets[str(kind)] = [[*map(str, shown.columns)]]
        for row in shown.to_dict("records"):
            unit, size = units.of_row(row)
            scaled = {key: row[key] / size for key in NUMBERS if key in row} | {"unit": unit}
            cells = (scaled.get(str(key), value) for key, value in row.items())
            rows.append([x if isinstance(x, str) else float(x) for x in cells])
    return sheets


def study_sheets(
    study: Plan, design: pd.DataFrame, units: Units, warnings: Sequence[str]
) -> list[Sheet]:
    """The two sheets of a study: its numbers; its model, limits and origin.

    Parameters
    ----------
    study : Plan
        What was run.
    design : DataFrame
        Its design numbers, a row a demand at each combination of the axes.
    units : Units
        Units.
    warnings : sequence of str
        Of its case.
    """
    return [list(_first(study, design, units)), list(_second(study, design, warnings))]


def _axes(study: Plan) -> list[str]:
    return [name for name in study.columns if name != RECORD]


def _largest(study: Plan, design: pd.DataFrame) -> tuple[pd.DataFrame, dict[str, pd.Series]]:
    """Largest demands at each combination of the axes, by last words, and a row of each."""
    column = f"{FRACTILES[1]:g} %"
    suffix = design["quantity"].map(lambda name: str(name).rpartition(".")[2])
    found = {word: design[suffix == word] for word in _SHOWN if (suffix == word).any()}
    if not found:
        found = {"abs_max": design[design["quantity"].str.startswith("peaks.")]}
    # Records alone are one point.
    at: Any = _axes(study) or (lambda _: 0)
    values = {
        word: rows.groupby(at, sort=False, dropna=False)[column].max()
        for word, rows in found.items()
    }
    if "demand/capacity" in design:
        ratios = design.groupby(at, sort=False, dropna=False)["demand/capacity"]
        values["ratio"] = ratios.max()
        found["ratio"] = pd.DataFrame(
            [{"demand": "demand/capacity", "unit": "", "quantity": "demand_over_capacity"}]
        )
    return pd.DataFrame(values).reset_index(), {word: rows.iloc[0] for word, rows in found.items()}


def _first(study: Plan, design: pd.DataFrame, units: Units) -> Iterator[Block]:
    axes = _axes(study)
    yield Head(study.title, title=True)
    stated = study.bases[0].case.run.stated
    records, (_, high) = int(design["records"].max()), FRACTILES
    under = f"the {high:g} % fractile over {records} records" if records > 1 else "one motion"
    said = [f"Each number is the largest of all elements of its kind, under {under}."]
    if records > 1 and "demand/capacity" in design:
        said.append(f"Demand over capacity is at {stated.fractile:g} % of the records.")
    said += [*capacity_words(design, stated.fractile), large_scales_of(study.bases)]
    if study.size > MOST_CLOSE:
        said.append(f"Forces that take rows close together are left out of {study.size} runs.")
    yield Words(tuple(filter(None, said)))
    values, called = _largest(study, design)
    numeric = [axis for axis in axes if values[axis].dtype.kind == "f"]
    if numeric:
        yield Head("Demand over the axes")
        yield Picture(_figure(study, values, numeric, called, units), _TALL)
    yield Head("Design numbers")
    yield _table(values, axes, called, units)


def _second(study: Plan, design: pd.DataFrame, warnings: Sequence[str]) -> Iterator[Block]:
    base = study.bases[0]
    case = base.at_first().case
    yield Words(("The model is that of the first run.",))
    yield from model_blocks(case)
    if base.records:
        yield Head("Records")
        yield Words((f"{len(base.records)}: {', '.join(r.name for r in base.records)}.",))
    yield Head("Limits and warnings")
    yield Words(tuple(f"• {text}" for text in limits(case, warnings)))
    yield Head("Origin")
    yield Words((solved_by(study.solver, study.rtol), f"SHA-256: study {study.digest[:16]}."))


def _together(study: Plan, x: str) -> set[str]:
    """Axes that vary together with one, row by row; it is one of them."""
    words = {axis.key: axis.together for base in study.bases for axis in base.axes}
    return {x} | {key for key, word in words.items() if word and word == words.get(x)}


@style.styled()
def _figure(
    study: Plan,
    values: pd.DataFrame,
    numeric: list[str],
    called: dict[str, pd.Series],
    units: Units,
) -> Figure:
    """Demands over the axis of most values, a curve for each combination of the others."""
    x = max(numeric, key=lambda axis: values[axis].nunique())
    with_x = _together(study, x)
    others = [axis for axis in _axes(study) if axis not in with_x]
    unit = display_unit(x, float(values[x].abs().max()))
    shown = list(called)[:_MOST_PANELS]
    figure = style.new_figure(_WIDE, _HIGH)
    panels = np.atleast_1d(figure.subplots(1, len(shown)))
    groups = list(values.groupby(others, sort=False, dropna=False)) if others else [((), values)]
    colors = style.colors(min(len(groups), _MOST_CURVES))
    for panel, word in zip(panels, shown, strict=True):
        name, size = units.of_row(called[word])
        for (at, rows), color in zip(groups, colors, strict=False):
            label = ", ".join(value_label(k, v) for k, v in zip(others, at, strict=True))
            panel.plot(rows[x] / unit.size, rows[word] / size, "o-", color=color, label=label)
        panel.set(xlabel=axis_label(x, unit))
        panel.set_ylim(0.0, 1.05 * panel.get_ylim()[1])
        panel.set_ylabel(headed(called[word]["demand"], name))
    if others:
        style.legend_above(panels[0], fontsize=6.5, ncols=1)
    return figure


def _table(
    values: pd.DataFrame, axes: list[str], called: dict[str, pd.Series], units: Units
) -> Cells:
    """A row for each combination of the axes."""
    of_axes = {
        axis: display_unit(axis, float(values[axis].abs().max()))
        for axis in axes
        if values[axis].dtype.kind == "f"
    }
    heads = [headed(axis, of_axes[axis].name) if axis in of_axes else axis for axis in axes]
    rows = []
    for row in values.head(_MOST_ROWS).to_dict("records"):
        cells = [_plain(row[a] / of_axes[a].size) if a in of_axes else str(row[a]) for a in axes]
        for word, first in called.items():
            cells.append(units.number(float(row[word]), str(first["unit"]), str(first["quantity"])))
        rows.append(tuple(cells))
    for first in called.values():
        heads.append(headed(str(first["demand"]), units.of_row(first).name))
    words = (*(axis not in of_axes for axis in axes), *(False for _ in called))
    return Cells(tuple(heads), tuple(rows), words, max(0, len(values) - _MOST_ROWS))


def _plain(value: float) -> str:
    """A value of an axis without an exponent where it is large."""
    text = f"{value:.4g}"
    return f"{value:.0f}" if "e+" in text else text
