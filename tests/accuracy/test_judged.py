"""`eventpound.simulate` estimates the error of what it returns, and warns where it is large."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import eventpound
from eventpound.accuracy.estimate import estimate_errors
from eventpound.errors import AccuracyWarning
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate

SCENE = Scene(
    (Body("deck", 1000.0),),
    (Spring("pier", (GROUND, "deck"), BoucWen(4e4, 2e3, 0.02)),),
    contacts=(Contact("joint", "deck", BARRIER, 0.03, 0.6),),
    motion=Sine(2.0, 0.8),
)
ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True, scope="module")
def _compiled() -> None:
    simulate(SCENE, "fast")


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_a_single_run_is_judged_unasked(solver: str, tmp_path: Path) -> None:
    plain = simulate(SCENE, solver)
    found = eventpound.simulate(SCENE, solver)
    assert plain.error_estimate is None
    assert found.error_estimate == estimate_errors(plain)
    assert found.error_estimate["by"] == "fast at rtol 1e-11"
    assert found.error_estimate["warnings"] == []
    eventpound.write(found, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["error_estimate"]["largest"] == found.error_estimate["largest"]


def test_it_is_not_made_where_it_is_not_wanted() -> None:
    assert eventpound.simulate(SCENE, error_estimate=False).error_estimate is None
    assert eventpound.simulate(SCENE, "fast").error_estimate is None
    assert eventpound.simulate(SCENE, "moreau").error_estimate is None
    bounded = eventpound.simulate(SCENE, max_steps=10**6).error_estimate
    assert bounded is not None
    assert bounded["by"] is None
    assert "the run is bounded" in bounded["missing"]


def test_it_is_made_where_it_is_asked_for() -> None:
    found = eventpound.simulate(SCENE, "fast", error_estimate=True).error_estimate
    assert found is not None
    assert set(found["peaks"]["deck"]) == {"max", "min", "t_max", "t_min"}
    with (
        pytest.warns(AccuracyWarning, match="impacts at contact 'joint' have other speeds"),
        pytest.warns(AccuracyWarning, match="is off by"),
    ):
        eventpound.simulate(SCENE, "moreau", error_estimate=True)


def test_a_case_may_ask_for_it(tmp_path: Path) -> None:
    text = (ROOT / "cases" / "elastic-barrier" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(f'{text}\n[solver]\nname = "fast"\n')
    case = eventpound.load_case(tmp_path)
    assert eventpound.simulate(case).error_estimate is None
    asked = f"{text}\n[run]\nerror_estimate = true"
    (tmp_path / "case.toml").write_text(f'{asked}\n[solver]\nname = "fast"\n')
    found = eventpound.simulate(eventpound.load_case(tmp_path)).error_estimate
    assert found is not None
    assert found["by"].startswith("fast at rtol")


def test_what_the_tolerance_does_not_tell_is_a_warning() -> None:
    case = eventpound.load_case(ROOT / "cases" / "hard" / "stiff-beside-soft")
    simulate(case, "fast")
    with pytest.warns(AccuracyWarning, match="contact 'a-b' comes to rest"):
        found = eventpound.simulate(case, "cvode")
    assert found.error_estimate is not None
    assert found.error_estimate["warnings"]


def test_two_bodies_that_part_later_name_every_contact() -> None:
    """Bodies of 1e-3 kg between others of some kg: no tolerance of cvode tells their bounces.

    Whether the first contact has one more or less than `fast` is a matter of rounding.
    """
    from tests.hard.stiff import named, solved, stiff_scene

    scene, end = stiff_scene(3)
    assert named(solved(scene, end, "cvode", 1e-9, 60.0)) >= {1, 2}


def test_without_contacts_there_is_an_estimate_too() -> None:
    scene = Scene((Body("b", 1.0, 0.1),), (Spring("s", (GROUND, "b"), Linear(1.0)),))
    found = eventpound.simulate(scene, duration=2.0).error_estimate
    assert found is not None
    assert found["events_agree"]
    assert 0.0 < found["final"]["b"]["u"] < 1e-8
