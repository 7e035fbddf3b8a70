"""What a row tells beside its quantities: of a study the outcome, of a suite its record."""

from types import SimpleNamespace

import numpy as np

from eventpound.study.forms import OfStudy, OfSuite


def ran(*success: bool):
    return SimpleNamespace(many=SimpleNamespace(success=np.array(success)), seconds=np.ones(2))


def test_a_run_of_a_study_says_in_one_line_why_it_failed():
    cells = OfStudy().outcome([], [None, "no\n  root"], ["contact.joint.gap"])
    assert cells == {"success": [True, False], "message": ["", "no root"]}


def test_a_record_that_cannot_be_read_says_so_and_not_what_follows():
    told = [
        {"record": "a", "file": "a.txt", "failed": "", "PGA": 2.0, "T_m": float("nan")},
        {"record": "b", "file": "b.txt", "failed": "is empty"},
        {"record": "c", "file": "c.txt", "failed": ""},
    ]
    said = [None, "b.txt: nothing there", "c.txt: no root"]
    cells = OfSuite().outcome(told, said, ["record", "PGA", "T_m"])
    assert cells["failed"] == ["", "is empty", "no root"]
    assert (cells["record"], cells["PGA"]) == (["a", "b", "c"], [2.0, "", ""])
    assert cells["T_m"] == ["", "", ""]


def test_a_suite_keeps_of_a_run_that_failed_only_how_far_it_came():
    found = {"t_final": np.array([3.0, 1.0]), "impacts": np.array([4.0, 2.0])}
    assert OfStudy().numbers(ran(True, False), found, "fast", 1e-6) is found
    own = OfSuite().numbers(ran(True, False), found, "fast", 1e-6)
    assert own["t_final"].tolist() == [3.0, 1.0]
    np.testing.assert_array_equal(own["impacts"], [4.0, np.nan])
    np.testing.assert_array_equal(own["seconds.solve"], [1.0, np.nan])


def test_times_and_errors_are_of_runs_that_are_made():
    assert OfSuite(errors=True).last_columns(ran=False) == []
    assert OfSuite(errors=True).last_columns(ran=True) == ["seconds.solve", "error_estimate"]
    assert OfStudy().last_columns(ran=True) == ["success", "message"]


def test_only_what_is_asked_for_decides_a_table():
    assert OfStudy().described() == {}
    assert OfSuite((0.5, 0.05)).described() == {"suite": {"sa": (0.5, 0.05), "errors": False}}
