"""One step of the Moreau–Jean rule: velocities and impulses, no event located.

    M (v₁ - v₀) = h f_θ + W p,   u₁ = u₀ + h v_θ
    0 <= γ₁ + ε γ₀ ⊥ p >= 0      over the contacts with g₀ + h γ₀ / 2 <= 0
    p = 0                        over the others;  γ = Wᵀ v

(J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics,
CISM 302, 1988; M. Jean, Comput. Methods Appl. Mech. Engrg 177, 1999, 235-257;
V. Acary, B. Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008).
Where the links are not linear the complementarity problem is solved anew in each
of Newton's iterations, with ``G = Wᵀ Â⁻¹ W``, Â being Newton's matrix. A gap is
held by its rate, so an impact may leave it up to ``h |γ| (1 - ε/2)`` below zero,
and rest keeps it there.

A step whose impulse follows one without is an impact, at its start; the velocity
jumps somewhere within h/2 of it. A contact rests while it is not open and neither end
of the step has a gap rate; its force is then p/h.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.contact_problem import solve_contacts
from eventpound.mechanics.impact import QUIET
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.banded import factor_banded, solve_banded
from eventpound.numerics.borrowing import put_numbers
from eventpound.numerics.compiled import kernel
from eventpound.numerics.lcp import solve_dense
from eventpound.solvers.events.cascade import EVENTS, GROUPS
from eventpound.solvers.events.event_rows import DETACHMENT, IMPACT, REST, EventRow, write_event
from eventpound.solvers.timestepping.compiled import step_kernel, step_loop
from eventpound.solvers.timestepping.equations import (
    add_work,
    balanced,
    difference,
    end_of_step,
    fill_newton_matrix,
    momentum_residual,
    pull_together,
)
from eventpound.solvers.timestepping.record import (
    DONE,
    NO_ROOM,
    NOT_CONVERGED,
    NOT_SOLVED,
    Span,
    Stepping,
    end_step,
)
from eventpound.solvers.timestepping.structure import CONTACT, STILL, State, Structure, Trial

MOST_ITERATIONS = 60
NOTHING = 1e-30
"""Part of the scene's speed that is none at all."""
RELAXED_AFTER = 15
"""Iterations after which Newton's steps are halved: by then they swing between branches."""


class Active(NamedTuple):
    """Room for the contacts that take part in a step.

    contacts (K,): their numbers, in front. marked (K,): who they are. column (N,): for
    ``Â⁻¹ W`` of one of them.
    """

    contacts: Ints
    marked: Bools
    column: Floats


@step_kernel
def _find_active(structure: Structure, h: float, state: State, active: Active) -> int:
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
def _take_impulses(structure: Structure, sign: float, trial: Trial) -> None:
    """Take ``sign W p`` from the residual."""
    for j in range(structure.gap.size):
        if trial.contact[j] != 0.0:
            pull_together(
                trial.residual, structure.left[j], structure.right[j], sign * trial.contact[j]
            )


@step_kernel
def _strike(structure: Structure, active: Active, j: int, state: State, trial: Trial) -> None:
    """Impulse of the only active contact, added to the free velocities in `increment`."""
    left, right = structure.left[j], structure.right[j]
    for b in range(structure.mass.size):
        active.column[b] = 0.0
    pull_together(active.column, left, right, -1.0)
    solve_banded(trial.band, active.column)
    q = difference(trial.increment, left, right)
    q += structure.restitution[j] * difference(state.v, left, right)
    p = max(0.0, -q / difference(active.column, left, right))
    trial.contact[j] = p
    for b in range(structure.mass.size):
        trial.increment[b] += active.column[b] * p


@kernel
def _strike_together(structure: Structure, active: Ints, state: State, trial: Trial) -> bool:
    """The same for several contacts: their complementarity problem; False where not solved.

    Between two barriers different ε may ask for gap rates that no motion has (their sum
    is fixed); the step is then taken as plastic, which every group can be.
    """
    left, right = structure.left[active], structure.right[active]
    q = np.empty(active.size)
    for share in (1.0, 0.0):
        for a in range(active.size):
            rebound = share * structure.restitution[active[a]]
            q[a] = difference(trial.increment, left[a], right[a])
            q[a] += rebound * difference(state.v, left[a], right[a])
            # What decays at rest without forces would underflow on the way through the problem.
            if abs(q[a]) < NOTHING * structure.speed:
                q[a] = 0.0
        p, change, solved = _impulses(structure, left, right, q, trial)
        if solved:
            put_numbers(p, active, trial.contact)
            for b in range(change.size):
                trial.increment[b] += change[b]
            return True
    return False


@kernel
def _impulses(
    structure: Structure, left: Ints, right: Ints, q: Floats, trial: Trial
) -> tuple[Floats, Floats, bool]:
    """Impulses p with ``0 <= G p + q ⊥ p >= 0``, ``Â⁻¹ W p``, and whether they were found."""
    change = np.zeros(structure.mass.size)
    noise = QUIET * np.max(np.abs(q))
    if np.all(trial.band[:, 1:] == 0.0):
        # No link between bodies: masses of their own, and a row of contacts is quickly solved.
        inverse = 1.0 / trial.band[:, 0]
        p, _, solved = solve_contacts(left, right, inverse, q, noise)
        for a in range(left.size):
            pull_together(change, left[a], right[a], -p[a])
        return p, change * inverse, solved
    columns, G = _delassus(structure, left, right, trial)
    p, _, solved = solve_dense(G, q, noise)
    for a in range(left.size):
        change += columns[a] * p[a]
    return p, change, solved


