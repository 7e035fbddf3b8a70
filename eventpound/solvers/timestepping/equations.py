"""The implicit equations of one step of length h, θ being that of the rule.

    M (v₁ - v₀) = h [(1-θ) f₀ + θ f₁] - h M 1 [(1-θ) a₀ + θ a₁] + (what contacts put in)
    u₁ = u₀ + h [(1-θ) v₀ + θ v₁]

with f(u, v, z) the forces of the links and a the ground acceleration (J. J.
Moreau 1988; M. Jean, Comput. Methods Appl. Mech. Engrg 177, 1999, 235-257). With
θ = 1/2 this is Newmark's method of average acceleration (N. M. Newmark, J. Eng.
Mech. Div. ASCE 85, 1959, 67-94) written in velocities. Newton's matrix is
``M + h θ (C + h θ K)``, C and K being the tangents of the links.

A law with a memory does not know time: with σ the sign of the change Δx of the elongation
over the step, ``y = σ z`` follows

    y' = |Δx| g(y),   g = dz/dx  (`eventpound.mechanics.elements.z_slopes`)

over a step of length one. It is solved by the L-stable implicit Runge-Kutta
method of two stages and order two (R. Alexander, SIAM J. Numer. Anal. 14,
1977, 1006-1021, γ = 1 - 1/√2), each stage by Newton's method. The trapezoid
rule would swing about the knee, where |z|^20 is stiff; backward Euler, the
usual choice, would make every stepper first order. A reversal within a step
is seen as the net change, an error of second order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from eventpound.mechanics.elements import pull_per_z, z_slopes
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import LOADED, add_body_loads
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import step_kernel
from eventpound.solvers.timestepping.stepping import (
    DONE,
    HYSTERETIC,
    INPUT,
    NO_ROOM,
    VISCOUS,
    Equations,
    Span,
    Stepping,
    Structure,
    add_to_ends,
    copy_values,
    hand_on,
    hand_on_sizes,
    pull_together,
    record_step,
)
from eventpound.tolerances import BALANCE, BALANCE_ROUNDING, ITERATED

DIAGONAL = 1.0 - 1.0 / math.sqrt(2.0)
"""γ of the method."""
MOST_ITERATIONS = 60


@step_kernel
def _stage(
    a: int, memory: Floats, known: float, length: float, bound: float
) -> tuple[float, float, float]:
    """Solve ``y = known + length g(y)``; returns y, g(y) and g'(y), numbers that are none in vain.

    Above zero the equation is convex, so Newton's method comes down from the
    bound without fail.
    """
    # Above zero g is largest at zero, and loading ends at the bound: y is beyond neither.
    y = min(known + length * z_slopes(a, memory, 1.0, 0.0, 0.0)[0], max(bound, known))
    for _ in range(MOST_ITERATIONS):
        g, g_y = z_slopes(a, memory, 1.0, y, 0.0)
        change = (y - known - length * g) / (1.0 - length * g_y)
        y -= change
        if abs(change) <= ITERATED * max(1.0, abs(y)):
            g, g_y = z_slopes(a, memory, 1.0, y, 0.0)
            return y, g, g_y
    return math.nan, math.nan, math.nan


@step_kernel
def z_after(a: int, memory: Floats, z: float, change: float, bound: float) -> tuple[float, float]:
    """Return z at the end of a step and its derivative by the elongation.

    Parameters
    ----------
    a : int
        Number of the link.
    memory : ndarray, shape (L, constants)
        Constants of the laws.
    z : float
        At the start of the step.
    change : float
        Δx (m).
    bound : float
        Largest |z| that loading can reach.

    Returns
    -------
    z, z_x : float
        z and ∂z/∂Δx (1/m); not numbers where a stage has no solution.
    """
    # Along its direction every change of x is loading or unloading of y = σ z.
    sign, length = 1.0 if change >= 0.0 else -1.0, abs(change)
    start = sign * z
    implicit, explicit = DIAGONAL * length, (1.0 - DIAGONAL) * length
    _, g_1, slope_1 = _stage(a, memory, start, implicit, bound)
    y_2, g_2, slope_2 = _stage(a, memory, start + explicit * g_1, implicit, bound)
    # The derivative by the length follows from those of the two stages.
    by_1 = DIAGONAL * g_1 / (1.0 - implicit * slope_1)
    by_2 = (1.0 - DIAGONAL) * g_1 + explicit * slope_1 * by_1 + DIAGONAL * g_2
    # The second stage is the result. In the derivative the signs of z = σ y and Δx = σ |Δx| cancel.
    return sign * y_2, by_2 / (1.0 - implicit * slope_2)


class FixedStep(NamedTuple):
    """A step: its start, end and length h (s), ground acceleration at its end and by θ (m/s²)."""

    start: float
    end: float
    h: float
    ground_end: float
    ground: float


@step_kernel
def _step_of(i: int, span: Span, ground: float, forcing: Forcing, theta: float) -> FixedStep:
    """Step i of a span, at whose start the ground has this acceleration (m/s²)."""
    # Not by adding h up, which would add its rounding up, too.
    start, end = forcing.start + i * span.h, forcing.start + (i + 1) * span.h
    ground_end = ground_acceleration(forcing, end)
    return FixedStep(start, end, span.h, ground_end, (1.0 - theta) * ground + theta * ground_end)


@step_kernel
def predict(step: FixedStep, stepping: Stepping) -> None:
    """Velocities at the end of the step if the forces of the links stayed."""
    state, mass = stepping.state, stepping.structure.mass
    load = stepping.equations.load[0]
    for b in range(mass.size):
        stepping.trial.v[b] = state.v[b] + step.h * ((state.f[b] + load[b]) / mass[b] - step.ground)
    place_points(stepping.structure.weights, stepping.trial.v)


@step_kernel
def end_of_step(h: float, stepping: Stepping) -> None:
    """Displacements and forces of the links at the end of a step, from the trial velocities.

    The sizes of the forces are left in `terms`.
    """
    structure, state = stepping.structure, stepping.state
    trial, equations = stepping.trial, stepping.equations
    theta, elastic, law = structure.theta, structure.elastic, structure.law
    stepping.record.progress[0].evaluations += 1
    for b in range(structure.mass.size):
        trial.u[b] = state.u[b] + h * ((1.0 - theta) * state.v[b] + theta * trial.v[b])
    for b in range(trial.f.size):
        trial.f[b] = equations.terms[b] = 0.0
    place_points(structure.weights, trial.u)
    for link in range(structure.bound.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        x = difference(trial.u, first, second) - elastic.offset[link]
        rate = difference(trial.v, first, second)
        k = elastic.compression[link] if x < 0.0 else elastic.extension[link]
        z, slope, place = 0.0, k, structure.z_of_link[link]
        if place >= 0:
            before = difference(state.v, first, second)
            # u₁ - u₀ by the rule itself, without the rounding of a difference.
            change = h * ((1.0 - theta) * before + theta * rate)
            bound = structure.bound[link]
            z, z_x = z_after(link, law.memory, state.z[place], change, bound)
            trial.z[place] = z
            slope += pull_per_z(link, law.memory) * z_x
        force = k * x + pull_per_z(link, law.memory) * z
        # Springs are listed without their dashpots.
        trial.link[link], equations.slope[link] = force, slope
        force += law.damping[link] * rate
        pull_together(trial.f, first, second, force)
        add_to_ends(equations.terms, first, second, abs(force))
    hand_on(structure.weights, trial.f)
    hand_on_sizes(structure.weights, equations.terms)


@step_kernel
def momentum_residual(step: FixedStep, stepping: Stepping) -> None:
    """What is missing in the balance of momentum without contacts (N s)."""
    structure, state = stepping.structure, stepping.state
    trial, equations = stepping.trial, stepping.equations
    theta, h = structure.theta, step.h
    for b in range(structure.mass.size):
        m = structure.mass[b]
        f = (1.0 - theta) * state.f[b] + theta * trial.f[b] + equations.load[0, b]
        equations.residual[b] = m * (trial.v[b] - state.v[b]) - h * (f - m * step.ground)
        equations.terms[b] = m * (abs(trial.v[b]) + abs(state.v[b])) + h * (
            equations.terms[b] + abs(state.f[b]) + abs(equations.load[0, b]) + m * abs(step.ground)
        )


@step_kernel
def balanced(stepping: Stepping) -> bool:
    """Whether nothing but the tolerance of Newton's method or rounding is missing."""
    structure, equations = stepping.structure, stepping.equations
    for b in range(structure.mass.size):
        allowed = BALANCE * structure.speed * structure.mass[b]
        # So asked, a number that is none is no balance.
        if not abs(equations.residual[b]) <= allowed + BALANCE_ROUNDING * equations.terms[b]:
            return False
    return True


