"""First positive root of a polynomial whose scale may be anything."""

from __future__ import annotations

import numpy as np
from numba import njit

from eventpound.numerics.arrays import Floats
from eventpound.numerics.complementarity import EPS


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
def _polish(c: Floats, x: float, limit: float) -> float:
    """Newton's iteration from x; inf where it leaves (0, limit]."""
    for _ in range(40):
        value, slope = value_and_slope(c, x)
        if slope == 0.0:
            return np.inf
        new = x - value / slope
        if not 0.0 < new <= 2.0 * limit:
            return np.inf
        if abs(new - x) <= 2.0 * EPS * new:
            return new if new <= limit else np.inf
        x = new
    return x if x <= limit else np.inf


@njit(cache=True)
def first_root(c: Floats, limit: float) -> float:
    """Smallest x in (0, limit] where a polynomial falls to zero.

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
        The root, or inf. It is looked for near that of the leading quadratic,
        then between 32 equal parts of the interval.
    """
    start = 0
    while start < c.size and c[start] == 0.0:
        start += 1
    c = c[start:]
    if c.size < 2:
        return np.inf
    guess = _quadratic_root(c[0], c[1], c[2] if c.size > 2 else 0.0)
    if guess <= limit:
        root = _polish(c, guess, limit)
        if root < np.inf and root < 1.5 * guess:
            return root
    before = 0.0
    for i in range(1, 33):
        x = limit * i / 32.0
        if value_and_slope(c, x)[0] < 0.0:
            return _bisect(c, before, x)
        before = x
    return np.inf


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
