"""A contact element's time in contact as one impact, from its closing to its opening."""

from __future__ import annotations

from eventpound.solvers.timestepping.compiled import step_kernel
from eventpound.solvers.timestepping.equations import difference
from eventpound.solvers.timestepping.record import IMPACT, Record, write_event
from eventpound.solvers.timestepping.structure import (
    CONTACT,
    GROUPS,
    State,
    Structure,
    Touch,
    Trial,
)


@step_kernel
def take_closing_rates(structure: Structure, state: State, touch: Touch) -> None:
    """Take the rate of every open gap as the one it may close with in this step (m/s)."""
    for j in range(structure.gap.size):
        if not touch.closed[j]:
            left, right = structure.left[j], structure.right[j]
            touch.before[j] = difference(state.v, left, right)
            # What is pressed shut at the start has never closed.
            open_gap = structure.gap[j] + difference(state.u, left, right) >= 0.0
            touch.approach[j] = max(0.0, -touch.before[j]) if open_gap else 0.0


@step_kernel
def follow_contacts(
    structure: Structure,
    h: float,
    t: float,
    state: State,
    trial: Trial,
    touch: Touch,
    record: Record,
) -> None:
    """Sum impulse and work of the contacts over a step from t (s); write those that end."""
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        gap_0 = structure.gap[j] + difference(state.u, left, right)
        gap_1 = structure.gap[j] + difference(trial.u, left, right)
        rate_0, rate_1 = difference(state.v, left, right), difference(trial.v, left, right)
        if gap_1 < 0.0 and not touch.closed[j]:
            touch.closed[j] = True
            touch.since[j] = t + h * max(0.0, gap_0) / (max(0.0, gap_0) - gap_1)
            touch.impulse[j] = touch.lost[j] = 0.0
        if not touch.closed[j]:
            continue
        impulse = 0.5 * h * (state.contact[j] + trial.contact[j])
        lost = -0.5 * impulse * (rate_0 + rate_1)
        touch.impulse[j] += impulse
        touch.lost[j] += lost
        state.work[CONTACT] += lost
        if gap_1 >= 0.0:
            touch.closed[j] = False
            touch.longest[j] = max(touch.longest[j], t + h - touch.since[j])
            write_event(
                record,
                state,
                touch.since[j],
                IMPACT,
                state.counters[GROUPS],
                j,
                touch.before[j],
                rate_1,
                touch.impulse[j],
                touch.lost[j],
            )
            state.counters[GROUPS] += 1
