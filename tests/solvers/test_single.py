"""The kernel of a single body, instant by instant and step by step."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from eventpound.contact import modes
from eventpound.contact.event_rows import ACCUMULATION, EVENT_WIDTH, IMPACT
from eventpound.mechanics.impact import impact_law
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.monitored import Running, blank_extremes, places_in
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Task
from eventpound.solvers.events.recorder import row_width
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.constants import begin_state, blank_series, plan_of, zero_state
from eventpound.solvers.fast.run import FastPlan, FastRecord, FastState
from eventpound.solvers.fast.sdof.body import SdofRun, load_body
from eventpound.solvers.fast.sdof.exact import fill_table
from eventpound.solvers.fast.sdof.oscillator import settle_sdof, stays_closed
from eventpound.solvers.fast.sdof.step import equations_hold
from eventpound.tolerances import LAST_SPEED
from tests.numerics.problems import joints
from tests.solvers.test_modes import TABLE

pytestmark = pytest.mark.usefixtures("interpreted")

RESTITUTION, GAP, MASS = 0.6, 0.2, 1.3
REST, SEPARATION = 2.0, 4.0
SIDES = [1.0, -1.0]


def blank_record(task: Task, model: Model) -> FastRecord:
    scales = scene_scales(task.scene, model, task.end - task.start)
    return FastRecord(
        np.zeros((400, EVENT_WIDTH)),
        np.zeros((400, row_width(model))),
        blank_extremes(places_in(model), scales),
        np.ones(model.contacts, np.bool_),
    )


def prepared(task: Task) -> tuple[Model, FastPlan, FastState]:
    model = assemble(task.scene)
    plan = plan_of(task, model, scene_scales(task.scene, model, task.end - task.start))
    state = zero_state(model.counts)
    begin_state(plan, model.u0, model.v0, model.z0, 0.0, state)
    return model, plan, state


def at_barrier(side: float, closed: bool, gap_rate: float, resting: bool = False) -> SdofRun:
    """A run of a body on a spring between two barriers, near or at one of them."""
    contacts = (
        Contact("right", "a", BARRIER, GAP, RESTITUTION),
        Contact("left", BARRIER, "a", GAP, RESTITUTION),
    )
    spring = Spring("s", (GROUND, "a"), Linear(1.0))
    motion = Sine(1.0, 2.0 * np.pi)
    task = Task(Scene((Body("a", MASS),), (spring,), (), contacts, motion), 0.0, 6.0, 1e-8)
    model, plan, state = prepared(task)
    series = blank_series(plan)
    body, record = series.sdof.body[0], blank_record(task, model)
    run = SdofRun(
        body,
        state.now[0],
        state.progress[0],
        record.events,
        record.rows,
        Running(*record.extremes, places_in(model)),
        plan.hysteresis.tables,
        plan,
        series.sdof,
    )
    load_body(plan, state, run)
    gap = 0.0 if closed else 0.1
    near, far = gap, 2.0 * GAP - gap
    body.right, body.left = (near, far) if side > 0.0 else (far, near)
    body.u, body.v = side * (GAP - gap), -side * gap_rate
    body.rests_on = side if resting else 0.0
    return run


def settle(run: SdofRun, g: float) -> None:
    """Settle under a ground acceleration that stays as it is (m/s²)."""
    piece = CurrentPiece(int(Family.SAMPLES), np.array([0.0, 1.0]), np.full(3, g), 2.0)
    settle_sdof(g, piece, run)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(("before", "gap", "gap_rate", "duty"), TABLE)
def test_duty(before, gap, gap_rate, duty, side):
    """The rows of the table of modes; what presses the body on the barrier is the ground."""
    run = at_barrier(side, gap == 0.0, gap_rate, before == "resting")
    settle(run, -side * 3.0)
    body, kinds = run.body, run.events[: run.now.events, 1].tolist()
    after = -side * body.v
    if duty == modes.NONE:
        assert after == gap_rate
        assert body.rests_on == 0.0
    elif duty == modes.IMPACT:
        # Below the last speed of a cascade it is plastic, and the ground presses.
        last = -gap_rate <= LAST_SPEED * run.plan.limits.length / run.plan.limits.time
        assert after == (0.0 if last else -RESTITUTION * gap_rate)
        assert kinds[0] == (ACCUMULATION if last else IMPACT)
        assert body.rests_on == (side if last else 0.0)
    else:
        assert body.rests_on == side
        assert kinds == ([] if before == "resting" else [REST])
    if before == "resting" and duty != modes.ACCELERATION:
        assert kinds[-1] == SEPARATION


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("eps", [0.0, 0.35, 1.0])
def test_impact_is_that_of_the_law(side, eps):
    run = at_barrier(side, True, -0.7)
    run.plan.contacts.restitution[:] = eps
    settle(run, 0.0)
    j = run.plan.oscillator.right if side > 0.0 else run.plan.oscillator.left
    rate, v = np.where(np.arange(2) == j, -0.7, 0.7), np.array([side * 0.7])
    ends = np.array([0, -1]), np.array([-1, 0])
    impulse, _, lost, solved = impact_law(
        joints(*ends, np.array([MASS])),
        np.array([MASS]),
        np.full(2, eps),
        np.arange(2) == j,
        rate,
        v,
    )
    event = run.events[0]
    assert solved
    assert event[3] == j
    assert run.body.v == pytest.approx(v[0], abs=1e-15)
    np.testing.assert_allclose(event[4:8], [-0.7, rate[j], impulse[j], lost], atol=1e-15)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(
    ("coefficients", "stays"),
    [
        # Of the ground's acceleration towards the left barrier's side, from order 1 on.
        ([1.0], False),
        ([-1.0], True),
        ([0.0, 1.0], False),
        ([0.0, -1.0, 5.0], True),
        ([0.0, 0.0, 1.0], False),
        ([0.0, 0.0, 0.0], True),
        ([1e-15, -1.0], True),
    ],
)
def test_a_vanished_force_is_decided_by_the_first_coefficient(side, coefficients, stays):
    """On the right barrier λ = m (A - a_g) falls where a_g grows."""
    cubic = np.zeros(4)
    cubic[1 : 1 + len(coefficients)] = side * np.array(coefficients)
    numbers = np.concatenate(([0.0, 1e-30], cubic))
    run = at_barrier(side, True, 0.0, resting=True)
    piece = CurrentPiece(int(Family.GAUSSIAN), numbers, np.empty(0), np.inf)
    found = stays_closed(side, piece, run)
    assert bool(found) is stays


def test_a_body_squeezed_between_two_barriers_is_left_to_the_general_kernel():
    spring = Spring("s", (GROUND, "a"), Linear(1.0))
    contacts = (
        Contact("right", "a", BARRIER, 0.0, RESTITUTION),
        Contact("left", BARRIER, "a", 0.0, RESTITUTION),
    )
    scene = Scene((Body("a", 1.0),), (spring,), (), contacts, Sine(1.0, 2.0 * np.pi))
    assert not prepared(Task(scene, 0.0, 6.0, 1e-8))[1].oscillator.alone
    wide = replace(scene, contacts=(replace(contacts[0], gap=1e-3), contacts[1]))
    assert prepared(Task(wide, 0.0, 6.0, 1e-8))[1].oscillator.alone


@pytest.mark.parametrize("dt", [1e-9, 0.005, 0.08])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_a_table_is_that_of_the_matrix_exponential(dt, damping):
    """Without damping every other term of the series is zero."""
    body, step, stiffness = at_barrier(1.0, False, 0.0).body, np.zeros(7), 16.0
    body.damping = damping
    fill_table(stiffness, dt, body, step)
    # u'' = a, a' = -K v - C a - s: the vector (u, v, a, s) is carried by one exponential.
    rates = np.zeros((4, 4))
    rates[0, 1] = rates[1, 2] = 1.0
    rates[2, 1:] = -stiffness, -damping, -1.0
    whole, order = expm(dt * rates), np.array([1.0, 2.0, 3.0])
    assert step[0] == dt
    assert (np.abs(step[1:4] - whole[0, 1:]) <= 1e-14 * dt**order).all()
    assert (np.abs(step[4:7] - whole[1, 1:]) <= 1e-14 * dt ** (order - 1.0)).all()


@pytest.mark.parametrize("order", [5, 14, 30])
def test_a_defect_counts_as_what_it_leaves(order):
    """Of one that grows like τ^(p-1), integrated once and twice."""
    body, tau, defect = at_barrier(1.0, False, 0.0).body, 0.3, 0.7
    body.next_a, body.next_g, body.bend = defect, 0.0, 0.0
    of_v = defect * tau / order
    of_u = of_v * tau / (order + 1)
    for share, holds in ((0.99, False), (1.0 + 1.01 / order, True)):
        body.of_u, body.of_v = share * of_u, np.inf
        assert equations_hold(tau, order, body) == holds
        body.of_u, body.of_v = np.inf, share * of_v
        assert equations_hold(tau, order, body) == holds
