"""Joints in plan: where their contacts are, and which edges are no joint."""

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.scene import BARRIER, Deck, Joint


def test_contacts_are_at_the_ends_of_the_stretch_that_faces():
    wide, narrow = Deck("W", 1.0, 20.0, 10.0), Deck("N", 1.0, 20.0, 4.0, centre=(20.01, 4.0))
    lower, upper = Joint("J", ("W", "N"), 0.01, 0.5).contacts({"W": wide, "N": narrow})
    assert (lower.left.at, upper.left.at) == ((10.0, 2.0), (10.0, 5.0))
    assert (lower.right.at, upper.right.at) == ((-10.0, -2.0), (-10.0, 1.0))


def test_a_gap_opens_as_the_place_of_the_right_moves_away_along_the_normal():
    deck = Deck("D", 7.0, 5.0, 3.0, 0.4)
    lower, _ = Joint("J", (BARRIER, "D"), 0.01, 0.5).contacts({"D": deck})
    u = {"D.x": 0.3, "D.y": -0.2, "D.turn": 0.01 * deck.radius}
    moved = sum(part * u.get(name, 0.0) for name, part in lower.direction)
    x, y = deck.on_edge("left", -1.5)
    displacement = np.array([0.3 - 0.01 * y, -0.2 + 0.01 * x])
    assert moved == pytest.approx(displacement @ (np.cos(0.4), np.sin(0.4)))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"skew": 0.1}, "accepted: decks of one skew"),
        ({"centre": (5.02, 3.5)}, "whose edges do not face"),
        ({"centre": (5.5, 0.0)}, "part their edges by 0.5 m"),
    ],
)
def test_edges_that_are_no_joint(changes, said):
    one = Deck("A", 1.0, 5.0, 3.0)
    other = Deck("B", 1.0, 5.0, 3.0, **({"centre": (5.02, 0.0)} | changes))
    with pytest.raises(InputError, match=said):
        Joint("J", ("A", "B"), 0.02, 0.5).contacts({"A": one, "B": other})
