"""Turning points of a motion known by samples of its value, rate and second derivative.

Between two samples at a distance h the quintic of Hermite type is used, whose
error is h⁶/46080 of the sixth derivative; where a derivative jumps (an event) there
are two samples of the same time, and no polynomial is laid across.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints


class Turn(NamedTuple):
    """A largest value in its neighbourhood.

    t: time (s). value: in the unit of the motion. sample: the sample it is at, where the
    rate jumps or the motion starts or ends, or the first of the two it lies between.
    between: whether it does.
    """

    t: float
    value: float
    sample: int
    between: bool


def largest_turns(t: Floats, x: Floats, v: Floats, a: Floats, above: float) -> list[Turn]:
    """Local maxima of a motion, in order of time.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times (s), not decreasing; twice the same at an event, before and after.
    x, v, a : ndarray, shape (n,)
        Value, rate and second derivative.
    above : float
        Maxima at or below this value may be left out.
    """
    turns = [
        Turn(float(t[k]), float(x[k]), int(k), False) for k in _at_samples(t, v) if x[k] > above
    ]
    h = np.diff(t)
    rising = (v[:-1] >= 0.0) & (v[1:] <= 0.0) & (v[:-1] > v[1:]) & (h > 0.0)
    # No motion turns higher than the lines of its rates at both ends meet, but for its curvature.
    reach = np.maximum(x[:-1], x[1:]) + h * np.maximum(np.abs(v[:-1]), np.abs(v[1:]))
    for k in np.flatnonzero(rising & (reach > above)):
        tau, value = _turn(x[k : k + 2], v[k : k + 2], a[k : k + 2], float(h[k]))
        if value > above:
            turns.append(Turn(float(t[k]) + tau, value, int(k), True))
    return sorted(turns)


def _at_samples(t: Floats, v: Floats) -> Ints:
    """Samples at which the rate jumps from rising or still to falling or still."""
    before = np.concatenate(([1.0], v[:-1]))
    jump = np.concatenate(([True], np.diff(t) == 0.0))
    turned: Ints = np.flatnonzero(jump & (before >= 0.0) & (v <= 0.0) & (before > v))
    if v.size and v[-1] > 0.0:
        turned = np.append(turned, v.size - 1)
    return turned


def _turn(x: Floats, v: Floats, a: Floats, h: float) -> tuple[float, float]:
    """Where between two samples the quintic is largest (s from the first), and its value."""
    p = _quintic(x, v * h, a * h * h)
    roots = np.polynomial.polynomial.polyroots(np.polynomial.polynomial.polyder(p))
    inside = roots[(np.abs(roots.imag) < 1e-9) & (roots.real >= 0.0) & (roots.real <= 1.0)].real
    places = np.concatenate((inside, [0.0, 1.0]))
    values = np.polynomial.polynomial.polyval(places, p)
    best = int(np.argmax(values))
    return float(places[best]) * h, float(values[best])


def _quintic(x: Floats, v: Floats, a: Floats) -> Floats:
    """Coefficients, lowest first, of the quintic with these values and derivatives at 0 and 1."""
    d = x[1] - x[0] - v[0] - a[0] / 2.0
    dv = v[1] - v[0] - a[0]
    da = a[1] - a[0]
    return np.array(
        (
            x[0],
            v[0],
            a[0] / 2.0,
            10.0 * d - 4.0 * dv + da / 2.0,
            -15.0 * d + 7.0 * dv - da,
            6.0 * d - 3.0 * dv + da / 2.0,
        )
    )
