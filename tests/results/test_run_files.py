"""The summary against numbers worked out by hand."""

import json
from dataclasses import replace

import pytest

from eventpound.motion.free import NoMotion
from eventpound.results import read, write
from eventpound.results.run_files import summarise
from eventpound.solvers.base import Drift


@pytest.fixture
def summary(run, tmp_path):
    write(run, tmp_path)
    return read(tmp_path).summary


def test_peaks(run, summary):
    assert summary["peaks"]["deck1"] == {
        "max": 0.05,
        "t_max": 1.0,
        "min": -0.06,
        "t_min": 2.0,
        "abs_max": 0.06,
        "t_abs_max": 2.0,
    }
    # Of two extremes of one size the earlier counts.
    assert summary["peaks"]["deck2"]["t_abs_max"] == 2.5
    for body, row in run.peaks.iterrows():
        assert summary["peaks"][body] == dict(row)


def test_bodies_and_springs(summary):
    assert summary["residual"] == {"deck1": 0.003, "deck2": 0.1 + 0.2}
    assert summary["final"]["deck1"] == {"u": 0.003, "v": -1 / 3}
    assert summary["final"]["frame1"] == {"z": 0.7}
    assert summary["acceleration"]["deck2"]["abs_max"] == 5.0
    assert summary["acceleration"]["deck2"]["t_abs_max"] == 1.3
    assert summary["springs"]["frame1"]["ductility"] == 0.062 / 0.0155
    assert summary["springs"]["frame1"]["min_elongation"] == -0.062
    assert "ductility" not in summary["springs"]["link"]
    assert summary["base_shear"]["abs_max"] == 4e6


def test_contacts(summary):
    assert summary["impacts"] == 42
    assert summary["contacts"]["joint"] == {
        "impacts": 41,
        "resting_time": 0.25,
        "max_impulse": 1000.0 / 3.0,
        "max_force": 9e5,
        "unique_force": True,
        "smallest_gap": 1e-4,
        "largest_gap": 0.05,
        # The opening of a joint of 12.7 mm.
        "seat_used": pytest.approx(0.0373, rel=1e-15),
        "t_max_impulse": 0.1,
        "t_first_impact": 0.1,
        "sum_impulse": 1000.0 / 3.0 + 0.25,
        # Of 55.5 J of a problem of two contacts its share, -1/2 L (g- + g+), and 1e-9 J.
        "energy_lost": 0.5 * 1000.0 / 3.0 * 0.09 + 1e-9,
        "fastest_closing": 0.3,
        "t_fastest_closing": 0.1,
        "impacts_faster": 1,
    }
    assert summary["contacts"]["stop"]["energy_lost"] == 0.5 * 20.0 * 0.05
    assert summary["contacts"]["stop"]["max_force"] is None
    assert summary["contacts"]["stop"]["unique_force"] is False


def test_scales_and_terms(summary):
    length = 1.0 / 20.0**2
    assert summary["scales"] == {"a_g": 1.0, "omega_g": 20.0, "L_e": length}
    assert summary["pi"]["um"] == pytest.approx(0.06 / length, rel=1e-15)
    assert summary["pi"]["um.deck2"] == pytest.approx(0.02 / length, rel=1e-15)
    assert summary["pi"]["delta.joint"] == pytest.approx(0.0127 / length, rel=1e-15)
    assert summary["error_estimate"] is None
    assert summary["work"] == {
        "rhs": 100,
        "jacobian": 5,
        "steps": 60,
        "restarts": 4,
        "seconds": 0.125,
        "compilation": 0.0,
    }


def test_drift_of_resting_contacts(summary, run):
    assert summary["constraint_drift"] is None
    drifting = replace(run, recording=replace(run.recording, drift=Drift(1e-16, 2e-16)))
    assert summarise(drifting)["constraint_drift"] == {"gap": 1e-16, "gap_rate": 2e-16}


def test_free_motion_has_no_scales(bridge, make_run, tmp_path):
    write(make_run(scene=bridge(NoMotion())), tmp_path)
    summary = read(tmp_path).summary
    assert summary["scales"] == {"a_g": None, "omega_g": None, "L_e": None}
    assert "um" not in summary["pi"]


def test_energy_where_asked_for(summary, make_run):
    assert "energy" not in summary
    assert summarise(make_run(energy=True))["energy"]["closure"] == 1e-12


def test_scene_is_described(summary):
    springs = summary["scene"]["springs"]
    assert [spring["law"] for spring in springs] == ["bouc-wen", "linear", "series"]
    assert springs[2]["parts"][1]["compression"] == 4.5e8
    assert summary["scene"]["contacts"][1]["right"] == "barrier"


def test_json_has_no_nan(make_run, tmp_path):
    write(make_run(), tmp_path)

    def refuse(word):
        raise ValueError(word)

    json.loads((tmp_path / "summary.json").read_text(), parse_constant=refuse)
