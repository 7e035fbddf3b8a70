"""Incremental dynamic analysis: fractile curves of a demand over an intensity.

One scene, many records, each scaled through a list of intensities. At every
intensity the demands of all records have fractiles; the curves through those
of 16, 50 and 84 per cent are the summary (D. Vamvatsikos and C. A. Cornell,
Incremental dynamic analysis, Earthquake Engineering and Structural Dynamics
31 (2002), 491-514). Between two demands a fractile is interpolated linearly;
a run that failed has none, and `runs` says how many had.

    [intensity]
    measure = "excitation.pga"        # an axis
    demand = "peaks.deck.abs_max"     # a quantity
    records = "excitation.file"       # the axis over which the fractiles are taken
    fractiles = [16, 50, 84]          # per cent, the default
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.case.figure import one_or_several
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.study.plan import Plan
from eventpound.study.variants import axis_cells

if TYPE_CHECKING:
    import pandas as pd

_FRACTILES: tuple[float, ...] = (16.0, 50.0, 84.0)


@dataclass(frozen=True)
class IntensityPlan:
    """What fractile curves are made of.

    Parameters
    ----------
    name : str
        Of the files, without the ending.
    measure, demand, records : str
        Columns of the table of the study.
    fractiles : tuple of float
        Per cent.
    """

    name: str
    measure: str
    demand: str
    records: str
    fractiles: tuple[float, ...]

    def problems(self, study: Plan) -> Iterator[str]:
        """Columns that the table does not have, and axes that leave no one fractile."""
        accepted = {"measure": study.columns, "records": study.columns, "demand": study.quantities}
        found = [key for key, known in accepted.items() if getattr(self, key) not in known]
        for key in found:
            known = ", ".join(accepted[key])
            yield f"[intensity]: {key}: found {getattr(self, key)!r}; accepted: {known}"
        if not found:
            import pandas as pd

            cells = [pd.DataFrame(axis_cells(base, range(base.size))) for base in study.bases]
            yield from self.ambiguities(pd.concat(cells))

    def ambiguities(self, table: pd.DataFrame) -> Iterator[str]:
        """Why some rows of a table have no one fractile: a record has several at one intensity."""
        if table[[self.measure, self.records]].dropna().duplicated().any():
            yield (
                f"[intensity]: several rows have one {self.records} and one {self.measure}, of "
                "which there is no one fractile; accepted: a study in which no other axis varies"
            )

    def doubts(self) -> Iterator[str]:
        """Fractiles that are hardly meant."""
        for value in self.fractiles:
            if 0.0 < value < 1.0:
                meant = f"{100.0 * value:g} for {100.0 * value:g} %"
                yield f"[intensity]: fractiles: {value:g} is {value:g} %; write {meant}"


def read_intensities(top: Table) -> tuple[IntensityPlan, ...]:
    """Read ``[intensity]`` or several ``[[intensity]]``; problems are noted."""
    return tuple(_read(table) for table in one_or_several(top, "intensity"))


def _read(table: Table) -> IntensityPlan:
    measure, demand, records = (
        table.text(key, "a column of the table") for key in ("measure", "demand", "records")
    )
    name = table.file_name("name", "intensity")
    fractiles = _FRACTILES
    if table.has("fractiles"):
        accepted = "a list of per cents, 0 to 100"
        fractiles = table.numbers("fractiles", accepted)
        within = bool(fractiles) and all(0.0 <= v <= 100.0 for v in fractiles)
        table.require("fractiles", within, accepted)
    table.close()
    return IntensityPlan(name, measure, demand, records, fractiles)


def fractile_curves(table: pd.DataFrame, plan: IntensityPlan) -> pd.DataFrame:
    """Fractiles of the demand at every intensity.

    Parameters
    ----------
    table : DataFrame
        Table of the study.
    plan : IntensityPlan
        Its columns.

    Returns
    -------
    DataFrame
        A row an intensity, in rising order: the measure, ``runs`` that have a
        demand, and a column a fractile, ``16 %``, NaN where there is none.

    Raises
    ------
    InputError
        Where a record has several rows at one intensity: another axis varies, too.
    """
    import pandas as pd

    if several := list(plan.ambiguities(table)):
        raise InputError(several)
    rows = []
    for intensity, group in table.groupby(plan.measure, sort=True):
        demands = group[plan.demand].dropna().to_numpy(float)
        found = (
            np.percentile(demands, plan.fractiles)
            if demands.size
            else np.full(len(plan.fractiles), np.nan)
        )
        rows.append([intensity, demands.size, *found])
    return pd.DataFrame(rows, columns=[plan.measure, "runs", *(f"{p:g} %" for p in plan.fractiles)])
