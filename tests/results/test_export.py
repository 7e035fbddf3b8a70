"""The exported matrices against ones written out by hand; the motion against its samples."""

import csv
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from eventpound import Case, InputError, load_case
from eventpound.case.record_options import RecordOptions
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.case.suite import Suite
from eventpound.motion import Cosine, Family, NoMotion, Piece, Record, Scales, Sine
from eventpound.motion.constant import PhasedSine
from eventpound.results import export
from eventpound.results.export import sampled_signals
from eventpound.scene import (
    GROUND,
    Backfill,
    Body,
    Contact,
    ContactLaw,
    Dashpot,
    Force,
    Linear,
    Scene,
    Spring,
    Support,
)
from eventpound.simulation import response_of
from tests.models import CASES

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
    t, (a_g,) = sampled_signals([Step()], 0.0, 4.0)
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
    t, (a_g,) = sampled_signals([NoMotion()], 1.0, 2.0)
    assert t.tolist() == [1.0, 2.0]
    assert a_g.tolist() == [0.0, 0.0]


def supported_scene():
    """Two decks on three supports, elastic, with a load; a gap against one of the supports."""
    record = Record(np.random.default_rng(5).normal(size=40), 0.05)
    return Scene(
        (Body("a", 2.0, 0.01), Body("b", 3.0, 0.0, 0.1)),
        (
            Spring("1", (GROUND, "a"), Linear(80.0)),
            Spring("2", ("a", "p"), Linear(30.0)),
            Spring("3", ("q", "b"), Linear(150.0)),
        ),
        (Dashpot(("p", "b"), 2.0), Dashpot(("a", "b"), 1.0)),
        (Contact("c", "q", "b", 0.5, 0.5), Contact("d", "a", "b", 9.0, 0.5)),
        Sine(2.0, 0.9),
        (Support("p", 0.25), Support("q", motion=record)),
        (Force("a", 3.0), Force("b", PhasedSine(4.0, 0.6, cycles=1.5)), Force("a", "-1 m/s^2")),
    )


