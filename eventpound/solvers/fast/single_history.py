"""Gaps of a single body and lines of its history."""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.history import write_row
from eventpound.solvers.fast.plan import OUTPUT, ROWS, Plan, Record, Series, State
from eventpound.solvers.fast.seen import OWN_GAP, Seen, look_apart
from eventpound.solvers.fast.single_ground import OF_X, other_acceleration
from eventpound.solvers.fast.single_series import ROOM, motion


@compiled
def agree_at_barrier(plan: Plan, state: State) -> None:
    """Take the velocity of a body at a barrier from the rate of its gap, and the other gap's too.

    After an impact that rate keeps its relative accuracy.
    """
    o, v = plan.oscillator, state.v[0]
    if o.right >= 0 and state.gap[o.right] == 0.0:
        v = -state.gap_rate[o.right]
    elif o.left >= 0 and state.gap[o.left] == 0.0:
        v = state.gap_rate[o.left]
    state.v[0] = v
    if o.right >= 0:
        state.gap_rate[o.right] = -v
    if o.left >= 0:
        state.gap_rate[o.left] = v


@compiled
def move_gaps(change: float, u: float, v: float, plan: Plan, state: State) -> float:
    """Gaps after a step to u, by their own variables where they are small; the deepest below 0."""
    o, contacts = plan.oscillator, plan.contacts
    own = OWN_GAP * plan.limits.length
    deepest = 0.0
    if o.right >= 0:
        near, far = state.gap[o.right] - change, contacts.gap[o.right] - u
        state.gap[o.right] = far if far >= own else near
        state.gap_rate[o.right] = -v
        deepest = min(deepest, state.gap[o.right])
    if o.left >= 0:
        near, far = state.gap[o.left] + change, contacts.gap[o.left] + u
        state.gap[o.left] = far if far >= own else near
        state.gap_rate[o.left] = v
        deepest = min(deepest, state.gap[o.left])
    return deepest


@compiled_apart
def sample_single(
    t: float,
    t_end: float,
    order: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
) -> bool:
    """History at the output times of a step; False where the record has no room."""
    o, count, times = plan.oscillator, state.count, plan.output_times
    x = series.single[OF_X : OF_X + ROOM]
    u, v = state.u[0], state.v[0]
    right = state.gap[o.right] if o.right >= 0 else 0.0
    left = state.gap[o.left] if o.left >= 0 else 0.0
    room = True
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        at = times[count[OUTPUT]]
        if at >= t:
            if count[ROWS] + 4 > record.rows.shape[0]:
                room = False
                break
            change, rate, _ = motion(at - t, order, x)
            state.u[0], state.v[0] = u + change, rate
            if o.right >= 0:
                state.gap[o.right], state.gap_rate[o.right] = right - change, -rate
            if o.left >= 0:
                state.gap[o.left], state.gap_rate[o.left] = left + change, rate
            g = other_acceleration(at, family, coefficients, samples)
            look_apart(0.0, order, g, plan, state, series, seen)
            write_row(at, plan, seen, state, record)
        count[OUTPUT] += 1
    state.u[0], state.v[0] = u, v
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = right, -v
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = left, v
    return room
