"""`eventpound.simulate` estimates the error of what it returns, and warns where it is large."""

import json
import warnings

import pytest

import eventpound
from eventpound.accuracy.estimate import estimate_errors
from eventpound.errors import AccuracyWarning
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from tests.models import ROOT

SCENE = Scene(
    (Body("deck", 1000.0),),
    (Spring("pier", (GROUND, "deck"), BoucWen(4e4, 2e3, 0.02)),),
    contacts=(Contact("joint", "deck", BARRIER, 0.03, 0.6),),
    motion=Sine(2.0, 0.8),
)


@pytest.fixture(autouse=True, scope="module")
def _compiled():
    response_of(SCENE, "fast")


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_a_single_run_is_judged_unasked(solver, tmp_path):
    plain = response_of(SCENE, solver)
    found = eventpound.simulate(SCENE, solver)
    assert plain.error_estimate is None
    assert found.error_estimate == estimate_errors(plain)
    assert found.error_estimate["by"] == "fast at rtol 1e-11"
    assert found.error_estimate["warnings"] == []
    eventpound.write(found, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["error_estimate"]["largest"] == found.error_estimate["largest"]


def test_it_is_not_made_where_it_is_not_wanted():
    assert eventpound.simulate(SCENE, error_estimate=False).error_estimate is None


def test_a_run_of_few_steps_warns_that_its_error_is_not_known():
    """Its judge has no more steps than it had itself."""
    plain = response_of(SCENE, "fast")
    with pytest.warns(
        AccuracyWarning, match="error not known: fast itself at rtol 1e-11 failed"
    ) as warned:
        found = eventpound.simulate(SCENE, "fast", max_steps=plain.work.steps)
    assert [each.filename for each in warned] == [__file__]
    assert "the limit of" in found.error_estimate["failed"]


def test_code_without_a_name_is_warned_too():
    """As a notebook's or a debugger's, which `exec` runs with globals of its own."""
    code = "from eventpound.basics.told import warn_caller; warn_caller('said', UserWarning)"
    with pytest.warns(UserWarning, match="said"):
        exec(code, {})


def test_it_is_made_where_it_is_asked_for():
    with (
        pytest.warns(AccuracyWarning, match="impacts at contact 'joint' have other speeds"),
        pytest.warns(AccuracyWarning, match="is off by"),
    ):
        eventpound.simulate(SCENE, "moreau", error_estimate=True)


def test_a_case_may_ask_for_it_or_leave_it_out(tmp_path):
    text = (ROOT / "cases" / "elastic-barrier" / "case.toml").read_text()
    by: dict[str, object] = {}
    for said in ("", "error_estimate = true", "error_estimate = false"):
        (tmp_path / "case.toml").write_text(f'{text}\n[run]\n{said}\n[solver]\nname = "moreau"\n')
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AccuracyWarning)
            found = eventpound.simulate(eventpound.load_case(tmp_path)).error_estimate
        by[said] = found and found["by"]
    assert list(by.values()) == [None, "fast at rtol 1e-11", None]
    assert found is None


def test_without_contacts_there_is_an_estimate_too():
    scene = Scene((Body("b", 1.0, 0.1),), (Spring("s", (GROUND, "b"), Linear(1.0)),))
    found = eventpound.simulate(scene, duration=2.0).error_estimate
    assert found["events_agree"]
    assert 0.0 < found["final"]["b"]["u"] < 1e-8
