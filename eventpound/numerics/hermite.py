"""Bounds of Hermite polynomials on a step, by their Bernstein coefficients.

A polynomial on ``[0, h]`` lies between the smallest and the largest of its
Bernstein coefficients (convex hull property: G. Farin, Curves and Surfaces
for CAGD, section 4), so a sign shared by all of them excludes a root, where
looking at the two ends alone does not.
"""

from __future__ import annotations

from numba import njit


@njit(cache=True)
def quintic_bernstein(
    p0: float, d0: float, s0: float, p1: float, d1: float, s1: float, h: float
) -> tuple[float, float, float, float, float, float]:
    """Bernstein coefficients from value p, slope d and second derivative s at both ends."""
    return (
        p0,
        p0 + h * d0 / 5.0,
        p0 + h * (0.4 * d0 + h * s0 / 20.0),
        p1 - h * (0.4 * d1 - h * s1 / 20.0),
        p1 - h * d1 / 5.0,
        p1,
    )


@njit(cache=True)
def cubic_bernstein(
    p0: float, d0: float, p1: float, d1: float, h: float
) -> tuple[float, float, float, float]:
    """Bernstein coefficients from value p and slope d at both ends."""
    return (p0, p0 + h * d0 / 3.0, p1 - h * d1 / 3.0, p1)
