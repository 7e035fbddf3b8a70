"""Elongations of links, the parts of a backbone, and the forces of contacts with a law.

*Hysteretic links.* With ``y = σ z / b = Φ(ξ)`` (`eventpound.mechanics.backbone`), to within a small
difference that the tolerance allows:

    part        ξ                    law             left at
    CORE        -core ... core       z linear in x   either end (the lower: turned)
    UNLOADING   down ... -core       z linear in x   reversal, ξ = core
    DOWN        below down           1 - ρ |y|^n     reversal, ξ = down
    UP          above core           1 - y^n         reversal
    SATURATED   above saturated      z constant      reversal

A reversal turns y into -y on the curve for the other direction. In the core
both directions are the same line, so a link that only swings there costs no event.

*Contacts with a law.* Their elements are the last P links
(`eventpound.mechanics.model.with_elements`), and their closing and opening are kinks. While one is
closed, with d = -g,

    F_k = K E_k + C Σ_j D_j (k - j + 1) d_{k-j+1},

E and D powers of d (`eventpound.mechanics.contact_laws`), whose coefficients follow from those of
d as long as d > 0. At d = 0 the force is no power series in time: there, and as far as the defect
of the step allows, all but its value is left out of the series, and the steps that follow grow
with the distance from the closing. Where the bodies part they shrink towards the opening.
"""

from __future__ import annotations

from eventpound.mechanics.backbone import backbone, backbone_inverse
from eventpound.mechanics.contact_elements import CUT, FIRST_CODE, SMOOTH_CODES
from eventpound.mechanics.contact_laws import element_exponents, element_pull
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events import noise
from eventpound.solvers.events.law_contacts import DRAG, WAY
from eventpound.solvers.fast.compiled import (
    compiled,
    compiled_apart,
    compiled_deferred,
    compiled_whole,
)
from eventpound.solvers.fast.run import Contacts, Hysteresis, Links, Run, Series, State


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


CORE, UNLOADING, DOWN, UP, SATURATED = 0, 1, 2, 3, 4


@compiled
def place(h: int, x: float, hysteresis: Hysteresis, state: State) -> float:
    """ξ of a hysteretic link at the elongation x (m)."""
    return state.xi_r[h] + state.sigma[h] * (x - state.x_r[h]) / hysteresis.scale[h]


@compiled
def hysteretic_variable(h: int, x: float, hysteresis: Hysteresis, state: State) -> float:
    """Z of a hysteretic link at the elongation x (m), reached without reversal."""
    if state.part[h] == SATURATED:
        return state.sigma[h] * hysteresis.bound[h]
    xi = place(h, x, hysteresis, state)
    if state.part[h] <= UNLOADING:
        return state.sigma[h] * hysteresis.bound[h] * xi
    return state.sigma[h] * hysteresis.bound[h] * backbone(hysteresis.tables, hysteresis.at[h], xi)


@compiled
def link_force(a: int, x: float, run: Run) -> tuple[float, float]:
    """Force of a link at the elongation x (m) without its dashpot (N), and its z, 0 for none."""
    links, z = run.plan.links, 0.0
    k = links.compression[a] if run.state.branch[a] < 0 else links.extension[a]
    force = k * (x - links.offset[a])
    h = links.z_of_link[a]
    if h >= 0:
        z = hysteretic_variable(h, x, run.plan.hysteresis, run.state)
        force += links.law.strength[a] * z
    return force, z


@compiled
def saturate(x: Floats, hysteresis: Hysteresis, state: State) -> tuple[bool, bool]:
    """Put links that have reached saturation there, from the elongations x (L,) of all links (m).

    Returned is whether a link is on a curved part, and whether one was put there.
    """
    curved, changed = False, False
    for h in range(hysteresis.link.size):
        part = state.part[h]
        if part < DOWN or part > UP:
            continue
        xi = place(h, x[hysteresis.link[h]], hysteresis, state)
        if part == UP and xi >= hysteresis.saturated[h]:
            state.part[h] = SATURATED
            changed = True
        else:
            curved = True
    return curved, changed


@compiled
def part_of(h: int, xi: float, hysteresis: Hysteresis) -> int:
    """Part of the backbone that ξ lies on."""
    core = hysteresis.core[h]
    if xi >= hysteresis.saturated[h]:
        return SATURATED
    if xi > core:
        return UP
    if xi >= -core:
        return CORE
    return UNLOADING if xi >= hysteresis.down[h] else DOWN


@compiled_apart
def set_curve(
    h: int, x: float, sigma: float, y: float, hysteresis: Hysteresis, state: State
) -> None:
    """Put a link on the curve of direction σ at the elongation x (m) and ``σ z / b = y``."""
    xi = backbone_inverse(hysteresis.tables, hysteresis.at[h], min(max(y, -1.0), 1.0))
    state.sigma[h] = sigma
    state.x_r[h] = x
    state.xi_r[h] = xi
    state.part[h] = part_of(h, xi, hysteresis)


@compiled_apart
def reverse(h: int, x: float, hysteresis: Hysteresis, state: State) -> None:
    """Turn a link round at the elongation x (m)."""
    sigma = state.sigma[h]
    y = sigma * hysteretic_variable(h, x, hysteresis, state) / hysteresis.bound[h]
    set_curve(h, x, -sigma, -y, hysteresis, state)


@compiled_apart
def cross_border(h: int, x: float, hysteresis: Hysteresis, state: State) -> None:
    """Move a link that has reached the border of its part to the next."""
    part = state.part[h]
    core = hysteresis.core[h]
    xi = place(h, x, hysteresis, state)
    if part == CORE and xi < 0.0:
        state.sigma[h] = -state.sigma[h]
        state.xi_r[h], state.x_r[h], state.part[h] = core, x, UP
    elif part <= UNLOADING:
        state.part[h] = UP
    elif part == DOWN:
        state.xi_r[h], state.x_r[h] = hysteresis.down[h], x
        state.part[h] = UNLOADING if hysteresis.down[h] < -core else CORE


