"""First positive root of a polynomial whose scale may be anything.

With the Bernstein coefficients on ``[0, l]``

    b_i = Σ_k C(i, k) / C(p, k) c_k l^k,    Σ c_k x^k = Σ b_i B_i(x / l),

a polynomial has at most as many roots inside as they change sign (Descartes'
rule in Bernstein form: G. Farin, Curves and Surfaces for CAGD, section 4), so
stretches without a change are passed over and the others divided.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from eventpound.numerics.arrays import Floats

DEEPEST = 48
"""Halvings after which a stretch with a positive end counts as clear: a dip inside
would be shallower than rounding."""


@njit(cache=True)
def value_and_slope(c: Floats, x: float) -> tuple[float, float]:
    """Value and derivative of ``Σ c_k x^k`` by Horner's rule."""
    value, slope = c[c.size - 1], 0.0
    for k in range(c.size - 2, -1, -1):
        slope = slope * x + value
        value = value * x + c[k]
    return value, slope


@njit(cache=True)
def _quadratic_root(c0: float, c1: float, c2: float) -> float:
    """Smallest positive root of ``c0 + c1 x + c2 x²`` with ``c0 > 0``, or inf."""
    discriminant = c1 * c1 - 4.0 * c0 * c2
    if discriminant < 0.0:
        return np.inf
    root = np.sqrt(discriminant)
    if c1 < 0.0:
        return 2.0 * c0 / (root - c1)
    return -(c1 + root) / (2.0 * c2) if c2 < 0.0 else np.inf


@njit(cache=True)
def _bernstein(c: Floats, limit: float) -> Floats:
    """Bernstein coefficients on ``[0, limit]``."""
    degree = c.size - 1
    b = c.copy()
    factor = 1.0
    for k in range(1, degree + 1):
        factor *= limit * k / (degree - k + 1)
        b[k] *= factor
    for k in range(1, degree + 1):
        for i in range(degree, k - 1, -1):
            b[i] += b[i - 1]
    return b


@njit(cache=True)
def _halve(b: Floats, left: Floats) -> None:
    """De Casteljau's division: the left half goes to `left`, the right one stays in b."""
    degree = b.size - 1
    for k in range(degree + 1):
        left[k] = b[0]
        for i in range(degree - k):
            b[i] = 0.5 * (b[i] + b[i + 1])


@njit(cache=True)
def _first_bracket(b: Floats) -> tuple[float, float]:
    """First part of [0, 1] at whose end a polynomial has just become negative, or (inf, inf)."""
    stack = np.empty((DEEPEST + 1, b.size))
    level = np.zeros(DEEPEST + 1, np.int64)
    stack[0] = b
    top, start = 0, 0.0
    while top >= 0:
        part = stack[top]
        width = 0.5 ** level[top]
        changes = 0
        for i in range(b.size - 1):
            changes += (part[i] < 0.0) != (part[i + 1] < 0.0)
        deepest = level[top] == DEEPEST
        if part[-1] < 0.0 and (changes == 1 or deepest):
            return start, start + width
        if changes == 0 or deepest:
            start += width
            top -= 1
            continue
        level[top] += 1
        level[top + 1] = level[top]
        _halve(part, stack[top + 1])
        top += 1
    return np.inf, np.inf


@njit(cache=True)
def _bisect(c: Floats, low: float, high: float) -> float:
    """Root between a point above zero and one below."""
    for _ in range(1100):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if value_and_slope(c, middle)[0] < 0.0:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True)
def first_root(c: Floats, limit: float) -> float:
    """Smallest x in (0, limit] at which a polynomial falls below zero.

    Roots at zero itself are divided out first, so a gap that has just opened
    is followed to its next closing however soon that is.

    Parameters
    ----------
    c : ndarray, shape (p + 1,)
        Coefficients of ``Σ c_k x^k``, the first that differs from zero positive.
    limit : float
        End of the search, positive.

    Returns
    -------
    float
        The root, or inf. It is looked for first within twice that of the
        leading quadratic, which sets the scale, then in the whole interval.
    """
    start = 0
    while start < c.size and c[start] == 0.0:
        start += 1
    c = c[start:]
    if c.size < 2:
        return np.inf
    near = 2.0 * _quadratic_root(c[0], c[1], c[2] if c.size > 2 else 0.0)
    for end in (min(near, limit), limit):
        low, high = _first_bracket(_bernstein(c, end))
        if high < np.inf:
            return _bisect(c, end * low, end * high)
    return np.inf
