"""Moreau–Jean: what the rule gives in closed form, and what its answers come to."""

import math
from itertools import pairwise

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.mechanics.impact import impact_law
from eventpound.mechanics.model import assemble
from eventpound.motion.pulses import Sine
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.tolerances import STILL_GAP_RATE
from tests.numerics.problems import joints
from tests.solvers.exact import Oscillator
from tests.solvers.random_scenes import random_scene
from tests.solvers.scenes import pounding_pair

EPS = np.finfo(float).eps


def run(scene: Scene, end: float, step: float, **options) -> Recording:
    settings = {"time_step": step, **options.pop("settings", {})}
    return solver_named("moreau").solve(Task(scene, 0.0, end, 1e-9, settings=settings, **options))


@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_free_oscillator_turns_by_the_angle_of_the_rule(solver):
    # With θ = 1/2 a step turns (u, v/ω) by 2 atan(ω h/2) exactly and keeps the energy.
    omega, h, steps = 3.0, 0.05, 400
    scene = Scene((Body("m", 2.0, 0.3, 0.4),), (Spring("k", (GROUND, "m"), Linear(18.0)),))
    task = Task(scene, 0.0, h * steps, 1e-9, settings={"time_step": h}, energy=True)
    recording = solver_named(solver).solve(task)
    phase = 2.0 * math.atan(0.5 * omega * h) * steps
    c, s = math.cos(phase), math.sin(phase)
    # Newton's tolerance, 1e-12 of the speed a step, and rounding.
    assert recording.u[0] == pytest.approx(0.3 * c + 0.4 / omega * s, abs=1e-11)
    assert recording.v[0] == pytest.approx(0.4 * c - 0.3 * omega * s, abs=1e-11)
    assert recording.work.steps == steps
    assert abs(recording.energy.closure) < 1e-12


def test_theta_one_damps_as_backward_euler_does():
    omega, h, steps = 3.0, 0.05, 100
    scene = Scene((Body("m", 2.0, 0.3, 0.0),), (Spring("k", (GROUND, "m"), Linear(18.0)),))
    recording = run(scene, h * steps, h, settings={"theta": 1.0})
    amplitude = math.hypot(recording.u[0], recording.v[0] / omega)
    assert amplitude == pytest.approx(0.3 * (1.0 + (omega * h) ** 2) ** (-steps / 2), rel=1e-9)


def test_one_impact_of_several_bodies_is_the_impact_law():
    # Without forces nothing but the complementarity problem is left, and M is Newton's matrix.
    rng = np.random.default_rng(2)
    names = [f"b{i}" for i in range(5)]
    for _ in range(20):
        mass, v = rng.uniform(0.2, 3.0, 5), np.sort(rng.normal(size=5))[::-1].copy()
        eps = rng.uniform(0.0, 1.0, 4)
        bodies = tuple(Body(n, m, 0.0, w) for n, m, w in zip(names, mass, v, strict=True))
        contacts = tuple(Contact(f"c{i}", names[i], names[i + 1], 0.0, eps[i]) for i in range(4))
        scene = Scene(bodies, (), (), contacts)
        recording = run(scene, 1e-3, 1e-3)
        model = assemble(scene)
        rate, after = model.rates(v), v.copy()
        impulse, _, lost, _ = impact_law(
            joints(model.left, model.right, mass), mass, eps, np.ones(4, bool), rate, after
        )
        np.testing.assert_allclose(recording.v, after, rtol=0, atol=1e-12)
        events = recording.events
        assert {e.group for e in events} == {0}
        np.testing.assert_allclose(
            [e.impulse for e in events], impulse[[e.contact for e in events]], atol=1e-12
        )
        assert sum(e.energy_lost for e in events) == pytest.approx(lost, abs=1e-12)
        assert mass @ recording.v == pytest.approx(mass @ v, abs=1e-12)


def test_penetration_is_at_most_a_step():
    # The gap half a step ahead decides, so a free body of speed v may have sunk by h v/2
    # before the step of its impact, in which its mean speed is (1 - ε) v/2.
    h, v, eps, deepest = 0.01, 2.0, 0.5, 0.0
    bound = h * v * (1.0 - 0.5 * eps)
    for gap in np.linspace(0.3, 0.3 + v * h, 41):
        contact = Contact("w", "m", BARRIER, gap, eps)
        recording = run(Scene((Body("m", 1.0, 0.0, v),), (), (), (contact,)), 0.4, h)
        assert recording.smallest_gap[0] >= -bound - 8 * EPS
        deepest = max(deepest, -recording.smallest_gap[0] / bound)
        assert recording.v[0] == pytest.approx(-eps * v, abs=1e-12)
        (impact,) = recording.events
        # The jump lies within half a step of the impact.
        assert abs(impact.t - gap / v) <= 0.5 * h + 1e-12
    assert deepest > 0.95


def _pressed_ball(eps: float) -> Scene:
    """A body that a constant push of 2 m/s² presses to a barrier 0.25 m away for 40 s."""
    contact = Contact("wall", "m", BARRIER, 0.25, eps)
    return Scene((Body("m", 3.0),), (), (), (contact,), Record(np.full(41, -2.0), 1.0))


