"""The contact elements: their published numbers, and the restitution each really gives."""

import math

import numpy as np
import pytest
from scipy.special import gamma

from eventpound.mechanics.model import assemble
from eventpound.scene import BARRIER, Body, Contact, Scene
from eventpound.scene.contact_law import (
    ContactLaw,
    Element,
    damping_constant,
    jankowski_ratio,
    kelvin_voigt_ratio,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from eventpound.solvers.events.law_contacts import DRAG, TOUCH_ROWS
from eventpound.solvers.events.run import Laws
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.penalty.elements import (
    HERTZ_TIME,
    PenaltyElements,
    contact_period,
    contact_stiffness,
    element_force,
    elements_of,
)
from tests.solvers.scenes import with_springs
from tests.solvers.steppers.restitution import real_restitution


def impact(element: Element, eps: float, speed: float = 1.7, *, period_steps: int = 800):
    """One isolated impact of two bodies, 2 and 3 kg, at rest otherwise: its run."""
    bodies = (Body("a", 2.0, 0.0, speed), Body("b", 3.0))
    scene = with_springs(Scene(bodies, (), (), (Contact("c", "a", "b", 0.3, eps),)), element, 5e4)
    settings = {"steps_per_period": period_steps}
    return solver_named("penalty").solve(Task(scene, 0.0, 0.4, 1e-9, settings=settings))


def _restitution_of(run: Recording) -> float:
    (event,) = [e for e in run.events if e.kind is EventKind.IMPACT]
    return -event.gap_velocity_after / event.gap_velocity_before


@pytest.mark.parametrize("eps", [0.2, 0.5, 0.65, 0.9, 1.0])
@pytest.mark.parametrize("element", list(Element))
def test_restitution_of_an_isolated_impact(element, eps):
    steps = 800
    run = impact(element, eps, period_steps=steps)
    wanted = real_restitution(element, eps)
    # The forces jump (kelvin-voigt) or have an infinite slope (jankowski) as the contact begins
    # or ends: an error of the order of the jump c v times a step, with c v h = 2 ζ m v ω h.
    ratio = {
        Element.KELVIN_VOIGT: kelvin_voigt_ratio(eps),
        Element.JANKOWSKI: jankowski_ratio(eps),
    }.get(element, 0.0)
    omega_h = 2.0 * math.pi / steps
    error = 2.0 * ratio * omega_h + omega_h**2
    assert _restitution_of(run) == pytest.approx(wanted, abs=error)
    assert 2.0 * run.v[0] + 3.0 * run.v[1] == pytest.approx(2.0 * 1.7, rel=1e-12)
    (event,) = run.events
    # By a straight line over a step in which the speed changes by as much.
    assert event.t == pytest.approx(0.3 / 1.7, abs=error * 0.4 / run.work.steps)
    assert event.impulse == pytest.approx(3.0 * run.v[1], rel=1e-9)
    lost = 0.5 * 1.2 * 1.7**2 * (1.0 - _restitution_of(run) ** 2)
    assert event.energy_lost == pytest.approx(lost, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("steps", [20, 50])
def test_a_contact_lasts_as_many_steps_as_it_is_told(steps):
    scene = Scene((Body("a", 2.0, 0.0, 1.7),), (), (), (Contact("c", "a", BARRIER, 0.3, 1.0),))
    h = 1e-4
    settings = {"contact_steps": steps, "time_step": h}
    task = Task(scene, 0.0, 0.4, 1e-9, output_times=np.arange(0.0, 0.4, h), settings=settings)
    run = solver_named("penalty").solve(task)
    # The speed of the scene is its own, that of the impact.
    assert abs(np.count_nonzero(run.history.u[:, 0] > 0.3) - steps) <= 1
    coarse = Task(scene, 0.0, 0.4, 1e-9, settings={**settings, "time_step": 0.1})
    default = Task(scene, 0.0, 0.4, 1e-9)
    model = assemble(scene)
    scales = scene_scales(scene, model, 0.4)
    softest = contact_stiffness(default, model, scales)
    assert contact_stiffness(coarse, model, scales) == softest
    assert contact_stiffness(task, model, scales) > softest


def test_how_far_the_formulas_are_from_their_target():
    # Anagnostopoulos' is exact; that of Muthukumar and DesRoches assumes little damping and
    # gives far too much restitution (Ye, Li and Zhu 2009); Jankowski's is a fit within 0.03.
    for eps in np.linspace(0.1, 0.95, 18):
        assert real_restitution(Element.HERTZ_DAMP, eps) - eps > 0.05 * (1.0 - eps)
        assert abs(real_restitution(Element.JANKOWSKI, eps) - eps) < 0.03
    assert real_restitution(Element.HERTZ_DAMP, 0.5) > 0.65


def test_published_damping_ratios():
    # ε = 0.65, concrete: ζ = 0.14 (Anagnostopoulos 1988, as quoted by Jankowski 2005).
    assert kelvin_voigt_ratio(0.65) == pytest.approx(0.14, abs=0.005)
    # No impact loses nothing; a plastic one is critically damped.
    assert kelvin_voigt_ratio(1.0) == jankowski_ratio(1.0) == 0.0
    assert kelvin_voigt_ratio(0.0) == 1.0


def _force(element: Element, depth: float, rate: float, open_before: float, cut=0) -> tuple:
    # Closed at 3 m/s.
    damping = 20.0 * 0.6 / 3.0 if element is Element.HERTZ_DAMP else 0.6
    first, kind, cuts = (np.array([number]) for number in (0, int(element), cut))
    laws = Laws(first, kind, np.array([damping]), np.zeros((TOUCH_ROWS, 1)))
    laws.touch[DRAG] = damping
    elements = PenaltyElements(np.array([20.0]), cuts, laws, np.zeros(1))
    return element_force(0, elements, depth, rate, open_before)


@pytest.mark.parametrize("element", list(Element))
@pytest.mark.parametrize("open_before", [0.0, 0.02])
def test_slopes_are_those_of_the_force(element, open_before):
    rng = np.random.default_rng(4)
    for _ in range(200):
        depth, rate = 10.0 ** rng.uniform(-3, 0), rng.normal()
        small = 1e-6
        by_depth = (
            _force(element, depth * (1 + small), rate, open_before)[0]
            - _force(element, depth * (1 - small), rate, open_before)[0]
        ) / (2 * small * depth)
        by_rate = (
            _force(element, depth, rate + small, open_before)[0]
            - _force(element, depth, rate - small, open_before)[0]
        ) / (2 * small)
        _, slope, damping = _force(element, depth, rate, open_before)
        size = 40.0 * (1.0 + abs(rate)) * (1.0 + 1.0 / depth)
        assert by_depth == pytest.approx(slope, abs=1e-9 * size)
        assert by_rate == pytest.approx(damping, abs=1e-8 * size)


def test_open_gaps_carry_nothing():
    for element in Element:
        assert _force(element, 0.0, 2.0, 0.0) == (0.0, 0.0, 0.0)


def test_a_contact_without_tension_does_not_pull():
    element = Element.KELVIN_VOIGT
    assert _force(element, 0.01, -1.0, 0.0)[0] == pytest.approx(20.0 * 0.01 - 0.6)
    assert _force(element, 0.01, -1.0, 0.0, cut=1) == (0.0, 0.0, 0.0)
    assert _force(element, 0.01, 1.0, 0.0, cut=1) == _force(element, 0.01, 1.0, 0.0)


@pytest.mark.parametrize("element", [e for e in Element if e.damped])
def test_a_restitution_is_another_way_to_give_the_damping(element):
    bodies = (Body("a", 2.0, 0.0, 1.7), Body("b", 3.0))
    law = ContactLaw(element.word, 5e4, damping_constant(element, 0.6))
    scene = Scene(bodies, (), (), (Contact("c", "a", "b", 0.3, None, law),))
    own = solver_named("penalty").solve(Task(scene, 0.0, 0.4, 1e-9))
    by_restitution = impact(element, 0.6, period_steps=100)
    np.testing.assert_array_equal(own.v, by_restitution.v)
    assert own.events == by_restitution.events


def test_newtons_law_becomes_a_kelvin_voigt_element():
    bodies = (Body("a", 2.0, 0.0, 1.7), Body("b", 3.0))
    newton = Scene(bodies, (), (), (Contact("c", "a", "b", 0.3, 0.6),))
    task = Task(newton, 0.0, 0.4, 1e-9)
    model = assemble(newton)
    k = contact_stiffness(task, model, scene_scales(newton, model, 0.4))
    found = solver_named("penalty").solve(task)
    own = Task(with_springs(newton, Element.KELVIN_VOIGT, k), 0.0, 0.4, 1e-9)
    np.testing.assert_array_equal(found.v, solver_named("penalty").solve(own).v)


def test_hertz_time_is_its_integral():
    exact = 0.8 * math.sqrt(math.pi) * gamma(0.4) / gamma(0.9)
    assert pytest.approx(exact, rel=1e-6) == HERTZ_TIME


@pytest.mark.parametrize("element", [Element.LINEAR, Element.HERTZ])
def test_the_period_is_twice_the_time_in_contact(element):
    k, speed = 5e4, 1.7
    scene = Scene((Body("m", 2.0, 0.0, speed),), (), (), (Contact("c", "m", BARRIER, 0.3, 0.9),))
    scene = with_springs(scene, element, k)
    period = contact_period(2.0, speed, element, k)
    settings = {"time_step": period / 4000}
    times = np.linspace(0, 1, int(4000 / period))
    task = Task(scene, 0.0, 1.0, 1e-9, output_times=times, settings=settings)
    run = solver_named("penalty").solve(task)
    # Half the period is the time in contact: the gap is below zero that long.
    inside = run.history.t[run.history.gap[:, 0] < 0.0]
    assert inside[-1] - inside[0] == pytest.approx(0.5 * period, rel=2e-3)
    # At the largest depth the element stores all kinetic energy.
    power = 2.5 if element.hertzian else 2.0
    depth = (0.5 * power * 2.0 * speed**2 / k) ** (1.0 / power)
    assert run.smallest_gap[0] == pytest.approx(-depth, rel=1e-5)


def test_default_stiffness():
    # A free body of 2 kg, 0.3 m and 1.7 m/s from a barrier: L = 0.3 m, T = L/V.
    scene = Scene((Body("m", 2.0, 0.0, 1.7),), (), (), (Contact("c", "m", BARRIER, 0.3, 0.9),))
    model = assemble(scene)
    scales = scene_scales(scene, model, 1.0)
    assert scales.speed == pytest.approx(1.7)
    k = contact_stiffness(Task(scene, 0.0, 1.0, 1e-9), model, scales)
    assert k == pytest.approx(100.0 * 2.0 * (1.7 / 0.3) ** 2, rel=1e-12)


def test_constants_of_damping():
    scene = Scene(
        (Body("a", 2.0), Body("b", 3.0)),
        (),
        (),
        (Contact("c", "a", "b", 0.1, 0.65), Contact("d", "b", BARRIER, 0.1, 0.0)),
    )
    np.testing.assert_allclose(
        elements_of(scene, 1e4).laws.damping,
        [2 * kelvin_voigt_ratio(0.65) * math.sqrt(1e4 * 1.2), 2 * math.sqrt(3e4)],
    )
    np.testing.assert_allclose(
        elements_of(with_springs(scene, Element.HERTZ_DAMP, 1e4), 1.0).laws.damping,
        [0.75 * (1 - 0.65**2) * 1e4, 0.75e4],
    )
    assert not elements_of(with_springs(scene, Element.HERTZ, 1e4), 1.0).laws.damping.any()
