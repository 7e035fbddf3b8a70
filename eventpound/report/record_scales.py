"""Figure of time and length scales: a record with its pulse, another without (paper, Fig. 1)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.motion.parametric import SinusoidMotion
from eventpound.motion.pulse_fit import PulseFit
from eventpound.motion.record import Record
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.report.pulse_fit import draw_pulses, draw_record, sample_times
from eventpound.report.style import PALETTE, styled
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 9.0, 6.6
# What is drawn before and after the shares of the squared acceleration are reached.
_SHARES = (0.002, 0.995)


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
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
        acceleration, velocity, below = figure.subplots(3, 1, height_ratios=(1.2, 1.0, 1.2))
        draw_pulses(acceleration, velocity, pulsed, [fit])
        _mark_pulse(acceleration, fit)
        acceleration.set_title(f"{names[0]}\n{_pulse_words(fit)}", loc="left")
        draw_record(below, plain)
        _mark_mean_period(below, plain)
        below.set_title(f"{names[1]}\n{_record_words(plain)}", loc="left")
        for axes, record in ((acceleration, pulsed), (velocity, pulsed), (below, plain)):
            axes.set_xlim(*_strong_part(record))
        acceleration.tick_params(labelbottom=False)
        velocity.set_xlabel("time (s)")
        below.set_xlabel("time (s)")
        figure.align_ylabels([acceleration, velocity, below])
        figure.suptitle(title, fontsize=10.0, wrap=True)
    return figure


def _mark_pulse(axes: Axes, fit: PulseFit) -> None:
    """Arrows of the length T_p and lines at +-a_p."""
    a = fit.a_p / STANDARD_GRAVITY
    _mark_length(axes, _middle(fit) - 0.5 * fit.T_p, fit.T_p, "$T_p$")
    for side in (-a, a):
        axes.axhline(side, color=PALETTE[0], linestyle=(0, (6, 3)), linewidth=0.8)
    axes.annotate(
        "$a_p$", (1.002, a), xycoords=("axes fraction", "data"), color=PALETTE[0], va="center"
    )


def _middle(fit: PulseFit) -> float:
    """Middle of a pulse (s)."""
    motion = fit.motion
    if isinstance(motion, Ricker | AntisymmetricRicker):
        return motion.middle
    assert isinstance(motion, SinusoidMotion)
    return 0.5 * (motion.start + motion.end)


def _mark_mean_period(axes: Axes, record: Record) -> None:
    """Arrows of the length T_m, where it is defined, around the peak and lines at +-PGA."""
    peak = float(sample_times(record)[np.argmax(np.abs(record.values))])
    for side in (-1.0, 1.0):
        axes.axhline(
            side * record.peak / STANDARD_GRAVITY,
            color=PALETTE[1],
            linestyle=(0, (6, 3)),
            linewidth=0.8,
        )
    axes.annotate(
        "PGA",
        (1.002, record.peak / STANDARD_GRAVITY),
        xycoords=("axes fraction", "data"),
        color=PALETTE[1],
        va="center",
    )
    period = record.mean_period
    if math.isfinite(period):
        _mark_length(axes, peak - 0.5 * period, period, "$T_m$")


def _mark_length(axes: Axes, start: float, length: float, name: str) -> None:
    """A double arrow of a duration (s) near the upper edge."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.28 * (high - low))
    height = high + 0.10 * (high - low)
    axes.annotate(
        "",
        (start, height),
        (start + length, height),
        arrowprops={"arrowstyle": "<->", "color": "#222222", "shrinkA": 0, "shrinkB": 0},
    )
    axes.annotate(
        name, (start + 0.5 * length, height), (0, 3), textcoords="offset points", ha="center"
    )


def _strong_part(record: Record) -> tuple[float, float]:
    """Times between which nearly all of the squared acceleration lies (s)."""
    grown = np.cumsum(record.values**2)
    low, high = np.searchsorted(grown, np.array(_SHARES) * grown[-1])
    t = sample_times(record)
    margin = 0.05 * float(t[high] - t[low])
    return max(record.start, float(t[low]) - margin), min(record.end, float(t[high]) + margin)


def _pulse_words(fit: PulseFit) -> str:
    return (
        f"{fit.kind} pulse, $a_p$ = {fit.a_p / STANDARD_GRAVITY:.3f} g, $T_p$ = {fit.T_p:.3f} s, "
        f"$L_e$ = {100.0 * fit.length:.2f} cm, "
        f"explains {100.0 * fit.explained:.0f} % of the {fit.on}"
    )


def _record_words(record: Record) -> str:
    scales = record.scales()
    words = f"PGA = {record.peak / STANDARD_GRAVITY:.3f} g"
    if scales is None:
        return f"{words}, no $T_m$"
    return f"{words}, $T_m$ = {scales.period:.3f} s, $L_e$ = {100.0 * scales.length:.2f} cm"
