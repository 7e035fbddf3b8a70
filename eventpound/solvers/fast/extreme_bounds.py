"""Whether a step of `sample_steps` can have an extreme inside that is larger than those so far.

It has none where a quantity stays within its extremes or goes one way, both by the bounds of
`eventpound.solvers.fast.sample_bounds`.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.event_bounds import Running
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.exact_step import (
    ACCELERATION,
    BEND,
    JERK,
    NEXT_ACCELERATION,
    NEXT_JERK,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    NEXT_X_RATE,
    SAG,
    X_RATE,
    SampleTables,
    X,
)
from eventpound.solvers.fast.run import Plan, Run
from eventpound.solvers.fast.sample_bounds import goes_one_way, of_pair, pair_goes_one_way
from eventpound.solvers.fast.sample_forces import base_shear


@compiled
def _covered(k: int, now: float, then: float, spread: float, running: Running) -> bool:
    """Whether a quantity that strays by `spread` from a line stays within its extremes."""
    same = running.rounding[k]
    return (
        max(now, then) + spread <= running.maximum[k] + same
        and min(now, then) - spread >= running.minimum[k] - same
    )


@compiled
def places_unseen(h: float, tables: SampleTables, run: Run) -> bool:
    """Whether displacements, elongations and gaps cannot exceed their extremes inside the step.

    What is joined to the ground turns with its body.
    """
    plan, state, running = run.plan, run.state, run.running
    bodies, along, links = tables.bodies, tables.along, plan.links
    n = state.u.size
    for b in range(n):
        v, v_1 = state.v[b], bodies[NEXT_V, b]
        if not _covered(
            b, state.u[b], bodies[NEXT_U, b], bodies[SAG, b], running
        ) and not pair_goes_one_way(h, -1, b, v, v_1, plan, tables):
            return False
    for a in range(links.springs):
        first, second = links.ends[a, 0], links.ends[a, 1]
        if first < 0 or second < 0:
            continue
        sag = of_pair(SAG, first, second, tables)
        if not _covered(
            n + a, along[X, a], along[NEXT_X, a], sag, running
        ) and not pair_goes_one_way(
            h, first, second, along[X_RATE, a], along[NEXT_X_RATE, a], plan, tables
        ):
            return False
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        if left < 0 or right < 0:
            continue
        sag = of_pair(SAG, left, right, tables)
        gap = contacts.gap[j] + state.u[right] - state.u[left]
        gap_1 = contacts.gap[j] + bodies[NEXT_U, right] - bodies[NEXT_U, left]
        if _covered(n + links.springs + j, gap, gap_1, sag, running):
            continue
        rate = state.v[right] - state.v[left]
        rate_1 = bodies[NEXT_V, right] - bodies[NEXT_V, left]
        if not pair_goes_one_way(h, left, right, rate, rate_1, plan, tables):
            return False
    return True


@compiled
def forces_covered(plan: Plan, tables: SampleTables, running: Running) -> bool:
    """Whether absolute accelerations and base shear stay within their extremes.

    The base shear strays from a straight line by no more than the accelerations of the
    bodies, times their masses, do.
    """
    mass, bodies = plan.mass, tables.bodies
    n = mass.size
    first, spread, covered = n + plan.links.springs + plan.contacts.gap.size, 0.0, True
    for b in range(n):
        spread += mass[b] * bodies[BEND, b]
        covered = covered and _covered(
            first + b,
            bodies[ACCELERATION, b],
            bodies[NEXT_ACCELERATION, b],
            bodies[BEND, b],
            running,
        )
    shear = base_shear(n, ACCELERATION, mass, tables)
    next_shear = base_shear(n, NEXT_ACCELERATION, mass, tables)
    return covered and _covered(first + n, shear, next_shear, spread, running)


@compiled
def forces_go_one_way(h: float, mass: Floats, tables: SampleTables) -> bool:
    """Whether all absolute accelerations, and the base shear they make, go one way.

    Their rates at both ends stand in the rows JERK and NEXT_JERK.
    """
    bodies = tables.bodies
    shear, next_shear, shear_change = 0.0, 0.0, 0.0
    for b in range(mass.size):
        change = 8.0 * bodies[BEND, b] / h
        if not goes_one_way(bodies[JERK, b], bodies[NEXT_JERK, b], change):
            return False
        shear += mass[b] * bodies[JERK, b]
        next_shear += mass[b] * bodies[NEXT_JERK, b]
        shear_change += mass[b] * change
    return goes_one_way(shear, next_shear, shear_change)
