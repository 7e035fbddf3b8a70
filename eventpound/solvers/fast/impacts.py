"""Impacts of one instant: closed gaps put on their constraints, then problem after problem.

The impact law is the compiled function of `eventpound.mechanics.impact`, the end of a
cascade that of `eventpound.solvers.events.cascade`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import close_one, join_bodies
from eventpound.mechanics.impact import impact_law, impact_of_one
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.solvers.events.cascade import (
    FADED,
    LAST_INTERVAL,
    LISTED_SPEED,
    WINDOW,
    is_endless,
    is_plastic,
)
from eventpound.solvers.events.modes import duties
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_with_arrays
from eventpound.solvers.fast.event_rows import kind_of_impact, write_event
from eventpound.solvers.fast.outcome import DONE, ENDLESS, FULL, NO_IMPACT
from eventpound.solvers.fast.plan import (
    EVENTS,
    FASTEST,
    FASTEST_HERE,
    GROUPS,
    HERE,
    IN_A_ROW,
    INTERVAL,
    LOST_HERE,
    PASSED_ON,
    SINCE_IMPACT,
    Contacts,
    Plan,
    Record,
    State,
    T,
)

NONE, SEVERAL = -1, -2
"""What `_only_closed` finds where it is not a single contact."""


@compiled
def _collapsed(time: float, clock: Floats) -> bool:
    """Whether the last interval was none, in a scene with the time `time` (s)."""
    return bool(clock[INTERVAL] <= LAST_INTERVAL * time)


@compiled
def close_collapsed(plan: Plan, state: State) -> None:
    """Where an interval was none, close every gap that is none beside it."""
    limits, clock = plan.limits, state.clock
    if not _collapsed(limits.time, clock):
        return
    none = LAST_INTERVAL * (limits.length + clock[FASTEST] * limits.time)
    for j in range(state.gap.size):
        if abs(state.gap[j]) <= none:
            state.gap[j] = 0.0


@compiled
def _only_closed(gap: Floats) -> int:
    """The only closed contact; `NONE` where there is none, `SEVERAL` where there are more."""
    found = NONE
    for j in range(gap.size):
        if gap[j] == 0.0:
            if found >= 0:
                return SEVERAL
            found = j
    return found


@compiled
def put_on_constraint(plan: Plan, state: State) -> None:
    """Make the displacements of closed contacts agree with their gaps of zero."""
    contacts = plan.contacts
    one = _only_closed(state.gap)
    if one >= 0:
        left, right = contacts.left[one], contacts.right[one]
        _close_one(left, right, contacts.gap[one], plan.mass, state.u)
    elif one == SEVERAL:
        _close_several(contacts, plan.mass, state.gap, state.u)


@compiled_with_arrays
def _close_several(contacts: Contacts, mass: Floats, gap: Floats, u: Floats) -> None:
    """Put all bodies that closed contacts join in touch, their centres of mass kept."""
    closed = gap == 0.0
    touching = join_bodies(contacts.left, contacts.right, contacts.gap, closed, closed, mass.size)
    total, moment = np.zeros(mass.size), np.zeros(mass.size)
    for b in range(mass.size):
        c = touching.of_body[b]
        if c >= 0:
            total[c] += mass[b]
            moment[c] += mass[b] * (u[b] - touching.offset[b])
    for b in range(mass.size):
        c = touching.of_body[b]
        u[b] = touching.offset[b] + (moment[c] / total[c] if c >= 0 else 0.0)


_close_one = compiled(close_one)


class Closed(NamedTuple):
    """What impacts of several contacts work on, of the groups of `eventpound.solvers.fast.plan`.

    A kernel that makes arrays takes two atomic operations for each array it is given.
    """

    mass: Floats
    contacts: Contacts
    gap: Floats
    gap_rate: Floats
    v: Floats
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples
    events: Floats
    speed: float
    time: float


@compiled
def impacts(plan: Plan, state: State, record: Record) -> int:
    """Impact problems of this instant, until no closed contact approaches."""
    one = _only_closed(state.gap)
    if one == SEVERAL:
        limits = plan.limits
        closed = Closed(
            plan.mass, plan.contacts, state.gap, state.gap_rate, state.v, state.clock,
            state.count, record.events, limits.length / limits.time, limits.time,
        )  # fmt: skip
        return _impact_problems(closed)
    if one >= 0 and state.gap_rate[one] < 0.0:
        _impact_of_one(one, plan, state, record)
    return DONE


@compiled_with_arrays
def _impact_problems(all_closed: Closed) -> int:
    contacts, gap_rate = all_closed.contacts, all_closed.gap_rate
    clock, count = all_closed.clock, all_closed.count
    closed = all_closed.gap == 0.0
    while True:
        # What the instant has seen so far outlives a pause in which the record gets more room.
        if count[EVENTS] + 3 * closed.size > all_closed.events.shape[0]:
            return FULL
        if not (duties(closed, gap_rate) == 1).any():
            return DONE
        approach = -np.min(gap_rate[closed])
        fastest = max(clock[FASTEST_HERE], approach)
        clock[FASTEST_HERE] = fastest
        if approach <= FADED * fastest:
            # A row squeezed without play: what is left is rounding of the first speeds.
            for j in range(closed.size):
                if closed[j] and abs(gap_rate[j]) <= 10.0 * FADED * fastest:
                    gap_rate[j] = 0.0
            return DONE
        if is_endless(count[HERE], clock[LOST_HERE], clock[PASSED_ON]):
            return ENDLESS
        if count[HERE] % WINDOW == 0:
            clock[LOST_HERE] = clock[PASSED_ON] = 0.0
        count[HERE] += 1
        plastic = _is_last(approach, all_closed.speed, all_closed.time, clock, count)
        restitution = np.zeros(closed.size) if plastic else contacts.restitution
        before = gap_rate.copy()
        impulse, involved, lost, solved = impact_law(
            all_closed.mass,
            contacts.left,
            contacts.right,
            restitution,
            closed,
            gap_rate,
            all_closed.v,
        )
        if not solved:
            return NO_IMPACT
        clock[LOST_HERE] += lost
        for j in range(closed.size):
            clock[PASSED_ON] -= impulse[j] * before[j]
        _write_impact(plastic, before, impulse, involved, lost, all_closed)


@compiled
def _is_last(approach: float, speed: float, time: float, clock: Floats, count: Ints) -> bool:
    """Whether an impact of this closing speed (m/s) is taken as plastic; counts it.

    `speed` (m/s) and `time` (s) are the scene's own.
    """
    clock[FASTEST] = max(clock[FASTEST], approach)
    count[IN_A_ROW] += 1
    last = is_plastic(approach, clock[FASTEST], speed, count[IN_A_ROW], count[HERE])
    return last or _collapsed(time, clock)


@compiled
def _impact_of_one(j: int, plan: Plan, state: State, record: Record) -> None:
    """A single contact closes: a scalar instead of a complementarity problem."""
    contacts, limits = plan.contacts, plan.limits
    before = state.gap_rate[j]
    speed = limits.length / limits.time
    plastic = _is_last(-before, speed, limits.time, state.clock, state.count)
    restitution = 0.0 if plastic else contacts.restitution[j]
    impulse, lost = impact_of_one(
        j, plan.mass, contacts.left, contacts.right, restitution, state.gap_rate, state.v
    )
    listed = -before >= LISTED_SPEED * state.clock[FASTEST]
    kind = kind_of_impact(listed, plastic, before, contacts.restitution[j])
    group = state.count[GROUPS]
    state.count[GROUPS] += 1
    state.clock[SINCE_IMPACT] = 0.0
    write_event(
        state.clock[T],
        state.count,
        record.events,
        kind,
        group,
        j,
        before,
        state.gap_rate[j],
        impulse,
        lost,
        1,
    )


@compiled_apart
def _write_impact(
    plastic: bool, before: Floats, impulse: Floats, involved: Bools, lost: float, closed: Closed
) -> None:
    """One row for each contact that took an impulse."""
    count, clock, restitution = closed.count, closed.clock, closed.contacts.restitution
    group = count[GROUPS]
    count[GROUPS] += 1
    clock[SINCE_IMPACT] = 0.0
    speed = 0.0
    for j in range(before.size):
        if involved[j]:
            speed = max(speed, -before[j])
    listed = speed >= LISTED_SPEED * clock[FASTEST]
    for j in range(before.size):
        if not (involved[j] and impulse[j] > 0.0):
            continue
        if plastic:
            closed.gap_rate[j] = 0.0
        kind = kind_of_impact(listed, plastic, before[j], restitution[j])
        write_event(
            clock[T],
            count,
            closed.events,
            kind,
            group,
            j,
            before[j],
            closed.gap_rate[j],
            impulse[j],
            lost,
            1,
        )
        lost = 0.0
