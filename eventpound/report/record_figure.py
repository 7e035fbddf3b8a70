"""Figures of records: their motions and spectra."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.motion.intensity import Characteristics
from eventpound.motion.scales import HIGHEST_FREQUENCY, LOWEST_FREQUENCY, fourier_amplitudes
from eventpound.motion.scaling import Target
from eventpound.numerics.arrays import Floats
from eventpound.report import style
from eventpound.results.shown_units import Unit, unit_by_size
from eventpound.units import STANDARD_GRAVITY, Dimension

_LINE = "#444444"
_BAND = "#EEF3F8"
_DRIFT = 0.5
"""Share of the largest displacement that a record without drift does not end with."""


@style.styled()
def record_figure(record: Characteristics) -> Figure:
    """Draw a record over time and its Fourier amplitudes over frequency.

    Parameters
    ----------
    record : Characteristics
        The record.
    """
    figure = style.new_figure(7.5, 8.0, style.literal(_title(record)))
    *histories, spectrum = figure.subplots(4, 1, height_ratios=(1.0, 1.0, 1.0, 1.4))
    _draw_histories(histories, record)
    _draw_spectrum(spectrum, record)
    figure.align_ylabels([*histories, spectrum])
    return figure


def _title(record: Characteristics) -> str:
    """Name of the file, and what its header says."""
    data = record.data
    named = [data.event, data.station, data.component and f"component {data.component}"]
    words = ", ".join(part for part in named if part)
    name = data.file.replace("\\", "/").rpartition("/")[2]
    processed = [note for note in data.notes if note.startswith("processed")]
    return "\n".join([name, *([words[:110]] if words else []), *processed])


def _draw_histories(axes: list[Axes], record: Characteristics) -> None:
    """Draw a, v and d with their peaks."""
    motion, measures = record.record, record.intensity
    t, unit = motion.times, unit_by_size(Dimension.LENGTH, measures.pgd)
    g, d = STANDARD_GRAVITY, motion.displacement(t)
    series = (
        ("acceleration", motion.values / g, measures.pga / g, "PGA", "g"),
        ("velocity", motion.velocity(t) / 0.01, measures.pgv / 0.01, "PGV", "cm/s"),
        ("displacement", d / unit.size, measures.pgd / unit.size, "PGD", unit.name),
    )
    for axis, (name, values, peak, symbol, units) in zip(axes, series, strict=True):
        _draw_history(axis, t, values)
        axis.set_ylabel(f"{name} ({units})")
        axis.set_title(f"{symbol} = {peak:.3g} {units}", loc="right")
        axis.tick_params(labelbottom=axis is axes[-1])
    if abs(d[-1]) > _DRIFT * measures.pgd:
        axes[2].set_title("drifts", loc="left")
    axes[0].axvspan(measures.duration_from, measures.duration_to, color=_BAND, zorder=0)
    axes[0].set_title(f"D$_{{5-95}}$ = {measures.significant_duration:.3g} s (shaded)", loc="left")
    axes[-1].set_xlabel("time (s)")


def _draw_history(axes: Axes, t: Floats, values: Floats) -> None:
    peak = int(np.argmax(np.abs(values)))
    style.zero_lines(axes)
    axes.plot(t, values, color=_LINE, linewidth=0.7)
    at: Any = {"color": style.PALETTE[1], "markersize": 3.5, "clip_on": False, "zorder": 5}
    axes.plot(t[peak], values[peak], "o", **at)
    axes.set_xlim(t[0], t[-1])


def _draw_spectrum(axes: Axes, record: Characteristics) -> None:
    """Draw C(f) with the band of the mean period shaded and 1/T_m marked."""
    data = record.data
    frequency, amplitude = fourier_amplitudes(data.acceleration, data.time_step, record.convention)
    period, scales = record.mean_period, record.scales
    axes.axvspan(LOWEST_FREQUENCY, HIGHEST_FREQUENCY, color=_BAND, zorder=0)
    axes.set(xlabel="frequency (Hz)", ylabel="Fourier amplitude (m/s)", xscale="log")
    if scales is None:
        axes.set_title("no $T_m$: nothing in the band of 0.25–20 Hz (shaded)", loc="left")
        return
    axes.loglog(frequency[1:], amplitude[1:], color=_LINE, linewidth=0.7)
    axes.set_xlim(max(frequency[1], 0.02), frequency[-1])
    shown = amplitude[(frequency >= 0.1) & (frequency <= HIGHEST_FREQUENCY)]
    axes.set_ylim(1e-4 * shown.max(), 2.0 * shown.max())
    axes.axvline(1.0 / period, color=style.PALETTE[1], linewidth=1.2)
    said = f"$T_m$ = {period:.3g} s (1/$T_m$ = {1.0 / period:.3g} Hz, line; band 0.25–20 Hz shaded)"
    axes.set_title(said, loc="left")
    axes.set_title(f"$L_e$ = {scales.length / 0.01:.3g} cm", loc="right")


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
    figure, upper, lower, unit = _two_panels(title, spectrum)
    upper.plot(spectrum["period"], spectrum["PSA_g"], color=style.PALETTE[0], label="of the motion")
    lower.plot(spectrum["period"], spectrum["SD"] / unit.size, color=style.PALETTE[0])
    if target is not None:
        upper.plot(target["period"], target["PSA_g"], "--", color=style.PALETTE[1], label="target")
        upper.legend()
    of = f", {_percent(damping)}"
    _finish(upper, f"PSA (g){of}", lower, f"SD ({unit.name}){of}")
    return figure


def _two_panels(title: str, spectrum: pd.DataFrame) -> tuple[Figure, Axes, Axes, Unit]:
    """A figure with panels of PSA and, below, of SD in this unit."""
    figure = style.new_figure(7.5, 5.2, style.literal(title))
    upper, lower = figure.subplots(2, 1, sharex=True)
    return figure, upper, lower, unit_by_size(Dimension.LENGTH, spectrum["SD"].max())


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
    figure, upper, lower, unit = _two_panels(title, table)
    bodies, ratios = table["body"].unique(), list(table["damping"].unique())
    shades = dict(zip(bodies, style.colors(len(bodies)), strict=True))
    looks: list[tuple[pd.DataFrame, str, Any]] = [(table, "", {"linewidth": 1.2})]
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
