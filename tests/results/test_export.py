"""The exported matrices against ones written out by hand; the motion against its samples."""

import csv
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from eventpound.case.case import Case, RunOptions, SolverOptions
from eventpound.motion.base import Family, Piece, Scales
from eventpound.motion.free import NoMotion
from eventpound.results import export
from eventpound.results.export import sampled_motion

_UNUSED = (SolverOptions(), Path("."), "", None, (), {})


@dataclass(frozen=True)
class Step(NoMotion):
    """Half a cosine of period 2 s from t = 0 to 1: jumps at both ends."""

    def pieces(self):
        return [
            Piece(-math.inf, 0.0, Family.ZERO),
            Piece(0.0, 1.0, Family.SINUSOIDS, np.array([0.0, 3.0, math.pi, 0.0])),
            Piece(1.0, math.inf, Family.ZERO),
        ]

    def acceleration(self, t):
        return np.where((t >= 0) & (t < 1), 3.0 * np.cos(math.pi * t), 0.0)

    def scales(self):
        return Scales(3.0, math.pi)


@pytest.fixture
def scene(bridge, tmp_path):
    case = Case("A bridge", bridge(), RunOptions(-0.5, 5.5, 0.01), *_UNUSED)
    export(case, tmp_path)
    return json.loads((tmp_path / "scene.json").read_text())


def test_matrices(scene):
    assert scene["title"] == "A bridge"
    assert scene["M"] == [1.3e6, 3.2e6]
    assert scene["B"] == [[1, -1, 0], [0, 1, -1]]
    assert scene["C"] == [[1.7e6 + 1e5, -1e5], [-1e5, 1e5]]
    assert scene["W"] == [[-1, 0], [1, -1]]
    assert scene["gaps"] == [0.0127, 0.02]
    assert scene["restitutions"] == [0.7, 0.5]
    assert scene["initial"] == {"u": [0.001, 0], "v": [-0.2, 0], "z": [0.1]}
    assert (scene["start"], scene["end"]) == (-0.5, 5.0)


def test_springs(scene):
    frame, link, abutment = scene["springs"]
    assert frame["between"] == ["ground", "deck1"]
    assert (frame["strength"], frame["yield_displacement"]) == (3.4e6, 0.0155)
    assert link == {"name": "link", "between": ["deck1", "deck2"], "law": "linear"} | {
        "stiffness": 1.05e6
    }
    condensed = abutment["condensed"]
    assert condensed["compression"] == pytest.approx(1.5e8 * 4.5e8 / 6e8, rel=1e-15)
    assert condensed["extension"] == pytest.approx(1.5e8 * 1.75e6 / 1.5175e8, rel=1e-15)


def test_conventions_are_said(scene):
    assert "ground" in scene["conventions"]["coordinates"]
    assert {spring["law"] for spring in scene["springs"]} <= set(scene["conventions"])


def test_record_gives_its_own_samples(scene, tmp_path):
    with (tmp_path / "motion.csv").open() as file:
        rows = [(float(r["t"]), float(r["a_g"])) for r in csv.DictReader(file)]
    assert rows == [
        (-0.5, 0.0),
        (0.0, 0.0),
        (0.0, 0.5),
        (0.1, -1.0),
        (0.2, 0.25),
        (0.2, 0.0),
        (5.0, 0.0),
    ]


def test_formula_is_sampled_with_both_values_at_a_jump():
    t, a_g = sampled_motion(Step(), 0.0, 4.0)
    assert a_g[0] == 3.0
    before, after = np.flatnonzero(t == 1.0)
    # One rounding of t before the jump: a change below eps * pi * 3.
    assert a_g[before] == pytest.approx(-3.0, abs=1e-15)
    assert a_g[after] == 0.0
    # Linear interpolation between samples errs by h^2/8 max|a''|, h = 2/1000.
    middle = (t[1 : before + 1] + t[:before]) / 2
    bound = 0.002**2 / 8 * 3 * math.pi**2
    assert (
        np.abs(
            np.interp(middle, t[: before + 1], a_g[: before + 1]) - 3.0 * np.cos(math.pi * middle)
        ).max()
        <= bound
    )
    assert np.all(np.diff(t) >= 0)


def test_free_motion_is_two_rows():
    t, a_g = sampled_motion(NoMotion(), 1.0, 2.0)
    assert t.tolist() == [1.0, 2.0]
    assert a_g.tolist() == [0.0, 0.0]
