"""Rank correlation, groups and scatter, against SciPy and data made to measure."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import spearmanr

from eventpound.study.suite_statistics import groups_of, order_of, rank_correlation


def test_rank_correlation_is_spearmans() -> None:
    random = np.random.default_rng(1)
    x, y = random.normal(size=40), random.normal(size=40)
    y[:5] = y[0]
    assert rank_correlation(x, y) == pytest.approx(spearmanr(x, y).statistic, rel=1e-12)
    assert rank_correlation(x, x**3) == pytest.approx(1.0, rel=1e-15)
    assert math.isnan(rank_correlation(x[:2], y[:2]))
    assert math.isnan(rank_correlation(np.ones(9), y[:9]))


def test_groups_have_equal_numbers_in_order_of_period() -> None:
    periods = np.array([0.9, 0.1, 0.5, 0.3, 0.7, 0.2, 0.4])
    groups = groups_of(periods, 4)
    assert sorted(np.bincount(groups)) == [1, 2, 2, 2]
    order = np.argsort(periods)
    assert np.all(np.diff(groups[order]) >= 0)


def test_line_and_scatter() -> None:
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
