"""What is possible but hardly meant is said, once a kind; usual scenes are silent."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound.motion import Cosine, Record
from eventpound.scene import (
    GROUND,
    Backfill,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Slider,
    Spring,
    Support,
)
from eventpound.scene.plausibility import doubts

USUAL = Scene(
    (Body("deck", 4e5), Body("other", 8e5)),
    (
        Spring("piers", (GROUND, "deck"), BoucWen(4e6, 5e5, 0.01)),
        Spring("frame", ("other", GROUND), Linear(2e7)),
    ),
    (Dashpot((GROUND, "deck"), 2e5),),
    (Contact("joint", "deck", "other", 0.05, 0.6),),
    Cosine(4.0, 0.8),
)


def spring(k: float, q: float, u_y: float) -> tuple[Spring, ...]:
    return (Spring("piers", (GROUND, "deck"), BoucWen(k, q, u_y)), USUAL.springs[1])


def record(time_step: float) -> Record:
    """Two cycles of 200 samples."""
    return Record(3.0 * np.sin(np.arange(200) * math.pi / 50.0), time_step)


def test_a_usual_scene_is_silent():
    assert doubts(USUAL, {"output_step": 0.005}, [("[[dashpot]] 1", 0.3)]) == []
    assert doubts(replace(USUAL, motion=record(0.01))) == []
    assert doubts(replace(USUAL, motion=Record(np.array([0.0, 1.0, -2.0, 0.0]), 0.1))) == []


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"motion": Cosine(0.04, 0.8)}, "excitation: a peak of 0.04 m/s^2 is 0.00408 g"),
        ({"motion": Cosine(40.0, 0.8)}, "excitation: a peak of 40 m/s^2 is 4.08 g"),
        ({"motion": Cosine(4.0, 0.0008)}, "excitation: a period of 0.0008 s; usual are 0.02"),
        ({"motion": record(10.0)}, "excitation: a time step of 10 s; usual are 0.0005 to 0.1 s"),
        ({"motion": record(1e-5)}, "excitation: a time step of 1e-05 s; usual are 0.0005"),
        ({"motion": record(10.0)}, "excitation: a length of 1990 s; usual are 0.1 to 1000 s"),
        ({"motion": record(1.0)}, "excitation: a peak velocity of "),
        ({"motion": record(1.0)}, "excitation: a peak displacement of "),
        ({"supports": (Support("pier", motion=record(10.0)),)}, "support 'pier': a time step of"),
        ({"springs": spring(4e6, 1.2e7, 0.02)}, "times the weight of 4e+05 kg"),
        ({"springs": spring(4e6, 5e5, 0.8)}, "spring 'piers': a yield displacement of 0.8 m"),
        ({"springs": spring(4e6, 1e6, 0.01), "motion": Cosine(0.2, 0.8)}, "is 12.5 times mass x"),
        ({"springs": spring(4e12, 0.0, 0.01)}, "'piers': a yield force of 4e+10 N"),
        ({"bodies": (Body("deck", 4.0), Body("other", 8e5))}, "body 'deck': a period of 0.00"),
        ({"springs": (Spring("s", (GROUND, "deck"), Linear(100.0)),)}, "a period of 397.4 s"),
        ({"dashpots": (Dashpot((GROUND, "deck"), 1e8),)}, "body 'deck': its dashpots are"),
        ({"contacts": (Contact("joint", "deck", "other", 5.0, 0.6),)}, "'joint': a gap of 5 m"),
    ],
)
def test_what_is_unlikely(changes, said):
    scene = replace(USUAL, **changes)
    assert any(said in text for text in doubts(scene)), doubts(scene)


@pytest.mark.parametrize(("force", "silent"), [(3e3, False), (2e6, True), (3e9, False)])
def test_a_deck_on_sliders_that_do_not_carry_it(force, silent):
    # Soil holds nothing up; a pier below does, and a joint slider beside it is no bearing.
    deck, pier = Body("deck", 4e5), Body("pier", 1e5)
    springs = (
        Spring("pier", (GROUND, "pier"), Linear(2e7)),
        *(Spring(f"on {end}", (end, "deck"), Slider(0.05, force, 1e6)) for end in (GROUND, "pier")),
        Spring("soil", (GROUND, "deck"), Backfill.of_wall(2.0, 10.0, 0.05)),
    )
    found = doubts(Scene((deck, pier), springs, motion=Cosine(4.0, 0.8)))
    assert any(text.startswith("body 'deck': stands on sliders") for text in found) != silent
    held = (*springs, Spring("spring", (GROUND, "deck"), Linear(1e7)))
    assert doubts(Scene((deck, pier), held, motion=Cosine(4.0, 0.8))) == []


def test_a_chosen_step_that_is_too_coarse():
    (text,) = doubts(USUAL, {"output_step": 0.5})
    assert text.startswith("run: an output_step of 0.5 s leaves fewer than 10 rows")


def test_one_sentence_a_kind():
    many = tuple(replace(USUAL.contacts[0], name=f"c{i}", gap=3.0) for i in range(40))
    (text,) = doubts(replace(USUAL, contacts=many))
    assert text == "contact 'c0': a gap of 3 m; usual is up to 1 m (and 39 more like it)"
    said = doubts(USUAL, None, [("[[dashpot]] 1", 5.0), ("[[rayleigh]] 1", 2.0)])
    assert said == [
        "[[dashpot]] 1: ratio = 5 is 500 % of critical damping; usual is up to 30 % "
        '(5 % is 0.05 or "5 %") (and 1 more like it)'
    ]


def test_a_weight_is_that_of_all_that_springs_join():
    # Ten floors of 1e5 kg on isolators with a quarter of their weight: 2.5 times the first alone.
    floors = tuple(Body(f"f{i}", 1e5) for i in range(10))
    storeys = tuple(Spring(f"s{i}", (f"f{i}", f"f{i + 1}"), Linear(2e8)) for i in range(9))
    base = Spring("isolators", (GROUND, "f0"), BoucWen(5e6, 2.4e6, 0.01))
    assert doubts(Scene(floors, (base, *storeys), motion=Cosine(4.0, 0.8))) == []


def test_a_dashpot_to_the_ground_past_the_isolators():
    deck, cap = Body("deck", 4e5), Body("cap", 1e5)
    bearings = Spring("bearings", ("cap", "deck"), BoucWen(3e6, 2e5, 0.01))
    bridge = replace(
        USUAL,
        bodies=(cap, deck),
        springs=(Spring("pier", (GROUND, "cap"), Linear(9e7)), bearings),
        contacts=(),
    )
    for own in (("cap", "deck"), (GROUND, "cap")):
        assert doubts(replace(bridge, dashpots=(Dashpot(own, 1e5),))) == []
    (text,) = doubts(replace(bridge, dashpots=(Dashpot((GROUND, "deck"), 1e5),)))
    assert text.startswith("body 'deck': a dashpot joins it to the ground past the springs that")


def test_a_forgotten_g_is_named_with_its_key():
    elastic = replace(USUAL, springs=USUAL.springs[1:], motion=Cosine(0.3, 0.8))
    (text,) = doubts(elastic, bare=[("excitation: amplitude", 0.3)])
    assert text.startswith("excitation: amplitude = 0.3 has no unit and is in m/s^2, 0.031 g")
    assert doubts(elastic, bare=[("excitation: amplitude", 3.0)]) == []
