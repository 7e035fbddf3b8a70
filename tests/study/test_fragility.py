"""Fragility against published maximum likelihood fits, and what has no curve."""

import re

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize
from scipy.stats import binom, norm

from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.study.fragility import fit_capacities, fit_counts, fragility_table


def test_beetles_of_bliss():
    """Bliss (1935), the probit fit that Agresti and Dobson print: -34.94 + 19.73 log10 x."""
    dose = 10.0 ** np.array([1.6907, 1.7242, 1.7552, 1.7842, 1.8113, 1.8369, 1.8610, 1.8839])
    total = np.array([59.0, 60.0, 62.0, 56.0, 63.0, 59.0, 62.0, 60.0])
    killed = np.array([6.0, 13.0, 18.0, 28.0, 52.0, 53.0, 61.0, 60.0])
    fit = fit_counts(dose, total, killed)
    slope = np.log(10.0) / fit.beta
    assert slope == pytest.approx(19.73, abs=0.005)
    assert -slope * np.log10(fit.theta) == pytest.approx(-34.94, abs=0.005)


def test_locomotives_of_nelson():
    """Nelson (1982), 37 failures of 96, the others censored: mean 2.2223 and 0.3064 of log10."""
    failed = [
        22.5, 37.5, 46.0, 48.5, 51.5, 53.0, 54.5, 57.5, 66.5, 68.0, 69.5, 76.5, 77.0, 78.5, 80.0,
        81.5, 82.0, 83.0, 84.0, 91.5, 93.5, 102.5, 107.0, 108.5, 112.5, 113.5, 116.0, 117.0, 118.5,
        119.0, 120.0, 122.5, 123.0, 127.5, 131.0, 132.5, 134.0,
    ]  # fmt: skip
    fit = fit_capacities(np.array(failed), np.full(59, 135.0))
    assert np.log10(fit.theta) == pytest.approx(2.2223, abs=1e-4)
    assert fit.beta / np.log(10.0) == pytest.approx(0.3064, abs=1e-4)


def test_example_of_baker():
    """The eight stripes of 40 motions that come with Baker (2015), by another optimiser."""
    x = np.array([0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0])
    collapses = np.array([0.0, 0.0, 0.0, 4.0, 6.0, 13.0, 12.0, 16.0])
    fit = fit_counts(x, np.full(8, 40.0), collapses)

    def unlikely(at: np.ndarray) -> float:
        p = norm.cdf(np.log(x / at[0]) / at[1])
        return -float(binom.logpmf(collapses, 40, p).sum())

    best = minimize(unlikely, [0.8, 0.4], method="Nelder-Mead", options={"xatol": 1e-9})
    assert [fit.theta, fit.beta] == pytest.approx(best.x, rel=1e-5)
    assert fit.probability(np.array([fit.theta]))[0] == pytest.approx(0.5)


def test_errors_are_those_of_repeated_experiments():
    """Of 400 experiments with known answers: no bias, and the spread that is stated."""
    rng = np.random.default_rng(5)
    x = np.linspace(0.4, 2.0, 9)
    p = norm.cdf(np.log(x) / 0.4)
    fits = [fit_counts(x, np.full(9, 40.0), rng.binomial(40, p) * 1.0) for _ in range(400)]
    theta = np.log([fit.theta for fit in fits])
    beta = np.array([fit.beta for fit in fits])
    stated = np.mean([fit.error_ln_theta for fit in fits])
    # A spread from 400 is known to 1/sqrt(800), a mean to a twentieth of it; 4 of these.
    assert theta.std() == pytest.approx(stated, rel=0.15)
    assert abs(theta.mean()) < 0.2 * stated
    assert beta.std() == pytest.approx(np.mean([fit.error_beta for fit in fits]), rel=0.15)


def test_capacities_that_are_known_of_both_sides():
    """Censored capacities are neither thrown away nor taken for known."""
    rng = np.random.default_rng(2)
    capacity = np.exp(rng.normal(np.log(3.0), 0.5, 20_000))
    inside = (capacity > 2.0) & (capacity < 5.0)
    beyond, below = np.full((capacity >= 5.0).sum(), 5.0), np.full((capacity <= 2.0).sum(), 2.0)
    fit = fit_capacities(capacity[inside], beyond, below)
    assert np.log(fit.theta / 3.0) == pytest.approx(0.0, abs=4.0 * fit.error_ln_theta)
    assert fit.beta == pytest.approx(0.5, abs=4.0 * fit.error_beta)
    assert fit.error_ln_theta < 0.005


@pytest.mark.parametrize(
    ("exceeded", "said"),
    [
        ([0, 0, 0], "no demand exceeds"),
        ([5, 5, 5], "every demand exceeds"),
        ([0, 2, 5], "beta is 0"),
        ([0, 0, 5], "beta is 0"),
        ([4, 2, 1], "does not grow"),
    ],
)
def test_no_curve(exceeded, said):
    fit = fit_counts(np.array([1.0, 2.0, 3.0]), np.full(3, 5.0), np.array(exceeded, float))
    assert said in fit.note
    assert np.isnan([fit.theta, fit.beta]).all()


ROWS = pd.DataFrame(
    {
        "excitation.file": list("aaabbbccc"),
        "excitation.psa": [1.0, 2.0, 4.0] * 3,
        "peaks.deck.abs_max": [0.01, 0.03, 0.05, 0.02, 0.04, 0.07, 0.01, 0.01, np.nan],
    }
)


