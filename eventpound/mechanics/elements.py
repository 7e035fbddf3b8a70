"""The laws of springs: all that a solver asks of one.

A link pulls its ends together with ``F = k x + f + c x' + Q z``. The elastic part has one k
(N/m) and f (N) on each side of its kink (`eventpound.scene.elastic_laws`). A law with a memory
has an internal variable z, which adds Q z and moves by a rate of its own, here eq. 3 of the
founding paper,

    z' = (1/u_y) [x' - γ |x'| z |z|^(n-1) - β x' |z|^n]
       = (x'/u_y) [1 - (β + γ σ s) |z|^n],    σ = sgn x',  s = sgn z.

x: elongation (m), u_y: yield displacement (m), Q: strength (N), z, β, γ, n: dimensionless. Such a
law does not know time: with x' = 1 and σ = 1 everything below is by the elongation.

One that degrades (Baber and Wen 1981; Foliente 1995) has a second variable beside z, in the row
of a link of its own, its hysteretic energy in parts of Q u_y:

    z' = (x'/(η u_y)) [1 - ν (β + γ σ s) |z|^n],   ε' = z x'/u_y,   ν = 1 + δ_ν ε,  η = 1 + δ_η ε.

The constants of a law with a memory are a row of `LinkLaw.memory`. What stands in it is known
here and in `eventpound.mechanics.backbone`, which solves eq. 3 with time eliminated.

A law with *branches* has other constants on each (`memory_on_branches`), and tells where a branch
ends (`branch_ends`) and which one follows. Soil behind an abutment (Shamsabadi, Rollins and
Kapuskar 2007) has the backbone ``F = -y / (1/K_0 + R_f y/F_ult)`` in the depth y beyond the gap.
With ``Q = F_ult/R_f``, ``u_y = Q/K_0`` and ``η = y/u_y``

    z' = x'/u_y              apart, Q z no force, and inside the backbone,
    z' = (x'/u_y) (1 + z)^2  yielding: z = -η/(1 + η), until x' turns.

A slider has two, the directions of its slip, on which it pulls with a constant Q of their sign and
z is one. Whether it sticks `eventpound.contact.sliders` decides.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.link_law import (
    APART,
    BACKFILL,
    BESIDE,
    BETA,
    CLOSED,
    DEGRADING,
    DELTA_ETA,
    DELTA_NU,
    EXPONENT,
    GAMMA,
    ITS_ENERGY,
    KIND,
    SLIDER,
    STRENGTH,
    YIELD,
    YIELDING,
    YIELDING_SOIL,
)
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel, step_kernel
from eventpound.numerics.power_series import integer_power, power_coefficient, sign_after
from eventpound.tolerances import NO_Z

CURVE_PLACES = 5
"""Numbers of a law that `next_z` wants to know."""
(OVER_UY, OVER_Z, LIFT, KAPPA, WEIGHT) = range(CURVE_PLACES)
"""Their places: 1/u_y, 1/z_0, n P_0/z_0, κ and n + 1."""
MOST_TERMS = 32
"""More than the highest order of a series, and two."""
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, MOST_TERMS)])
"""1/k."""


@step_kernel
def pull_per_z(a: int, memory: Floats) -> float:
    """∂F/∂z of link a (N), 0 without a memory."""
    return float(memory[a, STRENGTH])


@step_kernel
def drag(a: int, links: Any, x_rate: float) -> float:
    """What x' makes link a pull with (N); `links` are its `damping` and `memory`, at least."""
    return float(links.damping[a] * x_rate)


@step_kernel
def drag_slope(a: int, links: Any, x_rate: float) -> float:
    """∂F/∂x' of link a (N s/m)."""
    return float(links.damping[a])


@step_kernel
def drag_coefficient(a: int, k: int, links: Any, x_rate: Floats) -> float:
    """Taylor coefficient k of `drag` from those of x' up to k."""
    return float(links.damping[a] * x_rate[k])


