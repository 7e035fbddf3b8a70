"""Reversals of hysteretic links: where they are found, and what they leave of a tolerance."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from eventpound.mechanics.elements import z_rate
from eventpound.mechanics.ground_frame import NO_FRAME, frame_motion, moving_frame
from eventpound.mechanics.model import assemble
from eventpound.mechanics.reduced import Reduced
from eventpound.motion.base import Family
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.reversals import first_reversal, may_reverse, take_directions
from eventpound.solvers.events.short_series import _first_reversal
from eventpound.solvers.sundials.wrapped import WrappedCvode
from eventpound.tolerances import HELD_BELOW, REVERSAL_WITHIN, SERIES_SHARE
from tests.mechanics.dense import memory_of
from tests.mechanics.scenes import clusters_of, reduced

LAW = BoucWen(0.0, 1.0, 1e-2, 5.0, 0.7, 0.3)
START, END = 0.2, 1.0
NEAR = 4.0 * REVERSAL_WITHIN


def _system(*ends: tuple[str, str]) -> Reduced:
    """Two bodies with a hysteretic spring between each of the pairs of ends, none in touch."""
    springs = tuple(Spring(f"s{i}", pair, LAW) for i, pair in enumerate(ends))
    model = assemble(Scene((Body("a", 1.0), Body("b", 2.0)), springs))
    stiffness = np.zeros(len(ends))
    return reduced(model, clusters_of(model, []), stiffness, stiffness, ledger=False)


def _step(system: Reduced, speeds: list[Polynomial], frame: Floats = NO_FRAME) -> Dense:
    """A step over which the bodies have these speeds, as powers of the time before its end."""
    Y = np.zeros((max(p.degree() for p in speeds) + 1, system.size))
    for c, p in enumerate(speeds):
        shifted = p(Polynomial([END, 1.0])).coef
        Y[: shifted.size, system.iv[c]] = shifted
    return Dense(Y, END, START, END, frame, False, NO_GAPS)


def _crossing(*roots: float) -> Polynomial:
    """A speed with these roots, positive before the first."""
    return Polynomial.fromroots(roots) * (-1.0) ** len(roots)


@pytest.mark.parametrize(("z", "sign"), [(0.8, 1.0), (0.8, -1.0), (-0.8, 1.0), (-0.8, -1.0)])
def test_beyond_a_reversal_the_rate_of_z_goes_on(z, sign):
    """With a direction it is linear in x', and that of the law where x' has the direction."""
    law = memory_of(5.0, 0.7, 0.3, 1e-2)
    rates = [z_rate(0, law, x_rate, sign, z, 0.0) for x_rate in (-1.0, 1.0, 2.0)]
    np.testing.assert_allclose(rates, rates[1] * np.array([-1.0, 1.0, 2.0]), rtol=1e-14)
    assert rates[1] * sign == pytest.approx(z_rate(0, law, sign, sign, z, 0.0))


@pytest.mark.usefixtures("interpreted")
def test_directions_are_those_of_the_motion_and_stay():
    system = _system((GROUND, "a"), ("a", "b"), (GROUND, "b"))
    y, direction = np.zeros(system.size), np.array([0.0, 0.0, -1.0])
    y[system.iv] = 1.0, 1.0
    take_directions(y, system, HELD_BELOW, direction)
    np.testing.assert_array_equal(direction, [0.0, 0.0, -1.0])
    take_directions(y, system, 0.99 * HELD_BELOW, direction)
    # The second link does not move, and the third keeps the one it has.
    np.testing.assert_array_equal(direction, [1.0, 0.0, -1.0])


@pytest.mark.usefixtures("interpreted")
def test_the_first_of_several_reversals():
    """Links that reverse in the same instant do so together; others wait."""
    system = _system((GROUND, "a"), (GROUND, "b"), ("b", GROUND), ("a", "b"))
    step = _step(system, [_crossing(0.9), _crossing(0.7)])
    # x' of the last is -0.2 throughout.
    direction = np.array([1.0, 1.0, -1.0, -1.0])
    assert first_reversal(step, END, 0.0, system, direction) == pytest.approx(0.7, abs=NEAR)
    np.testing.assert_array_equal(direction, [1.0, -1.0, 1.0, -1.0])
    # One that lies where the step begins is a little later, so that time goes on.
    late = first_reversal(
        step._replace(start=0.7), END, 0.0, system, np.array([1.0, 1.0, -1.0, -1.0])
    )
    assert 0.7 < late < 0.7 + 4 * REVERSAL_WITHIN
    assert first_reversal(step, 0.8, 0.0, system, np.array([1.0, 0.0, 0.0, 0.0])) == np.inf
    rest = step._replace(start=0.75)
    assert first_reversal(rest, END, 0.0, system, direction) == pytest.approx(0.9, abs=NEAR)
    np.testing.assert_array_equal(direction, [-1.0, -1.0, 1.0, -1.0])
    assert first_reversal(step._replace(start=0.95), END, 0.0, system, direction) == np.inf


@pytest.mark.usefixtures("interpreted")
def test_two_reversals_within_a_step_are_seen():
    """Its ends move alike; the parabola through them tells that it may have turned between."""
    system = _system((GROUND, "a"))
    speed = _crossing(0.5, 0.7)
    step = _step(system, [speed, Polynomial([0.0])])
    before, rate, after = np.zeros((3, system.size))
    place = system.iv[0]
    before[place], after[place], rate[place] = speed(START), speed(END), speed.deriv()(START)
    before[system.iz[0]] = after[system.iz[0]] = 0.9
    direction = np.ones(1)
    assert may_reverse(before, rate, after, END - START, system, direction, 1e-9)
    assert first_reversal(step, END, 0.0, system, direction) == pytest.approx(0.5, abs=NEAR)
    assert direction[0] == -1.0


@pytest.mark.usefixtures("interpreted")
def test_what_does_not_matter_only_changes_the_direction():
    system = _system((GROUND, "a"))
    before, rate, after = np.zeros((3, system.size))
    before[system.iv[0]], after[system.iv[0]], rate[system.iv[0]] = 1e-3, -1e-3, -1.0
    direction = np.ones(1)
    for z, matters in ((0.9, True), (1e-3, False)):
        before[system.iz[0]] = after[system.iz[0]] = z
        # z errs by some 2 γ |z|^n |x'| h / u_y.
        errs = 2.0 * 0.3 * z**5.0 * 1e-3 * 2e-3 / 1e-2
        assert (errs > 1e-11) == matters
        assert may_reverse(before, rate, after, 2e-3, system, direction, 1e-11) == matters
    assert direction[0] == -1.0


@pytest.mark.usefixtures("interpreted")
def test_one_that_does_not_matter_waits_for_one_that_does():
    """The step ends where the second link reverses, perhaps before the first has."""
    system = _system((GROUND, "a"), (GROUND, "b"))
    before, rate, after = np.zeros((3, system.size))
    before[system.iv], after[system.iv], rate[system.iv] = 1e-3, -1e-3, -1.0
    before[system.iz] = after[system.iz] = 1e-3, 0.9
    direction = np.ones(2)
    assert may_reverse(before, rate, after, 2e-3, system, direction, 1e-11)
    np.testing.assert_array_equal(direction, [1.0, 1.0])


@pytest.mark.usefixtures("interpreted")
def test_in_a_moving_frame_the_links_reverse_where_they_do_on_the_ground():
    record = Record(np.random.default_rng(3).normal(size=9), 0.25)
    sampled = next(piece for piece in record.pieces() if piece.family is Family.SAMPLES)
    frame, origin = moving_frame(sampled), 0.3
    system = _system((GROUND, "a"), ("b", GROUND), ("a", "b"))
    carried = Polynomial([0.4, 0.3, -1.0])
    step = _step(system, [carried, 0.5 * carried + 0.1], frame)
    for a, speed in enumerate(
        (
            lambda t: carried(t) - frame_motion(frame, origin + t)[1],
            lambda t: frame_motion(frame, origin + t)[1] - 0.5 * carried(t) - 0.1,
            lambda t: 0.1 - 0.5 * carried(t),
        )
    ):
        direction = np.zeros(3)
        direction[a] = np.sign(speed(START))
        tau = first_reversal(step, END, origin, system, direction)
        assert direction[a] * speed(END) > 0.0
        assert abs(speed(tau)) < 1e-11


LENGTH = 8.6611213763226
STRUCK = Scene(
    (Body("b0", 53.74993830345716),),
    (
        Spring(
            "s0",
            (GROUND, "b0"),
            BoucWen(0.0, 114.01281726082472, 0.0026350760012257162, 5.0, 0.7, 0.3),
        ),
    ),
    (),
    (Contact("c0", "b0", BARRIER, 0.0, 0.5),),
    Harmonic(3.609418840984806, 1.1169314279644957),
)
"""An elastoplastic body struck four times; its motion is 70 u_y."""


@pytest.mark.parametrize("events", ["own", "sundials"])
def test_a_tighter_tolerance_gives_a_smaller_error(events):
    """Some hundred rtol at most; where reversals were stepped over, 3000."""
    truth = response_of(STRUCK, "fast", 1e-13, duration=LENGTH).recording
    size = abs(truth.displacement.minimum[0])
    for rtol in np.geomspace(0.99 * HELD_BELOW, 1e-12, 9):
        run = response_of(
            STRUCK, "cvode", rtol, duration=LENGTH, settings={"events": events}
        ).recording
        assert abs(run.u[0] - truth.u[0]) < 400.0 * rtol * size


def test_without_compiled_calls_the_steps_end_there_too():
    """The steps of scikit-sundae's own interface, which take long: the first two seconds."""
    task = Task(STRUCK, 0.0, 2.0, 1e-11)
    truth = solver_named("fast").solve(replace(task, rtol=1e-13))
    direct, wrapped = (
        EventLoop(task, way).run()
        for way in (integrator(task.rtol, "Adams"), WrappedCvode(task.rtol, "Adams"))
    )
    size = abs(truth.displacement.minimum[0])
    assert wrapped.u[0] == pytest.approx(truth.u[0], abs=400.0 * task.rtol * size)
    assert wrapped.work.steps == pytest.approx(direct.work.steps, rel=0.05)


def test_a_short_series_sees_a_reversal_after_all_the_way_that_its_terms_make():
    """All terms of the rate are as large: the way is 2.6 of one, and z bends by that much."""
    system = _system((GROUND, "a"))
    (z,) = system.iz[system.iz >= 0]
    Y = np.zeros((8, system.size))
    Y[:7, system.iv[0]] = 1e-3 * np.array([1, 1, 1, -1, -1, -1, -1])
    way = sum(1e-3 / (k + 1) for k in range(7))
    turn = min(
        root.real for root in Polynomial(Y[:7, system.iv[0]]).roots() if root.imag == 0 < root.real
    )
    weight = np.ones(system.size)
    for share, found in ((0.9, turn), (1.1, 1.0)):
        weight[z] = share * (way / 1e-2) ** 6.0 / SERIES_SHARE
        assert _first_reversal(Y, system, weight, 1.0) == pytest.approx(found, rel=1e-12)
