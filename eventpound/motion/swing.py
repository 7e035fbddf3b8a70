"""What the ground, or a floor, makes of light oscillators, followed to rounding.

    q'' + 2 xi w q' + w^2 q = -U'',    q = q' = 0 at the start

where U'' is a cubic over each cell of time, and U' may jump between two cells: q' then jumps by
as much the other way. Over at most 1/w the Taylor series of q is summed to its last digit.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.compiled.recipe import EVERY_STEP

_TERMS, _FEW_TERMS, _SHORT = 22, 12, 0.1
"""Of a series over at most 1/w, whose last is below 1/21! = 2e-20 of the first; and over at most
a tenth of that, 0.1^11/11! = 3e-19."""
_HALVINGS = 40
"""Of a bracket of a turning point, whose value errs by the square of what is left."""
_INSTANT = 1e-6
"""Part of 1/w below which the ends of a cell say all about it."""


@kernel.but(recipe=EVERY_STEP)
def largest_swings(
    h: Floats, push: Floats, jump: Floats, omega: Floats, ratio: float, found: Floats
) -> None:
    """Follow oscillators from rest over cells of time.

    Parameters
    ----------
    h : ndarray, shape (n,)
        Lengths of the cells (s); of an instant zero.
    push : ndarray, shape (n, 4)
        ``h^2 U''`` over a cell is ``sum_k push_k x^k``, 0 <= x <= 1 (m): no quotient of small
        numbers.
    jump : ndarray, shape (n,)
        Change of U' over a cell (m/s); used of instants.
    omega : ndarray, shape (k,)
        w (rad/s).
    ratio : float
        xi.
    found : ndarray, shape (k, 2)
        Zeros; takes the largest |q| (m) and |w^2 q + 2 xi w q'| (m/s^2).
    """
    scratch, f = np.empty((2, _TERMS)), np.empty(4)
    for j in range(omega.size):
        w = omega[j]
        place = rate = 0.0
        for i in range(h.size):
            if h[i] == 0.0:
                rate -= jump[i]
                found[j, 1] = max(found[j, 1], abs(w * w * place + 2.0 * ratio * w * rate))
                continue
            parts = max(1, math.ceil(w * h[i]))
            step = h[i] / parts
            terms = _FEW_TERMS if w * step <= _SHORT else _TERMS
            q, force = scratch[0, :terms], scratch[1, : terms - 1]
            inside = w * step > _INSTANT
            for part in range(parts):
                _pushed(push[i], part, parts, f)
                _series(place, rate * step, w * step, ratio, f, q)
                place, rate = _value(q, 1.0), _slope(q, 1.0) / step
                for k in range(terms - 1):
                    # w^2 q + 2 xi w q', whose terms are those of q and of its slope.
                    force[k] = w * w * q[k] + 2.0 * ratio * w / step * (k + 1) * q[k + 1]
                found[j, 0] = _largest(q, inside, found[j, 0])
                found[j, 1] = _largest(force, inside, found[j, 1])


@scalar_kernel
def _pushed(push: Floats, part: int, parts: int, f: Floats) -> None:
    """``h^2 U''`` over one of equal parts of a cell, with the length of the part for h, into f."""
    x, y = part / parts, 1.0 / parts
    # y² for h², and y more for each power of the part's own x.
    f[0] = y**2 * (push[0] + x * (push[1] + x * (push[2] + x * push[3])))
    f[1] = y**3 * (push[1] + x * (2.0 * push[2] + x * 3.0 * push[3]))
    f[2] = y**4 * (push[2] + x * 3.0 * push[3])
    f[3] = y**5 * push[3]


@scalar_kernel
def _series(place: float, rate: float, wh: float, ratio: float, f: Floats, q: Floats) -> None:
    """Taylor coefficients of ``q'' + 2 xi (w h) q' + (w h)^2 q = -f`` from q and q' into q."""
    q[0], q[1] = place, rate
    for k in range(q.size - 2):
        pushed = f[k] if k < f.size else 0.0
        restoring = 2.0 * ratio * wh * (k + 1) * q[k + 1] + wh * wh * q[k]
        q[k + 2] = -(restoring + pushed) / ((k + 1) * (k + 2))


@scalar_kernel
def _value(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, -1, -1):
        value = value * x + c[k]
    return value


@scalar_kernel
def _slope(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, 0, -1):
        value = value * x + k * c[k]
    return value


@scalar_kernel
def _bend(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, 1, -1):
        value = value * x + k * (k - 1) * c[k]
    return value


@scalar_kernel
def _largest(c: Floats, inside: bool, known: float) -> float:
    """Largest size of a polynomial on 0 <= x <= 1, where it is larger than what is known.

    Its curvature changes its sign at most once there.
    """
    most = 0.0
    for k in range(c.size):
        most += abs(c[k])
    if most <= known:
        return known
    largest = max(known, abs(c[0]), abs(_value(c, 1.0)))
    if not inside:
        return largest
    # Either side of where it bends the other way its slope is monotone, and has one root at most.
    middle = 1.0
    if _bend(c, 0.0) * _bend(c, 1.0) < 0.0:
        middle = _root(c, 0.0, 1.0, True)
    for low, high in ((0.0, middle), (middle, 1.0)):
        if _slope(c, low) * _slope(c, high) < 0.0:
            largest = max(largest, abs(_value(c, _root(c, low, high, False))))
    return largest


@scalar_kernel
def _root(c: Floats, low: float, high: float, of_bend: bool) -> float:
    """Where the slope, or the curvature, of a polynomial changes its sign between two points."""
    rising = (_bend(c, low) if of_bend else _slope(c, low)) < 0.0
    for _ in range(_HALVINGS):
        x = 0.5 * (low + high)
        if ((_bend(c, x) if of_bend else _slope(c, x)) < 0.0) == rising:
            low = x
        else:
            high = x
    return 0.5 * (low + high)