@step_kernel
def link_force(a: int, links: Any, x: float, x_rate: float, z: float) -> float:
    """``F = k x + f + c x' + Q z`` of link a (N); `links` are its `stiffness`, `preload`, too."""
    elastic = links.stiffness[a] * x + links.preload[a]
    return float(elastic + drag(a, links, x_rate) + pull_per_z(a, links.memory) * z)


@step_kernel
def link_force_rate(a: int, links: Any, x_rate: float, x_second: float, z_rate: float) -> float:
    """Rate of F (N/s) from those of x, and of x' and z."""
    elastic = links.stiffness[a] * x_rate
    viscous = drag_slope(a, links, x_rate) * x_second
    return float(elastic + viscous + pull_per_z(a, links.memory) * z_rate)


@step_kernel
def link_coefficient(a: int, k: int, links: Any, x: float, x_rate: Floats, z: float) -> float:
    """Taylor coefficient k of F from those of x and z, and those of x' up to k."""
    elastic = links.stiffness[a] * x + (links.preload[a] if k == 0 else 0.0)
    return float(elastic + drag_coefficient(a, k, links, x_rate) + pull_per_z(a, links.memory) * z)


@step_kernel
def memory_stiffness(a: int, memory: Floats) -> float:
    """What memory adds to the stiffness of link a at z = 0 (N/m)."""
    return float(memory[a, STRENGTH] / memory[a, YIELD])


@step_kernel
def contact_code(a: int, memory: Floats) -> int:
    """Code of link a, where it is a contact element, else not negative."""
    return int(memory[a, KIND])


@step_kernel
def number_beside(a: int, memory: Floats) -> int:
    """The link whose internal variable the rate of that of link a depends on, too; or a itself."""
    return int(memory[a, BESIDE])


@step_kernel
def z_rate(
    a: int, memory: Floats, x_rate: float, direction: float, z: float, beside: float
) -> float:
    """Rate of the internal variable of link a (1/s) at the elongation rate `x_rate` (m/s).

    The sign σ is that of `direction`: x' itself, or what it was before a reversal. `beside` is the
    variable of `number_beside`. In Python x', σ and the variables may be arrays.
    """
    if memory[a, KIND] == YIELDING_SOIL:
        slope = (1.0 + z) * (1.0 + z)
    elif memory[a, KIND] == ITS_ENERGY:
        slope = beside
    else:
        # Which sign a z of zero has makes no difference: |z|^n is zero there.
        same_sign = (direction > 0.0) == (z > 0.0)
        kappa = memory[a, BETA] + memory[a, GAMMA] * (2.0 * same_sign - 1.0)
        power = abs(z) ** memory[a, EXPONENT]
        if memory[a, KIND] == DEGRADING:
            worn = 1.0 + memory[a, DELTA_NU] * beside
            slope = (1.0 - kappa * worn * power) / (1.0 + memory[a, DELTA_ETA] * beside)
        else:
            slope = 1.0 - kappa * power
    rate: float = x_rate / memory[a, YIELD] * slope
    return rate


@step_kernel
def z_slopes(a: int, memory: Floats, x_rate: float, z: float, beside: float) -> tuple[float, float]:
    """Derivatives of `z_rate` by the elongation rate (1/m) and by z (1/s)."""
    if memory[a, KIND] == YIELDING_SOIL:
        left = 1.0 + z
        return left * left / memory[a, YIELD], 2.0 * left * x_rate / memory[a, YIELD]
    if memory[a, KIND] == ITS_ENERGY:
        return beside / memory[a, YIELD], 0.0
    n, kappa = memory[a, EXPONENT], memory[a, BETA] - memory[a, GAMMA]
    if (x_rate > 0.0) == (z > 0.0):
        kappa = memory[a, BETA] + memory[a, GAMMA]
    yields = memory[a, YIELD]
    if memory[a, KIND] == DEGRADING:
        kappa *= 1.0 + memory[a, DELTA_NU] * beside
        yields *= 1.0 + memory[a, DELTA_ETA] * beside
    size = abs(z)
    power = size ** (n - 1.0)
    by_size = -x_rate / yields * kappa * n * power
    return (1.0 - kappa * power * size) / yields, by_size if z > 0.0 else -by_size


