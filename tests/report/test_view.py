"""What figures read from the tables."""

import numpy as np

from eventpound.report.view import View


def test_rests_are_the_stretches_of_closed_gap(make_results):
    assert View(make_results()).rests("joint0") == [(9.0, 11.0)]


def test_touching_at_an_instant_is_no_rest(make_results):
    results = make_results()
    open_again = results.history["t"] > 9.0
    results.history.loc[open_again, "gap.joint0"] = 0.01
    assert View(results).rests("joint0") == []


def test_event_times(make_results):
    view = View(make_results(bounces=3))
    np.testing.assert_allclose(view.impact_times("joint0"), [3.0, 6.0, 9.0], rtol=1e-15)
    assert view.opening_times("joint0").tolist() == [11.0]


def test_ground_does_not_move(make_results):
    assert not View(make_results()).displacement("ground").any()
