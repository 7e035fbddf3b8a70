"""One step of the Moreau–Jean rule: velocities and impulses, no event located.

    M (v₁ - v₀) = h f_θ + W p,   u₁ = u₀ + h v_θ
    0 <= γ₁ + ε γ₀ ⊥ p >= 0      over the contacts with g₀ + h γ₀ / 2 <= 0, or Poisson's law
    p_T ∈ -μ p Sgn(γ_T₁)         of those with friction, in the tangential rows of W
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

from eventpound.contact.event_rows import (
    DETACHMENT,
    IMPACT,
    REST,
    EventRow,
    kind_of_slide,
    new_group,
    write_event,
    write_slide,
)
from eventpound.contact.poisson import compress_and_expand
from eventpound.contact.rubbing import PATH, keep_friction
from eventpound.mechanics.contact_problem import Joints, solve_contacts
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.banded import factor_banded, solve_banded
from eventpound.numerics.borrowing import put_numbers
from eventpound.numerics.compiled import kernel, scalar_kernel, step_kernel
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.numerics.coulomb import NO_ANSWER, SEVERAL, Rubbing, solve_rubbing
from eventpound.numerics.lcp import solve_dense
from eventpound.solvers.timestepping.equations import (
    FixedStep,
    balanced,
    end_of_step,
    fill_newton_matrix,
    momentum_residual,
    predict,
    take_steps,
)
from eventpound.solvers.timestepping.stepping import (
    CONTACT,
    DONE,
    FRICTION,
    GAINED,
    NOT_CONVERGED,
    NOT_SOLVED,
    NOT_UNIQUE,
    Span,
    Stepping,
    copy_values,
    gap_of,
    gap_rate,
    hand_on,
    pull_together,
    slip_rate,
)
from eventpound.tolerances import GAINED_IN_STEP, NO_SPEED, QUIET, STILL_GAP_RATE

MOST_ITERATIONS = 60
RELAXED_AFTER = 15
"""Iterations after which Newton's steps are halved: by then they swing between branches."""


class Active(NamedTuple):
    """Room for the contacts that take part in a step, and what they did in the last one.

    contacts (K,): their numbers, in front. marked (K,): who they are. struck, resting (K,): who
    took an impulse, who rested. column (N + D,): for ``Â⁻¹ W`` of one of them. rubbed (5, K): what
    friction has done, as `eventpound.contact.rubbing` keeps it. slides (K,): the kind of row that
    told how a contact rests.
    """

    contacts: Ints
    marked: Bools
    struck: Bools
    resting: Bools
    column: Floats
    rubbed: Floats
    slides: Ints


@step_kernel
def _find_active(h: float, active: Active, stepping: Stepping) -> int:
    """Write down and mark the contacts whose gap half a step ahead, ``g + h γ / 2``, is not open.

    A gap that a rate which counts as none would make in a step is not open either;
    else rounding would let go of a contact at rest. Returns their number.
    """
    structure, state = stepping.structure, stepping.state
    closed = h * STILL_GAP_RATE * structure.speed
    count = 0
    for j in range(structure.gap.size):
        ahead = gap_of(structure, j, state.u) + 0.5 * h * gap_rate(structure, j, state.v)
        active.marked[j] = ahead <= closed
        if active.marked[j]:
            active.contacts[count] = j
            count += 1
    return count


@step_kernel
def _take_impulses(sign: float, stepping: Stepping) -> None:
    """Take ``sign W p`` from the residual."""
    structure, residual = stepping.structure, stepping.equations.residual
    for j in range(structure.gap.size):
        p, p_T = stepping.trial.contact[j], stepping.trial.rubbing[j]
        if p != 0.0:
            pull_together(residual, structure.left[j], structure.right[j], sign * p)
        if p_T != 0.0:
            pull_together(residual, structure.tangent[j, 0], structure.tangent[j, 1], sign * p_T)
    hand_on(structure.weights, residual)


@step_kernel
def _answer(left: int, right: int, column: Floats, stepping: Stepping) -> None:
    """``Â⁻¹ W`` of one row, (N + D,)."""
    for b in range(column.size):
        column[b] = 0.0
    pull_together(column, left, right, -1.0)
    hand_on(stepping.structure.weights, column)
    solve_banded(stepping.equations.band, column)
    place_points(stepping.structure.weights, column)