def test_capacities_of_a_table():
    columns = "excitation.psa", "peaks.deck.abs_max"
    found = fragility_table(ROWS, *columns, [0.025, 0.5], "excitation.file")
    # Linear between two intensities: 1.75 and 1.25; the third is censored at 2, its last number.
    expected = fit_capacities(np.array([1.75, 1.25]), np.array([2.0]))
    assert found["theta"][0] == pytest.approx(expected.theta)
    assert found["beta"][0] == pytest.approx(expected.beta)
    assert found[["count", "exceeded", "left_out"]].iloc[0].tolist() == [3, 2, 1]
    assert "0 capacities" in found["note"][1]
    counted = fragility_table(ROWS, *columns, [0.025])
    assert counted[["count", "exceeded"]].iloc[0].tolist() == [8, 4]


@pytest.mark.parametrize(
    ("measure", "demand", "records", "said"),
    [
        ("pga", "peaks.deck.abs_max", None, "no column pga"),
        ("excitation.file", "peaks.deck.abs_max", None, "holds no numbers"),
        ("peaks.deck.abs_max", "excitation.psa", "excitation.file", "several rows"),
    ],
)
def test_refused(measure, demand, records, said):
    with pytest.raises(InputError, match=said):
        fragility_table(ROWS, measure, demand, [0.1], records)


CASE = """
body = [{ name = "deck", mass = 1000.0 }]
spring = [{ between = ["ground", "deck"], name = "piers", law = "linear", period = "0.5 s" }]
dashpot = [{ between = ["ground", "deck"], ratio = "5 %" }]
[excitation]
kind = "record"
units = "m/s2"
time_step = 0.02
psa_period = "0.5 s"
[run]
duration = "5 s"
[study]
quantities = ["peaks.deck.abs_max"]
[[study.axis]]
key = "excitation.file"
files = "records/*.txt"
[[study.axis]]
key = "excitation.psa"
values = ["0.1 g", "0.2 g", "0.4 g"]
"""


def test_command_on_a_study_by_psa(tmp_path, capsys):
    rng = np.random.default_rng(7)
    (tmp_path / "records").mkdir()
    for i in range(6):
        text = "\n".join(f"{v:.6f}" for v in rng.normal(0.0, 1.0 + i, 200))
        (tmp_path / "records" / f"{i}.txt").write_text(text)
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["study", str(tmp_path), "--no-figures"]) == 0
    table = pd.read_csv(tmp_path / "results" / "study.csv")
    # An elastic structure of this very period: its peak is the PSA over w^2, of every record.
    expected = table["excitation.psa"] / (2.0 * np.pi / 0.5) ** 2
    assert table["peaks.deck.abs_max"].to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-7)
    words = ["study", "fragility", str(tmp_path), "--measure", "excitation.psa"]
    words += ["--demand", "peaks.deck.abs_max", "--limit", "1 cm"]
    capsys.readouterr()
    # All capacities are one but for rounding: there is no dispersion to find.
    assert main(words) == 0
    said = capsys.readouterr().out
    assert said.startswith("limit 0.01 m: 6 of 6 exceed; every demand above an intensity")
    table["peaks.deck.abs_max"] *= np.repeat([0.7, 0.9, 1.0, 1.1, 1.2, 1.5], 3)
    table.to_csv(tmp_path / "results" / "study.csv", index=False)
    assert main([*words, "--limit", "2 cm", "--format", "svg", "--where", "success=True"]) == 0
    assert re.search(r"limit 0\.02 m: .*; theta [0-9.]+ m/s\^2 \(", capsys.readouterr().out)
    found = pd.read_csv(tmp_path / "results" / "fragility.csv")
    assert found["limit"].tolist() == [0.01, 0.02]
    assert (found["theta"].iloc[1], found["beta"].iloc[1]) > (found["theta"].iloc[0], 0.0)
    assert (tmp_path / "results" / "fragility.svg").stat().st_size > 5000
    assert main([*words[:-1], "1 s"]) == 2
    assert main([*words, "--where", "x=1"]) == 2
    assert "COLUMN=VALUE" in capsys.readouterr().err
    # What differs is kept, with what it is of; the same again is written over.
    first = pd.read_csv(tmp_path / "results" / "fragility-1.csv")
    assert first["limit"].tolist() == [0.01]
    assert [*found["rows"], *found["demand"]] == ["success=True"] * 2 + ["peaks.deck.abs_max"] * 2
    for _ in range(2):
        assert main([*words, "--limit", "2 cm", "--where", "excitation.psa=0.2 g"]) == 2
        assert "the same in all rows" in capsys.readouterr().err
    where = ["--where", "excitation.psa=1.96133", "--where"]
    assert main([*words, *where, "excitation.file=records/9.txt"]) == 2
    said = capsys.readouterr().err
    assert "--where: no row has 'excitation.file=records/9.txt'; accepted: exc" in said
    assert main([*words, "--where", "excitation.psa=20 s"]) == 2
    assert "--where: excitation.psa: found '20 s': 's' is no unit" in capsys.readouterr().err
    assert main([*words, "--where", "excitation.psa=0.3 g"]) == 2
    assert "accepted: excitation.psa of 0.980665, 1.96133, 3.92266" in capsys.readouterr().err
    assert not (tmp_path / "results" / "fragility-2.csv").exists()


def test_an_intensity_that_is_the_same_for_all_is_none():
    """Of records scaled to one PGA only the rounding of it differs."""
    rounded = 2.94 * (1.0 + np.finfo(float).eps * np.arange(6))
    table = pd.DataFrame({"PGA": rounded, "u": [1.0, 3.0, 1.0, 2.0, 3.0, 1.0]})
    with pytest.raises(InputError, match="column 'PGA' is the same in all rows"):
        fragility_table(table, "PGA", "u", [1.5], None)
