"""One step of Newmark's average acceleration with contact elements.

    M (v₁ - v₀) = h/2 (f₀ + W F₀ + f₁ + W F₁) - h/2 M 1 (a₀ + a₁)
    u₁ = u₀ + h/2 (v₀ + v₁)

with F(δ, δ') the forces of the elements (`eventpound.solvers.penalty.elements`),
solved for v₁ by Newton's method; a step of the iteration is halved until it
brings the balance of momentum nearer.
"""

from __future__ import annotations

from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.banded import factor_banded, solve_banded
from eventpound.numerics.compiled import scalar_kernel, step_kernel
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.solvers.events.law_contacts import (
    CLOSED,
    DRAG,
    add_share,
    closing_drag,
    switch_touch,
    write_touch,
)
from eventpound.solvers.events.run import Laws
from eventpound.solvers.penalty.elements import PenaltyElements, element_force
from eventpound.solvers.timestepping.equations import (
    FixedStep,
    balanced,
    couple,
    end_of_step,
    fill_newton_matrix,
    momentum_residual,
    predict,
    take_steps,
)
from eventpound.solvers.timestepping.stepping import (
    CONTACT,
    DONE,
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
def _take_elements(step: FixedStep, elements: PenaltyElements, stepping: Stepping) -> None:
    """Take the forces of the elements into the balance, their slopes into `pressing`."""
    structure, state = stepping.structure, stepping.state
    trial, equations = stepping.trial, stepping.equations
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
                max(0.0, gap_of(structure, j, state.u)),
            )
            # u₁ has h/2 of v₁ in it, so a slope by the depth counts with a factor h/2 more.
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
def _evaluate(step: FixedStep, elements: PenaltyElements, stepping: Stepping) -> float:
    """Residual of the trial velocities; returns its size, ``Σ r²/m`` (J)."""
    end_of_step(step.h, stepping)
    momentum_residual(step, stepping)
    _take_elements(step, elements, stepping)
    total = 0.0
    for b in range(stepping.structure.mass.size):
        total += stepping.equations.residual[b] ** 2 / stepping.structure.mass[b]
    return total


@step_kernel
def _newton_increment(h: float, stepping: Stepping) -> bool:
    """Solve Newton's equations for the increment of the velocities."""
    structure, equations = stepping.structure, stepping.equations
    fill_newton_matrix(h, stepping)
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
def _solve_step(step: FixedStep, elements: PenaltyElements, stepping: Stepping) -> int:
    """Newton's iteration for the end of the step; an outcome."""
    structure, v, contact = stepping.structure, stepping.trial.v, stepping.state.contact
    predict(step, stepping)
    # As if the contact forces stayed, as `predict` has it of the links.
    for j in range(structure.gap.size):
        left, right = structure.left[j], structure.right[j]
        if left >= 0:
            v[left] -= step.h * contact[j] / structure.mass[left]
        if right >= 0:
            v[right] += step.h * contact[j] / structure.mass[right]
    size = _evaluate(step, elements, stepping)
    for _ in range(MOST_ITERATIONS):
        if balanced(stepping):
            return DONE
        if not _newton_increment(step.h, stepping):
            return NOT_CONVERGED
        copy_values(v, elements.origin)
        length = 1.0
        for _ in range(MOST_HALVINGS):
            for b in range(v.size):
                v[b] = elements.origin[b] - length * stepping.equations.increment[b]
            new_size = _evaluate(step, elements, stepping)
            if new_size < size or balanced(stepping):
                break
            length *= 0.5
        size = new_size
    return NOT_CONVERGED


@step_kernel
def _take_closing_drags(laws: Laws, stepping: Stepping) -> None:
    """Let the damping of every open element be as if it closed at the start of this step."""
    structure, state = stepping.structure, stepping.state
    for j in range(structure.gap.size):
        if laws.touch[CLOSED, j] == 0.0:
            gap, rate = gap_of(structure, j, state.u), gap_rate(structure, j, state.v)
            laws.touch[DRAG, j] = closing_drag(j, gap, rate, 0.0, laws)


@step_kernel
def _follow_contacts(step: FixedStep, laws: Laws, stepping: Stepping) -> None:
    """Sum impulse and work of the contacts over a step; write those that end.

    The time in contact of an element is one impact, from its closing to its opening.
    """
    structure, state = stepping.structure, stepping.state
    trial, record = stepping.trial, stepping.record
    t, h = step.start, step.h
    for j in range(structure.gap.size):
        gap_0, gap_1 = gap_of(structure, j, state.u), gap_of(structure, j, trial.u)
        rate_0, rate_1 = gap_rate(structure, j, state.v), gap_rate(structure, j, trial.v)
        if gap_1 < 0.0:
            # Where the chord of the gap is zero.
            ahead = h * max(0.0, gap_0) / (max(0.0, gap_0) - gap_1)
            switch_touch(j, True, gap_0, rate_0, 0.0, laws, t + ahead)
        if laws.touch[CLOSED, j] == 0.0:
            continue
        force, rate = state.contact[j] + trial.contact[j], 0.5 * (rate_0 + rate_1)
        add_share(j, 0.5 * h, force, rate, laws)
        # By the mean force and the mean rate, as the rule itself has them.
        record.work[CONTACT] -= 0.5 * h * force * rate
        if switch_touch(j, gap_1 < 0.0, gap_1, rate_1, 0.0, laws, t + h):
            write_touch(j, rate_1, laws, record.now[0], record.events)


@step_kernel
def _take_step(step: FixedStep, elements: PenaltyElements, stepping: Stepping) -> int:
    """The rule; an outcome."""
    _take_closing_drags(elements.laws, stepping)
    outcome = _solve_step(step, elements, stepping)
    if outcome == DONE:
        _follow_contacts(step, elements.laws, stepping)
    return outcome


@scalar_kernel.but(recipe=SMALL)
def advance(
    span: Span, forcing: Forcing, elements: PenaltyElements, stepping: Stepping
) -> tuple[int, int]:
    """Take steps; see `eventpound.solvers.timestepping.run.Advance`."""
    return take_steps(_take_step, elements.stiffness.size, span, forcing, elements, stepping)
