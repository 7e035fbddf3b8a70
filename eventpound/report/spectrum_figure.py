"""Response spectra: pseudo-acceleration and displacement over the period, and a target."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.motion.scaling import Target
from eventpound.numerics.arrays import Floats
from eventpound.report import style
from eventpound.results.trade import unit_by_size
from eventpound.units import STANDARD_GRAVITY, Dimension

_DASHES = ("-", "--", ":", "-.")
"""Of the damping ratios of a figure, in turn."""


@style.styled()
def spectrum_figure(
    spectrum: pd.DataFrame, damping: float, title: str = "", target: pd.DataFrame | None = None
) -> Figure:
    """Draw a response spectrum.

    Parameters
    ----------
    spectrum : DataFrame
        As `eventpound.study.response_spectrum` gives it.
    damping : float
        Its damping ratio.
    title : str
        Above it.
    target : DataFrame, optional
        Columns period (s) and PSA_g (g), drawn beside it.
    """
    figure = style.new_figure(7.5, 5.2, style.literal(title))
    upper, lower = figure.subplots(2, 1, sharex=True)
    unit = unit_by_size(Dimension.LENGTH, spectrum["SD"].max())
    upper.plot(spectrum["period"], spectrum["PSA_g"], color=style.PALETTE[0], label="of the motion")
    lower.plot(spectrum["period"], spectrum["SD"] / unit.size, color=style.PALETTE[0])
    if target is not None:
        upper.plot(target["period"], target["PSA_g"], "--", color=style.PALETTE[1], label="target")
        upper.legend()
    of = f", {_percent(damping)}"
    _finish(upper, f"PSA (g){of}", lower, f"SD ({unit.name}){of}")
    return figure


@style.styled()
def floor_figure(table: pd.DataFrame, free: pd.DataFrame | None = None, title: str = "") -> Figure:
    """Draw floor spectra: a colour for each body, a kind of line for each damping ratio.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.Response.floor_spectrum` gives it.
    free : DataFrame, optional
        The same without contact, drawn thin and pale.
    title : str
        Above it.
    """
    figure = style.new_figure(7.5, 5.2, style.literal(title))
    upper, lower = figure.subplots(2, 1, sharex=True)
    unit = unit_by_size(Dimension.LENGTH, table["SD"].max())
    bodies, ratios = table["body"].unique(), list(table["damping"].unique())
    shades = dict(zip(bodies, style.colors(len(bodies)), strict=True))
    looks = [(table, "", {"linewidth": 1.2})]
    looks += [(free, ", no contact", {"linewidth": 0.8, "alpha": 0.45})] if free is not None else []
    for of, said, look in looks:
        for (body, ratio), curve in of.groupby(["body", "damping"], sort=False):
            label = style.literal(f"{body}, {_percent(ratio)}{said}")
            dashes = _DASHES[ratios.index(ratio) % len(_DASHES)]
            for axes, values in ((upper, curve["PSA_g"]), (lower, curve["SD"] / unit.size)):
                line = axes.plot(curve["period"], values, dashes, label=label, **look)
                line[0].set_color(shades[body])
    style.legend_beside(upper, upper.get_lines())
    _finish(upper, "PSA of equipment (g)", lower, f"SD ({unit.name})")
    return figure


@style.styled()
def suite_spectra_figure(
    periods: Floats,
    psa: Floats,
    damping: float,
    target: Target | None = None,
    at: tuple[float, Floats, float] | None = None,
) -> Figure:
    """Draw the spectra of many records with their fractiles.

    Parameters
    ----------
    periods : ndarray, shape (k,)
        T (s).
    psa : ndarray, shape (n, k)
        PSA (m/s^2), a row a record.
    damping : float
        Their damping ratio.
    target : Target, optional
        What they were scaled to.
    at : tuple of float, ndarray and float, optional
        A period (s), PSA of each record there, shape (n,), and what is wanted there (m/s^2), NaN
        where that is not said.
    """
    figure = style.new_figure(7.5, 3.6)
    axes = figure.subplots()
    g = STANDARD_GRAVITY
    axes.plot(periods, psa.T / g, color="#B5B5B5", linewidth=0.5)
    for part, dashes, label in (
        (50.0, "-", "median"),
        (16.0, "--", "16 % and 84 %"),
        (84.0, "--", "_"),
    ):
        curve = np.percentile(psa, part, axis=0) / g
        axes.plot(periods, curve, dashes, color=style.PALETTE[0], linewidth=1.5, label=label)
    if target is not None:
        points = np.array((target.period, target.psa))
        axes.plot(points[0], points[1] / g, color=style.PALETTE[1], linewidth=1.5, label="target")
        axes.axvspan(target.low, target.high, color="#EEEEEE", zorder=0)
    if at is not None:
        period, own, wanted = at
        axes.axvline(period, color="#666666", linestyle=":", linewidth=0.8)
        label = f"records at {period:.3g} s"
        axes.plot(np.full(own.size, period), own / g, "o", markersize=3.0, color="k", label=label)
        if wanted == wanted:
            look: Any = {"markersize": 14.0, "color": style.PALETTE[1], "label": "wanted there"}
            axes.plot([period], [wanted / g], "_", markeredgewidth=2.0, **look)
    axes.legend()
    _finish(axes, f"PSA (g), {_percent(damping)}")
    axes.set_xlim(periods[0], periods[-1])
    return figure


def _percent(damping: float) -> str:
    return f"{100.0 * damping:g} % damping"


def _finish(upper: Axes, name: str, lower: Axes | None = None, other: str = "") -> None:
    """Name the axes, with the period below the lowest, and let them begin at zero."""
    for axes, label in ((upper, name), (lower or upper, other or name)):
        axes.set_xscale("log")
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.0)
    axes.set_xlabel("period $T$ (s)")
    axes.xaxis.set_major_formatter("{x:g}")
