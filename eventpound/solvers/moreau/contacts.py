"""What the contacts of a Moreau–Jean step do: who takes part, and what is recorded of it.

A step whose impulse follows one without is an impact, at its start; the velocity
jumps somewhere within h/2 of it. A contact rests while it is not open and neither end
of the step has a gap rate; its force is then p/h.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.solvers.timestepping.compiled import step_kernel
from eventpound.solvers.timestepping.equations import difference
from eventpound.solvers.timestepping.record import (
    DETACHMENT,
    IMPACT,
    REST,
    Record,
    write_event,
)
from eventpound.solvers.timestepping.structure import (
    CONTACT,
    GROUPS,
    STILL,
    State,
    Structure,
    Touch,
    Trial,
)


class Active(NamedTuple):
    """Room for the contacts that take part in a step.

    contacts (K,): their numbers, in front. marked (K,): who they are. column (N,): for
    ``Â⁻¹ W`` of one of them.
    """

    contacts: Ints
    marked: Bools
    column: Floats


@step_kernel
def find_active(structure: Structure, h: float, state: State, active: Active) -> int:
    """Write down and mark the contacts whose gap half a step ahead, ``g + h γ / 2``, is not open.

    A gap that a rate which counts as none would make in a step is not open either;
    else rounding would let go of a contact at rest. Returns their number.
    """
    closed = h * STILL * structure.speed
    count = 0
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        gap = structure.gap[j] + difference(state.u, left, right)
        active.marked[j] = gap + 0.5 * h * difference(state.v, left, right) <= closed
        if active.marked[j]:
            active.contacts[count] = j
            count += 1
    return count


@step_kernel
def close_step(
    structure: Structure,
    h: float,
    t: float,
    active: Active,
    state: State,
    trial: Trial,
    touch: Touch,
    record: Record,
) -> None:
    """Write the events of a step that starts at t (s), and make forces of its impulses."""
    still = STILL * structure.speed
    lost, impacts = 0.0, 0
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        before, after = difference(state.v, left, right), difference(trial.v, left, right)
        lost -= 0.5 * trial.contact[j] * (before + after)
        if trial.contact[j] > 0.0 and before < -still:
            impacts += 1
    state.work[CONTACT] += lost
    group = state.counters[GROUPS]
    for j in range(structure.gap.size):
        p = trial.contact[j]
        left, right = structure.left[j], structure.right[j]
        before, after = difference(state.v, left, right), difference(trial.v, left, right)
        rests = active.marked[j] and abs(before) <= still and abs(after) <= still
        if p > 0.0 and before < -still and not touch.closed[j]:
            write_event(record, state, t, IMPACT, group, j, before, after, p, lost)
            # The first row of a problem stands for its whole loss.
            lost = 0.0
            state.counters[GROUPS] = group + 1
        if rests and not touch.resting[j]:
            write_event(record, state, t, REST, group, j, 0.0, 0.0, 0.0, 0.0)
            state.counters[GROUPS] = group + 1
        elif touch.resting[j] and not rests:
            write_event(record, state, t, DETACHMENT, group, j, 0.0, after, 0.0, 0.0)
            state.counters[GROUPS] = group + 1
        touch.resting[j] = rests
        touch.closed[j] = p > 0.0
        if not rests:
            trial.contact[j] = 0.0
        elif impacts > 0:
            # Its impulse answers the impact elsewhere, so p/h is no force.
            trial.contact[j] = state.contact[j]
        else:
            trial.contact[j] = p / h
