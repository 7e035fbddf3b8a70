"""Decks and joints of a case: what they stand for, and what is said of what is wrong."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from eventpound.case import load_case, read_case
from eventpound.errors import InputError
from eventpound.scene.parameters import number_places, with_values
from eventpound.scene.scene import Scene

DECKS = """
[[deck]]
name = "A"
mass = "1200 t"
length = "40 m"
width = "12 m"
skew = "30 deg"
initial = { displacement = ["1 mm", 0.0], velocity = [0.0, "2 cm/s"], rotation = 1e-4, spin = 0.0 }
[[deck]]
name = "B"
mass = "1000 t"
length = "36 m"
width = "12 m"
skew = "30 deg"
inertia = "1.5e5 t m^2"
[[joint]]
name = "west"
between = ["barrier", "A"]
gap = ["5 cm", "6 cm"]
restitution = 0.5
[[joint]]
between = ["A", "B"]
gap = "4 cm"
restitution = 0.6
"""
PULSE = """
[excitation]
kind = "ricker"
amplitude = "0.4 g"
period = "0.8 s"
"""


def load(tmp_path: Path, text: str) -> Scene:
    (tmp_path / "case.toml").write_text(text)
    return load_case(tmp_path).scene


def problems(tmp_path: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    return str(caught.value)


def test_what_decks_and_joints_stand_for(tmp_path: Path) -> None:
    scene = load(tmp_path, PULSE + DECKS)
    a, b = scene.decks
    assert [body.name for body in scene.bodies] == [
        "A.x", "A.y", "A.turn", "B.x", "B.y", "B.turn"
    ]  # fmt: skip
    assert [body.direction for body in scene.bodies[:3]] == ["x", "y", "turn"]
    assert scene.bodies[0].displacement == 0.001
    assert scene.bodies[1].velocity == 0.02
    assert scene.bodies[2].displacement == pytest.approx(1e-4 * a.radius)
    # End to end along x, the gap at right angles to the edges.
    assert b.centre == (pytest.approx(38.0 + 0.04 / math.cos(math.pi / 6)), 0.0)
    assert b.radius == pytest.approx(math.sqrt(150.0))
    assert [c.name for c in scene.contacts] == [
        "west.lower", "west.upper", "A-B.lower", "A-B.upper"
    ]  # fmt: skip
    assert [c.gap for c in scene.contacts] == [0.05, 0.06, 0.04, 0.04]


def test_a_deck_that_is_moved_alike_keeps_or_loses_its_gap(tmp_path: Path) -> None:
    """A small rigid motion of both decks about one centre changes no gap; along x one does."""
    scene = load(tmp_path, PULSE + DECKS)
    contact = scene.contacts[2]
    turn, rate = 1e-3, dict.fromkeys((b.name for b in scene.bodies), 0.0)
    for deck in scene.decks:
        x, y = deck.centre
        rate |= {
            f"{deck.name}.x": -turn * y,
            f"{deck.name}.y": turn * x,
            f"{deck.name}.turn": deck.radius * turn,
        }
    # Their places are apart by the gap along x.
    gap_along = 0.04 / math.cos(math.pi / 6)
    change = sum(part * rate[name] for name, part in contact.direction)
    assert change == pytest.approx(turn * gap_along * math.sin(math.pi / 6), rel=1e-9)
    assert sum(p for n, p in contact.direction if n == "B.x") == pytest.approx(
        math.cos(math.pi / 6)
    )


def test_the_law_of_impact_stands_at_the_top(tmp_path: Path) -> None:
    rubs = PULSE + DECKS.replace("restitution = 0.5", "restitution = 0.5\nfriction = 0.3")
    assert load(tmp_path, rubs).impact_law == "newton"
    (tmp_path / "case.toml").write_text('impact_law = "poisson"' + rubs)
    case = load_case(tmp_path)
    assert case.scene.impact_law == "poisson"
    assert read_case(case.understood, tmp_path / "case.toml").scene.impact_law == "poisson"
    said = problems(tmp_path, 'impact_law = "poison"' + rubs)
    assert "impact_law: found 'poison', did you mean 'poisson'?; accepted: one" in said
    said = problems(tmp_path, 'impact_law = "poisson"' + PULSE + DECKS)
    assert "impact_law: found poisson; accepted: newton where no contact has friction" in said


def test_the_case_that_was_understood_is_the_same(tmp_path: Path) -> None:
    pulse = PULSE.replace("ricker", "cosine")
    text = pulse + 'attack = "20 deg"\nacross = { amplitude = "0.2 g", period = "0.7 s" }\n' + DECKS
    (tmp_path / "case.toml").write_text(text)
    case = load_case(tmp_path)
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.scene == case.scene
    assert again.understood == case.understood
    assert case.scene.attack == math.radians(20.0)


def test_both_components_of_a_record_have_one_factor(tmp_path: Path) -> None:
    for name, peak in (("x.csv", 2.0), ("y.csv", 1.0)):
        t = 0.01 * np.arange(200)
        rows = "\n".join(f"{s:.2f},{peak * math.sin(9.0 * s):.8f}" for s in t)
        (tmp_path / name).write_text(f"time (s),acceleration (m/s^2)\n{rows}\n")
    text = '[excitation]\nkind = "record"\nfile = "x.csv"\npga = "0.3 g"\n'
    scene = load(tmp_path, text + 'across = { file = "y.csv" }\n' + DECKS)
    assert scene.across.factor == scene.motion.factor
    places = number_places(scene)
    more = with_values(scene, {places["excitation.pga"]: 0.6 * 9.80665})
    assert more.across.factor == pytest.approx(2.0 * scene.across.factor)
    own = load(tmp_path, text + 'across = { file = "y.csv", scale = 3.0 }\n' + DECKS)
    assert own.across.factor == 3.0
    turned = with_values(scene, {places["excitation.attack"]: 0.5})
    assert turned.attack == 0.5


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('length = "40 m"', "length = -1.0", "[[deck]] 1 (A): length: found -1.0; accepted: a pos"),
        ('skew = "30 deg"\ninit', 'skew = "85 deg"\ninit', "an angle within 80 degrees of zero"),
        ('name = "B"', 'name = "A"', "[[deck]] 2 (A): name: found 'A'; accepted: a name of its"),
        ('["A", "B"]', '["A", "C"]', "[[joint]] 2: between: found 'C'; accepted: two different on"),
        ('["A", "B"]', '["A", "A"]', "between: found 'A' twice; accepted: two different decks"),
        ("restitution = 0.6", "restitution = 1.6", "[[joint]] 2: restitution: found 1.6; accepte"),
        ('gap = "4 cm"', 'gap = ["4 cm"]', "gap: found ['4 cm']; accepted: a gap, or those"),
        ('skew = "30 deg"\ninertia', 'skew = "20 deg"\ninertia', "skews of 30 and 20 degrees"),
        ('inertia = "1.5e5 t m^2"', 'inertia = "1.5 m"', "is no unit of moment of inertia"),
        ("rotation = 1e-4", "turn = 1e-4", "initial.turn: unknown key"),
        ('mass = "1000 t"', 'mass = "1000 t"\ncentre = [41.0, 0.0]', "centre: missing; accepted"),
    ],
)
def test_wrong_decks_and_joints(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = PULSE + DECKS
    assert old in text
    assert said in problems(tmp_path, text.replace(old, new))


def test_decks_that_are_not_where_the_gap_is(tmp_path: Path) -> None:
    text = DECKS.replace('name = "A"\n', 'name = "A"\ncentre = [0.0, 0.0]\n')
    text = text.replace('name = "B"\n', 'name = "B"\ncentre = [40.0, 0.0]\n')
    assert "part their edges by 1.73205 m" in problems(tmp_path, PULSE + text)


def test_no_supports_and_no_second_component_of_what_is_on_a_line(tmp_path: Path) -> None:
    support = '[[support]]\nname = "s"\ndelay = 0.1\n'
    assert "none in a scene in plan" in problems(tmp_path, PULSE + DECKS + support)
    body = '[[body]]\nname = "b"\nmass = 1.0\n'
    across = PULSE + 'across = { amplitude = "0.2 g", period = "0.7 s" }\n'
    assert "no body moves across" in problems(tmp_path, across + body)


def test_a_contact_at_a_place_of_a_deck(tmp_path: Path) -> None:
    contact = (
        '[[contact]]\nbetween = [{ deck = "A", at = [20.0, 6.0], normal = [0.0, 1.0] }, "barrier"]'
        "\ngap = 0.01\nrestitution = 0.5\n"
    )
    scene = load(tmp_path, PULSE + DECKS + contact)
    assert scene.contacts[0].name == "A-barrier"
    parts = dict(scene.contacts[0].direction)
    assert parts == {"A.y": -1.0, "A.turn": -20.0 / scene.decks[0].radius, "barrier": 1.0}
    wrong = contact.replace("[0.0, 1.0]", "[0.0, 2.0]")
    assert "a normal of length one" in problems(tmp_path, PULSE + DECKS + wrong)
    assert "of the decks A, B" in problems(tmp_path, PULSE + DECKS + contact.replace('"A"', '"C"'))
