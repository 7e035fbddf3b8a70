"""Response spectra: pseudo-acceleration and displacement over the period, and a target."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.motion.scaling import Target
from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, colors, legend_beside, length_unit, literal, styled
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DASHES = ("-", "--", ":", "-.")
"""Of the damping ratios of a figure, in turn."""


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
    from matplotlib.figure import Figure

    unit = length_unit(float(spectrum["SD"].max()))
    with styled():
        figure = Figure(figsize=(7.5, 5.2), layout="constrained")
        upper, lower = _panels(figure)
        label = f"{100.0 * damping:g} % damping"
        upper.semilogx(spectrum["period"], spectrum["PSA_g"], color=PALETTE[0], label=label)
        lower.semilogx(spectrum["period"], spectrum["SD"] / unit.size, color=PALETTE[0])
        if target is not None:
            upper.plot(target["period"], target["PSA_g"], "--", color=PALETTE[1], label="target")
        upper.legend()
        _finish(upper, lower, f"SD ({unit.name})")
        figure.suptitle(literal(title), fontsize=10.0)
    return figure


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
    from matplotlib.figure import Figure

    unit = length_unit(float(table["SD"].max()))
    bodies, ratios = table["body"].unique(), table["damping"].unique()
    shades = dict(zip(bodies, colors(len(bodies)), strict=True))
    with styled():
        figure = Figure(figsize=(7.5, 5.2), layout="constrained")
        panels = _panels(figure)
        for of, strength, width in ((table, 1.0, 1.2), (free, 0.45, 0.8)):
            for (body, ratio), curve in (
                () if of is None else of.groupby(["body", "damping"], sort=False)
            ):
                dashes = _DASHES[list(ratios).index(ratio) % len(_DASHES)]
                label = f"{body}, {100.0 * ratio:g} %" + (", no contact" if of is free else "")
                for axes, column, size in ((panels[0], "PSA_g", 1.0), (panels[1], "SD", unit.size)):
                    axes.semilogx(
                        curve["period"],
                        curve[column] / size,
                        color=shades[body],
                        linestyle=dashes,
                        linewidth=width,
                        alpha=strength,
                        label=literal(label),
                    )
        legend_beside(panels[0], [*panels[0].get_lines()])
        _finish(*panels, f"SD ({unit.name})")
        figure.suptitle(literal(title), fontsize=10.0)
    return figure


def suite_spectra_figure(periods: Floats, psa: Floats, target: Target | None = None) -> Figure:
    """Draw the spectra of many records with their fractiles.

    Parameters
    ----------
    periods : ndarray, shape (k,)
        T (s).
    psa : ndarray, shape (n, k)
        PSA (m/s^2), a row a record.
    target : Target, optional
        What they were scaled to.
    """
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(7.5, 3.6), layout="constrained")
        axes = figure.subplots()
        size = STANDARD_GRAVITY
        axes.semilogx(periods, psa.T / size, color="#B5B5B5", linewidth=0.5)
        for part, dashes in ((50.0, "-"), (16.0, "--"), (84.0, "--")):
            curve = np.percentile(psa, part, axis=0) / size
            label = "median" if part == 50.0 else "16 % and 84 %" if part == 16.0 else "_"
            axes.plot(periods, curve, dashes, color=PALETTE[0], linewidth=1.5, label=label)
        if target is not None:
            points = np.array(target.points)
            axes.plot(points[0], points[1] / size, color=PALETTE[1], linewidth=1.5, label="target")
            axes.axvspan(target.low, target.high, color="#EEEEEE", zorder=0)
        axes.set_xlim(periods[0], periods[-1])
        axes.set_ylim(bottom=0.0)
        axes.set_xlabel("period (s)")
        axes.set_ylabel("PSA (g)")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.legend()
    return figure


def _panels(figure: Figure) -> tuple[Axes, Axes]:
    upper, lower = figure.subplots(2, 1, sharex=True)
    return upper, lower


def _finish(upper: Axes, lower: Axes, name: str) -> None:
    """Name the axes, and let them begin at zero."""
    upper.set_ylabel("PSA (g)")
    lower.set_ylabel(name)
    lower.set_xlabel("period (s)")
    lower.xaxis.set_major_formatter("{x:g}")
    for axes in (upper, lower):
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.0)
