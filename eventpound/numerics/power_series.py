"""Powers of a power series, coefficient by coefficient, and signs just after its start."""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import NO_POWER, NO_Z


@scalar_kernel
def integer_power(x: float, n: float) -> float:
    """``x^n`` for x >= 0, by squaring where n is a small integer."""
    m = int(n)
    if m != n or m > 64:
        return float(x**n)
    result = 1.0
    while m > 0:
        if m & 1:
            result *= x
        x *= x
        m >>= 1
    return result


@kernel
def sign_after(series: Floats, known: int, noise: float) -> float:
    """Sign just after zero: that of the first of `known` coefficients that does not vanish.

    The value itself counts as vanished up to `noise`.
    """
    for k in range(known):
        if abs(series[k]) > (noise if k == 0 else 0.0):
            return 1.0 if series[k] > 0.0 else -1.0
    return 0.0


@kernel
def power_coefficient(z: Floats, power: Floats, n: float, k: int) -> float:
    """Taylor coefficient k of |z|^n from those of z up to k and of |z|^n below k.

    From ``z P' = n z' P`` with ``P = |z|^n``; at z = 0 the product is built by
    repeated multiplication when n is a small integer, and vanishes below
    order n otherwise. Where n is not an integer it has a branch point at z = 0,
    so near to it that |z|^n is rounding it counts as there.

    Parameters
    ----------
    z, power : ndarray, shape (> k,)
        Taylor coefficients of z and, up to k - 1, of |z|^n.
    n : float
        Exponent, at least 1.
    k : int
        Order wanted.
    """
    if k == 0:
        return float(abs(z[0]) ** n)
    if abs(z[0]) <= NO_Z:
        return _power_at_zero(z, n, k)
    if power[0] < NO_POWER and n != int(n):
        return 0.0
    total = 0.0
    for j in range(1, k + 1):
        total += (n * j - (k - j)) * z[j] * power[k - j]
    return total / (k * z[0])


@kernel
def _power_at_zero(z: Floats, n: float, k: int) -> float:
    """Coefficient k of |z|^n where z starts from zero: z = τ^m (z_m + ...)."""
    leading = 1
    # In the first of a tail's coefficients rounding is most, and the recurrence divides by it.
    while leading < k and abs(z[leading]) <= NO_Z:
        leading += 1
    rest = k - leading * n
    if rest < 0.0 or rest != int(rest) or abs(z[leading]) <= NO_Z:
        return 0.0
    # |z|^n = τ^(m n) |z_m|^n (1 + z_(m+1)/z_m τ + ...)^n: the same recurrence again.
    depth = int(rest)
    series = [abs(z[leading]) ** n]
    for i in range(1, depth + 1):
        total = 0.0
        for j in range(1, i + 1):
            total += (n * j - (i - j)) * z[leading + j] * series[i - j]
        series.append(total / (i * z[leading]))
    return float(series[depth])
