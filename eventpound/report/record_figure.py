"""A record: acceleration, velocity, displacement, and its Fourier amplitudes with T_m."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.motion.intensity import Characteristics
from eventpound.motion.scales import HIGHEST_FREQUENCY, LOWEST_FREQUENCY, fourier_amplitudes
from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, literal, new_figure, styled, zero_lines
from eventpound.results.trade import unit_by_size
from eventpound.units import STANDARD_GRAVITY, Dimension

_LINE = "#444444"
_BAND = "#EEF3F8"
_DRIFT = 0.5
"""Share of the largest displacement that a record without drift does not end with."""


@styled()
def record_figure(record: Characteristics) -> Figure:
    """Draw a record over time and its Fourier amplitudes over frequency.

    Parameters
    ----------
    record : Characteristics
        The record.
    """
    figure = new_figure(7.5, 8.0, literal(_title(record)))
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
    zero_lines(axes)
    axes.plot(t, values, color=_LINE, linewidth=0.7)
    axes.plot(t[peak], values[peak], "o", color=PALETTE[1], markersize=3.5, clip_on=False, zorder=5)
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
    axes.axvline(1.0 / period, color=PALETTE[1], linewidth=1.2)
    said = f"$T_m$ = {period:.3g} s (1/$T_m$ = {1.0 / period:.3g} Hz, line; band 0.25–20 Hz shaded)"
    axes.set_title(said, loc="left")
    axes.set_title(f"$L_e$ = {scales.length / 0.01:.3g} cm", loc="right")
