"""Fragility: the probability that a demand exceeds a limit, over an intensity, as a lognormal.

    P(D > limit | x) = Phi(ln(x/theta)/beta)

theta (median) and beta (dispersion) maximise the likelihood of what was computed. There are two
kinds of data.

Counts. Of n_j records at the intensity x_j the demand of z_j exceeds the limit, each record by
itself (n_j = 1 for a suite of records as they are):

    prod_j binomial(n_j, z_j) p_j^z_j (1 - p_j)^(n_j - z_j)

Capacities. Each record is scaled up until its demand exceeds the limit, at x_i. A record that
never did is censored: its capacity is beyond the largest intensity c_k that it was scaled to;
that of one which did at once is below the smallest, b_l.

    prod_i phi(ln(x_i/theta)/beta)/beta  prod_k (1 - Phi(ln(c_k/theta)/beta))
    prod_l Phi(ln(b_l/theta)/beta)

With z = a + b ln x, a = -ln theta/beta, b = 1/beta, both are concave in (a, b), so Newton's
method finds the one maximum. Standard errors are those of the inverse information.

Source: J. W. Baker, Efficient analytical fragility function fitting using dynamic structural
analysis, Earthquake Spectra 31(1) (2015), 579-599.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.study.suite_statistics import varies

if TYPE_CHECKING:
    import pandas as pd

_STEPS, _HALVINGS = 200, 60
_SINGULAR = 1e14
_STEEPEST = 1e4
"""1/beta beyond which the outcomes are separated: no beta is too small for them."""

_NO_SPREAD = "every demand above an intensity exceeds the limit, and none below: beta is 0"


@dataclass(frozen=True, slots=True)
class Fragility:
    """A lognormal curve.

    Parameters
    ----------
    theta : float
        Median, in the unit of the intensity; NaN where there is none.
    beta : float
        Standard deviation of ln x.
    error_ln_theta, error_beta : float
        Standard errors of ln theta and beta.
    note : str
        Why there is none; empty where there is.
    """

    theta: float
    beta: float
    error_ln_theta: float
    error_beta: float
    note: str = ""

    def probability(self, x: Floats) -> Floats:
        """P(D > limit) at intensities, shape of `x`."""
        from scipy.special import ndtr

        return np.asarray(ndtr(np.log(np.asarray(x) / self.theta) / self.beta))


def fit_counts(x: Floats, total: Floats, exceeded: Floats) -> Fragility:
    """Fit a curve to counts.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Intensities, positive.
    total, exceeded : ndarray, shape (m,)
        Records at each, and those of them whose demand exceeds the limit.
    """
    if not exceeded.sum():
        return _none("no demand exceeds the limit")
    if (exceeded == total).all():
        return _none("every demand exceeds the limit")
    held = total - exceeded
    if x[exceeded > 0].min() >= x[held > 0].max():
        return _none(_NO_SPREAD)
    return _fit(np.log(x), {"by": exceeded, "beyond": held, "at": np.zeros_like(x)})


def fit_capacities(capacity: Floats, beyond: Floats, below: Floats | None = None) -> Fragility:
    """Fit a curve to capacities.

    Parameters
    ----------
    capacity : ndarray, shape (m,)
        Intensity at which the demand of a record exceeds the limit, positive.
    beyond : ndarray, shape (k,)
        Largest intensity of each record whose demand never does.
    below : ndarray, shape (l,), optional
        Smallest intensity of each record whose demand does at once.
    """
    below = np.empty(0) if below is None else below
    if np.unique(capacity).size < 2:
        return _none(f"{capacity.size} capacities are known; two are needed that differ")
    kinds = np.repeat([0, 1, 2], [capacity.size, beyond.size, below.size])
    counts = {word: 1.0 * (kinds == i) for i, word in enumerate(("at", "beyond", "by"))}
    return _fit(np.log(np.concatenate([capacity, beyond, below])), counts)


def _none(note: str) -> Fragility:
    return Fragility(math.nan, math.nan, math.nan, math.nan, note)


def _fit(x: Floats, counts: Mapping[str, Floats]) -> Fragility:
    """Newton's method, with a step halved until it is uphill; x is the logarithm of intensities."""
    middle = float(x.mean())
    design = np.stack([np.ones_like(x), x - middle])
    at = np.array([0.0, 1.0 / max(float(x.std()), 1e-3)])
    value, slope, bend = _likelihood(at, design, counts)
    for _ in range(_STEPS):
        if np.linalg.cond(bend) > _SINGULAR:
            return _none("the likelihood has no maximum")
        step = -np.linalg.solve(bend, slope)
        for _ in range(_HALVINGS):
            trial = _likelihood(at + step, design, counts)
            if trial[0] >= value:
                break
            step *= 0.5
        at, (value, slope, bend) = at + step, trial
        if abs(at[1]) > _STEEPEST or np.abs(step).max() <= 1e-12 * np.abs(at).max():
            break
    if not 0.0 < at[1] <= _STEEPEST:
        return _none("exceedance does not grow with the intensity" if at[1] <= 0.0 else _NO_SPREAD)
    a, b = float(at[0]), float(at[1])
    spread = np.linalg.inv(-bend)
    # ln theta = middle - a/b and beta = 1/b, by their derivatives to a and b.
    of_theta, of_beta = np.array([-1.0 / b, a / b**2]), np.array([0.0, -1.0 / b**2])
    errors = [math.sqrt(float(d @ spread @ d)) for d in (of_theta, of_beta)]
    return Fragility(math.exp(middle - a / b), 1.0 / b, errors[0], errors[1])


