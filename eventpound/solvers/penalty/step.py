"""One step of Newmark's average acceleration with contact elements.

    M (v₁ - v₀) = h/2 (f₀ + W F₀ + f₁ + W F₁) - h/2 M 1 (a₀ + a₁)
    u₁ = u₀ + h/2 (v₀ + v₁)

with F(δ, δ') the forces of the elements (`eventpound.solvers.penalty.elements`),
solved for v₁ by Newton's method; a step of the iteration is halved until it
brings the balance of momentum nearer.
"""

from __future__ import annotations

from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Floats
from eventpound.numerics.banded import factor_banded, solve_banded
from eventpound.solvers.events.cascade import EVENTS, GROUPS
from eventpound.solvers.events.event_rows import IMPACT, EventRow, write_event
from eventpound.solvers.penalty.elements import Elements, element_force
from eventpound.solvers.timestepping.compiled import step_kernel, step_loop
from eventpound.solvers.timestepping.equations import (
    add_work,
    balanced,
    copy_values,
    couple,
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
    Span,
    Stepping,
    end_step,
)
from eventpound.solvers.timestepping.structure import CONTACT, State, Structure, Touch, Trial

MOST_ITERATIONS = 60
MOST_HALVINGS = 40


@step_kernel
def _size(gap: float, u: Floats, left: int, right: int) -> float:
    """Sum of the sizes of the lengths that make a gap (m)."""
    total = abs(gap)
    if left >= 0:
        total += abs(u[left])
    if right >= 0:
        total += abs(u[right])
    return total


@step_kernel
def _take_elements(
    structure: Structure,
    elements: Elements,
    h: float,
    state: State,
    trial: Trial,
    touch: Touch,
) -> None:
    """Take the forces of the elements into the balance, their slopes into `pressing`."""
    half = 0.5 * h
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        penetration = -structure.gap[j] - difference(trial.u, left, right)
        force, by_penetration, trial.pressing[j] = 0.0, 0.0, 0.0
        if penetration > 0.0:
            force, by_penetration, by_rate = element_force(
                j,
                elements,
                penetration,
                -difference(trial.v, left, right),
                touch.approach[j],
                max(0.0, structure.gap[j] + difference(state.u, left, right)),
            )
            trial.pressing[j] = half * (by_rate + half * by_penetration)
        trial.contact[j] = force
        pull_together(trial.residual, left, right, half * (force + state.contact[j]))
        # δ is a difference of lengths, and its rounding one of the force.
        rounded = by_penetration * _size(structure.gap[j], trial.u, left, right)
        for b in (left, right):
            if b >= 0:
                trial.terms[b] += half * (abs(force) + abs(state.contact[j]) + abs(rounded))


@step_kernel
def _evaluate(
    structure: Structure,
    elements: Elements,
    h: float,
    ground: float,
    state: State,
    trial: Trial,
    touch: Touch,
) -> float:
    """Residual of the trial velocities; returns its size, ``Σ r²/m`` (J)."""
    end_of_step(structure, h, state, trial)
    momentum_residual(structure, h, ground, state, trial)
    _take_elements(structure, elements, h, state, trial, touch)
    total = 0.0
    for b in range(structure.mass.size):
        total += trial.residual[b] ** 2 / structure.mass[b]
    return total


@step_kernel
def _newton_increment(structure: Structure, h: float, trial: Trial) -> bool:
    """Solve Newton's equations for the increment of the velocities."""
    fill_newton_matrix(structure, h, trial)
    for j in range(structure.gap.size):
        if trial.pressing[j] != 0.0:
            couple(trial.band, structure.left[j], structure.right[j], trial.pressing[j])
    if not factor_banded(trial.band):
        return False
    copy_values(trial.residual, trial.increment)
    solve_banded(trial.band, trial.increment)
    return True


@step_kernel
def _solve_step(
    structure: Structure,
    elements: Elements,
    h: float,
    ground: float,
    state: State,
    trial: Trial,
    touch: Touch,
) -> int:
    """Newton's iteration for the end of the step; an outcome."""
    for b in range(structure.mass.size):
        trial.v[b] = state.v[b] + h * (state.f[b] / structure.mass[b] - ground)
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        if left >= 0:
            trial.v[left] -= h * state.contact[j] / structure.mass[left]
        if right >= 0:
            trial.v[right] += h * state.contact[j] / structure.mass[right]
    size = _evaluate(structure, elements, h, ground, state, trial, touch)
    for _ in range(MOST_ITERATIONS):
        if balanced(structure, trial):
            return DONE
        if not _newton_increment(structure, h, trial):
            return NOT_CONVERGED
        copy_values(trial.v, elements.origin)
        length = 1.0
        for _ in range(MOST_HALVINGS):
            for b in range(structure.mass.size):
                trial.v[b] = elements.origin[b] - length * trial.increment[b]
            new_size = _evaluate(structure, elements, h, ground, state, trial, touch)
            if new_size < size or balanced(structure, trial):
                break
            length *= 0.5
        size = new_size
    return NOT_CONVERGED


@step_kernel
def _take_closing_rates(structure: Structure, state: State, touch: Touch) -> None:
    """Take the rate of every open gap as the one it may close with in this step (m/s)."""
    for j in range(structure.gap.size):
        if not touch.closed[j]:
            left, right = structure.left[j], structure.right[j]
            touch.before[j] = difference(state.v, left, right)
            # What is pressed shut at the start has never closed.
            open_gap = structure.gap[j] + difference(state.u, left, right) >= 0.0
            touch.approach[j] = max(0.0, -touch.before[j]) if open_gap else 0.0


@step_kernel
def _follow_contacts(t: float, h: float, run: Stepping) -> None:
    """Sum impulse and work of the contacts over a step from t (s); write those that end.

    The time in contact of an element is one impact, from its closing to its opening.
    """
    structure, state, trial, touch = run.structure, run.state, run.trial, run.touch
    counters = state.counters
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
            group, since, before = counters[GROUPS], touch.since[j], touch.before[j]
            impulse, lost = touch.impulse[j], touch.lost[j]
            row = EventRow(since, IMPACT, group, j, before, rate_1, impulse, lost, 1)
            write_event(row, counters, run.record.events)
            counters[GROUPS] += 1


@step_loop
def advance(span: Span, forcing: Forcing, elements: Elements, run: Stepping) -> tuple[int, int]:
    """Take steps.

    Parameters
    ----------
    span : Span
        The steps.
    forcing : Forcing
        The ground motion.
    elements, run
        What the run works on.

    Returns
    -------
    int, int
        Number of the step before which it stopped, and one of
        `eventpound.solvers.timestepping.record`.
    """
    structure, state, trial, touch = run.structure, run.state, run.trial, run.touch
    h = span.h
    a_0 = ground_acceleration(forcing, forcing.start + span.first * h)
    for i in range(span.first, span.last):
        if state.counters[EVENTS] + structure.gap.size > run.record.events.shape[0]:
            return i, NO_ROOM
        t_0, t_1 = forcing.start + i * h, forcing.start + (i + 1) * h
        a_1 = ground_acceleration(forcing, t_1)
        ground = 0.5 * (a_0 + a_1)
        _take_closing_rates(structure, state, touch)
        outcome = _solve_step(structure, elements, h, ground, state, trial, touch)
        if outcome != DONE:
            return i, outcome
        add_work(structure, h, ground, state, trial)
        _follow_contacts(t_0, h, run)
        end_step(t_1, a_1, run)
        a_0 = a_1
    return span.last, DONE
