"""Roots of the motion of a single body: where it turns, and what it reaches before."""

from __future__ import annotations

import math

import numpy as np

from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.search import stays_above
from eventpound.solvers.fast.single.body import Body
from eventpound.solvers.fast.single.series import NUMBER

MOST_ITERATIONS = 200
"""Newton steps of a root; a few do but where two roots all but meet."""
CLOSE = 4e-16
"""Relative change at which a root stands."""
CLOSE_ENOUGH = 1e-6
"""The same where the next change would be of the order of its cube."""
BEYOND_GUESS = 1.25
"""How much later than a first guess a root is sure to have been passed."""


@compiled_apart
def first_zero(degree: int, bend: float, h: float, body: Body) -> float:
    """First zero in (0, h] of the polynomial in `work`, positive at zero, or inf.

    With a lower bound `bend` of the second derivative on [0, h],
    ``c_0 + c' s + bend s²/2`` lies below the polynomial, so its root is never
    past the zero wanted, to which it converges quadratically.
    """
    s, value, slope = 0.0, body.work[0], body.work[1]
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
        value, slope = body.work[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * s + value
            value = value * s + body.work[k]
        if value <= 0.0:
            return s
        if s == h:
            return np.inf
    return s


@compiled_apart
def only_zero(degree: int, h: float, body: Body) -> float:
    """The zero in (0, h] of the polynomial in `work`, which falls throughout, or inf."""
    square = body.work[1] * body.work[1] - 4.0 * body.work[0] * body.work[2]
    s = 2.0 * body.work[0] / (math.sqrt(square) - body.work[1]) if square > 0.0 else h
    return _polished(min(s, h), degree, h, body)


@compiled
def _polished(s: float, degree: int, h: float, body: Body) -> float:
    """The same from a first guess s, where it falls at its only zero.

    Roots of the osculating parabolas, which converge cubically, kept in the bracket.
    """
    low, high = 0.0, h
    for _ in range(MOST_ITERATIONS):
        value, slope, bend = body.work[degree], 0.0, 0.0
        for k in range(degree - 1, -1, -1):
            bend = bend * s + slope
            slope = slope * s + value
            value = value * s + body.work[k]
        if value > 0.0:
            if s == h:
                return np.inf
            low = s
        else:
            high = s
        square = slope * slope - 4.0 * value * bend
        change = 2.0 * value / (math.sqrt(square) - slope) if square > 0.0 else np.inf
        following = s + change
        if following >= h and high == h and value > 0.0:
            following = h
        elif not low < following < high:
            if value == 0.0 or not low < 0.5 * (low + high) < high:
                return s
            following = 0.5 * (low + high)
        elif abs(change) <= CLOSE_ENOUGH * s:
            return following
        s = following
    return s


@compiled
def first_turn(order: int, first: int, h: float, body: Body) -> float:
    """Time in (0, h] at which the velocity changes its sign, or inf.

    x[first] is the lowest coefficient, from 1 on, that differs from zero.
    """
    sign = 1.0 if body.x[first] > 0.0 else -1.0
    degree = max(order - first, 2)
    rest = 0.0
    for k in range(degree, 2, -1):
        rest = rest * h + NUMBER[first + k] * abs(body.x[first + k])
    slope = sign * NUMBER[first + 1] * body.x[first + 1]
    bend = sign * NUMBER[first + 2] * body.x[first + 2]
    start = sign * NUMBER[first] * body.x[first]
    if stays_above(start, slope, bend, rest * h * h * h, h):
        return np.inf
    return _located_turn(sign, degree, first, h, body)


@compiled_apart
def _located_turn(sign: float, degree: int, first: int, h: float, body: Body) -> float:
    for k in range(degree, -1, -1):
        body.work[k] = sign * NUMBER[first + k] * body.x[first + k]
    h = _nearer(degree, h, body)
    swing, curve = 0.0, 0.0
    for k in range(degree, 2, -1):
        term = NUMBER[k] * abs(body.work[k])
        swing = swing * h + term
        curve = curve * h + NUMBER[k - 1] * term
    slope, bend = body.work[1], 2.0 * body.work[2]
    if max(slope, slope + bend * h) + swing * h * h < 0.0:
        return only_zero(degree, h, body)
    return first_zero(degree, bend - curve * h, h, body)


@compiled
def _nearer(degree: int, h: float, body: Body) -> float:
    """A time up to h (s) before which the polynomial in `work` has a zero, or h.

    Bounds over a shorter time are better ones.
    """
    square = body.work[1] * body.work[1] - 4.0 * body.work[0] * body.work[2]
    if square <= 0.0 or body.work[1] >= math.sqrt(square):
        return h
    s = BEYOND_GUESS * 2.0 * body.work[0] / (math.sqrt(square) - body.work[1])
    if not s < h:
        return h
    value = body.work[degree]
    for k in range(degree - 1, -1, -1):
        value = value * s + body.work[k]
    return s if value < 0.0 else h


@compiled
def first_reached(distance: float, sign: float, order: int, h: float, body: Body) -> float:
    """Time in (0, h] at which the motion has gone `distance` (m) in the direction `sign`, or inf.

    From a distance of zero, the time at which it is there again.
    """
    first = 0
    if distance == 0.0:
        first = 1
        while first <= order and body.x[first] == 0.0:
            first += 1
        if first > order:
            return np.inf
        if sign * body.x[first] > 0.0:
            return 0.0
    degree = max(order - first, 2)
    rest = 0.0
    for k in range(degree, 2, -1):
        rest = rest * h + abs(body.x[first + k])
    start = distance if first == 0 else -sign * body.x[first]
    slope, bend = -sign * body.x[first + 1], -sign * body.x[first + 2]
    if stays_above(start, slope, bend, rest * h * h * h, h):
        return np.inf
    return _located_reach(start, sign, degree, first, h, body)


@compiled_apart
def _located_reach(
    start: float, sign: float, degree: int, first: int, h: float, body: Body
) -> float:
    curve = 0.0
    for k in range(degree, 0, -1):
        c = -sign * body.x[first + k]
        body.work[k] = c
        if k > 2:
            curve = curve * h + NUMBER[k] * NUMBER[k - 1] * abs(c)
    body.work[0] = start
    return first_zero(degree, 2.0 * body.work[2] - curve * h, h, body)


@compiled_apart
def crossing(distance: float, sign: float, order: int, h: float, body: Body) -> float:
    """The same where the motion goes one way throughout, and further than that within h."""
    body.work[0] = distance
    for k in range(1, order + 1):
        body.work[k] = -sign * body.x[k]
    return min(_polished(h, order, h, body), h)
