"""The implicit equations of one step of length h, θ being that of the rule.

    M (v₁ - v₀) = h [(1-θ) f₀ + θ f₁] - h M 1 [(1-θ) a₀ + θ a₁] + (what contacts put in)
    u₁ = u₀ + h [(1-θ) v₀ + θ v₁]

with f(u, v, z) the forces of the links and a the ground acceleration (J. J.
Moreau 1988; M. Jean, Comput. Methods Appl. Mech. Engrg 177, 1999, 235-257). With
θ = 1/2 this is Newmark's method of average acceleration (N. M. Newmark, J. Eng.
Mech. Div. ASCE 85, 1959, 67-94) written in velocities. Newton's matrix is
``M + h θ (C + h θ K)``, C and K being the tangents of the links.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.solvers.timestepping.compiled import step_kernel
from eventpound.solvers.timestepping.hysteresis import z_after
from eventpound.solvers.timestepping.structure import (
    EVALUATIONS,
    HYSTERETIC,
    INPUT,
    NEWTON_TOLERANCE,
    VISCOUS,
    State,
    Structure,
    Trial,
)

ROUNDING = 64.0 * 2.220446049250313e-16
"""Part of the sum of its terms up to which a balance of momentum is rounding."""


@step_kernel
def copy_values(source: Floats, target: Floats) -> None:
    """Copy a row; an assignment of slices would make an array."""
    for i in range(source.size):
        target[i] = source[i]


@step_kernel
def difference(values: Floats, first: int, second: int) -> float:
    """``value_second - value_first``, where -1 stands for the ground or a barrier."""
    total = 0.0
    if second >= 0:
        total += values[second]
    if first >= 0:
        total -= values[first]
    return total


@step_kernel
def pull_together(values: Floats, first: int, second: int, force: float) -> None:
    """Add a force to the first end and take it from the second."""
    if first >= 0:
        values[first] += force
    if second >= 0:
        values[second] -= force


@step_kernel
def end_of_step(structure: Structure, h: float, state: State, trial: Trial) -> None:
    """Displacements and forces of the links at the end of a step, from the trial velocities.

    The sizes of the forces are left in `terms`.
    """
    theta = structure.theta
    state.counters[EVALUATIONS] += 1
    for b in range(structure.mass.size):
        trial.u[b] = state.u[b] + h * ((1.0 - theta) * state.v[b] + theta * trial.v[b])
        trial.f[b] = 0.0
        trial.terms[b] = 0.0
    for link in range(structure.damping.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        x = difference(trial.u, first, second) - structure.offset[link]
        rate = difference(trial.v, first, second)
        k = structure.compression[link] if x < 0.0 else structure.extension[link]
        force, slope = k * x, k
        place = structure.z_of_link[link]
        if place >= 0:
            before = difference(state.v, first, second)
            trial.z[place], z_x = z_after(
                state.z[place],
                h * ((1.0 - theta) * before + theta * rate),
                structure.yield_displacement[link],
                structure.exponent[link],
                structure.beta[link],
                structure.gamma[link],
                structure.bound[link],
            )
            force += structure.strength[link] * trial.z[place]
            slope += structure.strength[link] * z_x
        trial.link[link], trial.slope[link] = force, slope
        force += structure.damping[link] * rate
        pull_together(trial.f, first, second, force)
        for b in (first, second):
            if b >= 0:
                trial.terms[b] += abs(force)


@step_kernel
def momentum_residual(
    structure: Structure, h: float, ground: float, state: State, trial: Trial
) -> None:
    """What is missing in the balance of momentum without contacts (N s).

    `ground` is the ground acceleration weighted by θ (m/s²).
    """
    theta = structure.theta
    for b in range(structure.mass.size):
        m = structure.mass[b]
        f = (1.0 - theta) * state.f[b] + theta * trial.f[b]
        trial.residual[b] = m * (trial.v[b] - state.v[b]) - h * (f - m * ground)
        trial.terms[b] = m * (abs(trial.v[b]) + abs(state.v[b])) + h * (
            trial.terms[b] + abs(state.f[b]) + m * abs(ground)
        )


@step_kernel
def balanced(structure: Structure, trial: Trial) -> bool:
    """Whether nothing but the tolerance of Newton's method or rounding is missing."""
    for b in range(structure.mass.size):
        allowed = NEWTON_TOLERANCE * structure.speed * structure.mass[b]
        if not abs(trial.residual[b]) <= allowed + ROUNDING * trial.terms[b]:
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
        band[max(first, second), abs(first - second)] -= value


@step_kernel
def fill_newton_matrix(structure: Structure, h: float, trial: Trial) -> None:
    """``M + h θ (C + h θ K)`` at the trial state, contacts apart."""
    reach = h * structure.theta
    trial.band[:, :] = 0.0
    for b in range(structure.mass.size):
        trial.band[b, 0] = structure.mass[b]
    for link in range(structure.damping.size):
        value = reach * (structure.damping[link] + reach * trial.slope[link])
        couple(trial.band, structure.ends[link, 0], structure.ends[link, 1], value)


@step_kernel
def add_work(structure: Structure, h: float, ground: float, state: State, trial: Trial) -> None:
    """Add the step's input, viscous and hysteretic work (J), forces by θ, paths by the mean."""
    theta = structure.theta
    for b in range(structure.mass.size):
        mean = 0.5 * (state.v[b] + trial.v[b])
        state.work[INPUT] -= h * structure.mass[b] * mean * ground
    for link in range(structure.damping.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        before, after = difference(state.v, first, second), difference(trial.v, first, second)
        path = 0.5 * h * (before + after)
        rate = (1.0 - theta) * before + theta * after
        state.work[VISCOUS] += structure.damping[link] * rate * path
        place = structure.z_of_link[link]
        if place >= 0:
            z = (1.0 - theta) * state.z[place] + theta * trial.z[place]
            state.work[HYSTERETIC] += structure.strength[link] * z * path


@step_kernel
def accept(state: State, trial: Trial) -> None:
    """Make the end of the step the present state."""
    copy_values(trial.u, state.u)
    copy_values(trial.v, state.v)
    copy_values(trial.f, state.f)
    copy_values(trial.z, state.z)
    copy_values(trial.link, state.link)
    copy_values(trial.contact, state.contact)
