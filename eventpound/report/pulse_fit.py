"""Figure of a record with the pulse that fits it best: acceleration above, velocity below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.motion.base import GroundMotion
from eventpound.motion.pulse_fit import PulseFit
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, styled
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 9.5, 4.6
_POINTS_A_PERIOD = 200
_CM = 0.01
RECORD_COLOR = "#999999"


def pulse_fit_figure(record: Record, fits: Sequence[PulseFit], title: str) -> Figure:
    """Draw pulses over the record they were fitted to.

    Parameters
    ----------
    record : Record
        The record.
    fits : sequence of PulseFit
        As `eventpound.motion.pulse_fit.fit_pulse` returns them.
    title : str
        Above the figure.
    """
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        draw_pulses(upper, lower, record, fits)
        figure.legend(handles=upper.get_lines()[1:], loc="outside right upper")
        lower.set_xlabel("time (s)")
        figure.align_ylabels([upper, lower])
        figure.suptitle(title, fontsize=10.0, wrap=True)
    return figure


def draw_pulses(upper: Axes, lower: Axes, record: Record, fits: Sequence[PulseFit]) -> None:
    """Draw acceleration (in g) and velocity of a record and of its pulses.

    Parameters
    ----------
    upper, lower : Axes
        Where acceleration and velocity go; they share the time.
    record : Record
        The record.
    fits : sequence of PulseFit
        Its pulses.
    """
    draw_record(upper, record)
    t = sample_times(record)
    lower.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    lower.plot(t, record.velocity(t) / _CM, color=RECORD_COLOR, linewidth=0.8)
    lower.set_ylabel("velocity (cm/s)")
    for number, fit in enumerate(fits):
        times = _times(fit.motion, record)
        color, style = PALETTE[number % len(PALETTE)], "-" if number == 0 else "--"
        upper.plot(
            times,
            fit.motion.acceleration(times) / STANDARD_GRAVITY,
            color=color,
            linestyle=style,
            linewidth=1.4,
            label=_words(fit),
        )
        velocity = fit.motion.velocity(times) / _CM
        lower.plot(times, velocity, color=color, linestyle=style, linewidth=1.4)


def draw_record(axes: Axes, record: Record) -> None:
    """Draw the acceleration of a record (in g)."""
    t = sample_times(record)
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    axes.plot(
        t, record.values / STANDARD_GRAVITY, color=RECORD_COLOR, linewidth=0.7, label="record"
    )
    axes.set_xlim(record.start, record.end)
    axes.set_ylabel("acceleration (g)")


def sample_times(record: Record) -> Floats:
    """Times of the samples, shape (n,) (s)."""
    return record.start + record.time_step * np.arange(record.samples.size, dtype=np.float64)


def _times(motion: GroundMotion, record: Record) -> Floats:
    """Times at which a pulse is drawn: just around it (s), shape (n,)."""
    scales = motion.scales()
    assert scales is not None
    start = float(getattr(motion, "start", record.start))
    margin = 0.02 * scales.period
    count = round(_POINTS_A_PERIOD * (motion.end - start + 2.0 * margin) / scales.period)
    return np.linspace(start - margin, motion.end + margin, count)


def _words(fit: PulseFit) -> str:
    return (
        f"{fit.kind}\n$a_p$ = {fit.a_p / STANDARD_GRAVITY:.3f} g\n$T_p$ = {fit.T_p:.3f} s\n"
        f"explains {100.0 * fit.explained:.0f} %\nof the {fit.on}"
    )