@step_kernel
def couple(band: Floats, first: int, second: int, value: float) -> None:
    """Add ``value (e_second - e_first)(e_second - e_first)ᵀ`` to a lower band."""
    if first >= 0:
        band[first, 0] += value
    if second >= 0:
        band[second, 0] += value
    if first >= 0 and second >= 0:
        # The lower triangle alone is kept, by its distance from the diagonal.
        band[max(first, second), abs(first - second)] -= value


@step_kernel
def _couple_at_points(
    structure: Structure, first: int, second: int, value: float, equations: Equations
) -> None:
    """The same of a link with an end at a point, the band being the whole lower triangle."""
    # A row of it, in the room of what is solved for later.
    row = equations.increment
    for b in range(row.size):
        row[b] = 0.0
    pull_together(row, first, second, 1.0)
    hand_on(structure.weights, row)
    for b in range(structure.mass.size):
        for c in range(b + 1):
            equations.band[b, b - c] += value * row[b] * row[c]


@step_kernel
def fill_newton_matrix(h: float, stepping: Stepping) -> None:
    """``M + h θ (C + h θ K)`` at the trial state, contacts apart."""
    structure, equations = stepping.structure, stepping.equations
    reach = h * structure.theta
    equations.band[:, :] = 0.0
    for b in range(structure.mass.size):
        equations.band[b, 0] = structure.mass[b]
    for link in range(structure.bound.size):
        # ∂u₁/∂v₁ = h θ.
        value = reach * (structure.law.damping[link] + reach * equations.slope[link])
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        if max(first, second) < structure.mass.size:
            couple(equations.band, first, second, value)
        else:
            _couple_at_points(structure, first, second, value, equations)


