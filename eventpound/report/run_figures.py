"""All figures of a run, from results in memory or on disk to files; among them its profiles."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from eventpound.basics.given import checked
from eventpound.case import read_case
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.report import style
from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure, nonlinear_springs
from eventpound.report.plan_view import worst_plan_figure
from eventpound.report.style import Paper, on_paper
from eventpound.report.towers import Tower, towers_of
from eventpound.report.view import OtherRun, View
from eventpound.response import Response
from eventpound.results import StoredResults, gather, read, write_together
from eventpound.results.shown_units import PERCENT, Unit
from eventpound.scene.scene import Scene

Source = StoredResults | Response | str | os.PathLike[str]


def figures(
    source: Source,
    beside: tuple[Source, str] | None = None,
    pi: bool = False,
    xlim: tuple[float, float] | None = None,
) -> dict[str, Figure]:
    """Draw the figures of a run.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    beside : tuple of (source, str), optional
        Another run of the same bodies and what it is called, drawn pale.
    pi : bool
        Whether axes are in Π-terms, as L_e and 1/omega_g.
    xlim : tuple of float, optional
        Stretch of time that is drawn (s).

    Returns
    -------
    dict
        Figures by the names of their files: ``displacements.png``; where a spring is not
        linear, ``loops.png``; where storeys stand on one another, ``profiles.png``; of decks in
        plan ``plan.png``.

    Raises
    ------
    InputError
        Where a directory holds no complete results, or a motion has no scales for Π-terms.
    """
    view, other = view_of_run(source, pi).within(xlim), None
    if beside is not None:
        # Times and lengths of both in the units of the first.
        own = replace(view_of_run(beside[0]), units_of=view)
        if set(own.bodies).isdisjoint(view.bodies):
            raise InputError(f"{beside[1]}: none of its bodies is called as one of this run")
        other = OtherRun(own.within(xlim), beside[1])
    drawn = {"displacements.png": displacement_figure(view, other)}
    if nonlinear_springs(view):
        drawn["loops.png"] = loop_figure(view, other)
    if (plan := worst_plan_figure(view)) is not None:
        drawn["plan.png"] = plan
    if towers_of(view):
        drawn["profiles.png"] = profile_figure(view, other)
    return drawn


@checked
def plot(
    source: Source,
    directory: str | os.PathLike[str],
    paper: Paper | None = None,
    xlim: tuple[float, float] | None = None,
    beside: tuple[Source, str] | None = None,
    pi: bool = False,
) -> list[Path]:
    """Draw the figures of a run and write them, all or none.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    directory : path
        Where the figures go.
    paper : Paper, optional
        Kinds of files, width and resolution; PNG by default.
    xlim : tuple of float, optional
        Stretch of time that is drawn (s).
    beside : tuple of (source, str), optional
        Another run of the same bodies and what it is called, drawn pale.
    pi : bool
        Whether axes are in Π-terms, as L_e and 1/omega_g.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where a directory holds no complete results or cannot be written to.
    """
    drawn = figures(source, beside, pi, xlim)
    return write_together(directory, on_paper(drawn, paper or Paper()))


def view_of_run(source: Source, pi: bool = False) -> View:
    """Results as figures read them, with the scene where it is known.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    pi : bool
        Whether axes are in Π-terms.
    """
    if isinstance(source, Response):
        return View(gather(source), source.scene, pi)
    results = source if isinstance(source, StoredResults) else read(source)
    return View(results, _scene(results), pi)


def _scene(results: StoredResults) -> Scene | None:
    """Bodies, springs and contacts of a run, without its motion; None where the case is unknown."""
    case = results.manifest.get("case")
    if not isinstance(case, dict) or "body" not in case:
        return None
    try:
        return read_case({**case, "excitation": {"kind": "none"}}, Path("case.toml")).scene
    except InputError:
        return None


@style.styled()
def profile_figure(view: View, beside: OtherRun | None = None) -> Figure:
    """Draw the profiles of a run, with both extremes of every number.

    Parameters
    ----------
    view : View
        Results of a run with `towers_of` it.
    beside : OtherRun, optional
        Another run of the same structures, drawn pale.
    """
    towers = towers_of(view)
    figure = style.new_figure(7.5, 4.0)
    left, right = figure.subplots(1, 2, sharey=True)
    units = _units(view, towers)
    handles = []
    for tower, color in zip(towers, style.PALETTE, strict=False):
        name = f"{tower.bodies[0]} to {tower.bodies[-1]}"
        handles.append(Line2D([], [], color=color, label=style.literal(name)))
        _draw_tower((left, right), view, tower, units, {"color": color, "linewidth": 1.5})
        if beside is not None:
            pale = {"color": color, "linewidth": 0.9, "alpha": 0.45}
            _draw_tower((left, right), beside.view, tower, units, pale)
    if beside is not None:
        handles.append(
            Line2D([], [], color="#444444", alpha=0.45, label=style.literal(beside.name))
        )
    drift = "drift ratio" if units[1] is PERCENT else "drift"
    for axes, name, unit in zip((left, right), ("displacement", drift), units, strict=True):
        style.zero_lines(axes, upright=True, level=False)
        axes.set_xlabel(f"{name} ({unit.name})")
    _name_levels(left, towers)
    style.legend_beside(right, handles)
    return figure


def _units(view: View, towers: Sequence[Tower]) -> tuple[Unit, Unit]:
    """Of displacements and of drifts, which are ratios where all heights are known."""
    u, drifts = zip(*(_extremes(view, tower) for tower in towers), strict=True)
    in_percent = all(tower.heights for tower in towers)
    of_drift = PERCENT if in_percent else view.length_unit(style.largest_size(*drifts))
    return view.length_unit(style.largest_size(*u)), of_drift


def _extremes(view: View, tower: Tower) -> tuple[Floats, Floats]:
    """Least and greatest displacement of each body, and drift of each storey, shape (2, n) (m)."""
    summary = view.results.summary
    peaks = [summary["peaks"][name] for name in tower.bodies]
    drifts = [summary["springs"][spring.name] for spring in tower.storeys]
    return (
        np.array([[peak[word] for peak in peaks] for word in ("min", "max")]),
        np.array([[drift[f"{word}_elongation"] for drift in drifts] for word in ("min", "max")]),
    )


def _draw_tower(
    panels: tuple[Axes, Axes],
    view: View,
    tower: Tower,
    units: tuple[Unit, Unit],
    look: dict[str, Any],
) -> None:
    """Both profiles of one structure."""
    u, drift = _extremes(view, tower)
    levels = np.array(tower.levels)
    if units[1] is PERCENT:
        # Isolators have no height, and no drift ratio.
        heights = np.array(tower.heights)
        drift = np.divide(drift, heights, out=np.full(drift.shape, np.nan), where=heights > 0.0)
    look_of_steps: Any = {"orientation": "horizontal", "baseline": None, "zorder": 2, **look}
    for side in range(2):
        # From the ground, which does not move against itself.
        moved = np.concatenate([[0.0], u[side]]) / units[0].size
        panels[0].plot(moved, levels, marker=".", **look)
        panels[1].stairs(drift[side] / units[1].size, levels, **look_of_steps)


def _name_levels(axes: Axes, towers: Sequence[Tower]) -> None:
    """Heights, or storeys by the names of the bodies where there is one structure."""
    if all(tower.heights for tower in towers):
        axes.set_ylabel("height (m)")
    elif len(towers) == 1:
        axes.set_yticks(towers[0].levels, ["ground", *map(style.literal, towers[0].bodies)])
    else:
        axes.set_yticks(range(1 + max(len(tower.bodies) for tower in towers)))
        axes.set_ylabel("floor")