@step_kernel
def _strike(active: Active, j: int, stepping: Stepping) -> None:
    """Impulse of the only active contact, added to the free velocities in `increment`."""
    structure, equations = stepping.structure, stepping.equations
    _answer(structure.left[j], structure.right[j], active.column, stepping)
    q = gap_rate(structure, j, equations.increment)
    q += structure.restitution[j] * gap_rate(structure, j, stepping.state.v)
    # Newton's law in Moreau's form: γ₁ + ε γ₀ = 0, unless that would pull.
    p = max(0.0, -q / gap_rate(structure, j, active.column))
    stepping.trial.contact[j] = p
    for b in range(active.column.size):
        equations.increment[b] += active.column[b] * p


@kernel
def _strike_together(active: Ints, stepping: Stepping) -> bool:
    """The same for several contacts: their complementarity problem; False where not solved.

    Between two barriers different ε may ask for gap rates that no motion has (their sum
    is fixed); the step is then taken as plastic, which every group can be.
    """
    structure, equations = stepping.structure, stepping.equations
    q = np.empty(active.size)
    for share in (1.0, 0.0):
        for a in range(active.size):
            j = active[a]
            q[a] = gap_rate(structure, j, equations.increment)
            q[a] += share * structure.restitution[j] * gap_rate(structure, j, stepping.state.v)
            # What decays at rest without forces would underflow on the way through the problem.
            if abs(q[a]) < NO_SPEED * structure.speed:
                q[a] = 0.0
        p, change, solved = _impulses(active, q, stepping)
        if solved:
            put_numbers(p, active, stepping.trial.contact)
            for b in range(change.size):
                equations.increment[b] += change[b]
            return True
    return False


@kernel
def _rub_together(active: Ints, stepping: Stepping) -> int:
    """The same for contacts some of which have friction; an outcome.

    What friction does is first order whatever θ is: the way of slip is that of the end of the step.
    By Poisson's law a step expands in which one strikes.
    """
    structure, equations, k = stepping.structure, stepping.equations, active.size
    ends = np.concatenate((structure.tangent[active], structure.tangent[active]))
    ends[:k, 0], ends[:k, 1] = structure.left[active], structure.right[active]
    columns, G = np.zeros((2 * k, equations.increment.size)), np.empty((2 * k, 2 * k))
    for a in range(2 * k):
        _answer(ends[a, 0], ends[a, 1], columns[a], stepping)
        for b in range(2 * k):
            G[a, b] = difference(columns[a], ends[b, 0], ends[b, 1])
    x, w, q, free = np.zeros(2 * k), np.zeros(2 * k), np.empty(2 * k), np.zeros(k, np.int64)
    state, before = np.zeros(k, np.int64), np.empty(k)
    for a in range(k):
        before[a] = gap_rate(structure, active[a], stepping.state.v)
    newton, poisson = structure.restitution[active], np.zeros(k)
    if structure.by_poisson:
        newton, poisson = poisson, newton * np.any(before < -STILL_GAP_RATE * structure.speed)
    for share in (1.0, 0.0):
        for a in range(2 * k):
            q[a] = difference(equations.increment, ends[a, 0], ends[a, 1])
            if a < k:
                q[a] += share * newton[a] * before[a]
            if abs(q[a]) < NO_SPEED * structure.speed:
                q[a] = 0.0
        noise = np.full(2 * k, QUIET * np.max(np.abs(q)))
        problem = Rubbing(G, q, structure.friction[active], free, noise)
        if share * np.max(poisson) > 0.0:
            found = compress_and_expand(problem, poisson, x, w, state)
        else:
            found = solve_rubbing(problem, x, w, state)
        if found == SEVERAL:
            return NOT_UNIQUE
        if found == NO_ANSWER:
            continue
        put_numbers(x[:k], active, stepping.trial.contact)
        put_numbers(x[k:], active, stepping.trial.rubbing)
        for a in range(2 * k):
            for b in range(equations.increment.size):
                equations.increment[b] += columns[a, b] * x[a]
        return DONE
    return NOT_SOLVED


