"""Quantities of decks in plan: no turn is told as a length, and shears are told by directions."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound import simulate
from eventpound.errors import InputError
from eventpound.motion import Cosine, Ricker, Sine
from eventpound.quantities.lookup import names_of
from eventpound.scene import BARRIER, GROUND, Body, Dashpot, Deck, Joint, Linear, Scene, Spring
from eventpound.scene.pi_terms import number_of_terms, pi_terms
from eventpound.solvers.supported import relative_accelerations

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


def test_no_floor_spectrum_of_a_turn():
    response = simulate(two_decks(), duration=0.1)
    with pytest.raises(InputError, match=r"found A\.turn; accepted: A\.x, A\.y, B\.x, B\.y"):
        response.floor_spectrum("A.turn", [0.3], 0.05)


def test_a_floor_across_is_that_of_a_body_under_the_second_component():
    in_plan = two_decks()
    alone = Scene(
        [Body("A.y", "900 t")],
        [Spring("y", (GROUND, "A.y"), Linear(ENDS["y"]))],
        [Dashpot((GROUND, "A.y"), 4e5)],
        motion=in_plan.across,
    )
    found, expected = (
        simulate(scene, duration=2.0).floor_spectrum("A.y", [0.3, 1.0], 0.05)
        for scene in (in_plan, alone)
    )
    for column in ("SD", "SA"):
        np.testing.assert_allclose(found[column], expected[column], rtol=1e-5)


def test_a_free_deck_stands_still_in_space():
    """The ground moves each coordinate by its own components."""
    deck = Deck("west", "900 t", "36 m", "11 m", "40 deg")
    motion, across = (
        Cosine("0.3 g", "0.8 s", start="0.3 s"),
        Cosine("0.2 g", "0.5 s", start="0.7 s"),
    )
    scene = Scene(deck.bodies(), decks=[deck], motion=motion, across=across, attack=0.4)
    response = simulate(scene, "fast", duration=2.0, output_step=0.05, error_estimate=False)
    history, scale = response.history, 0.3 * 9.81
    for name in ("x", "y", "turn"):
        np.testing.assert_allclose(history[f"a.west.{name}"], 0.0, atol=1e-12 * scale)
        logged = response.at([0.5, 1.0], logger="0.1 s")[f"logged.west.{name}"]
        np.testing.assert_allclose(logged, 0.0, atol=1e-8 * scale)
    relative = relative_accelerations(scene, response.recording.history)
    t = history["t"].to_numpy()
    a, b = motion.acceleration(t), across.acceleration(t)
    expected = -np.column_stack(
        [np.cos(0.4) * a - np.sin(0.4) * b, np.sin(0.4) * a + np.cos(0.4) * b, 0.0 * a]
    )
    np.testing.assert_allclose(relative, expected, atol=1e-12 * scale)
    np.testing.assert_allclose(history["a_g"], -expected[:, 0], atol=1e-12 * scale)
    np.testing.assert_allclose(history["a_across"], -expected[:, 1], atol=1e-12 * scale)


def test_work_of_a_dashpot_across_is_that_of_the_ledger():
    deck = Deck("west", "900 t", "36 m", "11 m", "40 deg")
    scene = Scene(
        deck.bodies(),
        [Spring("held", ("ground", "west.y"), Linear("40 MN/m"))],
        [Dashpot(("ground", "west.y"), "2 MN s/m")],
        decks=[deck],
        motion=Ricker("0.5 g", "0.8 s"),
        across=Ricker("0.3 g", "0.7 s"),
    )
    response = simulate(scene, "fast", duration=3.0, energy=True, error_estimate=False)
    found = response.quantity("dashpots.ground-west.y.dissipated_energy")
    assert found == pytest.approx(response.energy.viscous, rel=1e-6)
