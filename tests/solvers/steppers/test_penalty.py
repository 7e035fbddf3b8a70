"""Newmark with contact elements: the chain it gets wrong, records, the solved problems."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound.motion.record import Record
from eventpound.scene import BARRIER, Body, Contact, Scene
from eventpound.scene.contact_law import Element, kelvin_voigt_ratio
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from tests.reference.problems import load
from tests.solvers.scenes import pounding_pair, with_springs

PROBLEMS = load()


def run(scene: Scene, end: float, **settings) -> Recording:
    return solver_named("penalty").solve(Task(scene, 0.0, end, 1e-9, settings=settings))


def _touching_chain(eps: float) -> Scene:
    bodies = (Body("a", 1.0, 0.0, 1.0), Body("b", 1.0), Body("c", 1.0))
    contacts = (Contact("ab", "a", "b", 0.01, eps), Contact("bc", "b", "c", 0.0, eps))
    return Scene(bodies, (), (), contacts)


def _chain_by_quadrature(eps: float) -> np.ndarray:
    """Final velocities of the same chain with k = 1 and elements that push only when closed."""
    c = 2.0 * kelvin_voigt_ratio(eps) * math.sqrt(0.5)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        u, v = y[:3], y[3:]
        depth, closing = u[:-1] - u[1:], v[:-1] - v[1:]
        force = np.where(depth > 0.0, depth + c * closing, 0.0)
        return np.concatenate((v, [-force[0], force[0] - force[1], force[1]]))

    end = solve_ivp(
        rate, (0.0, 40.0), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0], max_step=1e-2, rtol=1e-8, atol=1e-10
    )
    return end.y[3:, -1]


@pytest.mark.parametrize("eps", [1.0, 0.6])
def test_simultaneous_impacts_of_a_chain_do_not_depend_on_the_stiffness(eps):
    # Nothing but the contacts sets a time, so the velocities are the same for every k: this
    # part of the error never vanishes.
    wanted = _chain_by_quadrature(eps)
    for k in (1e4, 1e8):
        chain = with_springs(_touching_chain(eps), Element.KELVIN_VOIGT, k)
        recording = run(chain, 0.3, steps_per_period=2000)
        # First order in the jump of the damping force, as for one impact.
        np.testing.assert_allclose(recording.v, wanted, atol=0.02 * (1.0 - eps) + 1e-4)
    rigid = solver_named("fast").solve(Task(_touching_chain(eps), 0.0, 0.3, 1e-10)).v
    assert np.abs(wanted - rigid).max() > 0.1


def test_linear_element_keeps_energy():
    # Average acceleration does the work of the mean force, and a linear one stores just that.
    scene = pounding_pair()
    scene = Scene(scene.bodies, (), (), scene.contacts, scene.motion)
    scene = with_springs(scene, Element.LINEAR, 2e4)
    recording = solver_named("penalty").solve(Task(scene, 0.0, 2.0, 1e-9, energy=True))
    assert abs(recording.energy.closure) < 1e-10
    impacts = [e for e in recording.events if e.kind is EventKind.IMPACT]
    # Opening lies within a step of its last force, so little is left over.
    assert len(impacts) > 3
    assert sum(abs(e.energy_lost) for e in impacts) < 0.02 * recording.energy.input


def test_a_pressed_body_sinks_in_by_its_weight():
    # Kelvin-Voigt at rest under a push of 2 m/s²: δ = m a/k, force m a.
    contact = Contact("wall", "m", BARRIER, 0.05, 0.3)
    scene = Scene((Body("m", 3.0),), (), (), (contact,), Record(np.full(41, -2.0), 1.0))
    recording = run(with_springs(scene, Element.KELVIN_VOIGT, 3e4), 20.0, time_step=2e-3)
    assert recording.u[0] == pytest.approx(0.05 + 6.0 / 3e4, abs=1e-9)
    assert recording.resting_time[0] == 0.0
    closing = math.sqrt(2.0 * 2.0 * 0.05)
    # The first peak force of an undamped contact is sqrt(k m) v; damping adds to its start.
    assert 0.9 * math.sqrt(9e4) * closing < recording.max_force[0] < 1.6 * math.sqrt(9e4) * closing


@pytest.mark.parametrize("name", ["A07", "B07", pytest.param("B12", marks=pytest.mark.sweep)])
@pytest.mark.parametrize("element", [Element.KELVIN_VOIGT, Element.JANKOWSKI])
def test_a_stiffer_contact_comes_nearer_to_the_solved_problem(name, element):
    # The time in contact goes as k^(-1/2), or k^(-2/5): a hundred times the stiffness takes
    # at least a factor of six off what vanishes with it, but not off the error of the step,
    # 2 ζ ω h as of one impact, nor off what Jankowski's formula misses, 0.03 of a speed.
    problem, steps = PROBLEMS[name], 400
    ratio = max(kelvin_voigt_ratio(c.restitution) for c in problem.scene.contacts)
    left = 2.0 * ratio * 2.0 * math.pi / steps + 0.03 * (element is Element.JANKOWSKI)
    wanted = [np.array([float(x) for x in problem.result[key]]) for key in ("u_max", "u_min")]
    errors = []
    for k in (1e3, 1e5):
        scene = with_springs(problem.scene, element, k)
        peaks = run(scene, problem.end, steps_per_period=steps).displacement
        found = (peaks.maximum, peaks.minimum)
        error = max(np.abs(a - b).max() for a, b in zip(found, wanted, strict=True))
        errors.append(error / max(np.abs(part).max() for part in wanted))
    # An error of a speed is at most as large in the peaks.
    assert errors[1] < errors[0] / 6.0 + left
    assert errors[1] < errors[0]