@step_kernel
def slope_beside(a: int, memory: Floats, x_rate: float, z: float, beside: float) -> float:
    """Derivative of `z_rate` by the variable beside (1/s), where that is not z itself."""
    if memory[a, KIND] == ITS_ENERGY:
        return float(x_rate / memory[a, YIELD])
    if memory[a, KIND] != DEGRADING:
        return 0.0
    eta = 1.0 + memory[a, DELTA_ETA] * beside
    here = z_rate(a, memory, x_rate, x_rate, z, beside)
    # By the quotient rule: of η z' the variable beside changes only the part that ν multiplies.
    fresh = z_rate(a, memory, x_rate, x_rate, z, 0.0)
    weaker = (fresh - x_rate / memory[a, YIELD]) * memory[a, DELTA_NU]
    return float((weaker - here * memory[a, DELTA_ETA]) / eta)


@step_kernel
def _knee_worn(a: int, memory: Floats, beside: float) -> float:
    """ν/η, by which what is nonlinear in the rate of z is larger than at first."""
    if memory[a, KIND] != DEGRADING:
        return 1.0
    return float((1.0 + memory[a, DELTA_NU] * beside) / (1.0 + memory[a, DELTA_ETA] * beside))


@step_kernel
def _has_one_formula(a: int, memory: Floats) -> bool:
    """Whether dz/dx of link a takes no power of z, as on each branch of a law that has branches."""
    return bool(memory[a, BETA] == memory[a, GAMMA] == 0.0)


@step_kernel
def z_bend(a: int, memory: Floats, z: float, beside: float, travel: float) -> float:
    """By how much z departs from a line over a `travel` of the elongation (m), at most."""
    if _has_one_formula(a, memory):
        return 0.0
    linear = travel / memory[a, YIELD]
    return float(linear * (abs(z) + linear) ** memory[a, EXPONENT] * _knee_worn(a, memory, beside))


@step_kernel
def reversal_jump(a: int, memory: Floats, z: float, beside: float) -> float:
    """By how much dz/dx jumps where the elongation of link a reverses (1/m), z >= 0."""
    jump = 2.0 * abs(memory[a, GAMMA]) * z ** memory[a, EXPONENT] / memory[a, YIELD]
    return float(jump * _knee_worn(a, memory, beside))


@step_kernel
def bends_at_zero(a: int, memory: Floats) -> bool:
    """Whether the rate of z of link a has another formula on the other side of z = 0."""
    return bool(memory[a, GAMMA] != 0.0)


@step_kernel
def has_branches(a: int, memory: Floats) -> bool:
    """Whether the law of link a has branches of its own, beside an elastic part without a kink."""
    return bool(memory[a, KIND] == BACKFILL or memory[a, KIND] == SLIDER)


@step_kernel
def slides(a: int, memory: Floats) -> bool:
    """Whether link a is a slider, whose branches end where its slip does."""
    return bool(memory[a, KIND] == SLIDER)


@kernel
def memory_on_branches(memory: Floats, branch: Ints) -> Floats:
    """Constants of links (L, ·) on their present branches (L,); the same array where none has."""
    found, any_changed = memory, False
    for a in range(branch.size):
        if slides(a, memory) and branch[a] < 0:
            found, any_changed = found if any_changed else memory.copy(), True
            # z of a slider is one, so Q has the sign of its slip.
            found[a, STRENGTH] = -memory[a, STRENGTH]
        elif memory[a, KIND] == BACKFILL and branch[a] != CLOSED:
            if not any_changed:
                found, any_changed = memory.copy(), True
            if branch[a] == YIELDING:
                found[a, KIND] = YIELDING_SOIL
            else:
                # Apart there is no force, but z goes on with x: it tells where both meet.
                found[a, STRENGTH] = 0.0
    return found


