"""Whether anything happens to linear bodies within an exact step (`sample_steps`).

With the largest acceleration A in a step of length dt,

* a quantity strays from the straight line between its values at both ends by no more
  than ``A dt²/8``, which bounds gaps, distances to kinks and borders of the backbone;
* one whose rates at both ends have one sign and are together larger than ``A dt``
  goes one way, so it has no extreme but at the ends.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast.backbone_parts import CORE, SATURATED, place
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import Plan, State
from eventpound.solvers.fast.sample_tables import (
    ACCELERATION,
    BEND,
    FASTEST,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    NEXT_X_RATE,
    PULLED,
    SAG,
    X_RATE,
    SampleTables,
    X,
)
from eventpound.solvers.fast.seen import OWN_GAP


@compiled
def _of_pair(row: int, first: int, second: int, tables: SampleTables) -> float:
    """Bound for the distance of two bodies, the ground among them, from those of each."""
    total = 0.0
    if first >= 0:
        total = tables.bodies[row, first]
    if second >= 0:
        total += tables.bodies[row, second]
    return total


@compiled
def _goes_one_way(rate: float, next_rate: float, change: float) -> bool:
    """Whether a rate that changes by no more than `change` all in all keeps its sign."""
    return rate * next_rate > 0.0 and abs(rate) + abs(next_rate) > change


@compiled
def stays_open(plan: Plan, state: State, tables: SampleTables) -> bool:
    """Whether every gap stays one that is a difference of displacements."""
    contacts, bodies = plan.contacts, tables.bodies
    least = OWN_GAP * plan.limits.length
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        now, then = contacts.gap[j], contacts.gap[j]
        if right >= 0:
            now, then = now + state.u[right], then + bodies[NEXT_U, right]
        if left >= 0:
            now, then = now - state.u[left], then - bodies[NEXT_U, left]
        if not min(now, then) - _of_pair(SAG, left, right, tables) >= least:
            return False
    return True


@compiled
def stays_linear(dt: float, plan: Plan, state: State, tables: SampleTables) -> bool:
    """Whether every link keeps its branch and its part; elongations at the end stand then."""
    links, hysteresis = plan.links, plan.hysteresis
    bodies, along = tables.bodies, tables.along
    for a in range(links.offset.size):
        first, second = links.ends[a, 0], links.ends[a, 1]
        x_1, rate_1 = 0.0, 0.0
        if second >= 0:
            x_1, rate_1 = bodies[NEXT_U, second], bodies[NEXT_V, second]
        if first >= 0:
            x_1, rate_1 = x_1 - bodies[NEXT_U, first], rate_1 - bodies[NEXT_V, first]
        x, rate = along[X, a], along[X_RATE, a]
        along[NEXT_X, a], along[NEXT_X_RATE, a] = x_1, rate_1
        h = links.z_of_link[a]
        if h < 0 and state.branch[a] == 0:
            continue
        sag = _of_pair(SAG, first, second, tables)
        if state.branch[a] != 0:
            side = float(state.branch[a])
            away = min(side * (x - links.offset[a]), side * (x_1 - links.offset[a]))
            if not away > sag:
                return False
        if h >= 0:
            one_way = _goes_one_way(rate, rate_1, dt * _of_pair(FASTEST, first, second, tables))
            part = state.part[h]
            if part != CORE and not (one_way and state.sigma[h] * rate > 0.0):
                return False
            if part == SATURATED:
                continue
            high = low = place(h, x_1, hysteresis, state)
            if not one_way:
                at, beyond = place(h, x, hysteresis, state), sag / hysteresis.scale[h]
                high, low = max(at, high) + beyond, min(at, low) - beyond
            core = hysteresis.core[h]
            if not high <= core or (part == CORE and not low >= -core):
                return False
    return True


@compiled
def _covered(k: int, now: float, then: float, spread: float, running: Running) -> bool:
    """Whether a quantity that strays by `spread` from a line stays within its extremes."""
    same = running.rounding[k]
    return (
        max(now, then) + spread <= running.maximum[k] + same
        and min(now, then) - spread >= running.minimum[k] - same
    )


@compiled
def places_unseen(
    dt: float, plan: Plan, state: State, tables: SampleTables, running: Running
) -> bool:
    """Whether displacements, elongations and gaps cannot exceed their extremes inside the step.

    What is joined to the ground turns with its body.
    """
    bodies, along, links = tables.bodies, tables.along, plan.links
    n = state.u.size
    for b in range(n):
        v, v_1 = state.v[b], bodies[NEXT_V, b]
        if not _goes_one_way(v, v_1, dt * bodies[FASTEST, b]) and not _covered(
            b, state.u[b], bodies[NEXT_U, b], bodies[SAG, b], running
        ):
            return False
    for a in range(links.springs):
        first, second = links.ends[a, 0], links.ends[a, 1]
        if first < 0 or second < 0:
            continue
        fastest = dt * _of_pair(FASTEST, first, second, tables)
        sag = _of_pair(SAG, first, second, tables)
        if not _goes_one_way(along[X_RATE, a], along[NEXT_X_RATE, a], fastest) and not _covered(
            n + a, along[X, a], along[NEXT_X, a], sag, running
        ):
            return False
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        if left < 0 or right < 0:
            continue
        fastest = dt * _of_pair(FASTEST, left, right, tables)
        sag = _of_pair(SAG, left, right, tables)
        rate, rate_1 = (
            state.v[right] - state.v[left],
            bodies[NEXT_V, right] - bodies[NEXT_V, left],
        )
        if _goes_one_way(rate, rate_1, fastest):
            continue
        gap = contacts.gap[j] + state.u[right] - state.u[left]
        gap_1 = contacts.gap[j] + bodies[NEXT_U, right] - bodies[NEXT_U, left]
        if not _covered(n + links.springs + j, gap, gap_1, sag, running):
            return False
    return True


@compiled
def forces_unseen(
    i: int,
    dt: float,
    g: float,
    shear: float,
    next_shear: float,
    plan: Plan,
    state: State,
    tables: SampleTables,
    running: Running,
) -> bool:
    """The same for absolute accelerations and base shear.

    `g` is the acceleration of the ground at the end (m/s²), `shear` the base shear at the
    start (N). ``A'' = -K a - C a'``, where dt |a'| is part of the bound of |a|.
    """
    mass, bodies = plan.mass, tables.bodies
    n = mass.size
    place_of_first = n + plan.links.springs + plan.contacts.gap.size
    over, spread, covered = 1.0 / dt, 0.0, True
    for b in range(n):
        bend = 0.0
        for c in range(n):
            fastest = bodies[FASTEST, c]
            jerk = (fastest - abs(bodies[PULLED, c])) * over
            bend += abs(tables.stiffness[i, b, c]) * fastest
            bend += abs(tables.damping[i, b, c]) * jerk
        bodies[BEND, b] = 0.125 * dt * dt * bend
        spread += mass[b] * bodies[BEND, b]
        covered = covered and _covered(
            place_of_first + b,
            bodies[ACCELERATION, b],
            bodies[NEXT_ACCELERATION, b],
            bodies[BEND, b],
            running,
        )
    covered = covered and _covered(place_of_first + n, shear, next_shear, spread, running)
    return covered or _forces_one_way(i, dt, g, mass, state.v, tables)


@compiled_apart
def _forces_one_way(
    i: int, dt: float, g: float, mass: Floats, v: Floats, tables: SampleTables
) -> bool:
    """Whether all absolute accelerations, and the base shear they make, go one way."""
    bodies, n = tables.bodies, mass.size
    shear, next_shear, shear_change = 0.0, 0.0, 0.0
    for b in range(n):
        rate, next_rate = 0.0, 0.0
        for c in range(n):
            K, C = tables.stiffness[i, b, c], tables.damping[i, b, c]
            rate -= K * v[c] + C * bodies[PULLED, c]
            next_rate -= K * bodies[NEXT_V, c] + C * (bodies[NEXT_ACCELERATION, c] - g)
        change = 8.0 * bodies[BEND, b] / dt
        if not _goes_one_way(rate, next_rate, change):
            return False
        shear += mass[b] * rate
        next_shear += mass[b] * next_rate
        shear_change += mass[b] * change
    return _goes_one_way(shear, next_shear, shear_change)
