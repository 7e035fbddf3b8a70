"""How well measures of intensity order the peaks of a suite: L_e, PGA, PGV and Sa(T1).

Rank correlation is Spearman's. The dispersion is the standard deviation s of ln u_max about the
straight line

    ln u_max = ln c + b ln x

of least squares over a measure x: two thirds of the records lie within a factor exp(s) of it. Of a
rank correlation r of n records, artanh r errs by sqrt(1.06/(n - 3)), nearly normally: E. C.
Fieller, H. O. Hartley and E. S. Pearson, Tests for rank correlation coefficients. I,
Biometrika 44 (1957), 470-481.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.numerics.arrays import Floats, Ints

if TYPE_CHECKING:
    import pandas as pd

INTENSITY_TABLE = "intensity.csv"
"""What the table of all measures is called."""
MEASURES = {"L_e": "m", "PGA": "m/s^2", "PGV": "m/s", "Sa_T1": "m/s^2"}
"""Columns of the table of a suite that measure the intensity of its records, and their units."""
_COLUMNS = ("demand", "measure", "unit", "records", "rank_correlation", "rank_low", "rank_high",
            "exponent", "dispersion")  # fmt: skip
_NORMAL_95, _FIELLER = 1.959964, 1.06
_ROUNDING = 1e-9
"""Part of its size within which a number is the same for all: scaling records to one rounds."""


@dataclass(frozen=True, slots=True)
class Order:
    """Peaks of one body against the length scale of the records.

    Parameters
    ----------
    records : int
        How many.
    rank_length, rank_acceleration, rank_period : float
        Rank correlation of u_max with L_e, PGA and T_m; NaN for fewer than three records, or
        where all have the same.
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


def intensity_table(table: pd.DataFrame, bodies: Sequence[str]) -> pd.DataFrame:
    """How well each measure of intensity that the table has orders the peaks of each body.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; failed records are left out.
    bodies : sequence of str
        Their names.

    Returns
    -------
    DataFrame
        A row a demand and measure, but for a measure that is the same for all records, or a
        demand: ``demand``, ``measure``, its ``unit``, ``records``, the rank
        correlation and its 95 % interval, exponent b and dispersion s.
    """
    import pandas as pd

    done, rows = table[table["failed"] == ""], []
    for name in (f"peaks.{body}.abs_max" for body in bodies):
        for measure, unit in MEASURES.items():
            if measure in done and name in done:
                known = done[done[measure].notna()]
                x, u = (known[key].to_numpy(float) for key in (measure, name))
                if not (varies(x) and varies(u)):
                    continue
                rank, (_, exponent, scatter) = rank_correlation(x, u), _line(x, u)
                rows.append((name, measure, unit, x.size, rank, *_interval(rank, x.size), exponent,
                             scatter))  # fmt: skip
    return pd.DataFrame(rows, columns=list(_COLUMNS))


def varies(x: Floats) -> bool:
    """Whether values differ by more than rounding."""
    return bool(x.size and np.ptp(x) > _ROUNDING * np.abs(x).max())


def _interval(rank: float, records: int) -> tuple[float, float]:
    """95 % interval of a rank correlation; NaN for fewer than four records.

    One of 1 is certain of no more than the next that so many records can have: half-way to it.
    """
    if records < 4:
        return float("nan"), float("nan")
    half = _NORMAL_95 * math.sqrt(_FIELLER / (records - 3))
    most = 1.0 - 6.0 / (records**3 - records)
    middle = math.atanh(max(-most, min(rank, most)))
    return min(math.tanh(middle - half), rank), max(math.tanh(middle + half), rank)


def peaks_of(table: pd.DataFrame, body: str) -> pd.DataFrame:
    """PGA (m/s^2), T_m (s), L_e (m) and u (m) of the records that did not fail and have a T_m."""
    known = (table["failed"] == "") & table["T_m"].notna()
    chosen = table[known][["PGA", "T_m", "L_e", f"peaks.{body}.abs_max"]]
    return chosen.rename(columns={f"peaks.{body}.abs_max": "u"}).reset_index(drop=True)


def rank_correlation(x: Floats, y: Floats) -> float:
    """Spearman's rank correlation; NaN for fewer than three values, or the same to rounding."""
    from scipy.stats import rankdata

    if x.size < 3 or not (varies(x) and varies(y)):
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
    if np.count_nonzero(moved) < 2 or not varies(length[moved]):
        return float("nan"), float("nan"), float("nan")
    x, y = np.log(length[moved]), np.log(u[moved])
    exponent, intercept = np.polyfit(x, y, 1)
    rest = y - (intercept + exponent * x)
    freedom = max(x.size - 2, 1)
    return float(np.exp(intercept)), float(exponent), float(np.sqrt(rest @ rest / freedom))
