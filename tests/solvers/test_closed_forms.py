"""Runs whose answer is known in closed form."""

import math

import numpy as np
import pytest

from eventpound.motion.pulses import Sine
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers.base import EventKind
from tests.solvers.accuracy import RTOL, allowed
from tests.solvers.exact import Oscillator


@pytest.mark.parametrize("last", [0.07, 0.4, 3.0])
def test_a_body_that_first_goes_the_other_way(solver, last):
    """A free body at rest under a_g = a + s t goes to -2/3 a³/s² at t = -2a/s, and back.

    The whole of it is one step, in which that is a dip of a few thousandths.
    """
    a, b, dt = 0.07, -0.6, last
    wall = Contact("wall", "m", BARRIER, 1e3, 0.5)
    scene = Scene((Body("m", 1.0),), (), (), (wall,), motion=Record(np.array([a, b, b]), dt))
    s = (b - a) / dt
    run = response_of(scene, solver, rtol=RTOL, duration=dt).recording
    lowest = -2.0 / 3.0 * a**3 / s**2
    assert run.displacement.minimum[0] == pytest.approx(lowest, rel=1e-6)
    assert run.displacement.time_of_minimum[0] == pytest.approx(-2.0 * a / s, rel=1e-5)
    assert -lowest < 0.01 * run.displacement.maximum[0]


def _oscillator_scene(exact: Oscillator, u: float, v: float) -> Scene:
    mass = 2.0
    spring = Spring("k", (GROUND, "m"), Linear(mass * exact.omega**2))
    contact = Contact("wall", "m", BARRIER, exact.gap, exact.restitution)
    motion = {"motion": Sine(exact.a_p, 2.0 * math.pi / exact.p)} if exact.a_p else {}
    return Scene((Body("m", mass, u, v),), (spring,), (), (contact,), **motion)


@pytest.mark.parametrize(
    ("exact", "u", "v", "end"),
    [
        (Oscillator(1.0, 0.5, 0.7), 0.0, 1.0, 20.0),
        (Oscillator(3.0, -0.1, 1.0), -0.4, 0.0, 6.0),
        (Oscillator(2.0, 0.05, 0.9, 1.5, 3.0), 0.0, 0.0, 8.0),
        (Oscillator(1.3, 0.1, 1.0, 2.0, 0.9), 0.02, -0.3, 12.0),
    ],
    ids=["free", "pressed", "sine", "elastic-impacts"],
)
@pytest.mark.parametrize("rtol", [1e-6, RTOL])
def test_elastic_oscillator_with_a_barrier(solver, exact, u, v, end, rtol):
    times, speeds, u_end, v_end = exact.solve(u, v, end)
    run = response_of(_oscillator_scene(exact, u, v), solver, rtol=rtol, duration=end).recording
    impacts = [e for e in run.events if e.kind is EventKind.IMPACT]
    assert len(run.events) == len(impacts) == len(times)
    scale = max(speeds)
    # Slow impacts turn errors of position into errors of time: δt = δu/γ, and the speed
    # after one differs by the acceleration times δt.
    slow = scale / min(speeds)
    np.testing.assert_allclose(
        [e.t for e in impacts], times, rtol=0.0, atol=slow * allowed(1, rtol)
    )
    np.testing.assert_allclose(
        [-e.gap_velocity_before for e in impacts],
        speeds,
        rtol=0.0,
        atol=slow * allowed(scale, rtol),
    )
    assert run.u[0] == pytest.approx(u_end, abs=slow * allowed(scale, rtol))
    assert run.v[0] == pytest.approx(v_end, abs=slow * allowed(scale, rtol))
    lost = sum(0.5 * 2.0 * s**2 * (1.0 - exact.restitution**2) for s in speeds)
    assert sum(e.energy_lost for e in impacts) == pytest.approx(
        lost, abs=slow * allowed(2.0 * scale**2, rtol)
    )


