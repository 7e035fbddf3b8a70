"""Records scaled by their spectra, against the spectrum of what comes out."""

from pathlib import Path

import numpy as np
import pytest

from eventpound import InputError, Record, load_case
from eventpound.case import read_case
from eventpound.motion.scaling import Target, factor_to, psa_of
from eventpound.study.response_spectrum import response_spectrum

RNG = np.random.default_rng(11)
SAMPLES = RNG.normal(0.0, 2.0, 300)
RECORD = Record(SAMPLES, 0.02)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_psa_is_that_of_the_fast_solver(damping):
    periods = np.array([0.03, 0.1, 0.5, 1.7, 9.0])
    found = psa_of(SAMPLES, 0.02, periods, damping)
    expected = response_spectrum(RECORD, damping, periods)["PSA"].to_numpy()
    # The solver errs by its rtol, 1e-8, over up to 300 periods.
    assert found == pytest.approx(expected, rel=1e-6)


def test_psa_of_a_constant_acceleration():
    # For a whole undamped period: u swings to twice a/w^2.
    found = psa_of(np.full(201, 3.0), 0.01, np.array([2.0]), 0.0)
    assert found[0] == pytest.approx(6.0, rel=1e-12)


def test_record_of_a_psa():
    record = Record(SAMPLES, 0.02, psa=4.0, psa_period=0.6, psa_damping=0.02, reverse=True)
    assert response_spectrum(record, 0.02, [0.6])["PSA"][0] == pytest.approx(4.0, rel=1e-6)
    assert record.values[0] * SAMPLES[0] < 0.0
    # Another size of the same record needs no other spectrum.
    other = record.like(psa=8.0)
    assert "recorded_psa" in vars(other)
    assert other.values == pytest.approx(2.0 * record.values)
    assert "recorded_psa" not in vars(record.like(psa_period=0.7))


def test_least_squares_to_a_target():
    period = np.geomspace(0.1, 3.0, 40)
    psa = psa_of(SAMPLES, 0.02, period, 0.05)
    own = Target(tuple(period), tuple(2.5 * psa), 0.1, 3.0)
    # Its own spectrum, 2.5 times as large, but for what is read between its points.
    assert factor_to(own, SAMPLES, 0.02) == pytest.approx(2.5, rel=0.02)
    flat = Target((0.1, 3.0), (5.0, 5.0), 0.2, 2.0, 0.1)
    factor = factor_to(flat, SAMPLES, 0.02)
    at = np.geomspace(0.2, 2.0, 60)

    def misfit(scale: float) -> float:
        return float((np.log(scale * psa_of(SAMPLES, 0.02, at, 0.1) / 5.0) ** 2).sum())

    assert misfit(factor) < min(misfit(0.999 * factor), misfit(1.001 * factor))


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"psa": 1.0}, "psa without psa_period"),
        ({"psa": 1.0, "psa_period": 1.0, "pga": 2.0}, "pga = 2.0 and psa = 1.0"),
        ({"psa": 1.0, "psa_period": 1.0, "scale": 2.0}, "scale = 2.0 and psa = 1.0"),
        ({"psa": -1.0, "psa_period": 1.0}, "psa"),
        ({"psa": 1.0, "psa_period": 1.0, "psa_damping": 1.0}, "psa_damping is 1.0"),
    ],
)
def test_refused(numbers, said):
    with pytest.raises(InputError, match=said):
        Record(SAMPLES, 0.02, **numbers)


CASE = """
body = [{{ name = "deck", mass = 1000.0 }}]
spring = [{{ between = ["ground", "deck"], name = "piers", law = "linear", period = "0.5 s" }}]
[excitation]
kind = "record"
units = "m/s2"
time_step = 0.02
{}
"""
TARGET = 'target_periods = ["0.2 s", 2]\ntarget_damping = "2 %"'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "a.txt").write_text("\n".join(map(repr, SAMPLES.tolist())))
    (tmp_path / "code.csv").write_text("period,PSA_g\n0.1,0.5\n0.5,0.5\n4,0.1\n")
    return tmp_path


def motion(folder: Path, text: str) -> Record:
    (folder / "case.toml").write_text(CASE.format(f'file = "a.txt"\n{text}'))
    case = load_case(folder)
    again = read_case(case.understood, folder / "case.toml").scene.motion
    record = case.scene.motion
    # What was understood gives the same motion, without the file of the target.
    assert again.factor == record.factor
    return record


def test_case_by_psa(folder):
    record = motion(folder, 'psa = "0.5 g"\npsa_period = "1.2 s"')
    found = response_spectrum(record, 0.05, [1.2])["PSA_g"][0]
    assert found == pytest.approx(0.5, rel=1e-6)


def test_case_by_target(folder):
    record = motion(folder, f'target = "code.csv"\n{TARGET}')
    g = 9.80665
    points = ((0.1, 0.5, 4.0), (0.5 * g, 0.5 * g, 0.1 * g))
    expected = factor_to(Target(*points, 0.2, 2.0, 0.02), SAMPLES, 0.02)
    assert record.factor == pytest.approx(expected, rel=1e-12)
    listed = 'target = [["100 ms", "0.5 g"], [0.5, "0.5 g"], [4, "0.1 g"]]'
    assert motion(folder, f"{listed}\n{TARGET}").factor == pytest.approx(expected, rel=1e-12)


def test_suite_by_psa(folder):
    text = 'suite = "*.txt"\npsa = 3\npsa_period = 1'
    (folder / "case.toml").write_text(CASE.format(text))
    case = load_case(folder)
    assert case.size.words().startswith("every record to a PSA of 0.3059 g at 1 s")
    (member,) = case.suite.members(folder)
    record = member.options.motion(member.read())
    assert psa_of(record.values, 0.02, np.array([1.0]), 0.05)[0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("psa = 3", "psa_period: missing"),
        ("psa = 3\npsa_period = -1", "psa_period: found -1"),
        ("psa = 3\npsa_period = 1\npsa_damping = 2", "psa_damping: found 2"),
        ("psa = 3\npsa_period = 1\nscale = 2", "psa: found 3; accepted: one of scale, pga"),
        ('target = "code.csv"', "target_periods: missing"),
        (f'target = "none.csv"\n{TARGET}', "there is no file"),
        (f'target = "a.txt"\n{TARGET}', "target: .*no column period, PSA_g"),
        (f"target = [[1, 2], [0.5, 2]]\n{TARGET}", "periods rising"),
        (f"target = [1, 2]\n{TARGET}", "target: found"),
        ('target = "code.csv"\ntarget_periods = [0.05, 2]', "between 0.1 and 4 s"),
        ('target = "code.csv"\ntarget_periods = [1]', "target_periods: found"),
        (f'target = "code.csv"\n{TARGET}\npga = 2', "one of scale, pga, psa, target"),
        ("target_periods = [1, 2]", "target_periods: .*a target beside it"),
    ],
)
def test_case_refused(folder, text, said):
    (folder / "case.toml").write_text(CASE.format(f'file = "a.txt"\n{text}'))
    with pytest.raises(InputError, match=said):
        load_case(folder)