@kernel
def _impulses(active: Ints, q: Floats, stepping: Stepping) -> tuple[Floats, Floats, bool]:
    """Impulses p with ``0 <= G p + q ⊥ p >= 0``, ``Â⁻¹ W p``, and whether they were found."""
    structure, band = stepping.structure, stepping.equations.band
    left, right = structure.left[active], structure.right[active]
    change = np.zeros(stepping.equations.increment.size)
    noise = QUIET * np.max(np.abs(q))
    if structure.weights.size == 0 and np.all(band[:, 1:] == 0.0):
        # No link between bodies: masses of their own, and a row of contacts is quickly solved.
        inverse = 1.0 / band[:, 0]
        joints = Joints(left, right, inverse, np.zeros((0, 0)))
        p, _, solved = solve_contacts(joints, q, noise)
        for a in range(left.size):
            pull_together(change, left[a], right[a], -p[a])
        return p, change * inverse, solved
    # Rows of `columns` are those of Â⁻¹ W transposed (k, N); G = Wᵀ Â⁻¹ W (k, k).
    columns, G = np.zeros((left.size, change.size)), np.empty((left.size, left.size))
    for a in range(left.size):
        _answer(left[a], right[a], columns[a], stepping)
        for b in range(left.size):
            G[a, b] = difference(columns[a], left[b], right[b])
    p, _, solved = solve_dense(G, q, noise)
    for a in range(left.size):
        change += columns[a] * p[a]
    return p, change, solved


@step_kernel
def _solve_step(step: FixedStep, active: Active, stepping: Stepping) -> int:
    """Newton's iteration for the end of the step; an outcome."""
    structure, trial, equations = stepping.structure, stepping.trial, stepping.equations
    count = _find_active(step.h, active, stepping)
    predict(step, stepping)
    rubs = False
    for j in range(trial.contact.size):
        trial.contact[j] = trial.rubbing[j] = 0.0
        rubs |= active.marked[j] and (structure.friction[j] > 0.0 or structure.by_poisson)
    for iteration in range(MOST_ITERATIONS):
        end_of_step(step.h, stepping)
        momentum_residual(step, stepping)
        _take_impulses(1.0, stepping)
        # The impulses of active contacts are known only after a first turn.
        if (iteration > 0 or count == 0) and balanced(stepping):
            return DONE
        # Out again: the complementarity problem finds the impulses anew.
        _take_impulses(-1.0, stepping)
        fill_newton_matrix(step.h, stepping)
        if not factor_banded(equations.band):
            return NOT_CONVERGED
        copy_values(equations.residual, equations.increment)
        solve_banded(equations.band, equations.increment)
        for b in range(structure.mass.size):
            # Free velocities, which the impulses then change.
            equations.increment[b] = trial.v[b] - equations.increment[b]
        place_points(structure.weights, equations.increment)
        if rubs:
            outcome = _rub_together(active.contacts[:count], stepping)
            if outcome != DONE:
                return outcome
        elif count == 1:
            _strike(active, active.contacts[0], stepping)
        elif count > 1 and not _strike_together(active.contacts[:count], stepping):
            return NOT_SOLVED
        share = 1.0 if iteration < RELAXED_AFTER else 0.5
        for b in range(trial.v.size):
            trial.v[b] += share * (equations.increment[b] - trial.v[b])
    return NOT_CONVERGED


@step_kernel
def _keep_rubbing(j: int, h: float, struck: bool, rubbed: Floats, stepping: Stepping) -> float:
    """Keep what the friction of a contact has done in a step; the energy it took (J)."""
    structure, p_T = stepping.structure, stepping.trial.rubbing[j]
    rates = slip_rate(structure, j, stepping.state.v) + slip_rate(structure, j, stepping.trial.v)
    lost = -0.5 * p_T * rates
    normal, tangential = (stepping.trial.contact[j], p_T) if struck else (0.0, 0.0)
    keep_friction(j, normal, tangential, lost, rubbed)
    if not struck and stepping.trial.contact[j] > 0.0:
        rubbed[PATH, j] += 0.5 * h * abs(rates)
    return lost


