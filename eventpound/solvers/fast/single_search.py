"""Roots of the motion of a single body: where it turns, and what it reaches before."""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.search import stays_above

MOST_ITERATIONS = 200
"""Newton steps of a root; a few do but where two roots all but meet."""
CLOSE = 4e-16
"""Relative change at which a root stands."""


@compiled_apart
def first_zero(w: Floats, degree: int, bend: float, h: float) -> float:
    """First zero in (0, h] of ``Σ w_k s^k`` with ``w_0 > 0``, or inf.

    With a lower bound `bend` of the second derivative on [0, h],
    ``w + w' s + bend s²/2`` lies below the polynomial, so its root is never
    past the zero wanted, to which it converges quadratically.
    """
    s, value, slope = 0.0, w[0], w[1]
    for _ in range(MOST_ITERATIONS):
        square = slope * slope - 2.0 * bend * value
        if square < 0.0:
            return np.inf
        root = math.sqrt(square)
        if slope < 0.0:
            change = 2.0 * value / (root - slope)
        elif bend < 0.0:
            change = -(slope + root) / bend
        else:
            return np.inf
        s += change
        if not s < h:
            s = h
        elif change <= CLOSE * s:
            return s
        value, slope = w[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * s + value
            value = value * s + w[k]
        if value <= 0.0:
            return s
        if s == h:
            return np.inf
    return s


@compiled_apart
def only_zero(w: Floats, degree: int, h: float) -> float:
    """The zero in (0, h] of a polynomial that falls throughout, or inf.

    Newton's method from the root of its quadratic, kept in the bracket.
    """
    low, high = 0.0, h
    square = w[1] * w[1] - 4.0 * w[0] * w[2]
    s = 2.0 * w[0] / (math.sqrt(square) - w[1]) if square > 0.0 else h
    if not s < h:
        s = h
    for _ in range(MOST_ITERATIONS):
        value, slope = w[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * s + value
            value = value * s + w[k]
        if value > 0.0:
            if s == h:
                return np.inf
            low = s
        else:
            high = s
        following = s - value / slope
        if following >= h and high == h:
            following = h
        elif not low < following < high:
            if value == 0.0 or not low < 0.5 * (low + high) < high:
                return s
            following = 0.5 * (low + high)
        if abs(following - s) <= CLOSE * s:
            return following
        s = following
    return s


@compiled
def first_turn(x: Floats, order: int, first: int, h: float, w: Floats) -> float:
    """Time in (0, h] at which the velocity changes its sign, or inf.

    x[first] is the lowest coefficient, from 1 on, that differs from zero.
    """
    sign = 1.0 if x[first] > 0.0 else -1.0
    rest, swing, curve = 0.0, 0.0, 0.0
    degree = max(order - first, 2)
    for k in range(degree, 2, -1):
        c = sign * (first + k) * x[first + k]
        w[k] = c
        rest = (rest + abs(c)) * h
        swing = swing * h + k * abs(c)
        curve = curve * h + k * (k - 1) * abs(c)
    for k in range(3):
        w[k] = sign * (first + k) * x[first + k]
    if stays_above(w[0], w[1], w[2], rest * h * h, h):
        return np.inf
    if max(w[1], w[1] + 2.0 * w[2] * h) + swing * h * h < 0.0:
        return only_zero(w, degree, h)
    return first_zero(w, degree, 2.0 * w[2] - curve * h, h)


@compiled
def first_reached(
    distance: float, sign: float, x: Floats, order: int, h: float, w: Floats
) -> float:
    """Time in (0, h] at which the motion has gone `distance` (m) in the direction `sign`, or inf.

    From a distance of zero, the time at which it is there again.
    """
    first = 0
    if distance == 0.0:
        first = 1
        while first <= order and x[first] == 0.0:
            first += 1
        if first > order:
            return np.inf
        if sign * x[first] > 0.0:
            return 0.0
    rest, curve = 0.0, 0.0
    degree = max(order - first, 2)
    for k in range(degree, -1, -1):
        c = -sign * x[first + k] if first + k > 0 else distance
        w[k] = c
        if k > 2:
            rest = (rest + abs(c)) * h
            curve = curve * h + k * (k - 1) * abs(c)
    if stays_above(w[0], w[1], w[2], rest * h * h, h):
        return np.inf
    return first_zero(w, degree, 2.0 * w[2] - curve * h, h)


@compiled_apart
def crossing(distance: float, sign: float, x: Floats, order: int, h: float) -> float:
    """The same where the motion goes one way throughout, and further than that within h.

    Newton's method, kept between a point before and one beyond.
    """
    low, high, s = 0.0, h, h
    for _ in range(MOST_ITERATIONS):
        change, rate = x[order], 0.0
        for k in range(order - 1, 0, -1):
            rate = rate * s + change
            change = change * s + x[k]
        rate = sign * (rate * s + change)
        value = distance - sign * change * s
        if value > 0.0:
            low = s
        else:
            high = s
        following = s + value / rate
        if not (low < following < high):
            if value == 0.0 or not low < 0.5 * (low + high) < high:
                return s
            following = 0.5 * (low + high)
        if abs(following - s) <= CLOSE * s:
            return following
        s = following
    return s
