"""What a scene tells of itself."""

import math

from eventpound.motion import Ricker
from eventpound.scene import Body, Deck, Force, Scene


def test_what_moves_across_or_from_the_side_is_in_plan():
    line, deck = [Body("b", 1.0)], Deck("D", 1.0, 2.0, 1.0)
    assert not Scene(line).in_plan
    assert Scene(deck.bodies(), decks=[deck]).in_plan
    assert Scene([Body("b", 1.0, direction="y")]).in_plan
    assert Scene(line, attack=math.pi / 6).in_plan
    assert Scene(line, across=Ricker(1.0, 1.0)).in_plan


def test_what_the_engine_has_otherwise():
    assert not Scene([Body("b", 1.0)]).is_driven
    assert Scene([Body("b", 1.0)], forces=[Force("b", 1.0)]).is_driven
    assert Scene([Body("b", 1.0)], attack=0.1).is_driven
