"""The table of contact modes and transitions, row by row."""

import numpy as np
import pytest

from eventpound.contact.kinks import choose_branches, turn_at_kinks
from eventpound.contact.modes import ACCELERATION, IMPACT, NONE, duty, transition_code
from eventpound.contact.state import Instant
from eventpound.mechanics.model import assemble
from eventpound.mechanics.reduced import state_vector
from eventpound.numerics.compiled import in_python
from eventpound.scene import GROUND, BilinearElastic, Body, Contact, Linear, Scene, Spring
from eventpound.solvers.base import EventKind, Task
from eventpound.solvers.events.event_run import EventRun
from eventpound.solvers.events.modes import ModeTable

# before, g, γ, duty: the rows of the table in `eventpound.contact.modes`.
TABLE = [
    ("open", 1e-300, -1.0, NONE),
    ("open", 1e-300, 0.0, NONE),
    ("open", 1e-300, 1.0, NONE),
    ("open", 0.0, 1e-300, NONE),
    ("open", 0.0, -1e-300, IMPACT),
    ("open", 0.0, 0.0, ACCELERATION),
    ("open", 0.0, -0.0, ACCELERATION),
    ("resting", 0.0, 0.0, ACCELERATION),
    ("resting", 0.0, -1.0, IMPACT),
    ("resting", 0.0, 1.0, NONE),
]
TRANSITIONS = [
    (False, False, 1.0, None),
    (False, False, 0.0, None),
    (True, True, 0.0, None),
    (False, True, 0.0, EventKind.REST),
    (True, False, 0.0, EventKind.DETACHMENT),
    (True, False, 1e-300, EventKind.SEPARATION),
]


@pytest.mark.parametrize(("before", "gap", "gap_rate", "demanded"), TABLE)
def test_duty(before, gap, gap_rate, demanded):
    assert in_python(duty)(gap, gap_rate) == demanded


@pytest.mark.parametrize(("was_resting", "rests", "gap_rate", "kind"), TRANSITIONS)
def test_transition(was_resting, rests, gap_rate, kind):
    kinds = None, EventKind.REST, EventKind.DETACHMENT, EventKind.SEPARATION
    assert kinds[in_python(transition_code)(was_resting, rests, gap_rate)] is kind


def _table(*contacts: Contact, law: object = Linear(1.0)) -> ModeTable:
    scene = Scene(
        (Body("a", 1.0), Body("b", 2.0)), (Spring("s", (GROUND, "a"), law),), (), contacts
    )
    return ModeTable(assemble(scene), ledger=False, force_noise=1e-12)


def _instant(law: object, u: float, v: float) -> Instant:
    """A scene with a spring from the ground to its first body, which is at u (m) with v (m/s)."""
    bodies = Body("a", 1.0, displacement=u, velocity=v), Body("b", 2.0)
    scene = Scene(bodies, (Spring("s", (GROUND, "a"), law),), (), ())
    return EventRun(Task(scene, 0.0, 1.0, 1e-8)).arrays.instant


def test_what_a_mode_watches():
    # a rests on b and b between a and the barrier: all three together are locked.
    table = _table(
        Contact("left", "barrier", "a", 0.0, 0.5),
        Contact("joint", "a", "b", 0.0, 0.5),
        Contact("right", "b", "barrier", 0.0, 0.5),
    )
    branch = np.zeros(1, np.int64)
    free = table.mode(np.array([False, True, False]), branch).guards
    np.testing.assert_array_equal(free.open_contacts, [True, False, True])
    np.testing.assert_array_equal(free.unlocked, [False, True, False])
    locked = table.mode(np.ones(3, bool), branch).guards
    assert not locked.open_contacts.any()
    assert not locked.unlocked.any()


def test_a_mode_is_built_once():
    table = _table(Contact("joint", "a", "b", 0.0, 0.5))
    branch = np.zeros(1, np.int64)
    one = table.mode(np.array([True]), branch)
    assert table.mode(np.array([True]), branch) is one
    assert table.mode(np.array([False]), branch) is not one


@pytest.mark.parametrize(
    ("u", "v", "a", "onset", "side"),
    [
        (0.3, 0.0, 0.0, 1.0, 1),
        (0.1, 0.0, 0.0, -1.0, -1),
        (0.2, 1.0, -1.0, 1.0, 1),
        (0.2, -1.0, 1.0, -1.0, -1),
        (0.2, 0.0, 1.0, 1.0, 1),
        (0.2, 0.0, -1.0, -1.0, -1),
        (0.2, 0.0, 0.0, -1.0, 1),
        (0.2, 0.0, 0.0, 1.0, -1),
    ],
)
def test_branch_of_a_kinked_spring(u, v, a, onset, side):
    at = _instant(BilinearElastic(1.0, 2.0, 0.2), u, v)
    in_python(choose_branches)(np.array([a, 0.0]), 0.0, onset, at)
    assert at.branch[0] == side


def test_a_straight_spring_has_no_branch():
    at = _instant(Linear(1.0), 0.0, 0.0)
    in_python(choose_branches)(np.zeros(2), 0.0, 1.0, at)
    assert at.branch[0] == 0


@pytest.mark.parametrize(
    ("away", "v", "side"),
    # Within rounding of the kink the velocity after an impact decides, and nowhere else.
    [(0.0, 1.0, 1), (0.0, -1.0, -1), (1e-14, -1.0, -1), (1e-12, -1.0, 1), (0.0, 0.0, 1)],
)
def test_side_of_a_kink_after_an_impact(away, v, side):
    at = _instant(BilinearElastic(1.0, 2.0, 0.2), 0.2, v)
    at.u[0] += away * at.length
    at.branch[0] = 1
    in_python(turn_at_kinks)(at)
    assert at.branch[0] == side


@pytest.mark.usefixtures("interpreted")
def test_pack_keeps_the_momentum():
    table = _table(Contact("joint", "a", "b", 0.4, 0.5))
    mode = table.mode(np.array([True]), np.zeros(1, np.int64))
    assert mode.clusters.count == 1
    u, v, none = np.array([0.7, 0.3]), np.array([3.0, 0.0]), np.empty(0)
    y = state_vector(mode.bodies, mode.system, mode.bodies.mass, u, v, none, none)
    assert y[mode.system.iv[0]] == pytest.approx(1.0, rel=1e-15)
    # u_b = u_a - gap: both say the same displacement of the cluster.
    assert y[mode.system.iq[0]] + mode.clusters.offset[0] == pytest.approx(0.7, rel=1e-15)
