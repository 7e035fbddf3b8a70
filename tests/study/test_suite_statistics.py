"""Rank correlation, groups and scatter, against SciPy and data made to measure."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import spearmanr

from eventpound.study.suite_statistics import groups_of, intensity_table, order_of, rank_correlation


def test_rank_correlation_is_spearmans():
    random = np.random.default_rng(1)
    x, y = random.normal(size=40), random.normal(size=40)
    y[:5] = y[0]
    assert rank_correlation(x, y) == pytest.approx(spearmanr(x, y).statistic, rel=1e-12)
    assert rank_correlation(x, x**3) == pytest.approx(1.0, rel=1e-15)
    assert math.isnan(rank_correlation(x[:2], y[:2]))
    assert math.isnan(rank_correlation(np.ones(9), y[:9]))


def test_groups_have_equal_numbers_in_order_of_period():
    periods = np.array([0.9, 0.1, 0.5, 0.3, 0.7, 0.2, 0.4])
    groups = groups_of(periods, 4)
    assert sorted(np.bincount(groups)) == [1, 2, 2, 2]
    order = np.argsort(periods)
    assert np.all(np.diff(groups[order]) >= 0)


def test_line_and_scatter():
    """Residuals orthogonal to the line's two columns leave it where it is."""
    x = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    rest = 0.1 * np.array([1.0, -2.0, 2.0, -2.0, 1.0])
    rest -= np.polyval(np.polyfit(x, rest, 1), x)
    table = pd.DataFrame(
        {
            "failed": ["", "", "", "", "", "no such file"],
            "L_e": [*np.exp(x), 1.0],
            "PGA": [1.0, 2.0, 3.0, 4.0, 5.0, 1.0],
            "T_m": [1.0, 2.0, 3.0, 4.0, 5.0, 1.0],
            "peaks.deck.abs_max": [*(3.0 * np.exp(0.8 * x + rest)), np.nan],
        }
    )
    order = order_of(table, "deck")
    assert order.records == 5
    assert order.factor == pytest.approx(3.0, rel=1e-12)
    assert order.exponent == pytest.approx(0.8, rel=1e-12)
    assert order.scatter == pytest.approx(math.sqrt(float(rest @ rest) / 3.0), rel=1e-10)


def test_table_of_measures():
    """Rank correlations of SciPy, dispersions of data made to measure, intervals by simulation."""
    random = np.random.default_rng(3)
    length = np.exp(random.normal(size=4000))
    u = 0.02 * length**0.7 * np.exp(0.4 * random.normal(size=4000))
    table = pd.DataFrame(
        {
            "failed": [*[""] * 4000, "no such file"],
            "L_e": [*length, 1.0],
            "PGA": [*(1.0 / length), 1.0],
            "PGV": [*np.exp(random.normal(size=4000)), 1.0],
            "peaks.deck.abs_max": [*u, np.nan],
        }
    )
    found = intensity_table(table, ["deck"]).set_index("measure")
    assert list(found.index) == ["L_e", "PGA", "PGV"]
    assert (found["records"] == 4000).all()
    for measure in found.index:
        expected = spearmanr(table[measure][:-1], u).statistic
        assert found.loc[measure, "rank_correlation"] == pytest.approx(expected, rel=1e-12)
    # Standard errors: 0.4/sqrt(2n) of the dispersion, 0.4/sqrt(n) of the exponent; five of them.
    assert found.loc["L_e", "dispersion"] == pytest.approx(0.4, abs=5 * 0.4 / math.sqrt(8000))
    assert found.loc["L_e", "exponent"] == pytest.approx(0.7, abs=5 * 0.4 / math.sqrt(4000))
    assert found.loc["PGA", "exponent"] == pytest.approx(-found.loc["L_e", "exponent"], rel=1e-9)
    low, high = found.loc["L_e", ["rank_low", "rank_high"]]
    assert low < found.loc["L_e", "rank_correlation"] < high


def test_intervals_hold_what_they_say():
    """Of 95 % intervals of samples of 30, about 95 in 100 hold the correlation of all."""
    random = np.random.default_rng(4)
    # Of two normal numbers of correlation r, Spearman's is 6/pi arcsin(r/2).
    r, inside, count = 0.7, 0, 600
    true = 6.0 / math.pi * math.asin(r / 2.0)
    for _ in range(count):
        x, e = random.normal(size=(2, 30))
        u = np.exp(r * x + math.sqrt(1.0 - r * r) * e)
        table = pd.DataFrame({"failed": "", "L_e": np.exp(x), "peaks.deck.abs_max": u})
        row = intensity_table(table, ["deck"]).iloc[0]
        inside += row["rank_low"] <= true <= row["rank_high"]
    # Four standard errors of a share of 95 %, sqrt(0.95 0.05/600) = 0.9 %, about 94 % (Fieller).
    assert 0.90 < inside / count < 0.985


def test_five_records_in_one_order_are_not_certain():
    """By chance 5 of 5 are in order once in 60: the interval begins near the rank that is then."""
    table = pd.DataFrame({"failed": "", "L_e": [1.0, 2.0, 3.0, 4.0, 5.0]})
    table["peaks.deck.abs_max"] = table["L_e"] ** 2
    row = intensity_table(table, ["deck"]).iloc[0]
    assert row["rank_correlation"] == pytest.approx(1.0, abs=1e-12)
    # tanh(artanh(0.95) - 1.96 sqrt(1.06/2)), 0.95 half-way from 1 to 0.9, the next of five.
    assert row["rank_low"] == pytest.approx(math.tanh(math.atanh(0.95) - 1.4269), abs=1e-4)
    assert row["rank_high"] == pytest.approx(1.0, abs=1e-12)


def test_records_without_a_mean_period_are_left_out_of_what_needs_it():
    table = pd.DataFrame(
        {
            "failed": [""] * 5,
            "PGA": [1.0, 2.0, 3.0, 4.0, 5.0],
            "T_m": [0.5, np.nan, 0.6, 0.8, 0.7],
            "L_e": [0.1, np.nan, 0.2, 0.4, 0.3],
            "peaks.a.abs_max": [0.1, 9.0, 0.2, 0.4, 0.3],
        }
    )
    order = order_of(table, "a")
    assert (order.records, order.rank_length) == (4, 1.0)
    measures = intensity_table(table, ["a"]).set_index("measure")
    assert measures["records"].to_dict() == {"L_e": 4, "PGA": 5}


def test_what_is_the_same_for_all_records_orders_nothing(recwarn):
    """Records scaled to one PGA have it but for rounding, which is no intensity."""
    u = np.array([0.01, 0.02, 0.04, 0.03, 0.05])
    rounded = 2.94 * (1.0 + np.finfo(float).eps * np.array([0.0, 1.0, -1.0, 2.0, 0.0]))
    columns = {"L_e": u**1.2, "PGA": rounded, "T_m": u, "peaks.deck.abs_max": u}
    table = pd.DataFrame(columns | {"failed": "", "peaks.pier.abs_max": rounded})
    found = intensity_table(table, ["deck", "pier"])
    assert found[["demand", "measure"]].values.tolist() == [["peaks.deck.abs_max", "L_e"]]
    order = order_of(table, "deck")
    assert math.isnan(order.rank_acceleration)
    assert order.rank_length == pytest.approx(1.0, rel=1e-15)
    one_length = order_of(table.assign(L_e=rounded), "deck")
    assert math.isnan(one_length.rank_length)
    assert math.isnan(one_length.scatter)
    assert not recwarn.list