def test_peaks_are_located_not_sampled(solver):
    # u = cos(t - 1) over two periods, no contact: 1 at t = 1, -1 at 1 + π, first attainments.
    spring = Spring("k", (GROUND, "m"), Linear(1.0))
    body = Body("m", 1.0, math.cos(1.0), math.sin(1.0))
    run = response_of(
        Scene((body,), (spring,)), solver, rtol=1e-12, duration=4 * math.pi, output_step=3.0
    )
    x = run.recording.displacement
    # At an extreme the value errs by the tolerance, the time by that of v over u''.
    assert x.maximum[0] == pytest.approx(1.0, abs=allowed(1.0, 1e-12))
    assert x.minimum[0] == pytest.approx(-1.0, abs=allowed(1.0, 1e-12))
    assert x.time_of_maximum[0] % (2 * math.pi) == pytest.approx(1.0, abs=allowed(1.0, 1e-12))
    assert x.time_of_minimum[0] % (2 * math.pi) == pytest.approx(
        1.0 + math.pi, abs=allowed(1.0, 1e-12)
    )


def _pushed_ball(restitution: float, side: str) -> Scene:
    """A free body pushed against a barrier by a constant ground acceleration for 40 s."""
    sign = 1.0 if side == "right" else -1.0
    ends = ("m", BARRIER) if side == "right" else (BARRIER, "m")
    motion = Record(np.full(41, -2.0 * sign), 1.0)
    return Scene((Body("m", 3.0),), (), (), (Contact("wall", *ends, 0.25, restitution),), motion)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("eps", [0.0, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("rtol", [1e-6, 1e-12])
def test_bouncing_ball_reaches_its_limit(solver, eps, side, rtol):
    # Push a = 2: first impact at t_1 = sqrt(2 δ/a) = 1/2 with v = a t_1 = 1, then
    # intervals 2 v ε^i/a: t_∞ = t_1 + 2 v ε/(a (1 - ε)).
    limit = 0.5 + eps / (1.0 - eps)
    run = response_of(_pushed_ball(eps, side), solver, rtol=rtol, duration=20.0).recording
    rest = [e for e in run.events if e.kind is EventKind.REST]
    assert len(rest) == 1
    # The promise is 1e-10 of the limit time at the tightest tolerance: 100 rtol.
    accuracy = 100.0 * rtol
    assert rest[0].t == pytest.approx(limit, rel=accuracy)
    before = [e for e in run.events if e.kind in (EventKind.IMPACT, EventKind.ACCUMULATION)]
    assert before[0].t == pytest.approx(0.5, rel=1e-12)
    # Momentum and energy of the whole cascade: 3 Σ (1 + ε) ε^i and ½ 3 v².
    assert sum(e.impulse for e in before) == pytest.approx(
        3.0 * (1 + eps) / (1 - eps), rel=accuracy
    )
    assert sum(e.energy_lost for e in before) == pytest.approx(1.5, rel=accuracy)
    if eps:
        # Counted, not listed, are closing speeds from 1e-9 of the first, 1 m/s, to 1e-15 of the
        # scene's own, L/T = sqrt(δ a) = sqrt(1/2) m/s: a constant motion has no mean period.
        assert before[-1].kind is EventKind.ACCUMULATION
        decades = 6.0 - 0.5 * np.log10(0.5)
        assert before[-1].count == pytest.approx(-decades / np.log10(eps), abs=2.0)
        listed = [e.gap_velocity_before for e in before[:-1]]
        expected = -(eps ** np.arange(len(listed)))
        np.testing.assert_allclose(listed, expected, rtol=accuracy)
    assert abs(run.u[0]) == 0.25
    assert run.v[0] == 0.0
    assert run.resting_time[0] == pytest.approx(20.0 - limit, abs=accuracy * limit)
    assert run.max_force[0] == pytest.approx(3.0 * 2.0, rel=1e-12)


def test_rest_ends_where_the_push_turns(solver):
    # a_g falls linearly from -2 at t = 10 to 2 at t = 20: λ = -m a_g vanishes at t = 15.
    samples = np.array([-2.0, -2.0, 2.0, 2.0])
    scene = Scene(
        (Body("m", 3.0),),
        (),
        (),
        (Contact("wall", "m", BARRIER, 0.25, 0.5),),
        Record(samples, 10.0),
    )
    run = response_of(scene, solver, rtol=RTOL, duration=25.0).recording
    last = run.events[-1]
    assert last.kind is EventKind.DETACHMENT
    # The first move is of third order in time: g = 0.4 τ³/6; force noise over its slope.
    assert last.t == pytest.approx(15.0, abs=allowed(1.0))
    # u = δ - 0.4 τ³/6 to t = 20, then at 2 m/s² on.
    u, v = 0.25 - 0.4 * 5.0**3 / 6.0, -0.4 * 5.0**2 / 2.0
    u, v = u + 5.0 * v - 25.0, v - 10.0
    assert run.u[0] == pytest.approx(u, rel=allowed(1.0))
    assert run.v[0] == pytest.approx(v, rel=allowed(1.0))


def _squeezed_light_body(light: float, eps: float) -> Scene:
    bodies = (Body("a", 1.0, 0.0, 1.0), Body("b", light, 0.0, 0.2), Body("c", 2.0, 0.0, -1.0))
    contacts = (Contact("ab", "a", "b", 0.3, eps), Contact("bc", "b", "c", 0.5, eps))
    return Scene(bodies, (), (), contacts)


@pytest.mark.parametrize(("light", "eps"), [(1e-3, 0.5), (1e-2, 0.5), (0.02, 0.3)])
def test_light_body_between_heavy_ones_collapses(solver, light, eps):
    # In the limit all three move at their common mean velocity, and the centre of mass
    # and the closed gaps say where they are.
    scene = _squeezed_light_body(light, eps)
    end = 3.0
    run = response_of(scene, solver, rtol=RTOL, duration=end).recording
    mass = np.array([b.mass for b in scene.bodies])
    v0 = np.array([b.velocity for b in scene.bodies])
    mean = mass @ v0 / mass.sum()
    np.testing.assert_allclose(run.v, mean, rtol=0.0, atol=1e-12)
    assert {e.kind for e in run.events} >= {EventKind.IMPACT, EventKind.REST}
    assert [e.contact for e in run.events if e.kind is EventKind.REST] in ([0, 1], [1, 0])
    gaps = np.array([0.3 + run.u[1] - run.u[0], 0.5 + run.u[2] - run.u[1]])
    np.testing.assert_allclose(gaps, 0.0, atol=1e-14)
    # Without forces the centre of mass moves at its mean velocity throughout.
    assert mass @ run.u / mass.sum() == pytest.approx(mean * end, abs=allowed(1.0))
    lost = 0.5 * mass @ v0**2 - 0.5 * mass.sum() * mean**2
    assert sum(e.energy_lost for e in run.events) == pytest.approx(lost, rel=1e-11)


def test_elastic_oscillator_over_a_hundred_periods(solver):
    spring = Spring("k", (GROUND, "m"), Linear(4.0))
    scene = Scene((Body("m", 1.0, 0.3, -0.5),), (spring,))
    end = 100.0 * math.pi + 1.0
    run = response_of(scene, solver, rtol=1e-11, duration=end, energy=True)
    u = 0.3 * math.cos(2.0 * end) - 0.25 * math.sin(2.0 * end)
    v = -0.6 * math.sin(2.0 * end) - 0.5 * math.cos(2.0 * end)
    # A hundred periods instead of a few: ten times as many steps.
    assert run.recording.u[0] == pytest.approx(u, abs=10 * allowed(0.4, 1e-11))
    assert run.recording.v[0] == pytest.approx(v, abs=10 * allowed(0.8, 1e-11))
    assert abs(run.energy.closure) < 10 * allowed(1.0, 1e-11)


@pytest.mark.parametrize("solver", ["fast", "cvode"])
def test_a_record_without_a_mean_period(solver):
    """Of constant acceleration a: u = (a/ω²)(cos ωt - 1), free once it ends; gap of a body far."""
    omega, a, end = 2.0 * math.pi, 0.5, 10.25
    scene = Scene(
        (Body("b", 2.0),),
        (Spring("s", (GROUND, "b"), Linear(2.0 * omega**2)),),
        motion=Record(np.full(2, a), end),
    )
    response = response_of(scene, solver, RTOL, duration=12.0)
    static = a / omega**2
    # At 10.25 s it is at -a/ω² with the speed -a/ω: an amplitude of 2^½ a/ω² about zero after that.
    assert response.peaks.loc["b", "min"] == pytest.approx(-2.0 * static, rel=100.0 * RTOL)
    assert response.peaks.loc["b", "max"] == pytest.approx(2.0**0.5 * static, rel=100.0 * RTOL)
    assert response.runs.scales is None
