"""The restitution that each contact element really gives an isolated impact.

With the effective mass m and the approach speed v_0,

    linear, hertz   1
    kelvin-voigt    exp(-π ζ / sqrt(1 - ζ²)) = ε
    hertz-damp      the root of α (1 + e) = ln[(1 + α)/(1 - α e)], α = 3 (1 - ε²)/4:
                    v dv/dδ = -(k/m) δ^1.5 (1 + α v/v_0) separates (K. Ye, L. Li, H. Zhu,
                    Earthq. Eng. Struct. Dyn. 38, 2009, 1135-1142, found so that the
                    formula misses its target)
    jankowski       by quadrature of m δ'' = -F here
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from eventpound.scene.contact_law import Element, jankowski_ratio


def real_restitution(element: Element, eps: float) -> float:
    """The coefficient of restitution of an isolated impact where the case says ε."""
    if element is Element.KELVIN_VOIGT:
        return eps
    if element is Element.HERTZ_DAMP and eps < 1.0:
        a = 0.75 * (1.0 - eps**2)
        return float(brentq(lambda e: a * (1 + e) - math.log((1 + a) / (1 - a * e)), 1e-9, 1.0))
    if element is Element.JANKOWSKI:
        return _jankowski_restitution(eps)
    return 1.0


def _jankowski_restitution(eps: float) -> float:
    """Quadrature with m = k = v_0 = 1; what follows is elastic, so the depth says it all."""
    xi = jankowski_ratio(eps)

    def rate(_: float, y: np.ndarray) -> list[float]:
        depth, speed = max(y[0], 0.0), y[1]
        return [speed, -(depth**1.5) - 2.0 * xi * depth**0.25 * max(speed, 0.0)]

    def stopped(_: float, y: np.ndarray) -> float:
        return float(y[1])

    stopped.terminal = True
    end = solve_ivp(rate, (0.0, 50.0), [0.0, 1.0], rtol=1e-11, atol=1e-13, events=stopped)
    return math.sqrt(0.8 * end.y[0, -1] ** 2.5)
