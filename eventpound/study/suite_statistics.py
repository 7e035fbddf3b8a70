"""How well the energetic length scale orders the peaks of a suite.

Rank correlation is Spearman's. The scatter is the standard deviation s of
ln u_max about the straight line

    ln u_max = ln c + b ln L_e

of least squares: two thirds of the records lie within a factor exp(s) of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.numerics.arrays import Floats, Ints

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class Order:
    """Peaks of one body against the length scale of the records.

    Parameters
    ----------
    records : int
        How many.
    rank_length, rank_acceleration, rank_period : float
        Rank correlation of u_max with L_e, PGA and T_m; NaN for fewer than three records.
    factor, exponent : float
        c (m^(1 - b)) and b of the line.
    scatter : float
        s; zero where two records fix the line.
    """

    records: int
    rank_length: float
    rank_acceleration: float
    rank_period: float
    factor: float
    exponent: float
    scatter: float


def order_of(table: pd.DataFrame, body: str) -> Order:
    """Order of one body's peaks.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; failed records are left out.
    body : str
        Its name.
    """
    peaks = peaks_of(table, body)
    u = np.asarray(peaks["u"], dtype=np.float64)
    scales = {key: np.asarray(peaks[key], dtype=np.float64) for key in ("L_e", "PGA", "T_m")}
    ranks = {key: rank_correlation(values, u) for key, values in scales.items()}
    factor, exponent, scatter = _line(scales["L_e"], u)
    return Order(u.size, ranks["L_e"], ranks["PGA"], ranks["T_m"], factor, exponent, scatter)


def peaks_of(table: pd.DataFrame, body: str) -> pd.DataFrame:
    """PGA (m/s^2), T_m (s), L_e (m) and u (m) of the records that did not fail."""
    chosen = table[table["failed"] == ""][["PGA", "T_m", "L_e", f"peaks.{body}.abs_max"]]
    return chosen.rename(columns={f"peaks.{body}.abs_max": "u"}).reset_index(drop=True)


def rank_correlation(x: Floats, y: Floats) -> float:
    """Spearman's rank correlation; NaN for fewer than three values or equal ones only."""
    from scipy.stats import rankdata

    if x.size < 3 or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return float("nan")
    return float(np.corrcoef(rankdata(x), rankdata(y))[0, 1])


def groups_of(periods: Floats, count: int) -> Ints:
    """Group of each record, 0 to count - 1: equal numbers in order of T_m.

    Parameters
    ----------
    periods : ndarray, shape (n,)
        T_m (s).
    count : int
        How many groups.
    """
    groups = np.empty(periods.size, dtype=np.int64)
    groups[np.argsort(periods, kind="stable")] = np.arange(periods.size) * count // periods.size
    return groups


def _line(length: Floats, u: Floats) -> tuple[float, float, float]:
    """Factor, exponent and scatter of the line through the logarithms."""
    moved = u > 0.0
    if np.count_nonzero(moved) < 2 or np.ptp(length[moved]) == 0.0:
        return float("nan"), float("nan"), float("nan")
    x, y = np.log(length[moved]), np.log(u[moved])
    exponent, intercept = np.polyfit(x, y, 1)
    rest = y - (intercept + exponent * x)
    freedom = max(x.size - 2, 1)
    return float(np.exp(intercept)), float(exponent), float(np.sqrt(rest @ rest / freedom))
