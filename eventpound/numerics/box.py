"""The least of a convex quadratic function over a box, and of linear ones where it leaves a choice.

    min ½ xᵀ G x + q(ε)ᵀ x,   low <= x <= high,   q(ε) = q_0 + ε q_1 + ε² q_2 + ...

for the smallest ε > 0, G symmetric positive semidefinite. Where G is singular, q_0 alone may leave
several x, or none that a small change of q would not carry off; q_1 and those that follow say which
one. The limit of x is found by principal pivoting (`eventpound.numerics.lcp`) on numbers that are
polynomials in ε, told apart by their first coefficient that is not rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import LCP_ROUNDING, SINGULAR


class _Pivoting(NamedTuple):
    """A problem of k unknowns on its way.

    x, w (k, m): unknowns and their ``G x + q``. passive (k,): unknowns whose w vanish. inverse
    (k, k): of their part of G, zero elsewhere. right, size (k,): right-hand sides and the sizes of
    their terms. along (k,): how unknowns move with the one that enters. What may stop that, its own
    w, other unknowns at their bounds, itself at its own: slack (k + 2, m) before it, speed (k + 2,)
    at which that is taken, 0 where there is none, and bound (k + 2,).
    """

    x: Floats
    w: Floats
    passive: Bools
    inverse: Floats
    right: Floats
    size: Floats
    along: Floats
    slack: Floats
    speed: Floats
    bound: Floats


@kernel
def least_in_box(
    G: Floats, q: Floats, low: Floats, high: Floats, start: Floats
) -> tuple[Floats, bool]:
    """The limit of x for ε to zero, shape (k,), and whether there is a least value.

    Parameters
    ----------
    G : ndarray, shape (k, k)
        Symmetric positive semidefinite, positive diagonal.
    q : ndarray, shape (k, m)
        Column i is q_i.
    low, high : ndarray, shape (k,)
        The box; a bound may be infinite.
    start : ndarray, shape (k,)
        A corner of it, on which unknowns stay that nothing moves.
    """
    k, m = q.shape
    work = _Pivoting(
        np.zeros((k, m)),
        np.zeros((k, m)),
        np.zeros(k, np.bool_),
        np.zeros((k, k)),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros((k + 2, m)),
        np.zeros(k + 2),
        np.zeros(k + 2),
    )
    return work.right, _pivot(G, q, low, high, start, work)


@scalar_kernel
def _pivot(G: Floats, q: Floats, low: Floats, high: Floats, start: Floats, work: _Pivoting) -> bool:
    """`least_in_box`, its limit in `right` at last."""
    x, k = work.x, low.size
    for i in range(k):
        x[i, 0] = start[i]
    for _ in range(50 * k + 50):
        _set_rates(G, q, work)
        j = _first_wrong(low, work)
        if j < 0:
            for i in range(k):
                work.right[i] = min(max(x[i, 0], low[i]), high[i])
            return True
        if not _enter(G, j, low, high, work):
            return False
        _set_passive(G, q, work)
    return False


@scalar_kernel
def _set_rates(G: Floats, q: Floats, work: _Pivoting) -> None:
    """Set w to ``G x + q``."""
    for i in range(q.shape[0]):
        for c in range(q.shape[1]):
            value, size = q[i, c], abs(q[i, c])
            for j in range(q.shape[0]):
                value += G[i, j] * work.x[j, c]
                size += abs(G[i, j] * work.x[j, c])
            work.w[i, c] = unless_rounding(value, LCP_ROUNDING * size)


@scalar_kernel
def _first_wrong(low: Floats, work: _Pivoting) -> int:
    """The first unknown on a bound whose w tells it to leave that, or -1."""
    for i in range(low.size):
        way = -1.0 if work.x[i, 0] <= low[i] else 1.0
        if not work.passive[i] and _sign(work.w[i]) * way > 0.0:
            return i
    return -1


@scalar_kernel
def _set_passive(G: Floats, q: Floats, work: _Pivoting) -> None:
    """Give passive unknowns the values with which their w vanish."""
    x, passive, right, size, inverse = work.x, work.passive, work.right, work.size, work.inverse
    _invert_passive(G, work)
    for c in range(q.shape[1]):
        for i in range(passive.size):
            right[i], size[i] = q[i, c], abs(q[i, c])
            for j in range(passive.size):
                if not passive[j]:
                    right[i] += G[i, j] * x[j, c]
                    size[i] += abs(G[i, j] * x[j, c])
        for i in range(passive.size):
            if passive[i]:
                value, terms = 0.0, 0.0
                for j in range(passive.size):
                    value -= inverse[i, j] * right[j]
                    terms += abs(inverse[i, j]) * size[j]
                x[i, c] = unless_rounding(value, LCP_ROUNDING * terms)


@scalar_kernel
def _invert_passive(G: Floats, work: _Pivoting) -> None:
    """Set the inverse of the passive part of G, by Gauss and Jordan, in place."""
    A, passive = work.inverse, work.passive
    for i in range(passive.size):
        for j in range(passive.size):
            A[i, j] = G[i, j] if passive[i] and passive[j] else 0.0
    for p in range(passive.size):
        if not passive[p]:
            continue
        pivot = A[p, p]
        A[p, p] = 1.0
        for j in range(passive.size):
            A[p, j] /= pivot
        for i in range(passive.size):
            factor = A[i, p]
            if i != p and factor != 0.0:
                A[i, p] = 0.0
                for j in range(passive.size):
                    A[i, j] -= factor * A[p, j]


@scalar_kernel
def _enter(G: Floats, j: int, low: Floats, high: Floats, work: _Pivoting) -> bool:
    """Move x_j off its bound until its w vanishes, or it comes to its other bound.

    Passive unknowns keep their w of zero on the way, and leave where they come to a bound. False
    where nothing stops x_j.
    """
    x, w_j, along, k = work.x, work.w[j], work.along, low.size
    way = -_sign(w_j)
    while True:
        _set_along(G, j, way, work)
        curvature = 0.0
        for i in range(k):
            curvature += G[j, i] * along[i] * way
        _set_stops(curvature if curvature > SINGULAR * G[j, j] else 0.0, j, way, (low, high), work)
        first = _first(work)
        if first < 0:
            return False
        for c in range(w_j.size):
            step = work.slack[first, c] / work.speed[first]
            w_j[c] += curvature * way * step
            for i in range(k):
                x[i, c] += along[i] * step
        if first == 0:
            work.passive[j] = True
            return True
        blocking = j if first == k + 1 else first - 1
        for c in range(w_j.size):
            x[blocking, c] = work.bound[first] if c == 0 else 0.0
        if blocking == j:
            return True
        work.passive[blocking] = False
        _invert_passive(G, work)


@scalar_kernel
def _set_along(G: Floats, j: int, way: float, work: _Pivoting) -> None:
    """Set how unknowns move with x_j, which moves by `way`: passive ones keep their w of zero."""
    along, largest = work.along, abs(way)
    for i in range(along.size):
        along[i] = 0.0
        for k in range(along.size):
            along[i] -= way * work.inverse[i, k] * G[k, j]
        largest = max(largest, abs(along[i]))
    along[j] = way
    for i in range(along.size):
        along[i] = unless_rounding(along[i], LCP_ROUNDING * largest)


@scalar_kernel
def _set_stops(
    curvature: float, j: int, way: float, box: tuple[Floats, Floats], work: _Pivoting
) -> None:
    """Set what may stop x_j, whose w changes by `curvature` on its way."""
    x, along, k = work.x, work.along, work.along.size
    work.speed[0], work.speed[j + 1] = curvature, 0.0
    for c in range(x.shape[1]):
        work.slack[0, c] = -work.w[j, c] * way
    for i in range(k):
        stop = k + 1 if i == j else i + 1
        bound = box[0][i] if along[i] < 0.0 else box[1][i]
        work.speed[stop] = abs(along[i]) if np.isfinite(bound) else 0.0
        work.bound[stop] = bound
        for c in range(x.shape[1]):
            slack = (bound if c == 0 else 0.0) - x[i, c]
            work.slack[stop, c] = -slack if along[i] < 0.0 else slack


@scalar_kernel
def _first(work: _Pivoting) -> int:
    """The first stop, by the coefficients of their steps one after the other; or -1.

    The rounding of slacks is that of the unknowns. Stops that come later lose their speed.
    """
    x, slack, speed = work.x, work.slack, work.speed
    for c in range(x.shape[1]):
        rounding, least, noise = 0.0, np.inf, 0.0
        for i in range(x.shape[0]):
            rounding = max(rounding, LCP_ROUNDING * abs(x[i, c]))
        for i in range(speed.size):
            if speed[i] > 0.0 and slack[i, c] / speed[i] < least:
                least, noise = slack[i, c] / speed[i], rounding / speed[i]
        for i in range(speed.size):
            if speed[i] > 0.0 and slack[i, c] / speed[i] > least + noise + rounding / speed[i]:
                speed[i] = 0.0
    for i in range(speed.size):
        if speed[i] > 0.0:
            return i
    return -1


@scalar_kernel
def unless_rounding(value: float, noise: float) -> float:
    """A value, zero where it is within its noise."""
    return value if abs(value) > noise else 0.0


@scalar_kernel
def _sign(coefficients: Floats) -> float:
    """Sign of a polynomial for small arguments."""
    for value in coefficients:
        if value != 0.0:
            return 1.0 if value > 0.0 else -1.0
    return 0.0
