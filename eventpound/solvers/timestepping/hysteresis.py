"""A law with a memory over one step of the elongation.

The law does not know time: with σ the sign of the change Δx of the elongation
over the step, ``y = σ z`` follows

    y' = |Δx| g(y),   g = dz/dx  (`eventpound.mechanics.elements.z_slopes`)

over a step of length one. It is solved by the L-stable implicit Runge-Kutta
method of two stages and order two (R. Alexander, SIAM J. Numer. Anal. 14,
1977, 1006-1021, γ = 1 - 1/√2), each stage by Newton's method. The trapezoid
rule would swing about the knee, where |z|^20 is stiff; backward Euler, the
usual choice, would make every stepper first order. A reversal within a step
is seen as the net change, an error of second order.
"""

from __future__ import annotations

import math

from eventpound.mechanics.elements import z_slopes
from eventpound.numerics.arrays import Floats
from eventpound.solvers.timestepping.structure import step_kernel
from eventpound.tolerances import ITERATED

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
"""γ of the method."""
MOST_ITERATIONS = 60


@step_kernel
def _stage(
    a: int, memory: Floats, known: float, length: float, bound: float
) -> tuple[float, float, float]:
    """Solve ``y = known + length g(y)``; returns y, g(y) and g'(y), numbers that are none in vain.

    Above zero the equation is convex, so Newton's method comes down from the
    bound without fail.
    """
    y = min(known + length * z_slopes(a, memory, 1.0, 0.0, 0.0)[0], max(bound, known))
    for _ in range(MOST_ITERATIONS):
        g, g_y = z_slopes(a, memory, 1.0, y, 0.0)
        change = (y - known - length * g) / (1.0 - length * g_y)
        y -= change
        if abs(change) <= ITERATED * max(1.0, abs(y)):
            g, g_y = z_slopes(a, memory, 1.0, y, 0.0)
            return y, g, g_y
    return math.nan, math.nan, math.nan


@step_kernel
def z_after(a: int, memory: Floats, z: float, change: float, bound: float) -> tuple[float, float]:
    """Return z at the end of a step and its derivative by the elongation.

    Parameters
    ----------
    a : int
        Number of the link.
    memory : ndarray, shape (L, constants)
        Constants of the laws.
    z : float
        At the start of the step.
    change : float
        Δx (m).
    bound : float
        Largest |z| that loading can reach.

    Returns
    -------
    z, z_x : float
        z and ∂z/∂Δx (1/m); not numbers where a stage has no solution.
    """
    sign, length = 1.0 if change >= 0.0 else -1.0, abs(change)
    start = sign * z
    implicit, explicit = DIAGONAL * length, (1.0 - DIAGONAL) * length
    _, g_1, slope_1 = _stage(a, memory, start, implicit, bound)
    y_2, g_2, slope_2 = _stage(a, memory, start + explicit * g_1, implicit, bound)
    # The derivative by the length follows from those of the two stages.
    by_1 = DIAGONAL * g_1 / (1.0 - implicit * slope_1)
    by_2 = (1.0 - DIAGONAL) * g_1 + explicit * slope_1 * by_1 + DIAGONAL * g_2
    return sign * y_2, by_2 / (1.0 - implicit * slope_2)
