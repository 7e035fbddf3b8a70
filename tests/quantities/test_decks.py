"""Quantities of decks in plan: no turn is told as a length, and shears are told by directions."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound import simulate
from eventpound.motion import Sine
from eventpound.quantities.lookup import names_of
from eventpound.scene import BARRIER, GROUND, Dashpot, Deck, Joint, Linear, Scene, Spring
from eventpound.scene.pi_terms import number_of_terms, pi_terms

ENDS = {"x": 40e6, "y": 25e6, "turn": 30e6}


def two_decks() -> Scene:
    """Decks that nothing joins, under two components, and a wall that neither comes to."""
    decks = [Deck(n, "900 t", "36 m", "11 m", 0.5, (x, 0.0)) for n, x in (("A", 0.0), ("B", 60.0))]
    held = [(f"{deck.name}.{end}", k) for deck in decks for end, k in ENDS.items()]
    springs = [Spring(name, (GROUND, name), Linear(k)) for name, k in held]
    dashpots = [Dashpot((GROUND, name), 4e5) for name, _ in held]
    wall = Joint("wall", (BARRIER, "A"), "2 m", 0.5)
    return Scene(
        [body for deck in decks for body in deck.bodies()],
        springs,
        dashpots,
        contacts=wall.contacts({"A": decks[0]}),
        decks=decks,
        motion=Sine("0.3 g", "0.8 s"),
        across=Sine("0.2 g", "0.6 s"),
    )


def test_no_turn_is_told_as_a_length():
    names = names_of(two_decks())
    kinds = "residual", "velocity", "acceleration", "pi_um", "amplification"
    assert not [n for n in names if n.startswith(kinds) and ".turn" in n]
    assert {"residual.A.y", "velocity.A.x.max", "decks.A.residual_rotation"} <= {*names}
    # Peaks of two corners at an edge are at other times than those of its coordinates.
    assert not [n for n in names if n.endswith((".srss", ".cqc", ".absolute_sum"))]


def test_pi_terms_beside_decks_are_those_of_contacts():
    scene = two_decks()
    assert {key.partition(".")[0] for key in pi_terms(scene)} == {"delta", "epsilon"}
    assert number_of_terms(scene) is None


@pytest.mark.parametrize(("word", "end"), [("", "x"), ("_across", "y")])
def test_base_shears_by_directions(word, end):
    names = [f"structures.{deck}.abs_max_base_shear{word}" for deck in "AB"]
    whole = f"base_shear{word}.abs_max"
    response = simulate(two_decks(), output_step=0.002)
    h = response.history
    pull = {d: ENDS[end] * h[f"u.{d}.{end}"] + 4e5 * h[f"v.{d}.{end}"] for d in "AB"}
    for name, deck in zip(names, "AB", strict=True):
        # A row is within 1 ms of a peak, which bends down by less than (2 pi 1 ms / 0.6 s)^2/2.
        assert response.quantity(name) == pytest.approx(np.abs(pull[deck]).max(), rel=1e-4)
    both = np.abs(pull["A"] + pull["B"]).max()
    assert response.quantity(whole) == pytest.approx(both, rel=1e-4)