@compiled_whole
def all_variables(x: Floats, hysteresis: Hysteresis, state: State, out: Floats) -> None:
    """Every z at the elongations x (L,) of the links, into `out` (H,)."""
    for h in range(out.size):
        out[h] = hysteretic_variable(h, x[hysteresis.link[h]], hysteresis, state)


_CUT = int(CUT)


@compiled
def _pull(p: int, x: float, x_rate: float, run: Run) -> float:
    """Force of element p as a link (N), 0 where it is open."""
    links = run.plan.links
    a = links.plain + p
    if run.state.branch[a] >= 0:
        return 0.0
    k, touch = links.compression[a], run.plan.laws.touch
    preload, code = -k * links.offset[a], int(links.law.exponent[a])
    return element_pull(code, k, preload, touch[DRAG, p], x, x_rate, touch[WAY, p])[0]


@compiled_deferred
def law_state(run: Run) -> None:
    """Elongations, forces and tangents of the elements at the start of a step."""
    plan, state, series = run.plan, run.state, run.series
    links = plan.links
    for p in range(plan.laws.contact.size):
        a = links.plain + p
        x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], state.u, state.v)
        series.x[a], series.x_rate[a] = x, x_rate
        series.F[a, 0] = _pull(p, x, x_rate, run)
        series.drag[p], series.way[p] = plan.laws.touch[DRAG, p], plan.laws.touch[WAY, p]
        smooth = int(links.law.exponent[a]) >= SMOOTH_CODES
        series.stiffness[a] = links.compression[a] if smooth and state.branch[a] < 0 else 0.0


@compiled_deferred
def law_coefficients(k: int, links: Links, state: State, series: Series) -> None:
    """Add coefficient k of the forces of elements that are no lines to those on the clusters.

    `law_state` stands, and coefficients of the displacement up to k + 1. Of order 0 the force
    is there already.
    """
    for p in range(series.drag.size):
        a = links.plain + p
        code = int(links.law.exponent[a])
        first, second = series.ends[a, 0], series.ends[a, 1]
        if state.branch[a] >= 0 or code >= SMOOTH_CODES or first == second:
            continue
        pull = _coefficient(k, p, a, FIRST_CODE - code, links, series)
        if k > 0:
            series.F[a, k] = pull
            if first >= 0:
                series.force[first] += pull
            if second >= 0:
                series.force[second] -= pull


@compiled
def _coefficient(k: int, p: int, a: int, kind: int, links: Links, series: Series) -> float:
    """Coefficient k of the force of a closed element, as a link pulls."""
    depth, powers = series.law[p, 0], series.law[p]
    if k == 0:
        depth[0] = links.offset[a] - series.x[a]
        depth[1] = -series.x_rate[a]
    else:
        depth[k + 1] = -_relative(k + 1, a, series)
    # Where it is cut, and at its closing.
    way = series.way[p]
    nothing = kind == _CUT and (way > 0.0 if way != 0.0 else series.F[a, 0] == 0.0)
    if nothing or depth[0] <= noise.LENGTH * series.scale[0]:
        powers[1, k] = powers[2, k] = 0.0
        return 0.0
    exponents = element_exponents(kind, way < 0.0 if way != 0.0 else depth[1] > 0.0)
    for i in range(2):
        powers[1 + i, k] = _power(k, exponents[i], depth, powers[1 + i])
    pull = -links.compression[a] * powers[1, k]
    drag = series.drag[p]
    for j in range(k + 1):
        pull -= drag * powers[2, j] * (k - j + 1) * depth[k - j + 1]
    return pull


@compiled
def _relative(k: int, a: int, series: Series) -> float:
    """Coefficient k of the elongation of link a."""
    first, second = series.ends[a, 0], series.ends[a, 1]
    value = series.X[second, k] if second >= 0 else 0.0
    return value - series.X[first, k] if first >= 0 else value


@compiled
def _power(k: int, exponent: float, depth: Floats, power: Floats) -> float:
    """Coefficient k of a power of d, from ``d P' = n d' P``; 0 for an exponent below 0."""
    if exponent <= 0.0:
        return 1.0 if exponent == 0.0 and k == 0 else 0.0
    if exponent == 1.0:
        return float(depth[k])
    if k == 0:
        return float(depth[0] ** exponent)
    total = 0.0
    for j in range(1, k + 1):
        total += (exponent * j - (k - j)) * depth[j] * power[k - j]
    return float(total / (k * depth[0]))


@compiled_deferred
def pull_by_laws(run: Run) -> None:
    """Add what the elements do in what is seen to the forces on the bodies."""
    plan, seen = run.plan, run.seen
    links = plan.links
    for p in range(plan.laws.contact.size):
        a = links.plain + p
        first, second = links.ends[a, 0], links.ends[a, 1]
        x, x_rate = elongation(first, second, seen.u, seen.v)
        pull = _pull(p, x, x_rate, run)
        seen.force[a] = pull
        if first >= 0:
            seen.body_force[first] += pull
        if second >= 0:
            seen.body_force[second] -= pull


@compiled_deferred
def put_law_forces(run: Run) -> None:
    """Put the forces of the elements, which are seen, into those of the contacts."""
    plan, seen = run.plan, run.seen
    for p in range(plan.laws.contact.size):
        seen.contact_force[plan.laws.contact[p]] = -seen.force[plan.links.plain + p]
