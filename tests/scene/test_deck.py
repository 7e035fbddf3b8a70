"""Shapes of decks: moments by numerical integration, joints by their geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eventpound.scene import BARRIER, Deck, Joint


@pytest.mark.parametrize("skew", [0.0, 0.3, -0.8])
def test_inertia_is_an_integral_over_the_shape(skew: float) -> None:
    deck = Deck("D", 7.0, 5.0, 3.0, skew)
    corners = np.array(deck.corners)
    # Green's theorem over the edges of the polygon: second moments and area.
    ahead = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * ahead[:, 1] - ahead[:, 0] * corners[:, 1]
    squares = (corners**2 + corners * ahead + ahead**2).sum(axis=1)
    area, second = 0.5 * cross.sum(), (cross * squares).sum() / 12.0
    assert area == pytest.approx(15.0)
    assert deck.inertia_about_centre == pytest.approx(7.0 * second / area, rel=1e-13)
    assert deck.radius == pytest.approx(math.sqrt(second / area))


def test_normals_are_at_right_angles_to_the_edges() -> None:
    deck = Deck("D", 7.0, 5.0, 3.0, 0.4)
    low, high = (np.array(deck.on_edge("right", y)) for y in (-1.5, 1.5))
    assert np.dot(high - low, deck.normal("right")) == pytest.approx(0.0, abs=1e-15)
    assert np.dot(deck.normal("left"), deck.normal("right")) == pytest.approx(-1.0)


def test_the_tangent_of_an_end_is_a_quarter_turn_to_the_left() -> None:
    deck = Deck("D", 7.0, 5.0, 3.0)
    (end, _) = (c.left for c in Joint("J", ("D", BARRIER), 0.01, 0.5).contacts({"D": deck}))
    assert end.normal == (1.0, 0.0)
    assert dict(end.tangent.parts) == {"D.y": 1.0, "D.turn": 2.5 / deck.radius}
