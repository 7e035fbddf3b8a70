"""Taylor series of a single body, as long as the step wants them.

``x_{k+2} = (A_k - g_k) / ((k + 1) (k + 2))``: A_k needs ``-K x_k - C (k + 1) x_{k+1}``
alone while z is linear in u or constant, and the convolutions of
`eventpound.solvers.fast.expansion` on the curved parts of the backbone. The
series ends where two terms in a row are below the tolerance.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.mechanics.backbone import integer_power
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled

ROOM = 48
"""Coefficients there is room for."""
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, ROOM)])
"""1/k."""
INVERSE_PAIRS = np.array([1.0 / ((k + 1) * (k + 2)) for k in range(ROOM)])
"""1/((k + 1)(k + 2))."""
SAFETY = 0.95
"""Part of the length at which the last terms reach the tolerance."""


@compiled
def linear_series(
    stiffness: float,
    damping: float,
    even: float,
    odd: float,
    g: Floats,
    most: int,
    h: float,
    of_u: float,
    of_v: float,
    x: Floats,
) -> tuple[int, bool]:
    """Coefficients 3 ... p of a linear oscillator; p, and whether a step of h (s) is good.

    The ground's are ``g[k] even`` and ``g[k] odd``. x[1] and x[2] stand. p is even, at most `most`.
    """
    first, second = x[1], x[2]
    square = h * h
    power = square
    order = 2
    good = False
    for i in range((most - 2) // 2):
        k = 2 * i + 1
        third = (-stiffness * first - damping * (k + 1) * second - g[k] * odd) * INVERSE_PAIRS[k]
        fourth = (
            -stiffness * second - damping * (k + 2) * third - g[k + 1] * even
        ) * INVERSE_PAIRS[k + 1]
        x[k + 2] = third
        x[k + 3] = fourth
        first, second = third, fourth
        order = k + 3
        last = power * max(abs(third) * h, abs(fourth) * square)
        power *= square
        if last <= of_u and order * last <= of_v * h:
            good = True
            break
    x[order + 1] = x[order + 2] = 0.0
    return order, good


@compiled
def curved_series(
    stiffness: float,
    damping: float,
    strength: float,
    per_scale: float,
    exponent: float,
    kappa: float,
    even: float,
    odd: float,
    g: Floats,
    most: int,
    h: float,
    of_u: float,
    of_v: float,
    z_0: float,
    x: Floats,
    z: Floats,
    power: Floats,
    speed: Floats,
) -> tuple[int, bool]:
    """The same on a curved part, where ``z' = (u'/scale)(1 - κ |z|^n)``; z is σ y."""
    p_0 = integer_power(abs(z_0), exponent)
    z[0], power[0] = z_0, p_0
    over, more = 1.0 / z_0, exponent + 1.0
    lift = exponent * p_0 * over
    reach = h * h
    last, before = np.inf, np.inf
    order = 2
    good = False
    newest = per_scale * x[1]
    first = speed[0] = newest
    through = first * p_0
    for k in range(most - 2):
        z_k = (newest - kappa * through) * INVERSE[k + 1]
        z[k + 1] = z_k
        x_k = (
            -stiffness * x[k + 1]
            - damping * (k + 2) * x[k + 2]
            - strength * z_k
            - g[k + 1] * (odd if k & 1 == 0 else even)
        ) * INVERSE_PAIRS[k + 1]
        x[k + 3] = x_k
        order = k + 3
        before, reach = last, reach * h
        last = abs(x_k) * reach
        worse = max(last, before)
        if worse <= of_u and order * worse <= of_v * h:
            good = True
            break
        newest = per_scale * (k + 2) * x[k + 2]
        speed[k + 1] = newest
        # Both sums at once, and two terms of each: one chain of additions would be waited for.
        of_speed, of_speed_too, of_z, of_z_too = 0.0, 0.0, 0.0, 0.0
        weight = more - (k + 1)
        for i in range(k // 2):
            j = 2 * i + 1
            of_speed += speed[j] * power[k + 1 - j]
            of_z += weight * z[j] * power[k + 1 - j]
            weight += more
            of_speed_too += speed[j + 1] * power[k - j]
            of_z_too += weight * z[j + 1] * power[k - j]
            weight += more
        if k & 1 == 1:
            of_speed += speed[k] * power[1]
            of_z += weight * z[k] * power[1]
        p_k = over * ((of_z + of_z_too) * INVERSE[k + 1]) + lift * z_k
        power[k + 1] = p_k
        through = of_speed + of_speed_too + newest * p_0 + first * p_k
    x[order + 1] = x[order + 2] = 0.0
    return order, good


@compiled
def shorter(h: float, order: int, of_u: float, of_v: float, x: Floats) -> float:
    """Length at which the last two terms are within the tolerance (s), at most h."""
    least = 1.0
    power = h
    for _ in range(order - 2):
        power *= h
    for k in range(order - 1, order + 1):
        term = abs(x[k]) * power
        error = max(term / of_u, k * term / (of_v * h))
        if error > 1.0:
            factor = math.exp(-math.log(error) * INVERSE[k - 1]) if error < np.inf else 1e-3
            least = min(least, SAFETY * factor)
        power *= h
    return h * least


@compiled
def motion(tau: float, order: int, x: Floats) -> tuple[float, float, float]:
    """Change of displacement (m), velocity (m/s) and relative acceleration (m/s²) after tau (s)."""
    change, rate, bend = x[order], 0.0, 0.0
    for k in range(order - 1, 0, -1):
        bend = bend * tau + rate
        rate = rate * tau + change
        change = change * tau + x[k]
    bend = bend * tau + rate
    rate = rate * tau + change
    return change * tau, rate, 2.0 * bend
