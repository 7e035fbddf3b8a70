"""The Bouc-Wen law over one step of the elongation.

The law does not know time: with σ the sign of the change Δx of the elongation
over the step, and ``y = σ z``, eq. 3 of the founding paper is

    y' = (|Δx|/u_y) g(y),   g(y) = 1 - κ |y|^n,   κ = β + γ for y > 0, β - γ below

over a step of length one. It is solved by the L-stable implicit Runge-Kutta
method of two stages and order two (R. Alexander, SIAM J. Numer. Anal. 14,
1977, 1006-1021, γ = 1 - 1/√2), each stage by Newton's method. The trapezoid
rule would swing about the knee, where |z|^20 is stiff; backward Euler, the
usual choice, would make every stepper first order. A reversal within a step
is seen as the net change, an error of second order.
"""

from __future__ import annotations

import math

from eventpound.solvers.timestepping.structure import step_kernel
from eventpound.tolerances import ITERATED

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
"""γ of the method."""
MOST_ITERATIONS = 60


@step_kernel
def _slope(y: float, n: float, beta: float, gamma: float) -> tuple[float, float]:
    """Return g(y) and g'(y)."""
    if y > 0.0:
        power = (beta + gamma) * y ** (n - 1.0)
        return 1.0 - power * y, -n * power
    power = (beta - gamma) * (-y) ** (n - 1.0) if y < 0.0 else 0.0
    return 1.0 + power * y, n * power


@step_kernel
def _stage(
    known: float, length: float, bound: float, n: float, beta: float, gamma: float
) -> tuple[float, float, float]:
    """Solve ``y = known + length g(y)``; returns y, g(y) and g'(y), numbers that are none in vain.

    Above zero the equation is convex, so Newton's method comes down from the
    bound without fail.
    """
    y = min(known + length, max(bound, known))
    for _ in range(MOST_ITERATIONS):
        g, g_y = _slope(y, n, beta, gamma)
        change = (y - known - length * g) / (1.0 - length * g_y)
        y -= change
        if abs(change) <= ITERATED * max(1.0, abs(y)):
            g, g_y = _slope(y, n, beta, gamma)
            return y, g, g_y
    return math.nan, math.nan, math.nan


@step_kernel
def z_after(
    z: float,
    change: float,
    yield_displacement: float,
    n: float,
    beta: float,
    gamma: float,
    bound: float,
) -> tuple[float, float]:
    """Return z at the end of a step and its derivative by the elongation.

    Parameters
    ----------
    z : float
        At the start of the step.
    change : float
        Δx (m).
    yield_displacement : float
        u_y (m).
    n, beta, gamma : float
        Constants of the law.
    bound : float
        Largest |z| that loading can reach, (β + γ)^(-1/n).

    Returns
    -------
    z, z_x : float
        z and ∂z/∂Δx (1/m); not numbers where a stage has no solution.
    """
    sign = 1.0 if change >= 0.0 else -1.0
    length = abs(change) / yield_displacement
    start = sign * z
    implicit, explicit = DIAGONAL * length, (1.0 - DIAGONAL) * length
    _, g_1, slope_1 = _stage(start, implicit, bound, n, beta, gamma)
    y_2, g_2, slope_2 = _stage(start + explicit * g_1, implicit, bound, n, beta, gamma)
    # The derivative by the length follows from those of the two stages.
    by_1 = DIAGONAL * g_1 / (1.0 - implicit * slope_1)
    by_2 = (1.0 - DIAGONAL) * g_1 + explicit * slope_1 * by_1 + DIAGONAL * g_2
    return sign * y_2, by_2 / (1.0 - implicit * slope_2) / yield_displacement