@step_kernel
def _knee(a: int, memory: Floats, offset: float, x: float, z: float) -> float:
    """How far inside link a is from where it left the backbone to where it comes apart (m).

    With ``ζ = p/u_y`` of the plastic depth p it left at ``η² = ζ (1 + η)``, and pressed with
    ``Q η/(1 + η)``.
    """
    zeta = max((offset - x) / memory[a, YIELD] + z, 0.0)
    eta = 0.5 * (zeta + np.sqrt(zeta * (zeta + 4.0)))
    return float(memory[a, YIELD] * eta / (1.0 + eta))


@scalar_kernel
def branch_ends(
    a: int, memory: Floats, branch: int, offset: float, x: float, z: float
) -> tuple[float, float]:
    """Elongations (m) between which link a stays on a branch, and is now, at x (m) and z.

    That of YIELDING ends where x' rises above zero: then they are of x'. So are those of a slip.
    """
    if slides(a, memory):
        return (0.0, np.inf) if branch > 0 else (-np.inf, 0.0)
    # Where z is zero. On both elastic branches z' = x'/u_y, so it stays the same along them.
    apart = x - memory[a, YIELD] * z
    if branch == YIELDING:
        return -np.inf, 0.0
    # An end that rounding has put beyond x is x itself: a link is on its branch.
    if branch == APART:
        return min(apart, x), np.inf
    return min(apart - _knee(a, memory, offset, x, z), x), max(apart, x)


@scalar_kernel
def next_branch(
    a: int, memory: Floats, branch: int, offset: float, x: float, z: float, noise: float
) -> int:
    """The branch of link a where one has ended, at x (m) and z; lengths below `noise` are none."""
    if slides(a, memory):
        # What follows a slip the accelerations decide.
        return branch
    if not has_branches(a, memory):
        # The two sides of an elastic kink are 1 and -1.
        return -branch
    knee, pressed = _knee(a, memory, offset, x, z), -z * memory[a, YIELD]
    # What was never pushed in has no elastic part on which it could close.
    if branch == APART:
        return CLOSED if knee > noise else YIELDING
    # Of both lengths z tells whether there is a force: that of the backbone may err beside it.
    if branch == YIELDING:
        return CLOSED if pressed > noise else APART
    # It has come to one of two ends, z = 0 and the knee, and stands nearer to that one.
    return APART if pressed <= max(0.5 * knee, noise) else YIELDING


@scalar_kernel
def branch_within(
    a: int, memory: Floats, offset: float, x: float, x_rate: float, z: float, noise: float
) -> int:
    """The branch of link a inside the backbone that it left, at x (m) and z; 0 where it is on it.

    On it, or where it was never pushed in, the motion decides. That of a slider is the sign of x'.
    """
    if slides(a, memory):
        return -1 if x_rate < 0.0 else 1
    knee = 0.0
    if memory[a, KIND] == BACKFILL:
        knee = _knee(a, memory, offset, x, z)
    if knee <= noise or -z * memory[a, YIELD] > knee - noise:
        return 0
    return APART if z >= 0.0 else CLOSED


@step_kernel
def _convolution(k: int, first: Floats, second: Floats) -> float:
    """Coefficient k of a product."""
    found = 0.0
    for j in range(k + 1):
        found += first[j] * second[k - j]
    return found


