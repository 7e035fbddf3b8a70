"""Contacts with a law in the Taylor stepper: their forces, and the series of these.

Their elements are the last P links (`eventpound.mechanics.model.with_elements`), and their
closing and opening are kinks. While one is closed, with d = -g,

    F_k = K E_k + C Σ_j D_j (k - j + 1) d_{k-j+1},

E and D powers of d (`eventpound.mechanics.contact_laws`), whose coefficients follow from those of
d as long as d > 0. At d = 0 the force is no power series in time: there, and as far as the defect
of the step allows, all but its value is left out of the series, and the steps that follow grow
with the distance from the closing. Where the bodies part they shrink towards the opening.
"""

from __future__ import annotations

from eventpound.mechanics.contact_elements import CUT, FIRST_CODE, SMOOTH_CODES
from eventpound.mechanics.contact_laws import element_exponents, element_pull
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events import noise
from eventpound.solvers.events.law_contacts import DRAG, WAY
from eventpound.solvers.fast.compiled import compiled, compiled_deferred
from eventpound.solvers.fast.elongation import elongation
from eventpound.solvers.fast.run import Links, Run, Series, State

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
