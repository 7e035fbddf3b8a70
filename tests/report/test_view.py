"""What figures read from the tables."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from eventpound.report.view import View
from eventpound.results.manifest import describe_scene
from tests.test_cases import NAMES, loaded


def test_rests_are_the_stretches_of_closed_gap(make_results):
    assert View(make_results()).rests("joint0") == [(9.0, 11.0)]


def test_touching_at_an_instant_is_no_rest(make_results):
    results = make_results()
    columns = results.history_columns
    columns["gap.joint0"][columns["t"] > 9.0] = 0.01
    assert View(results).rests("joint0") == []


def test_event_times(make_results):
    view = View(make_results(bounces=3))
    np.testing.assert_allclose(view.impact_times("joint0"), [3.0, 6.0, 9.0], rtol=1e-15)
    assert view.opening_times("joint0").tolist() == [11.0]


def test_ground_does_not_move(make_results):
    assert not View(make_results()).displacement("ground").any()


@pytest.mark.parametrize("name", NAMES)
def test_contacts_of_a_summary_are_those_of_the_case(name):
    """With laws of their own and at points, too."""
    scene = loaded(name).scene
    stored = json.loads(json.dumps({"scene": describe_scene(scene)}))
    found = View(SimpleNamespace(summary=stored)).contacts
    assert len(found) == len(scene.contacts)
    for contact, wanted in zip(found, scene.contacts, strict=True):
        assert (contact.name, contact.left, contact.right) == (
            wanted.name,
            wanted.left,
            wanted.right,
        )
        assert (contact.gap, contact.law) == (wanted.gap, wanted.law)