@kernel
def z_coefficient(
    a: int,
    k: int,
    memory: Floats,
    x_rate: Floats,
    z: Floats,
    beside: Floats,
    power: Floats,
    sigma: float,
) -> float:
    """Taylor coefficient k of z', from those of x', z and the variable beside up to k.

    `sigma` is the sign of x' just after the start. `power` is brought up to k: coefficients of
    |z|^n, or of -z (2 + z) of soil that yields.
    """
    sign_z = sign_after(z, k + 1, NO_Z)
    if sign_z == 0.0:
        # z that starts from zero grows the way x' goes, so z x' > 0.
        sign_z = sigma
    kappa = memory[a, BETA] + memory[a, GAMMA] * sigma * sign_z
    if memory[a, KIND] == ITS_ENERGY:
        return _convolution(k, x_rate, beside) / memory[a, YIELD]
    if memory[a, KIND] == YIELDING_SOIL:
        # (1 + z)² = 1 - P with P = -z (2 + z): the form of eq. 3 with κ = 1.
        kappa, power[k] = 1.0, -2.0 * z[k]
        for j in range(k + 1):
            power[k] -= z[j] * z[k - j]
    elif _has_one_formula(a, memory):
        # Of a small z a power, though it does not count, may be too large for a double.
        return float(x_rate[k] / memory[a, YIELD])
    else:
        power[k] = power_coefficient(z, power, memory[a, EXPONENT], k)
    product = _convolution(k, x_rate, power)
    if memory[a, KIND] != DEGRADING:
        return float((x_rate[k] - kappa * product) / memory[a, YIELD])
    for j in range(k + 1):
        # ν κ P = (1 + δ_ν ε) κ P, a product of two series more.
        product += memory[a, DELTA_NU] * beside[j] * _convolution(k - j, x_rate, power)
    rate = (x_rate[k] - kappa * product) / memory[a, YIELD]
    for j in range(1, k + 1):
        # η z' is known, so z'_k is what the terms of η z' with ε_1, ε_2 ... leave, over η_0.
        rate -= memory[a, DELTA_ETA] * beside[j] * (k - j + 1) * z[k - j + 1]
    return float(rate / (1.0 + memory[a, DELTA_ETA] * beside[0]))


@step_kernel.but(fused=True)
def begin_curve(
    a: int, memory: Floats, sign: float, z: float, power: Floats, curve: Floats
) -> None:
    """Make `next_z` ready for link a at z, not zero; `sign` is that of z x'."""
    n = memory[a, EXPONENT]
    power[0] = integer_power(abs(z), n)
    curve[OVER_UY], curve[OVER_Z] = 1.0 / memory[a, YIELD], 1.0 / z
    curve[LIFT] = n * power[0] * curve[OVER_Z]
    curve[KAPPA] = memory[a, BETA] + sign * memory[a, GAMMA]
    curve[WEIGHT] = n + 1.0


@step_kernel.but(fused=True)
def next_z(
    k: int, x: float, z: Floats, power: Floats, speed: Floats, weighted: Floats, curve: Floats
) -> float:
    """Coefficient k of z where z_0 is not zero, `x` that of the elongation; those before stand.

    ``k z_k = s_{k-1} - κ Σ s_i P_{k-1-i}`` with ``s = x'/u_y``, and of P, from ``n z' P = z P'``,
    ``z_0 m P_m = Σ ((n + 1) i - m) z_i P_{m-i}``. What came last is waited for, so its terms
    are added last, and each sum is made in two halves. The rate of x/u_y goes to `speed`,
    ``(n + 1) k z_k`` to `weighted`.
    """
    m = k - 1
    kappa, first = curve[KAPPA], speed[0]
    latest = k * curve[OVER_UY] * x
    speed[m] = latest
    if m == 0:
        value = latest * (1.0 - kappa * power[0])
    else:
        low, high, flow, later = 0.0, 0.0, 0.0, 0.0
        if m % 2 == 0:
            i = m // 2
            low = speed[i] * power[i]
            flow = (weighted[i] - m * z[i]) * power[i]
        i = (m - 1) // 2
        # Where the compiler sees no sign, each index costs as much as the sum that it serves.
        j = max(m - i, 0)
        while i > 0:
            low += speed[i] * power[j]
            high += speed[j] * power[i]
            flow += (weighted[i] - m * z[i]) * power[j]
            later += (weighted[j] - m * z[j]) * power[i]
            i -= 1
            j += 1
        power[m] = (flow + later) * (curve[OVER_Z] * INVERSE[m]) + curve[LIFT] * z[m]
        product = latest * power[0] + (low + high)
        value = ((latest - kappa * product) - kappa * first * power[m]) * INVERSE[k]
    z[k], weighted[k] = value, curve[WEIGHT] * k * value
    return float(value)
