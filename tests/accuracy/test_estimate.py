from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from eventpound import load_case
from eventpound.accuracy import estimate
from eventpound.accuracy.estimate import default_estimate, estimate_errors
from eventpound.cli import main
from eventpound.errors import ComputationError
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate
from eventpound.solvers.base import EventKind

CASES = Path(__file__).parents[2] / "cases"
WALL = Scene(
    (Body("b", 1.0, -1.0),),
    (Spring("s", (GROUND, "b"), Linear(1.0)),),
    (),
    (Contact("wall", "b", BARRIER, 0.5, 0.5),),
)


def test_estimates_are_the_true_errors_of_a_loose_run():
    """u = -cos t up to u = 0.5 at 2π/3, then half the speed back."""
    response = simulate(WALL, "cvode", 1e-6, duration=4.0)
    errors = estimate_errors(response)
    left, speed = 4.0 - 2.0 * math.pi / 3.0, math.sqrt(0.75)
    true = abs(response.final["b"]["u"] - (0.5 * math.cos(left) - speed / 2.0 * math.sin(left)))
    assert errors["by"] == "fast at rtol 1e-08"
    assert errors["events_agree"]
    # The finer run is a hundred times finer.
    assert errors["final"]["b"]["u"] == pytest.approx(true, rel=0.05)
    assert errors["peaks"]["b"]["t_max"] == pytest.approx(
        abs(response.peaks["t_max"].iloc[0] - 2.0 * math.pi / 3.0), rel=0.05
    )


def test_a_finer_run_that_fails_is_said(monkeypatch):
    class Failing:
        def solve(self, task):
            raise ComputationError("no progress", 1.25)

    response = simulate(WALL, "cvode", 1e-6, duration=4.0)
    monkeypatch.setattr(estimate, "solver_named", lambda name: Failing())
    assert estimate_errors(response)["failed"].endswith("no progress")


def test_run_writes_it_on_request(tmp_path):
    main(["new", str(tmp_path / "case")])
    words = ["run", str(tmp_path / "case"), "--no-figures", "--out"]
    assert main([*words, str(tmp_path / "plain")]) == 0
    assert main([*words, str(tmp_path / "asked"), "--error-estimate"]) == 0
    plain, asked = (
        json.loads((tmp_path / name / "summary.json").read_text())["error_estimate"]
        for name in ("plain", "asked")
    )
    # The run before this one may have left fast compiled.
    assert plain == asked or plain["by"] is None
    assert set(asked) == {"by", "events_agree", "peaks", "final", "largest", "warnings"}
    assert 0.0 <= asked["peaks"]["deck"]["min"] < 1e-6


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_unasked_where_it_costs_nothing(solver, monkeypatch):
    response = simulate(WALL, solver, 1e-6, duration=4.0)
    monkeypatch.setattr(estimate, "kernels_kept", lambda task: True)
    assert default_estimate(response) == estimate_errors(response)
    monkeypatch.setattr(estimate, "kernels_kept", lambda task: False)
    assert default_estimate(response)["by"] is None
    assert "not compiled" in default_estimate(response)["missing"]


def test_solvers_that_are_not_judged_unasked():
    assert default_estimate(simulate(WALL, "fast", 1e-6, duration=4.0)) is None
    assert default_estimate(simulate(WALL, "moreau", duration=4.0)) is None


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_a_contact_that_rests_again_and_again_is_judged_by_whatever_there_is(solver, monkeypatch):
    case = load_case(CASES / "hard" / "stiff-beside-soft")
    response = simulate(case, solver, 1e-9 if solver == "cvode" else 1e-6)
    monkeypatch.setattr(estimate, "kernels_kept", lambda task: False)
    found = default_estimate(response)
    assert found["by"].startswith(solver)
    assert "contact 'a-b' comes to rest" in found["warnings"][0]


def _struck_by_a_stiff_body(period: float) -> Scene:
    """A quickly vibrating body, and one that bounces on it under a push that lasts."""
    springs = (
        Spring("stiff", (GROUND, "a"), Linear((2.0 * math.pi / period) ** 2)),
        Spring("soft", (GROUND, "b"), Linear(0.3)),
    )
    contact = Contact("a-b", "a", "b", 0.01, 0.9)
    return Scene(
        (Body("a", 1.0), Body("b", 0.5)), springs, (), (contact,), Sine(1.0, 2.0 * math.pi)
    )


@pytest.mark.parametrize(("period", "judged"), [(0.03, True), (3.0, False)])
def test_a_stiff_body_that_is_struck_again_and_again_is_judged(period, judged):
    """By `fast` itself, too: nobody else would say that it is wrong."""
    response = simulate(_struck_by_a_stiff_body(period), "fast", 1e-6, duration=20.0)
    struck = [e for e in response.recording.events if e.kind is EventKind.IMPACT]
    assert len(struck) > estimate.RESTLESS
    assert (default_estimate(response) is not None) == judged


def test_a_value_that_the_tolerance_does_not_tell_is_a_warning(monkeypatch):
    """A judge that errs by a thousandth of the motion."""
    response = simulate(WALL, "cvode", 1e-9, duration=4.0)
    assert estimate_errors(response)["warnings"] == []

    class Off:
        def solve(self, task):
            found = simulate(WALL, "cvode", 1e-9, duration=4.0).recording
            return replace(found, u=found.u + 1e-3)

    monkeypatch.setattr(estimate, "solver_named", lambda name: Off())
    errors = estimate_errors(response)
    assert errors["largest"]["quantity"] == "final.b.u"
    assert errors["largest"]["part"] == pytest.approx(1e-3, rel=1e-6)
    (warning,) = errors["warnings"]
    assert "final.b.u is off by 1.0e-03" in warning
    assert "eventpound verify" in warning


def test_a_run_says_it(tmp_path, capsys):
    case = str(CASES / "hard" / "stiff-beside-soft")
    assert main(["run", case, "--no-figures", "--error-estimate", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    assert "of its scale at most" in said.out
    assert "warning: contact 'a-b' comes to rest" in said.err
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["error_estimate"]["warnings"][0] in said.err


def test_a_bounded_run_is_not_judged_unasked(tmp_path, capsys):
    main(["new", str(tmp_path / "case")])
    words = ["run", str(tmp_path / "case"), "--no-figures", "--max-steps", "100000"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    assert "not estimated: the run is bounded" in capsys.readouterr().out
