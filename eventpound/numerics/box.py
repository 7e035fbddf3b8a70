"""The least of a convex quadratic function over a box, and of linear ones where it leaves a choice.

    min ½ xᵀ G x + q(ε)ᵀ x,   low <= x <= high,   q(ε) = q_0 + ε q_1 + ε² q_2 + ...

for the smallest ε > 0, G symmetric positive semidefinite. Where G is singular, q_0 alone may leave
several x, or none that a small change of q would not carry off; q_1 and those that follow say which
one. The limit of x is found by principal pivoting (`eventpound.numerics.lcp`) on numbers that are
polynomials in ε, told apart by their first coefficient that is not rounding.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Bools, Floats
from eventpound.tolerances import LCP_ROUNDING, SINGULAR


def least_in_box(G: Floats, q: Floats, low: Floats, high: Floats, start: Floats) -> Floats | None:
    """The limit of x for ε to zero, shape (k,); None where there is no least value.

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
    x, passive = np.zeros(q.shape), np.zeros(low.size, np.bool_)
    x[:, 0] = start
    for _ in range(50 * low.size + 50):
        terms = np.abs(q) + np.abs(G) @ np.abs(x)
        w = without_rounding(G @ x + q, LCP_ROUNDING * terms)
        ways = np.where(x[:, 0] <= low, -1.0, 1.0) * [_sign(row) for row in w]
        wrong = np.flatnonzero(~passive & (ways > 0.0))
        if wrong.size == 0:
            return np.clip(x[:, 0], low, high)
        if not _enter(G, w[wrong[0]], int(wrong[0]), (low, high), x, passive):
            return None
        P = np.flatnonzero(passive)
        if P.size > 0:
            to_bounds, inverse = G[P] * ~passive, np.linalg.inv(G[np.ix_(P, P)])
            terms = np.abs(q[P]) + np.abs(to_bounds) @ np.abs(x)
            found = -inverse @ (q[P] + to_bounds @ x)
            x[P] = without_rounding(found, LCP_ROUNDING * np.abs(inverse) @ terms)
    return None


def _enter(
    G: Floats, w_j: Floats, j: int, box: tuple[Floats, Floats], x: Floats, passive: Bools
) -> bool:
    """Move x_j off its bound until its w (m,) vanishes, or it comes to its other bound.

    Passive entries keep their w of zero on the way, and leave where they come to a bound. False
    where nothing stops x_j.
    """
    way = -_sign(w_j)
    while True:
        P = np.flatnonzero(passive)
        along = np.zeros(passive.size)
        along[P], along[j] = -np.linalg.solve(G[np.ix_(P, P)], G[P, j]) * way, way
        along = without_rounding(along, LCP_ROUNDING * np.abs(along).max())
        curvature = float(G[j] @ along) * way
        stops = []
        if curvature > SINGULAR * G[j, j]:
            stops.append((-1, 0.0, -w_j * way, curvature))
        for i in (*P, j):
            bound = box[0][i] if along[i] < 0.0 else box[1][i]
            if along[i] != 0.0 and np.isfinite(bound):
                slack = -x[i].copy()
                slack[0] += bound
                stops.append((int(i), float(bound), slack * np.sign(along[i]), abs(along[i])))
        if not stops:
            return False
        blocking, bound, step = _first(stops, np.abs(x).max(axis=0))
        x += along[:, None] * step
        if blocking < 0:
            passive[j] = True
            return True
        x[blocking] = 0.0
        x[blocking, 0] = bound
        if blocking == j:
            return True
        passive[blocking] = False
        w_j = w_j + curvature * way * step


def _first(
    stops: list[tuple[int, float, Floats, float]], size: Floats
) -> tuple[int, float, Floats]:
    """The first of some stops, by the coefficients of their steps one after the other.

    Of each: its unknown, its bound, the slack before it (m,), and how much of that a step of one
    takes. size (m,): of the unknowns, whose rounding is that of slacks.
    """
    for c in range(size.size):
        steps = [(slack[c] / speed, LCP_ROUNDING * size[c] / speed) for *_, slack, speed in stops]
        least, noise = min(steps)
        stops = [
            stop
            for stop, (step, own) in zip(stops, steps, strict=True)
            if step <= least + noise + own
        ]
    blocking, bound, slack, speed = stops[0]
    return blocking, bound, slack / speed


def without_rounding(values: Floats, noise: Floats) -> Floats:
    """Values, those within their noise zero; arrays of one shape."""
    return np.where(np.abs(values) <= noise, 0.0, values)


def _sign(coefficients: Floats) -> float:
    """Sign of a polynomial for small arguments."""
    first = coefficients[np.flatnonzero(coefficients)[:1]]
    return float(np.sign(first[0])) if first.size else 0.0
