"""Contacts that come to rest, are released together, or open by a high derivative."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from tests.solvers.accuracy import RTOL, allowed
from tests.solvers.scenes import run


@pytest.mark.parametrize(
    "eps", [(0.5, 0.5, 0.5), (0.75, 0.3, 0.9), (0.2, 0.8, 0.3), (0.98, 0.5, 0.7)]
)
@pytest.mark.parametrize("v", [0.2, -0.2])
def test_a_row_without_play_comes_to_rest_at_once(solver, eps, v):
    # Barrier, a, b, barrier, every gap zero: no body can move, and with ε < 1 the impacts
    # of the first instant take all the energy.
    scene = Scene(
        (Body("a", 1.0, 0.0, v), Body("b", 2.0)),
        contacts=(
            Contact("left", BARRIER, "a", 0.0, eps[0]),
            Contact("joint", "a", "b", 0.0, eps[1]),
            Contact("right", "b", BARRIER, 0.0, eps[2]),
        ),
    )
    recording = run(scene, RTOL, 1.0, solver=solver)
    np.testing.assert_allclose(recording.v, 0.0, atol=1e-12)
    np.testing.assert_allclose(recording.u, 0.0, atol=1e-12)
    assert {e.t for e in recording.events} == {0.0}
    assert {e.contact for e in recording.events if e.kind is EventKind.REST} == {0, 1, 2}
    assert sum(e.energy_lost for e in recording.events) == pytest.approx(0.5 * v**2, rel=1e-9)


def test_a_row_without_play_stays_at_rest(solver):
    # The impacts of the first instant leave speeds at rounding, whose damping forces keep
    # the three gap accelerations from adding up to exactly nothing.
    scene = Scene(
        (Body("a", 1.5, 0.0, -0.037), Body("b", 0.23, 0.0, 0.11)),
        dashpots=(Dashpot((GROUND, "a"), 1.0),),
        contacts=(
            Contact("left", BARRIER, "a", 0.0, 0.8),
            Contact("joint", "a", "b", 0.0, 1.0),
            Contact("right", "b", BARRIER, 0.0, 0.5),
        ),
        motion=Sine(2.9, 0.93),
    )
    recording = run(scene, RTOL, 2.0, solver=solver)
    np.testing.assert_allclose(recording.v, 0.0, atol=1e-12)
    np.testing.assert_allclose(recording.u, 0.0, atol=1e-12)
    np.testing.assert_allclose(recording.resting_time, 2.0, rtol=1e-12)


@pytest.mark.parametrize("law", [Linear(60.0), BoucWen(0.3, 3.3, 0.054)], ids=["linear", "loop"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-8, RTOL])
def test_released_together_but_not_opened(solver, law, rtol):
    # a and b rest against the barrier on their right until the cosine turns at T/4, where
    # both contact forces vanish. b, free, is then pulled off the barrier and on to a, which
    # its spring holds back from the fourth derivative on: only the barrier is left.
    period = 1.7
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0, 0.0, -0.3)),
        (Spring("s", (GROUND, "a"), law),),
        contacts=(Contact("joint", "a", "b", 0.0, 0.4), Contact("wall", "b", BARRIER, 0.0, 0.6)),
        motion=Cosine(2.0, period, reverse=True),
    )
    recording = run(scene, rtol, 0.5, solver=solver)
    released = [e for e in recording.events if e.kind is EventKind.DETACHMENT]
    assert [e.contact for e in released] == [1]
    # The force m a_p cos ω t passes zero steeply: the time errs like the tolerance.
    assert released[0].t == pytest.approx(0.25 * period, abs=allowed(1.0, rtol))
    assert recording.smallest_gap.min() >= -1e-12


@pytest.mark.parametrize("omega", [1.0, 30.0, 1e3, 1e5])
def test_a_gap_opened_by_its_third_derivative(solver, omega):
    # a and b move left at v; b's spring, slack at 0, holds it back from there on:
    # gap = v (t - sin(ω t)/ω). At ω t = 0.1 a meets a wall and returns to meet b.
    v, eps = 0.3 * omega, 0.6
    wall = 0.1 * v / omega
    start = 0.02 * v / omega
    # On the way to 0 both ride on the spring, at ω/√2 and with the energy of both.
    ride = math.hypot(v, start * omega / math.sqrt(2.0))
    begun = math.atan2(start * omega / math.sqrt(2.0), v) / (omega / math.sqrt(2.0))
    scene = Scene(
        (Body("a", 1.0, start, -v), Body("b", 1.0, start, -v)),
        (Spring("s", (GROUND, "b"), Linear(omega**2)),),
        contacts=(Contact("wall", BARRIER, "a", wall, eps), Contact("joint", "a", "b", 0.0, 1.0)),
    )
    at_wall = wall / ride

    def gap(t: float) -> float:
        a = -wall + eps * ride * (t - at_wall)
        return -ride / omega * math.sin(omega * t) - a

    meeting = float(brentq(gap, at_wall, 1.5 * at_wall, xtol=1e-30, rtol=1e-14))
    impacts = [
        e
        for e in run(scene, RTOL, begun + 0.2 / omega, solver=solver).events
        if e.kind is EventKind.IMPACT
    ][:2]
    assert [e.contact for e in impacts] == [0, 1]
    accuracy = allowed(1.0)
    assert impacts[0].t == pytest.approx(begun + at_wall, rel=accuracy)
    assert impacts[1].t - impacts[0].t == pytest.approx(meeting - at_wall, rel=1e-4)
    approach = -ride * (eps + math.cos(omega * meeting))
    assert impacts[1].gap_velocity_before == pytest.approx(approach, rel=accuracy)


def test_a_ledger_that_ends_at_nothing_still_closes(solver):
    # A free body is at rest again after a whole sine: every term of the ledger vanishes.
    scene = Scene((Body("m", 2.0),), motion=Sine(1.0, 1.5))
    recording = run(scene, RTOL, 3.0, solver=solver, energy=True)
    assert abs(recording.energy.closure) < allowed(1.0)


def test_a_force_that_vanishes_as_the_row_meets_a_barrier(solver):
    """The impact presses together what its vanishing force was about to let go.

    On springs of their own, k_b/m_b > k_a/m_a, the force between two bodies in touch is a
    multiple of their common displacement, so it vanishes where they come back to the
    barrier, whatever the ground does; which presses them on it then, ever less, until 4 s.
    """
    scene = Scene(
        (Body("a", 1.0, 0.0, 0.5), Body("b", 0.5, 0.0, 0.5)),
        (Spring("k", (GROUND, "a"), Linear(1.0)), Spring("l", (GROUND, "b"), Linear(1.0))),
        contacts=(Contact("wall", BARRIER, "a", 0.0, 0.0), Contact("joint", "a", "b", 0.0, 0.0)),
        motion=Sine(0.1, 8.0),
    )
    recording = run(scene, 1e-9, 3.9, solver=solver)
    np.testing.assert_array_equal(recording.u, [0.0, 0.0])
    np.testing.assert_array_equal(recording.v, [0.0, 0.0])
    np.testing.assert_array_equal(recording.displacement.minimum, [0.0, 0.0])
    assert EventKind.DETACHMENT not in [event.kind for event in recording.events]
    # λ = (m_a + m_b) a_g between wall and row, m_b a_g within the row.
    push = 0.1 * np.sin(2.0 * np.pi * 3.9 / 8.0)
    np.testing.assert_allclose(recording.history.contact_force[-1], [1.5 * push, 0.5 * push])


@pytest.mark.parametrize("pulse", [Ricker, AntisymmetricRicker])
@pytest.mark.parametrize("company", [False, True], ids=["alone", "beside another"])
def test_a_force_that_dies_away_holds(solver, company, pulse):
    """The tail of a pulse presses a body without a spring for ever, however little.

    What another body does meanwhile, which meets its own barrier again and again, is nothing
    to the first.
    """
    end = 6.0
    late = np.linspace(4.0, end, 200)
    motion = pulse(3.0, 1.0)
    if motion.acceleration(late)[0] < 0.0:
        motion = pulse(3.0, 1.0, reverse=True)
    assert np.all(motion.acceleration(late) > 0.0)
    bodies, springs = [Body("a", 1.3)], []
    contacts = [Contact("wall", BARRIER, "a", 0.0, 0.0), Contact("stop", "a", BARRIER, 0.01, 0.0)]
    if company:
        bodies.append(Body("b", 0.7, 0.0, 0.4))
        springs.append(Spring("b", (GROUND, "b"), Linear(55.0)))
        contacts.append(Contact("other", "b", BARRIER, 0.01, 0.9))
    scene = Scene(tuple(bodies), tuple(springs), (), tuple(contacts), motion)
    recording = run(scene, RTOL, end, solver=solver)
    mine = [e for e in recording.events if e.contact == 0]
    others = [e for e in recording.events if e.contact == 2 and e.t > 4.5]
    assert mine[-1].kind is EventKind.REST
    assert mine[-1].t < 4.0
    assert company == bool(others)


@pytest.mark.parametrize("turned", [False, True], ids=["to ground", "from ground"])
@pytest.mark.parametrize("reverse", [False, True], ids=["left", "right"])
def test_a_kink_at_the_start_is_left_the_way_the_ground_sets_out(solver, turned, reverse):
    # Nothing acts at the start, neither springs nor ground, whose acceleration grows from zero
    # and takes both bodies along; what parts them is of fifth order, the difference of their
    # stiffnesses. On the branch that a goes to it is softer than b, on the other one stiffer.
    # Alone, u = -(a_p/(ω² - Ω²)) (sin Ωt - (Ω/ω) sin ωt).
    a_p, side = 3.0, 1.0 if reverse else -1.0
    extends = side > 0.0 if not turned else side < 0.0
    law = BilinearElastic(25.0, 4.0) if extends else BilinearElastic(4.0, 25.0)
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        (
            Spring("kinked", ("a", GROUND) if turned else (GROUND, "a"), law),
            Spring("straight", (GROUND, "b"), Linear(9.0)),
        ),
        contacts=(Contact("joint", *(("b", "a") if reverse else ("a", "b")), 0.0, 0.5),),
        motion=Sine(a_p, 2.0 * math.pi, reverse=reverse),
    )
    end = 1.0
    recording = run(scene, RTOL, end, solver=solver)
    assert recording.events == ()
    expected = [
        side * a_p / (omega**2 - 1.0) * (math.sin(end) - math.sin(omega * end) / omega)
        for omega in (2.0, 3.0)
    ]
    np.testing.assert_allclose(recording.u, expected, rtol=allowed(10.0))


@pytest.mark.parametrize("part", [1e-12, 1e-11, 1e-10])
def test_bodies_that_accelerate_almost_alike_part(part):
    # Both are let go from x0, where they touch: x = x0 cos ωt, and so the gap is
    # 2 x0 sin((ω_a + ω_b) t/2) sin((ω_a - ω_b) t/2).
    x0, k = -1.0, 4.0
    scene = Scene(
        (Body("a", 1.0, x0), Body("b", 1.0, x0)),
        (Spring("s", (GROUND, "a"), Linear(k)), Spring("t", (GROUND, "b"), Linear(k * (1 + part)))),
        contacts=(Contact("joint", "a", "b", 0.0, 0.5),),
    )
    times = np.array([0.01, 0.1, 0.2])
    recording = solver_named("fast").solve(Task(scene, 0.0, 0.3, 1e-12, output_times=times))
    assert recording.events == ()
    seen = np.isin(recording.history.t, times)
    mean = math.sqrt(k) * (1.0 + 0.25 * part)
    expected = -x0 * np.sin(mean * times) * math.sqrt(k) * 0.5 * part * times
    np.testing.assert_allclose(recording.history.gap[seen, 0], expected, rtol=1e-3)


@pytest.mark.parametrize("seeds", [range(15), range(15, 30)], ids=["few", "more"])
def test_an_impulse_passed_on_opens_nothing(solver, seeds):
    # a stands at its wall on an unstrained stiff spring, b hits it, all without restitution: the
    # impulse goes through a into the wall, and afterwards nothing acts on a. The ground is still.
    for seed in seeds:
        rng = np.random.default_rng(seed)
        m_a, m_b = rng.uniform(1.0, 10.0, 2)
        k_a = m_a * (2.0 * math.pi * 10.0 ** rng.uniform(1.0, 3.0)) ** 2
        scene = Scene(
            (Body("a", m_a), Body("b", m_b, 0.0, -rng.uniform(0.5, 2.0))),
            (
                Spring("stiff", (GROUND, "a"), Linear(k_a)),
                Spring("soft", (GROUND, "b"), Linear(m_b * rng.uniform(1.0, 40.0))),
            ),
            (Dashpot((GROUND, "a"), 0.1 * math.sqrt(k_a * m_a)),),
            (
                Contact("wall", BARRIER, "a", 0.0, 0.0),
                Contact("joint", "a", "b", rng.uniform(0.01, 0.03), 0.0),
            ),
            Sine(2.0, 1.0, start=-2.0),
        )
        recording = run(scene, RTOL, 0.1, solver=solver)
        kinds = [event.kind for event in recording.events if event.contact == 0]
        assert kinds == [EventKind.REST, EventKind.IMPACT]
        assert recording.v[0] == 0.0


def test_bodies_without_springs_part_from_a_third_together(solver):
    # Both contact forces are parts of one spring force, so they vanish in one instant, in which
    # rounding has hold of the smaller first. What is left of it is nothing that parts b from c.
    bodies = tuple(
        Body(name, mass, -0.05) for name, mass in zip("abc", (0.6, 4.5, 0.15), strict=True)
    )
    contacts = (Contact("ab", "a", "b", 0.0, 0.0), Contact("bc", "b", "c", 0.0, 0.0))
    spring, dashpot = Spring("s", (GROUND, "a"), Linear(80.0)), Dashpot((GROUND, "a"), 0.7)
    scene = Scene(bodies, (spring,), (dashpot,), contacts)
    for rtol in np.geomspace(1e-5, 1e-11, 61):
        recording = solver_named(solver).solve(Task(scene, 0.0, 0.5, rtol))
        told = [(e.kind, e.contact) for e in recording.events if e.t > 0.0]
        assert told == [(EventKind.DETACHMENT, 0)], rtol
