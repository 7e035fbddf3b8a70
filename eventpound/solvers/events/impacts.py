"""Impacts of one instant: closed gaps put on their constraints, then problem after problem.

The rules by which a cascade ends are those of `eventpound.solvers.events.cascade`.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.clusters import close_one, join_bodies
from eventpound.mechanics.impact import impact_law, impact_of_one
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.cascade import (
    FADED,
    LAST_INTERVAL,
    LISTED_SPEED,
    WINDOW,
    is_endless,
    is_plastic,
)
from eventpound.solvers.events.event_rows import kind_of_impact, put_event
from eventpound.solvers.events.modes import Duty, duties
from eventpound.solvers.events.run import (
    EVENTS,
    FASTEST,
    FASTEST_HERE,
    GROUPS,
    HERE,
    IN_A_ROW,
    INTERVAL,
    LOST_HERE,
    PASSED_ON,
    Run,
    T,
    rules_of,
    state_of,
)

_IMPACT = int(Duty.IMPACT)
DONE, FULL, NO_SOLUTION, ENDLESS = range(4)
"""How the impacts of an instant end; FULL: the record needs more room, then they go on."""
NONE, SEVERAL = -1, -2
"""What `only_closed` finds where it is not a single contact."""

_close_one = kernel(close_one)


@scalar_kernel
def collapsed(interval: float, time: float) -> bool:
    """Whether the last interval (s) was none beside the scene's own time (s)."""
    return interval <= LAST_INTERVAL * time


@kernel
def close_collapsed(run: Run) -> None:
    """Where an interval was none, close every gap that is none beside it."""
    rules, state = rules_of(run), state_of(run)
    if not collapsed(state.clock[INTERVAL], rules.time):
        return
    none = LAST_INTERVAL * (rules.length + state.clock[FASTEST] * rules.time)
    for j in range(state.gap.size):
        if abs(state.gap[j]) <= none:
            state.gap[j] = 0.0


@scalar_kernel
def only_closed(gap: Floats) -> int:
    """The only closed contact; `NONE` where there is none, `SEVERAL` where there are more."""
    found = NONE
    for j in range(gap.size):
        if gap[j] == 0.0:
            if found >= 0:
                return SEVERAL
            found = j
    return found


@kernel
def close_only(j: int, run: Run) -> None:
    """Make the displacements of a single closed contact agree with its gap of zero."""
    rules = rules_of(run)
    _close_one(rules.left[j], rules.right[j], rules.gap[j], rules.mass, state_of(run).u)


@kernel
def close_several(run: Run) -> None:
    """Put all bodies that closed contacts join in touch, their centres of mass kept."""
    rules, state = rules_of(run), state_of(run)
    closed = state.gap == 0.0
    bodies = rules.mass.size
    touching = join_bodies(rules.left, rules.right, rules.gap, closed, closed, bodies)
    total, moment = np.zeros(bodies), np.zeros(bodies)
    for b in range(bodies):
        c = touching.of_body[b]
        if c >= 0:
            total[c] += rules.mass[b]
            moment[c] += rules.mass[b] * (state.u[b] - touching.offset[b])
    for b in range(bodies):
        c = touching.of_body[b]
        state.u[b] = touching.offset[b] + (moment[c] / total[c] if c >= 0 else 0.0)


@kernel
def _is_last(approach: float, run: Run) -> bool:
    """Whether an impact of this closing speed (m/s) is taken as plastic; counts it."""
    rules, state = rules_of(run), state_of(run)
    clock, counts = state.clock, state.counts
    clock[FASTEST] = max(clock[FASTEST], approach)
    counts[HERE] += 1
    counts[IN_A_ROW] += 1
    speed = rules.length / rules.time
    last = is_plastic(approach, clock[FASTEST], speed, counts[IN_A_ROW], counts[HERE])
    return last or collapsed(clock[INTERVAL], rules.time)


@kernel
def impact_of_only(j: int, run: Run) -> None:
    """A single contact closes: no problem to solve."""
    rules, state = rules_of(run), state_of(run)
    before = state.gap_rate[j]
    plastic = _is_last(-before, run)
    impulse, lost = impact_of_one(
        j,
        rules.mass,
        rules.left,
        rules.right,
        0.0 if plastic else rules.restitution[j],
        state.gap_rate,
        state.v,
    )
    listed = -before >= LISTED_SPEED * state.clock[FASTEST]
    kind = kind_of_impact(listed, plastic, before, rules.restitution[j])
    counts = state.counts
    put_event(
        run.events[counts[EVENTS]],
        state.clock[T],
        kind,
        counts[GROUPS],
        j,
        (before, state.gap_rate[j]),
        impulse,
        lost,
        1,
    )
    counts[EVENTS] += 1
    counts[GROUPS] += 1


@kernel
def impacts_of_several(run: Run) -> int:
    """Impact problems of this instant, until no closed contact approaches."""
    rules, state = rules_of(run), state_of(run)
    clock, counts = state.clock, state.counts
    while True:
        # What the instant has seen so far outlives a pause in which the record gets more room.
        if counts[EVENTS] + 4 * rules.gap.size > run.events.shape[0]:
            return FULL
        closed = state.gap == 0.0
        if not (duties(closed, state.gap_rate) == _IMPACT).any():
            return DONE
        approach = -np.min(state.gap_rate[closed])
        fastest = max(clock[FASTEST_HERE], approach)
        clock[FASTEST_HERE] = fastest
        if approach <= FADED * fastest:
            # A row squeezed without play: what is left is rounding of the first speeds.
            for j in range(closed.size):
                if closed[j] and abs(state.gap_rate[j]) <= 10.0 * FADED * fastest:
                    state.gap_rate[j] = 0.0
            return DONE
        if is_endless(counts[HERE], clock[LOST_HERE], clock[PASSED_ON]):
            return ENDLESS
        if counts[HERE] % WINDOW == 0:
            clock[LOST_HERE] = clock[PASSED_ON] = 0.0
        plastic = _is_last(approach, run)
        restitution = np.zeros(closed.size) if plastic else rules.restitution
        before = state.gap_rate.copy()
        impulse, involved, lost, solved = impact_law(
            rules.mass, rules.left, rules.right, restitution, closed, state.gap_rate, state.v
        )
        if not solved:
            return NO_SOLUTION
        clock[LOST_HERE] += lost
        for j in range(closed.size):
            clock[PASSED_ON] -= impulse[j] * before[j]
        _list_impacts(plastic, before, impulse, involved, lost, run)


@kernel
def _list_impacts(
    plastic: bool,
    before: Floats,
    impulse: Floats,
    involved: Bools,
    lost: float,
    run: Run,
) -> None:
    """One row for each contact that took an impulse; the first tells what the problem lost (J)."""
    rules, state, speed = rules_of(run), state_of(run), 0.0
    counts = state.counts
    for j in range(before.size):
        if involved[j]:
            speed = max(speed, -before[j])
    listed = speed >= LISTED_SPEED * state.clock[FASTEST]
    for j in range(before.size):
        if not (involved[j] and impulse[j] > 0.0):
            continue
        if plastic:
            state.gap_rate[j] = 0.0
        put_event(
            run.events[counts[EVENTS]],
            state.clock[T],
            kind_of_impact(listed, plastic, before[j], rules.restitution[j]),
            counts[GROUPS],
            j,
            (before[j], state.gap_rate[j]),
            impulse[j],
            lost,
            1,
        )
        counts[EVENTS] += 1
        lost = 0.0
    counts[GROUPS] += 1
