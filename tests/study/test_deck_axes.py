"""Axes of a study over the tables of decks in plan, each value of which is another scene."""

import math

import pytest

from eventpound.errors import InputError
from eventpound.study.reading import load_study

TEXT = """
[excitation]
kind = "cosine"
amplitude = "0.3 g"
period = "0.8 s"
[[deck]]
name = "A"
mass = "900 t"
length = "36 m"
width = "11 m"
[[deck]]
name = "B"
mass = "700 t"
length = "28 m"
width = "11 m"
[[joint]]
name = "J"
between = ["A", "B"]
gap = "4 cm"
restitution = 0.5
[study]
quantities = ["decks.<deck>.abs_max_rotation"]
[[study.axis]]
key = "deck.skew"
values = ["0 deg", "30 deg"]
[[study.axis]]
key = "joint.J.gap"
values = ["4 cm", "6 cm"]
[[study.axis]]
key = "excitation.attack"
values = [0.0, 0.5]
"""


def loaded(tmp_path, text=TEXT):
    (tmp_path / "case.toml").write_text(text)
    return load_study(tmp_path).study


def test_each_value_is_a_scene_of_its_own(tmp_path):
    study = loaded(tmp_path)
    scenes = [base.case.scene for base in study.bases]
    skews = [[deck.skew for deck in scene.decks] for scene in scenes]
    assert skews == [[math.radians(a)] * 2 for a in (0.0, 0.0, 30.0, 30.0)]
    assert [scene.contacts[0].gap for scene in scenes] == [0.04, 0.06] * 2
    assert study.size == 8


def test_an_axis_of_no_deck(tmp_path):
    with pytest.raises(InputError, match=r"deck\.C\.skew.*no \[\[deck\]\] of that name"):
        loaded(tmp_path, TEXT.replace('"deck.skew"', '"deck.C.skew"'))
