"""The period that a record is scaled at: of a scene, or of a body with what swings with it."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from eventpound import InputError, Record, Study, load_case, prepare, simulate, simulate_suite
from eventpound.motion.scaling import psa_of
from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from eventpound.scene.periods import period_called
from eventpound.study.reading import load_study
from tests.study.test_suite import time_series


def period(mass: float, stiffness: float) -> float:
    return 2.0 * math.pi * math.sqrt(mass / stiffness)


def scene(bodies: Sequence[str], springs: Sequence[tuple[str, str, float]]) -> Scene:
    return Scene(
        tuple(Body(name, 1.0 + i) for i, name in enumerate(bodies)),
        tuple(Spring(f"{a}-{b}", (a, b), Linear(k)) for a, b, k in springs),
    )


def test_of_segments_each_has_its_own_on_all_its_springs():
    bridge = scene("ab", [(GROUND, "a", 50.0), (GROUND, "b", 20.0), ("a", "b", 5.0)])
    assert period_called(bridge, "T1 of a") == pytest.approx(period(1.0, 55.0), rel=1e-12)
    assert period_called(bridge, "T1 of b") == pytest.approx(period(2.0, 25.0), rel=1e-12)
    matrix = np.array([[55.0, -5.0], [-5.0, 25.0]]) / np.sqrt(np.outer([1.0, 2.0], [1.0, 2.0]))
    slowest = 2.0 * math.pi / math.sqrt(np.linalg.eigvalsh(matrix)[0])
    assert period_called(bridge, "T1") == pytest.approx(slowest, rel=1e-12)


def test_every_floor_of_a_building_has_that_of_the_building():
    springs = [(GROUND, "a", 30.0), ("a", "b", 20.0), (GROUND, "c", 1.0)]
    building = scene("abc", springs)
    matrix = np.array([[50.0, -20.0], [-20.0, 20.0]]) / np.sqrt(np.outer([1.0, 2.0], [1.0, 2.0]))
    own = 2.0 * math.pi / math.sqrt(np.linalg.eigvalsh(matrix)[0])
    for floor in "ab":
        assert period_called(building, f"T1 of {floor}") == pytest.approx(own, rel=1e-12)
    assert period_called(building, "T1") == pytest.approx(period(3.0, 1.0), rel=1e-12)


def test_what_has_no_period_is_refused():
    loose = scene("a", [])
    with pytest.raises(InputError, match="no spring resists"):
        period_called(loose, "T1")
    with pytest.raises(InputError, match=r"found 'T1 of x'; accepted: T1, or T1 of a"):
        period_called(loose, "T1 of x")


CASE = """
body = [{{ name = "deck", mass = 1000.0 }}]
[[spring]]
between = ["ground", "deck"]
name = "piers"
law = "linear"
stiffness = "{stiffness} kN/m"
[excitation]
kind = "record"
{record}
units = "g"
time_step = 0.02
psa = "0.4 g"
psa_period = {at}
[solver]
name = "fast"
"""


def written(folder: Path, record: str, at: str = '"T1"', more: str = "", k: float = 80.0) -> Path:
    for name, amplitude in (("a", 0.2), ("b", 0.5)):
        (folder / f"{name}.txt").write_text(time_series(amplitude))
    (folder / "case.toml").write_text(CASE.format(stiffness=k, record=record, at=at) + more)
    return folder


def sa(record: Record, at: float) -> float:
    return float(psa_of(record.values, record.time_step, np.array([at]), 0.05)[0]) / 9.80665


@pytest.mark.parametrize("at", ['"T1"', '"T1 of deck"'])
def test_a_record_has_its_ordinate_at_the_period_of_the_scene(tmp_path, at):
    motion = load_case(written(tmp_path, 'file = "a.txt"', at)).scene.motion
    assert sa(motion, period(1e3, 80e3)) == pytest.approx(0.4, rel=1e-9)


SLOWER = """
[[spring]]
between = ["ground", "beside"]
law = "linear"
stiffness = 20e3
"""


@pytest.mark.parametrize(
    ("at", "more"),
    [('"T1"', ""), ('"T1 of deck"\npsa_damping = 0.1', SLOWER), ("0.3", SLOWER)],
    ids=["scene", "body", "number"],
)
def test_a_suite_tells_the_ordinate_that_was_asked_for(tmp_path, at, more):
    file = written(tmp_path, 'suite = "?.txt"', at, more) / "case.toml"
    if more:
        file.write_text(file.read_text().replace("0 }]", '0 }, { name = "beside", mass = 1e3 }]'))
    table = simulate_suite(load_case(tmp_path), intensities=True)
    assert table["Sa_T1"].to_numpy() / 9.80665 == pytest.approx([0.4, 0.4], rel=1e-9)


def test_a_suite_says_at_which_period(tmp_path):
    case = load_case(written(tmp_path, 'suite = "?.txt"'))
    assert case.suite is not None
    assert "a PSA of 0.4 g at T1 = 0.7025 s" in case.size.words()


def test_each_variant_of_a_study_has_its_own(tmp_path):
    stiffnesses, key = [40e3, 80e3, 160e3], "spring.piers.stiffness"
    axis = f'[[study.axis]]\nkey = "{key}"\nvalues = {stiffnesses}\n'
    quantities = 'quantities = ["peaks.deck.abs_max", "excitation.psa_period"]'
    more = f'[study]\nrecords = "?.txt"\n{quantities}\n{axis}'
    folder = written(tmp_path, "", more=more)
    plan = load_study(folder).study
    assert plan.size == 6
    case = load_case(written(tmp_path, 'file = "b.txt"'))
    study = Study(case, {key: stiffnesses}, quantities=["peaks.deck.abs_max"], rtol=1e-9).run()
    for i, k in enumerate(stiffnesses):
        fixed = repr(period(1e3, k))
        one = load_case(written(tmp_path, 'file = "b.txt"', fixed, k=k / 1e3))
        peak = simulate(one, "fast", rtol=1e-9).peaks["abs_max"]["deck"]
        assert study["peaks.deck.abs_max"][i] == pytest.approx(peak, rel=1e-7)
        for given in (None, case.run.duration):
            again = prepare(case, "fast", 1e-9, duration=given).run({key: k})
            assert again.peaks["abs_max"]["deck"] == pytest.approx(peak, rel=1e-7)


@pytest.mark.parametrize(
    ("at", "said"),
    [
        ('"T1 of pier"', r"psa_period: found 'T1 of pier'; accepted: T1, or T1 of deck"),
        ('"T1 of "', "psa_period: found 'T1 of '; accepted: T1, or T1 of deck"),
        ('"T2"', "psa_period: found 'T2'"),
    ],
)
def test_what_a_case_may_not_call_it(tmp_path, at, said):
    with pytest.raises(InputError, match=said):
        load_case(written(tmp_path, 'file = "a.txt"', at))


@pytest.mark.parametrize("key", ["psa_period", "psa_damping"])
def test_what_belongs_to_a_psa_is_refused_without_one(tmp_path, key):
    folder = written(tmp_path, 'file = "a.txt"')
    text = (folder / "case.toml").read_text()
    kept = [line for line in text.splitlines() if not line.startswith("psa")]
    at = kept.index('file = "a.txt"') + 1
    (folder / "case.toml").write_text("\n".join([*kept[:at], f"{key} = 0.1", *kept[at:]]))
    with pytest.raises(InputError, match=rf"{key}: found 0\.1; accepted: a psa beside it"):
        load_case(folder)


def test_a_support_has_no_period_of_its_own(tmp_path):
    own = '{ kind = "record", file = "b.txt", units = "g", psa = 1, psa_period = "T1" }'
    more = f'[[support]]\nname = "far"\nexcitation = {own}\n'
    folder = written(
        tmp_path, 'file = "a.txt"', more=more.replace("psa = 1", "time_step = 0.02, psa = 1")
    )
    with pytest.raises(InputError, match=r"psa_period: found 'T1'; accepted: a period \(s\)"):
        load_case(folder)
