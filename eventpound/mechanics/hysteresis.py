"""The Bouc–Wen law in rate form, its bound, and its Taylor coefficients.

``z' = (1/u_y) [x' - γ |x'| z |z|^(n-1) - β x' |z|^n]``  (founding paper, eq. 3)

With σ the sign of x' and s that of z this is
``z' = (x'/u_y) [1 - (β + γ σ s) |z|^n]``; the second form is used throughout.
x: elongation (m), u_y: yield displacement (m), z, β, γ, n: dimensionless.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import NO_POWER, NO_Z


@scalar_kernel
def z_rate(
    x_rate: float,
    direction: float,
    z: float,
    yield_displacement: float,
    n: float,
    beta: float,
    gamma: float,
) -> float:
    """Z' of eq. 3 (1/s) at the elongation rate `x_rate` (m/s).

    The sign σ is that of `direction`: x' itself, or what it was before a reversal.
    """
    same_sign = (direction > 0.0) == (z > 0.0)
    kappa = beta + gamma if same_sign else beta - gamma
    return x_rate / yield_displacement * (1.0 - kappa * abs(z) ** n)


@scalar_kernel
def z_rate_slopes(
    x_rate: float, z: float, yield_displacement: float, n: float, beta: float, gamma: float
) -> tuple[float, float]:
    """Derivatives of `z_rate` by the elongation rate (1/m) and by z (1/s)."""
    same_sign = (x_rate > 0.0) == (z > 0.0)
    kappa = beta + gamma if same_sign else beta - gamma
    size = abs(z)
    by_rate = (1.0 - kappa * size**n) / yield_displacement
    by_size = -x_rate / yield_displacement * kappa * n * size ** (n - 1.0)
    return by_rate, by_size if z > 0.0 else -by_size


@scalar_kernel
def z_bound(n: float, beta: float, gamma: float) -> float:
    """Largest |z| that loading can reach, (β + γ)^(-1/n)."""
    return float((beta + gamma) ** (-1.0 / n))


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
    while leading < k and z[leading] == 0.0:
        leading += 1
    rest = k - leading * n
    if rest < 0.0 or rest != int(rest) or z[leading] == 0.0:
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