@step_kernel
def _add_work(step: FixedStep, stepping: Stepping) -> None:
    """Add the step's input, viscous and hysteretic work (J), forces by θ, paths by the mean."""
    structure, state = stepping.structure, stepping.state
    trial, work = stepping.trial, stepping.record.work
    theta, law, h = structure.theta, structure.law, step.h
    for b in range(structure.mass.size):
        # With the mean velocity M (v₁ - v₀) does exactly the change of the kinetic energy.
        mean = 0.5 * (state.v[b] + trial.v[b])
        work[INPUT] -= h * structure.mass[b] * mean * step.ground
        work[INPUT] += h * stepping.equations.load[0, b] * mean
    for link in range(structure.bound.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        before, after = difference(state.v, first, second), difference(trial.v, first, second)
        path = 0.5 * h * (before + after)
        rate = (1.0 - theta) * before + theta * after
        work[VISCOUS] += law.damping[link] * rate * path
        place = structure.z_of_link[link]
        if place >= 0:
            z = (1.0 - theta) * state.z[place] + theta * trial.z[place]
            work[HYSTERETIC] += pull_per_z(link, law.memory) * z * path


@step_kernel
def _end_step(step: FixedStep, stepping: Stepping) -> None:
    """Make the end of the step the present state, and record it."""
    _add_work(step, stepping)
    state, trial = stepping.state, stepping.trial
    copy_values(trial.u, state.u)
    copy_values(trial.v, state.v)
    copy_values(trial.f, state.f)
    copy_values(trial.z, state.z)
    copy_values(trial.link, state.link)
    copy_values(trial.contact, state.contact)
    copy_values(trial.rubbing, state.rubbing)
    stepping.record.progress[0].steps += 1
    record_step(step.end, step.ground_end, stepping)


@step_kernel
def _take_loads(t: float, forcing: Forcing, stepping: Stepping) -> None:
    """Loads of the step that ends at t (s), those at its start being known."""
    load, theta = stepping.equations.load, stepping.structure.theta
    for b in range(load.shape[1]):
        load[0, b], load[1, b] = (1.0 - theta) * load[1, b], 0.0
    # None of them drives a support.
    add_body_loads(forcing, t, load[1], stepping.equations.terms)
    for b in range(load.shape[1]):
        load[0, b] += theta * load[1, b]


@step_kernel
def take_steps(
    take: Callable[[FixedStep, Any, Stepping], int],
    most_events: int,
    span: Span,
    forcing: Forcing,
    contacts: Any,
    stepping: Stepping,
) -> tuple[int, int]:
    """Take the steps of a span; see `eventpound.solvers.timestepping.run.Advance`.

    Parameters
    ----------
    take : callable
        The rule of a method: takes one step, writes its events, returns an outcome.
    most_events : int
        Of one step.
    span, forcing, contacts, stepping
        Of `Advance`.
    """
    now = stepping.record.now[0]
    ground = ground_acceleration(forcing, forcing.start + span.first * span.h)
    loaded = forcing.family == LOADED
    if loaded:
        _take_loads(forcing.start + span.first * span.h, forcing, stepping)
    for i in range(span.first, span.last):
        # No step begins whose events may find no room, as none can be taken back.
        if now.events + most_events > stepping.record.events.shape[0]:
            return i, NO_ROOM
        step = _step_of(i, span, ground, forcing, stepping.structure.theta)
        if loaded:
            _take_loads(step.end, forcing, stepping)
        outcome = take(step, contacts, stepping)
        if outcome != DONE:
            return i, outcome
        _end_step(step, stepping)
        ground = step.ground_end
    return span.last, DONE
