"""A case as it was understood, in a file that says the same."""

import json

import pytest

from eventpound.case import load_case, read_case
from tests.case.test_loading import FULL


def test_understood_is_the_case_again(tmp_path):
    (tmp_path / "case.toml").write_text(FULL)
    case = load_case(tmp_path / "case.toml")
    written = json.loads(json.dumps(case.understood, allow_nan=False))
    again = read_case(written, tmp_path / "case.toml")
    assert again.scene == case.scene
    assert again.run == case.run
    assert again.solver == case.solver
    assert again.understood == case.understood == written


def test_a_large_case_reports_ends_briefly(tmp_path):
    document = {
        "excitation": {"kind": "sine", "amplitude": 1, "period": 1},
        "body": [{"name": f"b{i}", "mass": 1} for i in range(100)],
        "contact": [{"between": ["b0", "b100"], "gap": 1, "restitution": 0}],
    }
    with pytest.raises(Exception, match=r"b0, b1, .*, b7, \.\.\., barrier"):
        read_case(document, tmp_path / "case.toml")