@kernel
def _delassus(structure: Structure, left: Ints, right: Ints, trial: Trial) -> tuple[Floats, Floats]:
    """``Â⁻¹ W`` transposed (k, N) and ``G = Wᵀ Â⁻¹ W`` (k, k) of some contacts."""
    columns = np.zeros((left.size, structure.mass.size))
    G = np.empty((left.size, left.size))
    for a in range(left.size):
        pull_together(columns[a], left[a], right[a], -1.0)
        solve_banded(trial.band, columns[a])
        for b in range(left.size):
            G[a, b] = difference(columns[a], left[b], right[b])
    return columns, G


@step_kernel
def _solve_step(
    structure: Structure, h: float, ground: float, active: Active, state: State, trial: Trial
) -> int:
    """Newton's iteration for the end of the step; an outcome."""
    count = _find_active(structure, h, state, active)
    for b in range(structure.mass.size):
        trial.v[b] = state.v[b] + h * (state.f[b] / structure.mass[b] - ground)
    for j in range(structure.gap.size):
        trial.contact[j] = 0.0
    for iteration in range(MOST_ITERATIONS):
        end_of_step(structure, h, state, trial)
        momentum_residual(structure, h, ground, state, trial)
        _take_impulses(structure, 1.0, trial)
        if (iteration > 0 or count == 0) and balanced(structure, trial):
            return DONE
        _take_impulses(structure, -1.0, trial)
        fill_newton_matrix(structure, h, trial)
        if not factor_banded(trial.band):
            return NOT_CONVERGED
        for b in range(structure.mass.size):
            trial.increment[b] = trial.residual[b]
        solve_banded(trial.band, trial.increment)
        for b in range(structure.mass.size):
            trial.increment[b] = trial.v[b] - trial.increment[b]
        if count == 1:
            _strike(structure, active, active.contacts[0], state, trial)
        elif count > 1 and not _strike_together(structure, active.contacts[:count], state, trial):
            return NOT_SOLVED
        share = 1.0 if iteration < RELAXED_AFTER else 0.5
        for b in range(structure.mass.size):
            trial.v[b] += share * (trial.increment[b] - trial.v[b])
    return NOT_CONVERGED


@step_kernel
def _close_step(t: float, h: float, active: Active, run: Stepping) -> None:
    """Write the events of a step that starts at t (s), and make forces of its impulses."""
    structure, state, trial, touch = run.structure, run.state, run.trial, run.touch
    counters, events = state.counters, run.record.events
    still = STILL * structure.speed
    lost, impacts = 0.0, 0
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        before, after = difference(state.v, left, right), difference(trial.v, left, right)
        lost -= 0.5 * trial.contact[j] * (before + after)
        if trial.contact[j] > 0.0 and before < -still:
            impacts += 1
    state.work[CONTACT] += lost
    group = counters[GROUPS]
    for j in range(structure.gap.size):
        p = trial.contact[j]
        left, right = structure.left[j], structure.right[j]
        before, after = difference(state.v, left, right), difference(trial.v, left, right)
        rests = active.marked[j] and abs(before) <= still and abs(after) <= still
        if p > 0.0 and before < -still and not touch.closed[j]:
            row = EventRow(t, IMPACT, group, j, before, after, p, lost, 1)
            write_event(row, counters, events)
            # The first row of a problem stands for its whole loss.
            lost = 0.0
            counters[GROUPS] = group + 1
        if rests and not touch.resting[j]:
            write_event(EventRow(t, REST, group, j, 0.0, 0.0, 0.0, 0.0, 1), counters, events)
            counters[GROUPS] = group + 1
        elif touch.resting[j] and not rests:
            row = EventRow(t, DETACHMENT, group, j, 0.0, after, 0.0, 0.0, 1)
            write_event(row, counters, events)
            counters[GROUPS] = group + 1
        touch.resting[j] = rests
        touch.closed[j] = p > 0.0
        if not rests:
            trial.contact[j] = 0.0
        elif impacts > 0:
            # Its impulse answers the impact elsewhere, so p/h is no force.
            trial.contact[j] = state.contact[j]
        else:
            trial.contact[j] = p / h


@step_loop
def advance(span: Span, forcing: Forcing, active: Active, run: Stepping) -> tuple[int, int]:
    """Take steps.

    Parameters
    ----------
    span : Span
        The steps.
    forcing : Forcing
        The ground motion.
    active, run
        What the run works on.

    Returns
    -------
    int, int
        Number of the step before which it stopped, and one of
        `eventpound.solvers.timestepping.record`.
    """
    structure, state, trial, h = run.structure, run.state, run.trial, span.h
    theta = structure.theta
    a_0 = ground_acceleration(forcing, forcing.start + span.first * h)
    for i in range(span.first, span.last):
        if state.counters[EVENTS] + 3 * structure.gap.size > run.record.events.shape[0]:
            return i, NO_ROOM
        t_0, t_1 = forcing.start + i * h, forcing.start + (i + 1) * h
        a_1 = ground_acceleration(forcing, t_1)
        ground = (1.0 - theta) * a_0 + theta * a_1
        outcome = _solve_step(structure, h, ground, active, state, trial)
        if outcome != DONE:
            return i, outcome
        add_work(structure, h, ground, state, trial)
        _close_step(t_0, h, active, run)
        end_step(t_1, a_1, run)
        a_0 = a_1
    return span.last, DONE
