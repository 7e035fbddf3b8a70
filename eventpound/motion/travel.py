"""How far a formula of `eventpound.motion.forcing` goes: its first two integrals, compiled.

They are those of the formula without constants. Of samples they are the running sums of
`eventpound.motion.record.integrals`, which stand behind them:

    samples = [a_0 ... a_n-1, v_0 ... v_n-1, d_0 ... d_n-1]
"""

from __future__ import annotations

import math

from eventpound.motion.base import Family
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel

_SINUSOIDS = int(Family.SINUSOIDS)
_GAUSSIAN = int(Family.GAUSSIAN)
_SAMPLES = int(Family.SAMPLES)
ROUNDING = 1e-14
"""Part of a coefficient that counts as its rounding: of it alone a wavelet would drift."""


@scalar_kernel
def signal_travel(
    family: int, coefficients: Floats, samples: Floats, t: float
) -> tuple[float, float]:
    """Second and first integral of a formula at one time (m, m/s), but for two constants.

    Parameters
    ----------
    family, coefficients, t
        As of `eventpound.motion.forcing.signal_value`.
    samples : ndarray, shape (3 n,)
        Of the family SAMPLES, with their sums; else empty.
    """
    d, v = 0.0, 0.0
    if family == _SINUSOIDS:
        s = t - coefficients[0]
        for k in range(1, coefficients.size, 3):
            w = coefficients[k + 1]
            v += coefficients[k] / w * math.sin(w * s + coefficients[k + 2])
            d -= coefficients[k] / (w * w) * math.cos(w * s + coefficients[k + 2])
    elif family == _GAUSSIAN:
        d, v = _gaussian_travel(coefficients, t)
    elif family == _SAMPLES:
        n, dt = samples.size // 3, coefficients[1]
        # Beyond its ends a record goes on by its first and its last line.
        i = min(max(math.floor((t - coefficients[0]) / dt), 0), n - 2)
        h = t - (coefficients[0] + i * dt)
        a, slope = samples[i], (samples[i + 1] - samples[i]) / dt
        v = samples[n + i] + h * (a + h / 2.0 * slope)
        d = samples[2 * n + i] + h * (samples[n + i] + h / 2.0 * (a + h / 3.0 * slope))
    return d, v


@scalar_kernel
def _gaussian_travel(coefficients: Floats, t: float) -> tuple[float, float]:
    """`signal_travel` of a cubic times a Gaussian; both vanish at -inf where it is a wavelet's.

    v is a square times the Gaussian and what is left of c_0 times its integral E, d a line
    times the Gaussian and what is left of both times E.
    """
    s, q = t - coefficients[0], coefficients[1]
    c_0, c_1, c_2, c_3 = coefficients[2:6]
    if q == 0.0:
        v = s * (c_0 + s * (c_1 / 2.0 + s * (c_2 / 3.0 + s * c_3 / 4.0)))
        return s * s * (c_0 / 2.0 + s * (c_1 / 6.0 + s * (c_2 / 12.0 + s * c_3 / 20.0))), v
    gaussian, integral = math.exp(-q * s * s), 0.5 * math.sqrt(math.pi / q)
    integral *= math.erf(math.sqrt(q) * s)
    # By the derivative of (b_0 + b_1 s + b_2 s²) exp(-q s²), from s³ down.
    b_2, b_1 = -0.5 * c_3 / q, -0.5 * c_2 / q
    b_0 = (b_2 - 0.5 * c_1) / q
    left_of_c, left_of_b = _left(c_0, b_1), _left(b_0, -0.5 * b_2 / q)
    v = (b_0 + s * (b_1 + s * b_2)) * gaussian + left_of_c * integral
    d = -0.5 * (b_1 + b_2 * s - left_of_c) / q * gaussian + (left_of_b + left_of_c * s) * integral
    return d, v


@scalar_kernel
def _left(whole: float, part: float) -> float:
    """What is left of a number beside a part of it, none where that is rounding."""
    # A wavelet is made so that nothing is left; what rounding leaves would drift away with t.
    return whole - part if abs(whole - part) > ROUNDING * abs(whole) else 0.0