@step_kernel
def _take_losses(
    h: float, still: float, rubbed: Floats, stepping: Stepping
) -> tuple[float, int, bool]:
    """Keep what the impulses of a step took; what impacts lost (J), how many, and if they gained.

    still: gap rate that counts as none (m/s).
    """
    structure, state = stepping.structure, stepping.state
    trial, work = stepping.trial, stepping.record.work
    lost, by_friction, passed, impacts = 0.0, 0.0, 0.0, 0
    for j in range(structure.gap.size):
        before, after = gap_rate(structure, j, state.v), gap_rate(structure, j, trial.v)
        # An impulse takes -p (γ₀ + γ₁)/2.
        lost -= 0.5 * trial.contact[j] * (before + after)
        if trial.contact[j] > 0.0 and before < -still:
            passed -= trial.contact[j] * before
            impacts += 1
    for j in range(structure.gap.size):
        if structure.friction[j] > 0.0:
            by_friction += _keep_rubbing(j, h, impacts > 0, rubbed, stepping)
    gained = False
    if impacts > 0:
        # Without friction only what restitutions contradict each other in could.
        gained = by_friction != 0.0 and lost + by_friction < -GAINED_IN_STEP * passed
        lost, by_friction = lost + by_friction, 0.0
    work[CONTACT] += lost
    work[FRICTION] += by_friction
    return lost, impacts, gained


@step_kernel
def _list_slide(
    j: int, t: float, still: float, group: int, active: Active, stepping: Stepping
) -> int:
    """Write down that a contact at rest begins to stick or to slip; group of the step's events."""
    kind, now = -1, stepping.record.now[0]
    if active.resting[j]:
        rate = slip_rate(stepping.structure, j, stepping.trial.v)
        kind = kind_of_slide(rate if abs(rate) > still else 0.0)
        if kind != active.slides[j]:
            group = new_group(now) if group < 0 else group
            write_slide(t, kind, j, group, now, stepping.record.events)
    active.slides[j] = kind
    return group


@step_kernel
def _close_step(step: FixedStep, active: Active, stepping: Stepping) -> int:
    """Write the events of a step, and make forces of its impulses; an outcome."""
    structure, state = stepping.structure, stepping.state
    trial, resting = stepping.trial, active.resting
    now, events, t = stepping.record.now[0], stepping.record.events, step.start
    still, group = STILL_GAP_RATE * structure.speed, -1
    lost, impacts, gained = _take_losses(step.h, still, active.rubbed, stepping)
    if gained:
        return GAINED
    for j in range(structure.gap.size):
        p = trial.contact[j]
        before, after = gap_rate(structure, j, state.v), gap_rate(structure, j, trial.v)
        rests = active.marked[j] and abs(before) <= still and abs(after) <= still
        strikes = p > 0.0 and before < -still and not active.struck[j]
        if group < 0 and (strikes or rests != resting[j]):
            group = new_group(now)
        if strikes:
            write_event(EventRow(t, IMPACT, group, j, before, after, p, lost, 1), now, events)
            # The first row of a problem stands for its whole loss.
            lost = 0.0
        if rests and not resting[j]:
            write_event(EventRow(t, REST, group, j, 0.0, 0.0, 0.0, 0.0, 1), now, events)
        elif resting[j] and not rests:
            row = EventRow(t, DETACHMENT, group, j, 0.0, after, 0.0, 0.0, 1)
            write_event(row, now, events)
        resting[j] = rests
        if structure.friction[j] > 0.0:
            group = _list_slide(j, t, still, group, active, stepping)
        active.struck[j] = p > 0.0
        if not rests:
            trial.contact[j] = trial.rubbing[j] = 0.0
        elif impacts > 0:
            # Its impulse answers the impact elsewhere, so p/h is no force.
            trial.contact[j], trial.rubbing[j] = state.contact[j], state.rubbing[j]
        else:
            trial.contact[j], trial.rubbing[j] = p / step.h, trial.rubbing[j] / step.h
    return DONE


@step_kernel
def _take_step(step: FixedStep, active: Active, stepping: Stepping) -> int:
    """The rule; an outcome."""
    outcome = _solve_step(step, active, stepping)
    return _close_step(step, active, stepping) if outcome == DONE else outcome


@scalar_kernel.but(recipe=SMALL)
def advance(span: Span, forcing: Forcing, active: Active, stepping: Stepping) -> tuple[int, int]:
    """Take steps; see `eventpound.solvers.timestepping.run.Advance`."""
    return take_steps(_take_step, 3 * active.marked.size, span, forcing, active, stepping)
