"""The acceleration problem of any contact graph against non-negative least squares."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import nnls

from eventpound.contact.rest import Touching, rest_contacts
from eventpound.mechanics.clusters import ContactEnds
from eventpound.mechanics.link_law import link_law
from eventpound.mechanics.reduced import Branches, Forcing
from eventpound.motion.base import Family
from tests.numerics.problems import Contacts, graph

pytestmark = pytest.mark.usefixtures("interpreted")

STILL = Forcing(int(Family.ZERO), np.empty(0), np.empty(0), 0.0)
# Some ten terms of order one and masses of a ratio up to 100.
NOISE = 1e-11


def _rest(
    contacts: Contacts, push: np.ndarray, undecided: np.ndarray, released: np.ndarray
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Each body pushed by a constant force (N), all at rest and in touch."""
    bodies, nothing = contacts.mass.size, np.zeros(contacts.mass.size)
    ends = np.column_stack((np.full(bodies, -1), np.arange(bodies)))
    gaps = np.zeros(contacts.left.size)
    between = ContactEnds(
        contacts.left, contacts.right, gaps, contacts.mass, np.zeros((0, bodies)), gaps.size
    )
    return rest_contacts(
        _touching(between, undecided, released, ends, Branches(nothing, -push), STILL)
    )


def _touching(
    between: ContactEnds,
    undecided: np.ndarray,
    released: np.ndarray,
    ends: np.ndarray,
    branches: Branches,
    forcing: Forcing,
) -> Touching:
    """All at rest, with scales of one."""
    nothing, pressed = np.zeros(between.mass.size), np.zeros_like(undecided)
    at = SimpleNamespace(
        released=released,
        mass=between.mass,
        u=nothing,
        v=nothing,
        ends=ends,
        hysteretic=np.empty(0, np.int64),
        length=1.0,
        time=1.0,
    )
    law = link_law([], nothing)
    return Touching(at, between, undecided, pressed, np.empty(0), law, branches, forcing)


def _openings(contacts: Contacts, push: np.ndarray, members: np.ndarray) -> np.ndarray:
    """Accelerations of all gaps where the members push and do not pull, shape (K,).

    Gauss: the accelerations are the nearest to those without contact that part
    no member's gap wrongly, in the norm of the masses.
    """
    root = np.sqrt(contacts.mass)
    forces = np.zeros(members.size)
    if members.any():
        forces[members] = nnls(contacts.factor[:, members], -push / root)[0]
    return contacts.W.T @ ((push + contacts.W @ forces) / contacts.mass)


def test_random_graphs() -> None:
    rng = np.random.default_rng(83)
    several = 0
    for _ in range(150):
        contacts = graph(rng, 1.0)
        push = rng.normal(size=contacts.mass.size)
        touching = rng.random(contacts.left.size) < 0.9
        resting, pressed, solved = _rest(contacts, push, touching, np.zeros_like(touching))
        assert solved
        opening = _openings(contacts, push, touching)
        np.testing.assert_array_equal(resting, touching & (opening < NOISE))
        assert not (pressed & ~resting).any()
        # Those found pressed hold back the bodies as all that touch do.
        np.testing.assert_allclose(_openings(contacts, push, pressed), opening, atol=NOISE)
        several += (resting & ~pressed).any()
    assert several > 6


def test_what_was_released_stays_closed_where_no_order_decides() -> None:
    # Constant forces have no derivatives: the order zero, which would open or press, is void.
    contacts = Contacts(np.array([0, 1]), np.array([1, -1]), np.array([1.0, 2.0]))
    every = np.ones(2, bool)
    resting, pressed, solved = _rest(contacts, np.array([-1.0, -1.0]), every, every)
    assert solved
    assert resting.all()
    assert not pressed.any()


@pytest.mark.parametrize("push", [1e-9, -1e-9])
def test_a_large_push_elsewhere_hides_nothing(push: float) -> None:
    """Two bodies that press, or part, by next to nothing beside one pressed by a large force."""
    contacts = Contacts(np.array([0, 2]), np.array([1, -1]), np.array([1.0, 2.0, 3.0]))
    every = np.ones(2, bool)
    resting, pressed, solved = _rest(contacts, np.array([push, 0.0, 1e3]), every, ~every)
    assert solved
    assert resting.tolist() == pressed.tolist() == [push > 0.0, True]


def test_the_arguments_are_left_alone() -> None:
    contacts = Contacts(np.array([0]), np.array([-1]), np.array([1.0]))
    touching = np.ones(1, bool)
    resting, _, _ = _rest(contacts, np.array([-1.0]), touching, np.zeros(1, bool))
    assert not resting[0]
    assert touching[0]


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_rounding_of_an_acceleration_does_not_open_a_stiff_body(way: float) -> None:
    """The ground's acceleration passes zero, and to rounding is 1e-16 of its amplitude there.

    Both bodies are at rest at their springs' zero and move as the jerk has it. The stiff one
    stays behind, so that the soft one presses it or leaves it. What its spring makes of 1e-16
    says that it opens, two orders before.
    """
    ground = Forcing(
        int(Family.SINUSOIDS), np.array([0.0, 2.0, 3.0, way * 0.5 * np.pi]), np.empty(0), 0.0
    )
    pair = np.array([0]), np.array([1]), np.zeros(1), np.ones(2), np.zeros((0, 2))
    branches, ends = Branches(np.array([1.0, 1e9]), np.zeros(2)), np.array([[-1, 0], [-1, 1]])
    one, none = np.ones(1, bool), np.zeros(1, bool)
    touching = _touching(ContactEnds(*pair, 1), one, none, ends, branches, ground)
    resting, pressed, solved = rest_contacts(touching)
    assert solved
    assert resting[0] == pressed[0] == (way > 0.0)