def test_supports_as_another_program_reads_them(tmp_path):
    """The files alone, integrated by SciPy, give the motion that we compute."""
    scene, end = supported_scene(), 2.0
    export(Case("", scene, RunOptions(0.0, end, 0.01), *_UNUSED), tmp_path)
    given = json.loads((tmp_path / "scene.json").read_text())
    with (tmp_path / "motion.csv").open() as file:
        rows = list(csv.DictReader(file))
    column = {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
    assert list(column)[2:8] == ["s.p", "sv.p", "sa.p", "s.q", "sv.q", "sa.q"]
    t = column["t"]
    M, C, B = (np.array(given[key]) for key in ("M", "C", "B"))
    C_s, B_s, W, W_s = (np.array(given[key]) for key in ("C_s", "B_s", "W", "W_s"))
    k = np.array([spring["stiffness"] for spring in given["springs"]])
    y, low = np.concatenate([given["initial"]["u"], given["initial"]["v"]]), 0
    pushes = [column["p.a"], column["p.b"]]
    for high in [*np.flatnonzero(np.diff(t) == 0.0), t.size - 1]:
        own = slice(low, high + 1)

        def rate(now, y, own=own):
            def at(values):
                return np.interp(now, t[own], values[own])

            s = np.array(
                [
                    CubicHermiteSpline(t[own], column[f"s.{n}"][own], column[f"sv.{n}"][own])(now)
                    for n in "pq"
                ]
            )
            sv = np.array([at(column[f"sv.{n}"]) for n in "pq"])
            F = k * (B.T @ y[:2] + B_s.T @ s)
            p = np.array([at(push) for push in pushes])
            a = (p - C @ y[2:] - C_s @ sv - B @ F) / M - at(column["a_g"])
            return np.concatenate([y[2:], a])

        if t[high] > t[low]:
            step = solve_ivp(rate, (t[low], t[high]), y, rtol=1e-8, atol=1e-10, max_step=0.02)
            y = step.y[:, -1]
        low = high + 1
    ours = response_of(scene, "fast", 1e-10, duration=end).recording
    # Rows of the sine lie 0.9 ms apart: h^2/8 of its second derivative, 1e-5 of it.
    assert np.abs(ours.u - y[:2]).max() <= 3e-5 * np.abs(ours.displacement.maximum).max()
    last = np.array([column["s.p"][-1], column["s.q"][-1]])
    gap = np.array(given["gaps"]) + W.T @ y[:2] + W_s.T @ last
    assert np.abs(gap - ours.history.gap[-1]).max() <= 1e-5


def exported(scene, start, directory):
    export(Case("", scene, RunOptions(start, 1.0, 0.01), *_UNUSED), directory)
    return json.loads((directory / "scene.json").read_text())


def test_soil_at_a_support_that_has_moved(tmp_path):
    """What is not touched has z = (x + gap)/u_y > 0, wherever the support is at the start."""
    soil = Spring("soil", ("p", "a"), Backfill(1e3, 8.0, 0.8, 0.3))
    pulse, start = Cosine(1.0, 2.0), 0.5
    scene = Scene((Body("a", 1.0),), (soil,), supports=(Support("p", motion=pulse),))
    place = (1.0 - math.cos(math.pi * start)) / math.pi**2
    (z,) = exported(scene, start, tmp_path)["initial"]["z"]
    assert z == pytest.approx((0.3 - place) / (8.0 / 0.8 / 1e3), rel=1e-12)


def test_a_contact_law_is_said(tmp_path):
    law = ContactLaw("kelvin-voigt", 1e6)
    scene = Scene((Body("a", 1.0),), contacts=(Contact("c", "a", "barrier", 0.1, 0.5, law),))
    found = exported(scene, 0.0, tmp_path)
    assert "kelvin-voigt" in found["conventions"]["contact laws"]
    ratio = math.log(2.0) / math.hypot(math.pi, math.log(2.0))
    assert found["contacts"][0]["law"]["damping"] == pytest.approx(ratio, rel=1e-15)


def test_without_supports_nothing_is_said_of_them(scene):
    assert not {"C_s", "B_s", "W_s"} & set(scene)
    assert not {"supports", "forces"} & set(scene["conventions"])


def test_a_suite_has_no_one_motion(scene, tmp_path):
    records = Suite(None, ((1, 1),), RecordOptions())
    case = Case("many", scene, RunOptions(duration=1.0), *_UNUSED, suite=records)
    with pytest.raises(InputError, match="holds a suite of records"):
        export(case, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_deck_in_plan_as_another_program_reads_it(tmp_path):
    """Under two components from an angle, before anything strikes."""
    text = (CASES / "skew-deck" / "case.toml").read_text()
    second = 'across = { kind = "ricker", amplitude = "0.2 g", period = "0.6 s" }\nattack = 0.4\n'
    text = text.replace("\n[[deck]]", f"{second}\n[[deck]]", 1)
    text = text.replace('gap = "4 cm"', 'gap = "4 m"').replace('"8 s"', '"2 s"')
    (tmp_path / "case.toml").write_text(text)
    case = load_case(tmp_path)
    export(case, tmp_path / "out")
    told = json.loads((tmp_path / "out" / "scene.json").read_text())
    motion = np.genfromtxt(tmp_path / "out" / "motion.csv", delimiter=",", names=True)
    M, C, B, iota = (np.array(told[key]) for key in ("M", "C", "B", "iota"))
    K = B * [spring["stiffness"] for spring in told["springs"]] @ B.T

    def rates(t, y):
        ground = [np.interp(t, motion["t"], motion[name]) for name in ("a_g", "a_across")]
        u, v = np.split(y, 2)
        return np.concatenate((v, -(C @ v + K @ u) / M - iota @ ground))

    y = solve_ivp(rates, (0.0, 2.0), np.zeros(6), rtol=1e-9, atol=1e-12, max_step=0.01).y[:, -1]
    found = response_of(case, rtol=1e-9).recording
    # Between rows a thousandth of a period apart a pulse is off by 5e-6 of its amplitude.
    assert found.u == pytest.approx(y[:3], abs=1e-5 * np.abs(y[:3]).max())


def test_friction_slides_along_the_edges(tmp_path):
    """W_T by the shape of the deck: along (-sin α, cos α), at the arm of a place of the edge."""
    export(load_case(CASES / "skew-deck-friction"), tmp_path)
    told = json.loads((tmp_path / "scene.json").read_text())
    assert "friction" in told["conventions"]
    assert told["frictions"] == [0.0] * 4 + [0.3] * 4
    column = np.array(told["W_T"])[:, 5]
    alpha, y = math.radians(30.0), 5.5
    along = np.array([-math.sin(alpha), math.cos(alpha)])
    x = -18.0 - y * math.tan(alpha)
    radius = math.sqrt((36.0**2 + (11.0 / math.cos(alpha)) ** 2) / 12.0)
    turn = (x * along[1] - y * along[0]) / radius
    assert column == pytest.approx([0.0, 0.0, 0.0, *along, turn], abs=1e-14)
