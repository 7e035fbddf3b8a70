"""Elongations of links, and the parts of a backbone.

With ``y = σ z / b = Φ(ξ)`` (`eventpound.mechanics.backbone`), to within a small
difference that the tolerance allows:

    part        ξ                    law             left at
    CORE        -core ... core       z linear in x   either end (the lower: turned)
    UNLOADING   down ... -core       z linear in x   reversal, ξ = core
    DOWN        below down           1 - ρ |y|^n     reversal, ξ = down
    UP          above core           1 - y^n         reversal
    SATURATED   above saturated      z constant      reversal

A reversal turns y into -y on the curve for the other direction. In the core
both directions are the same line, so a link that only swings there costs no event.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.backbone import Hysteresis, backbone, backbone_inverse
from eventpound.mechanics.elements import memory_stiffness, pull_per_z
from eventpound.mechanics.observables import difference, gap_rounding
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.run import Contacts, FastObserved, FastPlan, FastRun, FastState, Links


@compiled
def elongations(ends: Ints, u: Floats, v: Floats, x: Floats, x_rate: Floats) -> None:
    """Elongations of all links (m) and their rates (m/s), into `x` and `x_rate` (L,)."""
    for a in range(ends.shape[0]):
        x[a], x_rate[a] = elongation(ends[a, 0], ends[a, 1], u, v)


@compiled
def elongation(first: int, second: int, u: Floats, v: Floats) -> tuple[float, float]:
    """Elongation of a link between two bodies (m) and its rate (m/s)."""
    return difference(u, first, second), difference(v, first, second)


@compiled
def gap_of(j: int, contacts: Contacts, u: Floats, v: Floats) -> tuple[float, float]:
    """Gap of a contact (m) and its rate (m/s)."""
    left, right = contacts.left[j], contacts.right[j]
    gap, rate = contacts.gap[j], 0.0
    if right >= 0:
        gap, rate = gap + u[right], v[right]
    if left >= 0:
        gap, rate = gap - u[left], rate - v[left]
    return gap, rate


@compiled
def open_gaps(plan: FastPlan, state: FastState) -> None:
    """Gaps and their rates at the start of a run."""
    contacts = plan.contacts
    rounding = gap_rounding(contacts.gap, state.u, plan.limits.length)
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        opened, state.gap_rate[j] = elongation(left, right, state.u, state.v)
        gap = contacts.gap[j] + opened
        # A gap of rounding would close with an impact, or penetrate.
        state.gap[j] = 0.0 if abs(gap) <= rounding else gap


CORE, UNLOADING, DOWN, UP, SATURATED = 0, 1, 2, 3, 4


@compiled
def xi_at(h: int, x: float, hysteresis: Hysteresis, state: FastState) -> float:
    """ξ of a hysteretic link at the elongation x (m)."""
    return state.xi_r[h] + state.sigma[h] * (x - state.x_r[h]) / hysteresis.scale[h]


@compiled
def hysteretic_variable(h: int, x: float, hysteresis: Hysteresis, state: FastState) -> float:
    """Z of a hysteretic link at the elongation x (m), reached without reversal."""
    xi = xi_at(h, x, hysteresis, state)
    y = on_part(state.part[h], xi, hysteresis.tables, hysteresis.at[h])
    return state.sigma[h] * hysteresis.bound[h] * y


@compiled
def on_part(part: int, xi: float, tables: Floats, at: int) -> float:
    """Φ(ξ) on a part of the backbone whose table begins at a place."""
    if part == SATURATED:
        return 1.0
    return xi if part <= UNLOADING else backbone(tables, at, xi)


@compiled
def with_drag(a: int, force: float, x_rate: float, links: Links) -> float:
    """A force of link a (N) and what x' adds to it."""
    return force + links.law.damping[a] * x_rate


@compiled
def link_force(a: int, x: float, x_rate: float, run: FastRun) -> tuple[float, float, float]:
    """Force of a link (N) without the dashpot beside it and with it, and its z, 0 for none.

    At the elongation x (m) and its rate (m/s).
    """
    links, z = run.plan.links, 0.0
    k = links.compression[a] if run.state.branch[a] < 0 else links.extension[a]
    force = k * (x - links.offset[a])
    h = links.z_of_link[a]
    if h >= 0:
        z = hysteretic_variable(h, x, run.plan.hysteresis, run.state)
        force += pull_per_z(a, run.series.memory) * z
    return force, with_drag(a, force, x_rate, links), z