@pytest.mark.parametrize("eps", [0.0, 0.5, 0.8])
def test_a_bouncing_ball_comes_to_rest_with_its_weight(eps):
    limit, h = 0.5 + eps / (1.0 - eps), 1e-3
    recording = run(_pressed_ball(eps), 20.0, h, output_times=np.array([0.0, 10.0, 20.0]))
    (rest,) = [e for e in recording.events if e.kind is EventKind.REST]
    # Each bounce is off by up to h in its time; those shorter than h are cut short, which
    # then decay by ε a step: some log(1e-9)/log(ε) steps.
    allowed = h * (10.0 + (21.0 / -math.log(eps) if eps else 0.0)) / (1.0 - eps)
    assert rest.t == pytest.approx(limit, abs=allowed)
    assert recording.resting_time[0] == pytest.approx(20.0 - rest.t, abs=1e-9)
    assert recording.v[0] == pytest.approx(0.0, abs=1e-8)
    # In its first step a contact at rest may still stop a rate that counts as none.
    scene = _pressed_ball(eps)
    speed = scene_scales(scene, assemble(scene), 20.0).speed
    assert 6.0 - 1e-8 <= recording.max_force[0] <= 6.0 + 2.0 * 3.0 * STILL_GAP_RATE * speed / h
    np.testing.assert_allclose(recording.history.contact_force[1:, 0], 6.0, rtol=1e-9)
    # At rest on a barrier that moves with the ground: the absolute acceleration is the ground's.
    np.testing.assert_allclose(recording.history.a[1:, 0], -2.0, rtol=1e-9)


def test_detaches_when_the_push_ends():
    scene = _pressed_ball(0.0)
    sine = Sine(2.0, 4.0, reverse=True)
    scene = Scene(scene.bodies, (), (), (Contact("wall", "m", BARRIER, 0.0, 0.5),), sine)
    recording = run(scene, 4.0, 1e-3)
    kinds = [(e.kind, e.t) for e in recording.events]
    # Pressed for half a period, then the ground takes the barrier away.
    assert [k for k, _ in kinds] == [EventKind.REST, EventKind.DETACHMENT]
    assert kinds[1][1] == pytest.approx(2.0, abs=2e-3)


def _wall(exact: Oscillator, u: float, v: float) -> Scene:
    spring = Spring("k", (GROUND, "m"), Linear(2.0 * exact.omega**2))
    contact = Contact("wall", "m", BARRIER, exact.gap, exact.restitution)
    return Scene((Body("m", 2.0, u, v),), (spring,), (), (contact,))


def test_impacts_converge_at_first_order():
    exact = Oscillator(1.0, 0.5, 0.7)
    times, speeds, u_end, v_end = exact.solve(0.0, 1.0, 20.0)
    for h in (4e-3, 1e-3):
        recording = run(_wall(exact, 0.0, 1.0), 20.0, h)
        impacts = [e for e in recording.events if e.kind is EventKind.IMPACT]
        assert len(impacts) == len(times)
        # Each impact is put off by up to h/2, and so is all that follows it; the motion
        # between is of second order. A slow impact stretches what came before it.
        allowed = 0.5 * h * np.cumsum(1.0 + max(speeds) / np.array(speeds))
        assert (np.abs(np.array([e.t for e in impacts]) - times) < allowed).all()
        assert abs(recording.u[0] - u_end) < allowed[-1] * max(speeds)
        assert abs(recording.v[0] - v_end) < allowed[-1] * max(speeds)


def test_ledger_closes_to_rounding_where_forces_are_linear():
    # θ = 1/2 and forces by their mean do the work that the stored energy changes by.
    scene = pounding_pair()
    springs = tuple(s for s in scene.springs if isinstance(s.law, BoucWen))
    scene = Scene(scene.bodies, springs, scene.dashpots, scene.contacts, scene.motion)
    recording = run(scene, 6.0, 2e-3, energy=True)
    assert any(e.kind is EventKind.IMPACT for e in recording.events)
    # Newton's tolerance of every step, which has a fraction of the work in it.
    assert abs(recording.energy.closure) < 1e-10
    assert recording.energy.impact > 0.0
    assert recording.energy.hysteretic > 0.0


def test_history_lies_between_steps_and_ends_at_the_end():
    scene = Scene((Body("m", 2.0, 0.3, 0.4),), (Spring("k", (GROUND, "m"), Linear(18.0)),))
    times = np.linspace(0.0, 1.0, 38)
    fine = run(scene, 1.0, 0.01, output_times=times)
    np.testing.assert_array_equal(fine.history.t, times)
    at_steps = run(scene, 1.0, 0.01, output_times=np.linspace(0.0, 1.0, 101))
    wanted = np.interp(times, at_steps.history.t, at_steps.history.u[:, 0])
    np.testing.assert_allclose(fine.history.u[:, 0], wanted, atol=1e-12)
    assert fine.history.u[-1, 0] == pytest.approx(fine.u[0], abs=1e-14)


