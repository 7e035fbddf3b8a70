"""Peaks, events and states of the program for decks, by closed form."""

import math

import pytest

from eventpound.scene import BARRIER, GROUND, Deck, Linear, Scene, Spring
from eventpound.scene.deck import DeckStart
from eventpound.scene.joint import Joint
from tests.oracle.plan_answer import ask_plan

SPEED, GAP, PERIOD, RESTITUTION = 0.3, 0.02, 1.6, 0.5


def test_an_oscillator_that_strikes_with_a_whole_edge():
    """``u = V/ω sin ωt`` up to a wall at right angles, and back by energy."""
    deck = Deck("d", 9e5, 36.0, 11.0)
    omega = 2.0 * math.pi / PERIOD
    scene = Scene(
        deck.bodies(DeckStart(velocity=(SPEED, 0.0))),
        springs=[Spring("s", (GROUND, "d.x"), Linear(9e5 * omega**2))],
        contacts=(joint := Joint("wall", ("d", BARRIER), GAP, RESTITUTION)).contacts({"d": deck}),
        decks=[deck],
    )
    t_hit = math.asin(omega * GAP / SPEED) / omega
    before = math.sqrt(SPEED**2 - (omega * GAP) ** 2)
    turned = math.pi - math.atan2(RESTITUTION * before, omega * GAP)
    lowest = -math.hypot(RESTITUTION * before / omega, GAP)
    told = ask_plan(scene, [joint], (0.0, 0.7), [0.05])
    for name, true in {
        "history.0.d.x": SPEED / omega * math.sin(omega * 0.05),
        "peaks.d.x.max": GAP,
        "peaks.d.x.t_max": t_hit,
        "peaks.d.x.min": lowest,
        "peaks.d.x.t_min": t_hit + turned / omega,
        "peaks.d.turn.max": 0.0,
    }.items():
        assert float(told.values[name].value) == pytest.approx(true, rel=1e-12, abs=1e-15)
        assert told.values[name].uncertainty < 1e-12
    assert [(e.kind, e.contact) for e in told.events] == [("impact", 0), ("impact", 1)]
    assert float(told.events[0].numbers["before"].value) == pytest.approx(-before, rel=1e-12)
