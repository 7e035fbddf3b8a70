"""Floor spectra against closed forms and an oscillator of a billionth of the mass in the scene."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound import Case, InputError, Response, load_case, simulate
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.cli import main
from eventpound.motion import Cosine, NoMotion, Record, Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Dashpot, Linear, Scene, Spring
from eventpound.study.response_spectrum import response_spectrum
from tests.models import CASES
from tests.solvers.scenes import pounding_pair

PERIODS = [0.05, 0.13, 0.3, 0.7, 2.0, 6.0]
SHAKEN = Record(np.random.default_rng(3).normal(0.0, 6.0, 150), 0.02)


def struck_once(velocity: float = 0.5, restitution: float = 0.6) -> Scene:
    """A body that flies freely into a barrier, at 0.2 s, and back."""
    contact = Contact("wall", "a", BARRIER, 0.1, restitution)
    return Scene((Body("a", 1.0, velocity=velocity),), contacts=(contact,))


# At t = 0 the ground jumps beside a body that is free by then.
@pytest.mark.parametrize("motion", [NoMotion(), Cosine(0.5, 1.0)])
def test_one_impact_in_closed_form(motion):
    scene, run = replace(struck_once(), motion=motion), RunOptions(-0.5, 8.0, 0.01)
    case = Case("", scene, run, SolverOptions("fast", 1e-10), Path(), "", None, (), {})
    response = simulate(case)
    found = response.floor_spectrum("a", PERIODS, [0.0, 0.05, 0.2])
    # An impulse (1 + e) v on an oscillator at rest.
    w, xi = 2.0 * np.pi / found["period"], found["damping"]
    swing = np.sqrt(1.0 - xi**2)
    late = np.arctan2(swing, xi) / swing
    expected = 1.6 * 0.5 / w * np.exp(-xi * late)
    assert found["SD"].to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-12)
    # w^2 q + 2 xi w q' is largest where its phase, which the dashpot sets ahead, is a right angle.
    early = np.maximum(np.arctan2(swing, xi) - np.arctan2(2.0 * xi * swing, 1.0 - 2.0 * xi**2), 0.0)
    force = 1.6 * 0.5 * w * np.exp(-xi * early / swing)
    assert found["SA"].to_numpy() == pytest.approx(force.to_numpy(), rel=1e-12)


def with_oscillator(response: Response, on: int, period: float, ratio: float) -> Scene:
    scene = response.scene
    body = scene.bodies[on]
    mass, w = 1e-9 * body.mass, 2.0 * math.pi / period
    ends = (body.name, "equipment")
    light = Body("equipment", mass, body.displacement, body.velocity)
    return replace(
        scene,
        bodies=(*scene.bodies, light),
        springs=(*scene.springs, Spring("mount", ends, Linear(mass * w**2))),
        dashpots=(*scene.dashpots, Dashpot(ends, 2.0 * ratio * w * mass)),
    )


def _resting() -> Scene:
    """The pair under a record, with impacts that accumulate and rests."""
    scene = pounding_pair()
    contacts = tuple(replace(c, restitution=0.1) for c in scene.contacts)
    return replace(scene, contacts=contacts, motion=SHAKEN)


@pytest.mark.parametrize("solver", ["fast", "cvode"])
@pytest.mark.parametrize("scene", [pounding_pair(), _resting()], ids=["pulse", "resting"])
def test_against_an_oscillator_of_the_scene(scene, solver):
    response = simulate(scene, solver, 1e-11, duration=5.0)
    assert response.impacts > 5
    assert scene.motion is not SHAKEN or response.recording.resting_time.sum() > 0.01
    found = response.floor_spectrum("a", PERIODS, [0.02, 0.2])
    for _, row in found.iterrows():
        scene = with_oscillator(response, 0, row["period"], row["damping"])
        coupled = simulate(scene, "fast", 1e-11, duration=5.0)
        drift = coupled.springs.loc["mount", ["min_elongation", "max_elongation"]]
        # The oscillator moves the body by its mass over twice the damping, 2.5e-8.
        assert row["SD"] == pytest.approx(np.abs(drift).max(), rel=5e-8)
        largest = coupled.quantity("acceleration.equipment.abs_max")
        assert largest is not None
        assert row["SA"] == pytest.approx(abs(largest), rel=5e-8)


def test_scene_with_supports_and_with_forces():
    wave = load_case(CASES / "passing-wave")
    response = simulate(wave, "fast", 1e-11, duration=4.0)
    assert response.impacts > 0
    (row,) = response.floor_spectrum("deck2", [0.3], 0.2).to_dict("records")
    scene = with_oscillator(response, 1, 0.3, 0.2)
    coupled = simulate(scene, "fast", 1e-11, duration=4.0)
    drift = coupled.springs.loc["mount", ["min_elongation", "max_elongation"]]
    assert row["SD"] == pytest.approx(np.abs(drift).max(), rel=5e-8)
    # A bead falls with g from rest: under a step an undamped oscillator swings to twice g/w^2.
    # Its own weight would keep it as it is; forces act on the bodies that they name, not on it.
    beads = simulate(load_case(CASES / "bead-column"), "fast", 1e-11, duration=0.1)
    assert beads.impacts == 0
    found = beads.floor_spectrum("low", [0.05], 0.0)["SD"][0]
    assert found == pytest.approx(2.0 * 9.80665 / (2.0 * np.pi / 0.05) ** 2, rel=1e-9)


def test_a_stiff_body_hands_the_ground_on():
    # Its own motion is 1e-4 of the ground's: (T/T_g)^2 of a pulse of 0.8 s on a body of 8 ms.
    motion = Sine(3.0, 0.8)
    scene = Scene(
        (Body("a", 1.0),),
        (Spring("s", (GROUND, "a"), Linear((2.0 * math.pi / 0.008) ** 2)),),
        (Dashpot((GROUND, "a"), 2.0 * 0.5 * 2.0 * math.pi / 0.008),),
        motion=motion,
    )
    found = simulate(scene, "fast", 1e-9, duration=6.0).floor_spectrum("a", [0.3, 1.0, 4.0], "5 %")
    expected = response_spectrum(motion, "5 %", [0.3, 1.0, 4.0])
    assert found["SD"].to_numpy() == pytest.approx(expected["SD"].to_numpy(), rel=5e-3)
    assert found["PSA_g"].to_numpy() == pytest.approx(expected["PSA_g"].to_numpy(), rel=5e-3)


def test_table():
    response = simulate(pounding_pair(), "fast", 1e-8, duration=2.0)
    table = response.floor_spectrum(["b", "a"], [0.2, 0.4], ["2 %", 0.05])
    assert list(table["body"]) == ["b"] * 4 + ["a"] * 4
    assert list(table["damping"][:4]) == [0.02, 0.02, 0.05, 0.05]
    assert table.attrs["units"]["SA"] == "m/s^2"
    assert set(table.attrs["units"]) == set(table.columns)


@pytest.mark.parametrize(
    ("body", "periods", "damping", "said"),
    [
        ("c", [1.0], 0.05, "body: found c; accepted: a, b"),
        ([], [1.0], 0.05, "body: found none"),
        ("a", [-1.0], 0.05, "periods"),
        ("a", [1.0], 1.0, "damping: found 1.0"),
        ("a", [1.0], "5 m", "damping: found '5 m'"),
    ],
)
def test_refused(body, periods, damping, said):
    response = simulate(pounding_pair(), "fast", 1e-6, duration=0.5)
    with pytest.raises(InputError, match=said):
        response.floor_spectrum(body, periods, damping)


CASE = """
body = [{ name = "deck", mass = "900 t" }]
spring = [{ name = "pier", between = ["ground", "deck"], law = "linear", period = "0.9 s" }]
contact = [{ name = "wall", between = ["deck", "barrier"], gap = "2 cm", restitution = 0.7 }]
[excitation]
kind = "sine"
amplitude = "0.3 g"
period = "0.6 s"
[run]
duration = "3 s"
"""


def test_command(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(CASE)
    words = ["floor-spectrum", str(tmp_path), "deck", "--damping", "2%,5 %", "--periods", "0.1,2"]
    assert main([*words, "--without-contact", "--format", "png,svg"]) == 0
    assert "deck             2 % damping: PSA up to" in capsys.readouterr().out
    table = pd.read_csv(tmp_path / "results" / "floor-spectra.csv")
    assert len(table) == 400
    assert table["period"].iloc[[0, 199]].tolist() == pytest.approx([0.1, 2.0])
    assert (table["PSA"] > table["free.PSA"]).any()
    for kind in ("png", "svg"):
        assert (tmp_path / "results" / f"floor-spectra.{kind}").stat().st_size > 5000


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["pier"], "body: found pier"),
        (["deck", "--periods", "0,1"], "--periods: found 0,1"),
        (["deck", "--damping", "120 %"], "damping: found '120 %'"),
    ],
)
def test_command_refuses(tmp_path, capsys, words, said):
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["floor-spectrum", str(tmp_path), *words]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "results").exists()
