"""Figures of records with the pulses that fit them: one record, or time and length scales of two.

The second is the paper's Fig. 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.motion.base import GroundMotion
from eventpound.motion.pulse_fit import PulseFit
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.report.style import DASHED, PALETTE, arrow, new_figure, say, styled, zero_lines
from eventpound.units import STANDARD_GRAVITY

_POINTS_A_PERIOD = 200
_CM = 0.01
_RECORD = "#999999"
# What is drawn before and after the shares of the squared acceleration are reached.
_SHARES = (0.002, 0.995)


@styled()
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
    figure = new_figure(9.5, 4.6, title)
    upper, lower = figure.subplots(2, 1, sharex=True)
    _draw_pulses(upper, lower, record, fits)
    figure.legend(handles=upper.get_lines()[1:], loc="outside right upper")
    figure.align_ylabels([upper, lower])
    return figure


@styled()
def record_scales_figure(
    pulsed: Record, fit: PulseFit, plain: Record, names: Sequence[str], title: str
) -> Figure:
    """Draw two records with their scales.

    Parameters
    ----------
    pulsed : Record
        A record characterised by its pulse, above.
    fit : PulseFit
        The pulse.
    plain : Record
        A record characterised by PGA and T_m, below.
    names : sequence of str
        What the two are called.
    title : str
        Above the figure.
    """
    figure = new_figure(9.0, 6.6, title)
    acceleration, velocity, below = figure.subplots(3, 1, height_ratios=(1.2, 1.0, 1.2))
    _draw_pulses(acceleration, velocity, pulsed, [fit])
    _mark_scales(acceleration, fit.a_p, "$a_p$", PALETTE[0])
    _mark_length(acceleration, _middle(fit), fit.T_p, "$T_p$")
    acceleration.set_title(f"{names[0]}\n{_pulse_words(fit)}", loc="left")
    _draw_record(below, plain)
    _mark_scales(below, plain.peak, "PGA", PALETTE[1])
    if math.isfinite(plain.mean_period):
        peak = float(plain.times[np.argmax(np.abs(plain.values))])
        _mark_length(below, peak, plain.mean_period, "$T_m$")
    below.set_title(f"{names[1]}\n{_record_words(plain)}", loc="left")
    below.set_xlabel("time (s)")
    for axes, record in ((acceleration, pulsed), (velocity, pulsed), (below, plain)):
        axes.set_xlim(*_strong_part(record))
    acceleration.tick_params(labelbottom=False)
    figure.align_ylabels([acceleration, velocity, below])
    return figure


def _draw_pulses(upper: Axes, lower: Axes, record: Record, fits: Sequence[PulseFit]) -> None:
    """Draw acceleration (in g) and velocity of a record and of its pulses over the same time."""
    _draw_record(upper, record)
    t = record.times
    zero_lines(lower)
    lower.plot(t, record.velocity(t) / _CM, color=_RECORD, linewidth=0.8)
    lower.set(xlabel="time (s)", ylabel="velocity (cm/s)")
    for number, fit in enumerate(fits):
        times = _times(fit.motion, record)
        look: Any = {"color": PALETTE[number % len(PALETTE)], "linewidth": 1.4}
        look["linestyle"] = "--" if number else "-"
        label = _pulse_words(fit, "\n")
        upper.plot(times, fit.motion.acceleration(times) / STANDARD_GRAVITY, label=label, **look)
        lower.plot(times, fit.motion.velocity(times) / _CM, **look)


def _draw_record(axes: Axes, record: Record) -> None:
    """Draw the acceleration of a record (in g)."""
    zero_lines(axes)
    values = record.values / STANDARD_GRAVITY
    axes.plot(record.times, values, color=_RECORD, linewidth=0.7, label="record")
    axes.set_xlim(record.start, record.end)
    axes.set_ylabel("acceleration (g)")


def _times(motion: GroundMotion, record: Record) -> Floats:
    """Times at which a pulse is drawn: just around it (s), shape (n,)."""
    scales = motion.scales()
    assert scales is not None
    start = float(getattr(motion, "start", record.start))
    margin = 0.02 * scales.period
    count = round(_POINTS_A_PERIOD * (motion.end - start + 2.0 * margin) / scales.period)
    return np.linspace(start - margin, motion.end + margin, count)


def _middle(fit: PulseFit) -> float:
    """Middle of a pulse (s)."""
    middle = 0.5 * (getattr(fit.motion, "start", 0.0) + fit.motion.end)
    return float(getattr(fit.motion, "middle", middle))


def _mark_scales(axes: Axes, amplitude: float, name: str, color: str) -> None:
    """Lines at plus and minus an acceleration (m/s^2), with its name at the right end."""
    a = amplitude / STANDARD_GRAVITY
    for side in (-a, a):
        axes.axhline(side, color=color, **DASHED)
    at: Any = ("axes fraction", "data")
    axes.annotate(name, (1.002, a), xycoords=at, color=color, va="center")


def _mark_length(axes: Axes, middle: float, length: float, name: str) -> None:
    """A double arrow of a duration (s) near the upper edge."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.28 * (high - low))
    height = high + 0.10 * (high - low)
    ends = (middle - 0.5 * length, height), (middle + 0.5 * length, height)
    arrow(axes, *ends, arrowstyle="<->", color="#222222")
    say(axes, name, (middle, height), (0, 6))


def _strong_part(record: Record) -> tuple[float, float]:
    """Times between which nearly all of the squared acceleration lies (s)."""
    grown = np.cumsum(record.values**2)
    low, high = np.searchsorted(grown, np.array(_SHARES) * grown[-1])
    t = record.times
    margin = 0.05 * float(t[high] - t[low])
    return max(record.start, float(t[low]) - margin), min(record.end, float(t[high]) + margin)


def _pulse_words(fit: PulseFit, apart: str = ", ") -> str:
    """Kind, size and fit of a pulse, in a line or one below the other."""
    return apart.join(
        [
            f"{fit.kind} pulse",
            f"$a_p$ = {fit.a_p / STANDARD_GRAVITY:.3f} g",
            f"$T_p$ = {fit.T_p:.3f} s",
            f"$L_e$ = {100.0 * fit.length:.2f} cm",
            f"explains {100.0 * fit.explained:.0f} %{apart[-1]}of the {fit.on}",
        ]
    )


def _record_words(record: Record) -> str:
    scales = record.scales()
    words = f"PGA = {record.peak / STANDARD_GRAVITY:.3f} g"
    if scales is None:
        return f"{words}, no $T_m$"
    return f"{words}, $T_m$ = {scales.period:.3f} s, $L_e$ = {100.0 * scales.length:.2f} cm"