def _likelihood(
    at: Floats, design: Floats, counts: Mapping[str, Floats]
) -> tuple[float, Floats, Floats]:
    """Logarithm of the likelihood, with its first and second derivatives to (a, b)."""
    from scipy.special import log_ndtr

    z = at @ design
    value, first, second = 0.0, np.zeros_like(z), np.zeros_like(z)
    for sign, count in ((1.0, counts["by"]), (-1.0, counts["beyond"])):
        log_p = log_ndtr(sign * z)
        ratio = np.exp(-0.5 * z**2 - 0.5 * math.log(2.0 * math.pi) - log_p)
        value += float(count @ log_p)
        first += count * sign * ratio
        second -= count * ratio * (sign * z + ratio)
    exact = counts["at"]
    first, second = first - exact * z, second - exact
    value -= float(exact @ (0.5 * z**2))
    slope, bend = design @ first, (design * second) @ design.T
    if exact.any():
        # The density of ln x has the factor b.
        if at[1] <= 0.0:
            return -math.inf, slope, bend
        value += float(exact.sum()) * math.log(at[1])
        slope[1] += exact.sum() / at[1]
        bend[1, 1] -= exact.sum() / at[1] ** 2
    return value, slope, bend


def fragility_table(
    table: pd.DataFrame,
    measure: str,
    demand: str,
    limits: Sequence[float],
    records: str | None = None,
) -> pd.DataFrame:
    """Fragility of the runs of a study or a suite.

    Parameters
    ----------
    table : DataFrame
        A row a run; where it has no demand, as of a run that failed, it is left out.
    measure, demand : str
        Columns of the intensity and of what has a limit.
    limits : sequence of float
        In the unit of the demand.
    records : str, optional
        Column that names the record of a row. With it, capacities are found by following each
        record up its intensities, linearly between two of them; without it, outcomes are
        counted.

    Returns
    -------
    DataFrame
        A row a limit: limit, theta, beta, error_ln_theta, error_beta, the numbers of runs or
        records that count, exceed the limit, were left out, method and note.

    Raises
    ------
    InputError
        Where a column is missing, holds no numbers, or intensities that are not positive or all
        the same.
    """
    import pandas as pd

    columns = [measure, demand, *([records] if records else [])]
    if missing := [name for name in columns if name not in table.columns]:
        known = ", ".join(table.columns)
        raise InputError(f"no column {', '.join(missing)}; the table has {known}")
    for name in (measure, demand):
        if not pd.api.types.is_numeric_dtype(table[name]):
            raise InputError(f"column {name!r} holds no numbers")
    there = table[columns].dropna()
    if there.empty:
        raise InputError(f"no row has a {measure} and a {demand}")
    if not (there[measure] > 0.0).all():
        raise InputError(f"column {measure!r}: an intensity has to be positive")
    if not varies(there[measure].to_numpy(float)):
        raise InputError(f"column {measure!r} is the same in all rows: nothing grows with it")
    if records and there.duplicated([records, measure]).any():
        raise InputError(
            f"several rows have one {records} and one {measure}; choose some, as by --where"
        )
    rows = []
    for limit in limits:
        fit, count, exceeded = _of_limit(there, measure, demand, limit, records)
        counts = {"count": count, "exceeded": exceeded, "left_out": len(table) - len(there)}
        fitted = asdict(fit)
        last = {"method": "capacities" if records else "counts", "note": fitted.pop("note")}
        rows.append({"limit": limit, **fitted, **counts, **last})
    return pd.DataFrame(rows)


def _of_limit(
    table: pd.DataFrame, measure: str, demand: str, limit: float, records: str | None
) -> tuple[Fragility, int, int]:
    """A curve, how much it counts and how much of it exceeds the limit."""
    if records is None:
        x, exceeded = table[measure].to_numpy(float), table[demand].to_numpy(float) > limit
        return fit_counts(x, np.ones(x.size), 1.0 * exceeded), x.size, int(exceeded.sum())
    capacity, beyond, below = [], [], []
    for _, group in table.sort_values(measure).groupby(records, sort=False):
        x, d = group[measure].to_numpy(float), group[demand].to_numpy(float)
        over = np.flatnonzero(d > limit)
        if not over.size:
            beyond.append(x[-1])
        elif over[0] == 0:
            below.append(x[0])
        else:
            i = int(over[0])
            part = (limit - d[i - 1]) / (d[i] - d[i - 1])
            capacity.append(x[i - 1] + part * (x[i] - x[i - 1]))
    fit = fit_capacities(*(np.array(found) for found in (capacity, beyond, below)))
    reached = len(capacity) + len(below)
    return fit, reached + len(beyond), reached