def test_a_long_row_is_as_a_short_one():
    # Bodies apart from each other answer each for itself, whatever the band.
    bodies = tuple(Body(f"m{i}", 1.0 + i, 0.1, 0.0) for i in range(30))
    springs = tuple(Spring(f"k{i}", (GROUND, f"m{i}"), Linear(5.0)) for i in range(30))
    springs += (Spring("far", ("m3", "m17"), Linear(0.0)),)
    dashpots = (Dashpot(("m0", "m29"), 0.0),)
    together = run(Scene(bodies, springs, dashpots), 1.0, 0.01)
    for i in (0, 3, 17, 29):
        alone = run(Scene(bodies[i : i + 1], springs[i : i + 1]), 1.0, 0.01)
        assert together.u[i] == pytest.approx(alone.u[0], abs=1e-13)


@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_a_failure_keeps_what_was_computed(solver):
    # With γ < |β| the law makes energy against the direction of loading, z runs away, and
    # Newton's matrix loses its sign.
    law = BoucWen(0.0, 10.0, 0.1, 2.0, 2.0, -1.5, -0.9)
    scene = Scene((Body("m", 1.0, 0.1, 1.0),), (Spring("k", (GROUND, "m"), law),))
    times = np.linspace(0.0, 1.0, 101)
    task = Task(scene, 0.0, 1.0, 1e-9, output_times=times, settings={"time_step": 0.01})
    with pytest.raises(ComputationError, match="does not converge; try a smaller time_step") as e:
        solver_named(solver).solve(task)
    recording = e.value.recording
    assert not recording.success
    assert 0.0 < e.value.time == recording.t < 1.0
    # One row a step up to the last that was taken.
    assert recording.history.t[-1] == pytest.approx(recording.t)
    assert recording.work.steps == recording.history.t.size - 1


@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_a_run_can_be_interrupted(solver):
    scene = Scene((Body("m", 2.0, 0.3, 0.4),), (Spring("k", (GROUND, "m"), Linear(18.0)),))
    seen = []

    def stop(t):
        seen.append(t)
        if t > 40.0:
            raise KeyboardInterrupt

    task = Task(scene, 0.0, 1e5, 1e-9, settings={"time_step": 1e-3}, progress=stop)
    with pytest.raises(KeyboardInterrupt):
        solver_named(solver).solve(task)
    # Every 20 000 steps of 1 ms.
    np.testing.assert_allclose(seen, [20.0, 40.0, 60.0])


def _row(link: float) -> Scene:
    """Six oscillators side by side, their neighbours joined by springs of a stiffness."""
    names = [f"m{i}" for i in range(6)]
    bodies = tuple(Body(name, 1.0 + 0.3 * i) for i, name in enumerate(names))
    springs = [Spring(f"k{i}", (GROUND, n), Linear(20.0 + 9 * i)) for i, n in enumerate(names)]
    pairs = list(pairwise(names))
    springs += [Spring(f"l{i}", pair, Linear(link)) for i, pair in enumerate(pairs)]
    contacts = tuple(Contact(f"c{i}", *pair, 2e-3, 0.4) for i, pair in enumerate(pairs))
    return Scene(bodies, tuple(springs), (), contacts, Sine(3.0, 1.0))


def test_masses_of_their_own_and_a_full_matrix_give_the_same():
    # A link of no stiffness worth speaking of brings the dense complementarity problem.
    apart, joined = run(_row(0.0), 2.0, 2e-3), run(_row(1e-200), 2.0, 2e-3)
    assert len(apart.events) == len(joined.events) > 20
    np.testing.assert_allclose(apart.u, joined.u, rtol=0, atol=1e-12)
    np.testing.assert_allclose(apart.v, joined.v, rtol=0, atol=1e-11)


def test_a_locked_row_rests_all_along():
    # Three contacts for two bodies: their forces are not unique, their rest is.
    contacts = (
        Contact("l", BARRIER, "a", 0.0, 0.5),
        Contact("m", "a", "b", 0.0, 0.5),
        Contact("r", "b", BARRIER, 0.0, 0.5),
    )
    scene = Scene((Body("a", 1.0), Body("b", 2.0)), (), (), contacts, Sine(3.0, 1.0))
    recording = run(scene, 2.0, 1e-3)
    assert [e.kind for e in recording.events] == [EventKind.REST] * 3
    np.testing.assert_allclose(recording.resting_time, 2.0, rtol=1e-12)
    np.testing.assert_allclose(recording.u, 0.0, atol=1e-12)


@pytest.mark.parametrize("seed", [77, 116, 149])
def test_contradicting_restitutions_between_barriers_are_taken_as_plastic(seed):
    # Scenes in which a group closed between two barriers is asked for rates it cannot have.
    scene, end = random_scene(seed)
    recording = solver_named("moreau").solve(Task(scene, 0.0, end, 1e-9))
    assert recording.success
    assert np.isfinite(recording.u).all()
