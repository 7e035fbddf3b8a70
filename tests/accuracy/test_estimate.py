from __future__ import annotations

import json
import math

import pytest

from eventpound.accuracy import estimate
from eventpound.accuracy.estimate import estimate_errors
from eventpound.cli import main
from eventpound.errors import ComputationError
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate

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