@compiled
def add_pull(a: int, force: float, links: Links, observed: FastObserved) -> None:
    """Add what a force (N) of link a puts on its ends, and on the ground, to `observed`."""
    first, second = links.ends[a, 0], links.ends[a, 1]
    if first >= 0:
        observed.body_force[first] += force
    if second >= 0:
        observed.body_force[second] -= force
    observed.base[1] += links.on_ground[a] * force


@compiled
def tangent(a: int, links: Links, state: FastState) -> float:
    """Stiffness of a link (N/m), on a curved part of its backbone without its z."""
    k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
    h = links.z_of_link[a]
    # On a curve z has a series of its own, and beyond it stands still.
    if h >= 0 and state.part[h] <= UNLOADING:
        k += memory_stiffness(a, links.law.memory)
    return float(k)


@compiled
def saturate(x: Floats, hysteresis: Hysteresis, state: FastState) -> None:
    """Put links that have reached saturation there, from the elongations x (L,) of all (m)."""
    for h in range(hysteresis.link.size):
        if state.part[h] != UP:
            continue
        # No event: Φ is one from there on to within what does not count.
        if xi_at(h, x[hysteresis.link[h]], hysteresis, state) >= hysteresis.saturated[h]:
            state.part[h] = SATURATED


@compiled
def part_at(xi: float, core: float, down: float, saturated: float) -> int:
    """Part of a backbone with such borders that ξ lies on."""
    if xi >= saturated:
        return SATURATED
    if xi > core:
        return UP
    if xi >= -core:
        return CORE
    return UNLOADING if xi >= down else DOWN


@compiled_noinline
def set_curve(
    h: int, x: float, sigma: float, y: float, hysteresis: Hysteresis, state: FastState
) -> None:
    """Put a link on the curve of direction σ at the elongation x (m) and ``σ z / b = y``."""
    # Beyond one y is so by rounding only.
    xi = backbone_inverse(hysteresis.tables, hysteresis.at[h], min(max(y, -1.0), 1.0))
    state.sigma[h] = sigma
    state.x_r[h] = x
    state.xi_r[h] = xi
    state.part[h] = part_at(xi, hysteresis.core[h], hysteresis.down[h], hysteresis.saturated[h])


@compiled
def turns_back(part: int, sigma: float, rate: float, still: float) -> bool:
    """Whether a link seen along σ goes the other way now; `still` (m/s) has no direction.

    On the line about its origin it has none.
    """
    return part != CORE and sigma * rate < -still


@compiled_noinline
def reverse(h: int, x: float, hysteresis: Hysteresis, state: FastState) -> None:
    """Turn a link round at the elongation x (m)."""
    sigma = state.sigma[h]
    y = sigma * hysteretic_variable(h, x, hysteresis, state) / hysteresis.bound[h]
    # z stays, so σ z / b changes its sign with σ.
    set_curve(h, x, -sigma, -y, hysteresis, state)


@compiled
def across_border(part: int, xi: float, core: float, down: float) -> tuple[float, float, int]:
    """What follows a part left at ξ: -1 where σ changes, ξ to count from or inf, the next part."""
    if part == CORE and xi < 0.0:
        # The lower end of the core is its upper one on the curve of the other direction.
        return -1.0, core, UP
    if part == DOWN:
        # From here on ξ counts from the border exactly, without the rounding of the way there.
        return 1.0, down, UNLOADING if down < -core else CORE
    return 1.0, np.inf, UP if part <= UNLOADING else part


@compiled_noinline
def cross_border(h: int, x: float, hysteresis: Hysteresis, state: FastState) -> None:
    """Move a link that has reached the border of its part to the next."""
    xi = xi_at(h, x, hysteresis, state)
    side, begin, part = across_border(state.part[h], xi, hysteresis.core[h], hysteresis.down[h])
    state.part[h] = part
    state.sigma[h] *= side
    if begin < np.inf:
        state.xi_r[h], state.x_r[h] = begin, x


@compiled_deferred
def all_variables(x: Floats, hysteresis: Hysteresis, state: FastState, out: Floats) -> None:
    """Every z at the elongations x (L,) of the links, into `out` (H,)."""
    for h in range(out.size):
        out[h] = hysteretic_variable(h, x[hysteresis.link[h]], hysteresis, state)
