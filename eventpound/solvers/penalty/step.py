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
from eventpound.numerics.banded import factor_banded, solve_banded
from eventpound.solvers.events.cascade import EVENTS
from eventpound.solvers.events.event_rows import IMPACT, EventRow, new_group, write_event
from eventpound.solvers.penalty.elements import Elements, element_force
from eventpound.solvers.timestepping.compiled import step_kernel, step_loop
from eventpound.solvers.timestepping.equations import (
    Step,
    balanced,
    couple,
    end_of_step,
    end_step,
    fill_newton_matrix,
    momentum_residual,
    predict,
)
from eventpound.solvers.timestepping.record import (
    CONTACT,
    DONE,
    NO_ROOM,
    NOT_CONVERGED,
    Span,
    Stepping,
    add_to_ends,
    copy_values,
    gap_of,
    gap_rate,
    pull_together,
)

MOST_ITERATIONS = 60
MOST_HALVINGS = 40


@step_kernel
def _take_elements(step: Step, elements: Elements, run: Stepping) -> None:
    """Take the forces of the elements into the balance, their slopes into `pressing`."""
    structure, state, trial, equations = run.structure, run.state, run.trial, run.equations
    half = 0.5 * step.h
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        penetration = -gap_of(structure, j, trial.u)
        force, by_penetration, equations.pressing[j] = 0.0, 0.0, 0.0
        if penetration > 0.0:
            force, by_penetration, by_rate = element_force(
                j,
                elements,
                penetration,
                -gap_rate(structure, j, trial.v),
                run.touch.approach[j],
                max(0.0, gap_of(structure, j, state.u)),
            )
            equations.pressing[j] = half * (by_rate + half * by_penetration)
        trial.contact[j] = force
        pull_together(equations.residual, left, right, half * (force + state.contact[j]))
        # δ is a difference of lengths, and its rounding one of the force.
        lengths = abs(structure.gap[j])
        if left >= 0:
            lengths += abs(trial.u[left])
        if right >= 0:
            lengths += abs(trial.u[right])
        size = abs(force) + abs(state.contact[j]) + abs(by_penetration * lengths)
        add_to_ends(equations.terms, left, right, half * size)


@step_kernel
def _evaluate(step: Step, elements: Elements, run: Stepping) -> float:
    """Residual of the trial velocities; returns its size, ``Σ r²/m`` (J)."""
    end_of_step(step.h, run)
    momentum_residual(step, run)
    _take_elements(step, elements, run)
    total = 0.0
    for b in range(run.structure.mass.size):
        total += run.equations.residual[b] ** 2 / run.structure.mass[b]
    return total


@step_kernel
def _newton_increment(h: float, run: Stepping) -> bool:
    """Solve Newton's equations for the increment of the velocities."""
    structure, equations = run.structure, run.equations
    fill_newton_matrix(h, run)
    for j in range(structure.gap.size):
        if equations.pressing[j] != 0.0:
            left, right = structure.left[j], structure.right[j]
            couple(equations.band, left, right, equations.pressing[j])
    if not factor_banded(equations.band):
        return False
    copy_values(equations.residual, equations.increment)
    solve_banded(equations.band, equations.increment)
    return True


@step_kernel
def _solve_step(step: Step, elements: Elements, run: Stepping) -> int:
    """Newton's iteration for the end of the step; an outcome."""
    structure, v, contact = run.structure, run.trial.v, run.state.contact
    predict(step, run)
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        if left >= 0:
            v[left] -= step.h * contact[j] / structure.mass[left]
        if right >= 0:
            v[right] += step.h * contact[j] / structure.mass[right]
    size = _evaluate(step, elements, run)
    for _ in range(MOST_ITERATIONS):
        if balanced(run):
            return DONE
        if not _newton_increment(step.h, run):
            return NOT_CONVERGED
        copy_values(v, elements.origin)
        length = 1.0
        for _ in range(MOST_HALVINGS):
            for b in range(v.size):
                v[b] = elements.origin[b] - length * run.equations.increment[b]
            new_size = _evaluate(step, elements, run)
            if new_size < size or balanced(run):
                break
            length *= 0.5
        size = new_size
    return NOT_CONVERGED


@step_kernel
def _take_closing_rates(run: Stepping) -> None:
    """Take the rate of every open gap as the one it may close with in this step (m/s)."""
    structure, state, touch = run.structure, run.state, run.touch
    for j in range(structure.gap.size):
        if not touch.closed[j]:
            touch.before[j] = gap_rate(structure, j, state.v)
            # What is pressed shut at the start has never closed.
            open_gap = gap_of(structure, j, state.u) >= 0.0
            touch.approach[j] = max(0.0, -touch.before[j]) if open_gap else 0.0


@step_kernel
def _follow_contacts(step: Step, run: Stepping) -> None:
    """Sum impulse and work of the contacts over a step; write those that end.

    The time in contact of an element is one impact, from its closing to its opening.
    """
    structure, state, trial, touch = run.structure, run.state, run.trial, run.touch
    counters, t, h = run.record.counters, step.start, step.h
    for j in range(structure.gap.size):
        gap_0, gap_1 = gap_of(structure, j, state.u), gap_of(structure, j, trial.u)
        rate_0, rate_1 = gap_rate(structure, j, state.v), gap_rate(structure, j, trial.v)
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
        run.record.work[CONTACT] += lost
        if gap_1 >= 0.0:
            touch.closed[j] = False
            touch.longest[j] = max(touch.longest[j], t + h - touch.since[j])
            group, since, before = new_group(counters), touch.since[j], touch.before[j]
            impulse, lost = touch.impulse[j], touch.lost[j]
            row = EventRow(since, IMPACT, group, j, before, rate_1, impulse, lost, 1)
            write_event(row, counters, run.record.events)


@step_loop
def advance(span: Span, forcing: Forcing, elements: Elements, run: Stepping) -> tuple[int, int]:
    """Take steps; see `eventpound.solvers.timestepping.run.Advance`."""
    counters = run.record.counters
    ground = ground_acceleration(forcing, forcing.start + span.first * span.h)
    for i in range(span.first, span.last):
        if counters[EVENTS] + elements.kind.size > run.record.events.shape[0]:
            return i, NO_ROOM
        start, end = forcing.start + i * span.h, forcing.start + (i + 1) * span.h
        ground_end = ground_acceleration(forcing, end)
        step = Step(start, end, span.h, ground_end, 0.5 * (ground + ground_end))
        _take_closing_rates(run)
        outcome = _solve_step(step, elements, run)
        if outcome != DONE:
            return i, outcome
        _follow_contacts(step, run)
        end_step(step, run)
        ground = ground_end
    return span.last, DONE
