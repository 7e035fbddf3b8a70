"""Figures of the report: demands over the records, and the motion under the one that governs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.quantities.lookup import Named
from eventpound.quantities.owners import owners_of
from eventpound.report import style
from eventpound.report.design_tables import joint_names
from eventpound.report.markers import draw_circles, draw_ground, draw_shocks
from eventpound.report.view import View
from eventpound.results.shown_units import Units
from eventpound.results.tables import headed
from eventpound.scene.contact import Contact
from eventpound.scene.ends import End, label_of, weights_of
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.scene import Scene
from eventpound.study.demands import NEEDED
from eventpound.study.design import FRACTILES
from eventpound.study.records import FAILED, SA
from eventpound.units import Dimension

_WIDE, _HIGH = 7.4, 2.3
"""Inches."""
_MOST_LINES = 6
"""Contacts or springs in one panel."""
_NAMES: Any = {"fontsize": 6.5, "ncols": 2, "columnspacing": 1.0, "handletextpad": 0.2}


_ROOM = 270.0
"""Size of letters of names in two columns, times their number and that of panels, that fits."""
_ABOVE: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.96), **_NAMES, "borderaxespad": 0.0}
"""A legend over its panel, not over a curve."""


@style.styled()
def demand_figure(
    scene: Scene,
    runs: pd.DataFrame,
    panels: Sequence[Sequence[Named]],
    units: Units,
    size: tuple[str, float] | None = None,
) -> Figure:
    """Draw demands over the numbers of the records.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    runs : DataFrame
        Table of the suite, a row a record.
    panels : sequence of sequence of Named
        Demands of one kind each, of several owners.
    units : Units
        Units.
    size : tuple of str and float, optional
        What the size of the records is called, in a panel of its own, and what it was to be
        (m/s^2), NaN where that is not said.
    """
    figure = style.new_figure(_WIDE, _HIGH)
    numbers = np.arange(1, len(runs) + 1)
    shown = runs.where(runs[FAILED] == "")
    every = list(np.atleast_1d(figure.subplots(1, len(panels) + (size is not None))))
    if size is not None:
        _draw_sizes(every.pop(0), runs, size, units)
    for axes, demands in zip(every, panels, strict=True):
        quantity = demands[0].quantity
        name, of = units.unit(quantity.dimension.unit, quantity.path)
        drawn = _largest(shown, demands)
        # Lines of all are told apart by nobody.
        governs = shown[[named.name for named in drawn]].abs().quantile(FRACTILES[-1] / 100.0)
        for named, color in zip(drawn, style.colors(len(drawn)), strict=True):
            values = shown[named.name].abs().to_numpy(float) / of
            joint = joint_names(scene).get(named.i) if quantity.path == NEEDED else None
            label = style.literal(joint or owners_of(scene, quantity.owner)[named.i])
            axes.plot(numbers, values, "o", markersize=3.0, color=color, label=label)
            of_largest = FRACTILES if named.name == governs.idxmax() else ()
            for fractile, line in zip(of_largest, (":", "--"), strict=False):
                level = np.nanpercentile(values, fractile) if np.isfinite(values).any() else np.nan
                axes.axhline(level, color=color, linestyle=line, linewidth=0.8)
        _name_axes(axes, runs, headed(quantity.called, name))
        if len(demands) > 1:
            longest = max(len(str(label)) for label in axes.get_legend_handles_labels()[1])
            fitting = min(_NAMES["fontsize"], _ROOM / (len(panels) * longest))
            style.legend_above(axes, **_NAMES | {"fontsize": fitting})
    return figure


def _name_axes(axes: Axes, runs: pd.DataFrame, name: str) -> None:
    """Name axes over the numbers of the records, from zero on."""
    axes.set(xlabel="record", ylabel=name, xlim=(0.0, len(runs) + 1.0))
    # A point is as wide as half a millimetre.
    axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])


def _draw_sizes(axes: Axes, runs: pd.DataFrame, size: tuple[str, float], units: Units) -> None:
    """Draw Sa of each record, and what it was to be."""
    called, wanted = size
    unit, of = units.unit(Dimension.ACCELERATION.unit)
    values = runs[SA].to_numpy(float) / of
    axes.plot(np.arange(1, len(runs) + 1), values, "o", markersize=3.0, color="#444444")
    if wanted == wanted:
        axes.axhline(wanted / of, color=style.PALETTE[1], linewidth=0.8, label="wanted")
        style.legend_above(axes, **_NAMES)
    _name_axes(axes, runs, headed(called, unit))


def _largest(runs: pd.DataFrame, demands: Sequence[Named]) -> list[Named]:
    """Demands that are largest under some record, as many as a panel shows, in their order."""
    most = runs[[named.name for named in demands]].abs().max()
    kept = set(most.nlargest(_MOST_LINES).index)
    return [named for named in demands if named.name in kept][:_MOST_LINES]


@style.styled()
def governing_figure(view: View, contact: Contact | None, body: str, units: Units) -> Figure:
    """Draw the ground, what moves at a contact, and its gap.

    Parameters
    ----------
    view : View
        Results of the run.
    contact : Contact, optional
        Which; without one only the body is drawn.
    body : str
        What is drawn without a contact.
    units : Units
        Units.
    """
    ends: list[End] = [body] if contact is None else _drawn_ends(contact, view)
    view = view.within(_strong(view, ends))
    figure = style.new_figure(_WIDE, 3.6 if contact else 2.6)
    heights = [1.0, 1.6, 1.2] if contact else [1.0, 1.6]
    ground, motion, *gaps = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    for axes in (ground, motion, *gaps):
        style.zero_lines(axes)
    unit, size = units.unit(Dimension.ACCELERATION.unit)
    draw_ground(ground, view, size)
    ground.set_ylabel(f"ground ({unit})")
    draw_shocks(ground, view)
    unit, size = units.unit(Dimension.LENGTH.unit)
    for name, color in zip(ends, style.colors(len(ends)), strict=True):
        line = view.displacement(name) / size
        where = " normal to the edge" * isinstance(name, PlanPoint)
        label = style.literal(f"{label_of(name)}{where}")
        motion.plot(view.t, line, color=color, label=label)
        if contact is not None:
            draw_circles(motion, view, contact.name, (view.t, line), color)
    motion.set_ylabel(f"displacement ({unit})")
    motion.legend(**_ABOVE)
    for axes in gaps:
        assert contact is not None
        _draw_gap(axes, view, contact, units)
    (gaps or [motion])[-1].set_xlabel("time (s)")
    motion.set_xlim(view.t[0], view.t[-1])
    figure.align_ylabels()
    return figure


def _drawn_ends(contact: Contact, view: View) -> list[End]:
    """Ends of a contact that move: bodies, or places of decks in its direction."""
    found = list[End]()
    for end in contact.sides:
        names: list[End] = [name for name, _ in weights_of(end) if name in view.bodies]
        found += [end] if isinstance(end, PlanPoint) else names
    return found


def _draw_gap(axes: Axes, view: View, contact: Contact, units: Units) -> None:
    unit, size = units.unit(Dimension.LENGTH.unit)
    gap, name = view.column(f"gap.{contact.name}") / size, style.literal(contact.name)
    axes.plot(view.t, gap, color=style.PALETTE[2], label=name)
    axes.axhline(contact.gap / size, color=style.PALETTE[2], **style.DASHED)
    draw_circles(axes, view, contact.name, (view.t[:1], np.zeros(1)), style.PALETTE[2])
    axes.set_ylabel(f"gap ({unit})")
    axes.legend(**_ABOVE)


def _strong(view: View, ends: Sequence[End]) -> tuple[float, float]:
    """The stretch of time in which what is drawn moves by more than a twentieth of its peak (s)."""
    u = np.max([np.abs(view.displacement(name)) for name in ends], axis=0)
    moving = np.flatnonzero(u > 0.05 * u.max(initial=0.0))
    if not moving.size:
        return float(view.t[0]), float(view.t[-1])
    return float(view.t[moving[0]]), float(view.t[moving[-1]])
