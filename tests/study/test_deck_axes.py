"""Axes of a study over the tables of decks in plan, each value of which is another scene."""

import math

import numpy as np
import pandas as pd
import pytest

from eventpound import InputError, load_case, simulate, simulate_many
from eventpound.report.study_figure import study_figures
from eventpound.study.plan import Chunk
from eventpound.study.reading import load_study
from eventpound.study.table import compute
from tests.models import CASES

TEXT = """
deck = [
  { name = "A", mass = "900 t", length = "36 m", width = "11 m" },
  { name = "B", mass = "700 t", length = "28 m", width = "11 m" },
]
joint = [{ name = "J", between = ["A", "B"], gap = "4 cm", restitution = 0.5 }]
[excitation]
kind = "cosine"
amplitude = "0.3 g"
period = "0.8 s"
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


def test_a_map_of_rotations_with_its_boundary():
    """A whole edge without friction turns a deck where W/L < |sin 2 alpha|/2, as the line says."""
    case = load_study(CASES / "skew-map")
    (plan,), study = case.figures, case.study
    for skew, width in plan.line:
        # Four digits.
        assert width == pytest.approx(abs(math.sin(2.0 * skew)) / 2.0, abs=5e-5)
    rows = [compute(study, Chunk(0, i, 0, 1)).decode().split(",") for i in range(0, 494, 31)]
    table = pd.DataFrame(
        [[float(cell) for cell in row[:4]] for row in rows],
        columns=[*study.columns, "turned", "impacts"],
    )
    width, skew = table["deck.deck.width"], table["deck.deck.skew"]
    turns = width < np.abs(np.sin(2.0 * skew)) / 2.0
    assert (table["turned"].abs() > 1e-5).tolist() == turns.tolist()
    assert (np.sign(table["turned"]) == -np.sign(skew))[turns].all()
    ((_, figure),) = study_figures(case, plan, table.assign(**{plan.y[0]: table["turned"]}))
    (line,) = [each for each in figure.axes[0].get_lines() if each.get_linestyle() == "--"]
    # The length of the deck is 1 m, and the axis in cm.
    assert line.get_xydata() * [1.0, 0.01] == pytest.approx(np.array(plan.line))
    low, high = figure.axes[0].collections[0].get_clim()
    assert low == -high


def test_many_runs_of_a_deck_are_those_of_each():
    """The ground moves a deck along, not across, whether it runs alone or among others."""
    case = load_case(CASES / "skew-deck")
    options = {"rtol": 1e-8, "duration": 2.0}
    key = "contact.west.lower.restitution"
    many = simulate_many(case, {key: [0.5, 0.7]}, **options)
    alone = simulate(case, "fast", **options).recording.displacement
    assert many.displacement.maximum[0].tolist() == alone.maximum.tolist()
    assert many.displacement.minimum[0].tolist() == alone.minimum.tolist()
    assert many.displacement.minimum[1].tolist() != alone.minimum.tolist()
