"""Bounds of Hermite polynomials on a step, by their Bernstein coefficients.

A polynomial on ``[0, h]`` lies between the smallest and the largest of its
Bernstein coefficients (convex hull property: G. Farin, Curves and Surfaces
for CAGD, section 4), so a sign shared by all of them excludes a root, where
looking at the two ends alone does not.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.compiled import kernel


@kernel
def quintic_bernstein(
    start: tuple[float, float, float], end: tuple[float, float, float], h: float
) -> tuple[float, float, float, float, float, float]:
    """Bernstein coefficients from value p, slope d and second derivative s at both ends."""
    p0, d0, s0 = start
    p1, d1, s1 = end
    return (
        p0,
        p0 + h * d0 / 5.0,
        p0 + h * (0.4 * d0 + h * s0 / 20.0),
        p1 - h * (0.4 * d1 - h * s1 / 20.0),
        p1 - h * d1 / 5.0,
        p1,
    )


@kernel
def cubic_bernstein(
    p0: float, d0: float, p1: float, d1: float, h: float
) -> tuple[float, float, float, float]:
    """Bernstein coefficients from value p and slope d at both ends."""
    return (p0, p0 + h * d0 / 3.0, p1 - h * d1 / 3.0, p1)


@kernel
def cubic_at(p0: float, d0: float, p1: float, d1: float, h: float, x: float) -> float:
    """Value at the part x of a step of length h, from values and slopes at both ends."""
    y = 1.0 - x
    return y * y * ((1.0 + 2.0 * x) * p0 + x * h * d0) + x * x * ((1.0 + 2.0 * y) * p1 - y * h * d1)


@kernel
def quintic_at(
    start: tuple[float, float, float], end: tuple[float, float, float], h: float, x: float
) -> tuple[float, float]:
    """Value and slope at the part x of a step, from value, slope and second derivative."""
    b = np.array(quintic_bernstein(start, end, h))
    y = 1.0 - x
    # De Casteljau's division down to two: their difference is the slope.
    for count in (5, 4, 3, 2):
        for i in range(count):
            b[i] = y * b[i] + x * b[i + 1]
    return y * b[0] + x * b[1], 5.0 * (b[1] - b[0]) / h
