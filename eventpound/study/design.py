"""Design numbers: separation, seat width, impulse, ductility, drift; over records with fractiles.

Of a run each demand is one number. Over many records it has fractiles, the values that so many per
cent of them do not exceed (linear between the demands in their order), and the largest with its
record. A record under which nothing touches counts with its zero impulse. Of a study all this
stands for each combination of its axes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from eventpound.basics.given import Count, checked
from eventpound.basics.told import Counted, Reached
from eventpound.case.case import Case, case_of
from eventpound.case.loading import CASE_FILE
from eventpound.case.run_options import DEFAULTS, Stated
from eventpound.errors import ComputationError, InputError
from eventpound.quantities.base import TakenFrom, least_governs, over_capacity
from eventpound.quantities.owners import owners_of
from eventpound.quantities.storeys import storeys_of_structure
from eventpound.response import Response
from eventpound.scene.scene import Scene
from eventpound.simulation import response_of
from eventpound.study.base import RECORD, suite_base
from eventpound.study.demands import STOREY_DRIFT, Demand, demands_of, words_of
from eventpound.study.engine import engine_of
from eventpound.study.forms import SUCCESS, SUITE_TABLE
from eventpound.study.large_scales import warn_of_scales
from eventpound.study.plan import Plan
from eventpound.study.records import FAILED
from eventpound.study.running import run_study
from eventpound.study.study import Study
from eventpound.study.suite import run_suite, suite_plan
from eventpound.study.table import read_table

if TYPE_CHECKING:
    import pandas as pd

DESIGN_TABLE = "report.csv"
"""What the table is called."""
FRACTILES = (50.0, DEFAULTS.fractile)
"""Per cent."""
MOST_CLOSE = 1000
"""Runs of a study beyond which demands are left out that take rows close together."""
_IMPACTS = "contacts.<contact>.impacts"


def asking(case: Case) -> Case:
    """The case with its design numbers among the quantities that ``[run]`` asks for."""
    stated = case.run.stated
    names = [demand.named.name for demand in demands_of(case.scene, stated)]
    stated = replace(stated, quantities=tuple(dict.fromkeys((*stated.quantities, *names))))
    return replace(case, run=replace(case.run, stated=stated))


def plan_asking(plan: Plan) -> Plan:
    """The plan of a study that tabulates design numbers, too; of one in Π-terms there are none."""
    return replace(plan, quantities=tuple(dict.fromkeys((*plan.quantities, *_told(plan)))))


def _told(plan: Plan) -> dict[str, tuple[Case, Demand]]:
    """Design numbers of the scenes of a study that are not in Π-terms, each with its case."""
    found: dict[str, tuple[Case, Demand]] = {}
    for case in (base.at_first().case for base in plan.bases if base.case.pi is None):
        for demand in demands_of(case.scene, case.run.stated):
            close = demand.named.quantity.source is TakenFrom.BETWEEN and plan.size > MOST_CLOSE
            if not close or demand.named.name in plan.quantities:
                found.setdefault(demand.named.name, (case, demand))
    return found


@checked
def design_numbers(
    case: Case | Scene | Study,
    *,
    folder: str | Path | None = None,
    workers: Count | None = None,
    progress: Counted | None = None,
) -> pd.DataFrame:
    """Give the design numbers of a run, a suite or a study, as ``eventpound report`` does.

    Parameters
    ----------
    case : Case, Scene or Study
        A case of a suite has a row a demand, with fractiles over its records.
    folder : path, optional
        Where the table of all runs of a suite or a study is kept, which goes on there where it was.
    workers : int, optional
        Threads of the fast solver; as many as there are cores.
    progress : callable, optional
        Called with the numbers of runs done and of all, of a suite or a study.

    Returns
    -------
    DataFrame
        Columns as in ``report.csv`` (page "design" of the docs), SI.

    Raises
    ------
    InputError
        Where the case cannot be run.
    ComputationError
        Where a single run fails, or every record of a suite; a record that fails among others
        is left out.
    """
    with TemporaryDirectory() as scratch:
        out = Path(scratch if folder is None else folder)
        if isinstance(case, Study):
            warn_of_scales(case.plan.bases)
            return made_of_study(case.plan, out, progress)[0]
        own = case_of(case)
        if not own.members:
            return made_of_run(own)[0]
        if not own.scene.bodies:
            file = own.directory / CASE_FILE
            raise InputError(f"{file}: [[body]]: missing; design numbers are of bodies that move")
        warn_of_scales([suite_base(own)])
        return made_of_suite(own, out, progress, workers)[1]


def made_of_run(
    case: Case, progress: Reached | None = None, again: Callable[[], None] | None = None
) -> tuple[pd.DataFrame, Response]:
    """Design numbers of a run, which is made, and the run; `again` is called in between."""
    response = response_of(asking(case), progress=progress)
    if again is not None:
        again()
    return design_of_run(response), response


def made_of_suite(
    case: Case, out: Path, progress: Counted | None = None, workers: int | None = None
) -> tuple[Case, pd.DataFrame, pd.DataFrame]:
    """The case of a suite as it is run, its design numbers, and the table of its runs."""
    own = asking(case)
    plan = suite_plan(own, intensities=True)
    run_suite(plan, own, out, progress, workers=workers)
    runs = read_table(out, SUITE_TABLE)
    return own, design_of_suite(runs, own), runs


def made_of_study(
    plan: Plan, out: Path, progress: Counted | None = None
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Design numbers of a study, which is made, and the table of its runs."""
    plan = plan_asking(plan)
    run_study(plan, out, engine_of(plan.solver, None), progress)
    runs = read_table(out)
    return design_of_study(runs, plan), runs


def design_of_run(response: Response) -> pd.DataFrame:
    """Design numbers of a run: a row a demand, with its ``value``."""
    import pandas as pd

    stated, rows = response.stated, []
    for demand in demands_of(response.scene, stated):
        value = response.quantity(demand.named.name)
        size = np.nan if value is None else abs(value)
        row = {**words_of(response.scene, demand, stated), "value": size}
        rows.append(row | _held(demand, stated, size))
    return _with_storeys(pd.DataFrame(rows), response.scene)


def design_of_suite(table: pd.DataFrame, case: Case) -> pd.DataFrame:
    """Design numbers of a suite, from its table: fractiles over the records that did not fail.

    Raises
    ------
    ComputationError
        Where all of them failed.
    """
    import pandas as pd

    done = table[table[FAILED] == ""]
    if done.empty:
        why = f"all {len(table)} records failed, the first because of: {table[FAILED].iloc[0]}"
        raise ComputationError(why, case.run.start_time)
    stated = case.run.stated
    rows = _rows(done, case.scene, stated, demands_of(case.scene, stated), len(table) - len(done))
    return _with_storeys(_tabled(pd.DataFrame(list(rows))), case.scene)


def design_of_study(table: pd.DataFrame, plan: Plan) -> pd.DataFrame:
    """Design numbers of a study, from its table, for each combination of its axes."""
    import pandas as pd

    axes = [name for name in plan.columns if name != RECORD]
    demands, done, parts = _told(plan), table[table[SUCCESS]], []
    groups = done.groupby(axes, sort=False, dropna=False) if axes else [((), done)]
    for values, group in groups:
        at, rows = dict(zip(axes, values, strict=True)), list[dict[str, object]]()
        failed = _failed(table, at)
        for case, demand in demands.values():
            own = _rows(group, case.scene, case.run.stated, [demand], failed)
            rows += [at | row for row in own]
        parts.append(pd.DataFrame(rows))
    return _tabled(pd.concat(parts, ignore_index=True)) if parts else pd.DataFrame()


def _failed(table: pd.DataFrame, at: Mapping[str, object]) -> int:
    """How many runs of a study failed at a combination of its axes."""
    there = ~table[SUCCESS]
    for name, value in at.items():
        there &= table[name] == value
    return int(there.sum())


def _tabled(table: pd.DataFrame) -> pd.DataFrame:
    """The table with whole numbers of records, where there are some."""
    return table.astype({"pounding": "Int64"}) if "pounding" in table else table


def _rows(
    done: pd.DataFrame, scene: Scene, stated: Stated, demands: Sequence[Demand], failed: int
) -> Iterator[dict[str, object]]:
    """A row a demand: over how many records, its fractiles, the largest and its record."""
    for demand in demands:
        named = demand.named
        if named.name not in done:
            continue
        sizes = done[named.name].abs().dropna()
        row = {**words_of(scene, demand, stated), "records": len(sizes)}
        if named.quantity.owner == "contact":
            struck = done[_IMPACTS.replace("<contact>", str(row["of"]))]
            row["pounding"] = int((struck > 0).sum())
        if len(sizes):
            least = least_governs(named.name)
            (*parts, held) = _fractiles(sizes, (*FRACTILES, stated.fractile), least)
            if named.quantity.kind is int:
                parts = np.ceil(parts).tolist()
            row |= {f"{p:g} %": value for p, value in zip(FRACTILES, parts, strict=True)}
            governs = sizes.idxmin() if least else sizes.idxmax()
            row |= {"largest": float(sizes[governs])}
            row |= {name: done[key][governs] for key, name in _GOVERNING.items() if key in done}
            row |= _held(demand, stated, held, failed)
        yield row


_GOVERNING = {RECORD: "under", "scale": "scale"}
"""Columns of the runs, and what they are called: the record that governs and its factor."""


def _fractiles(sizes: pd.Series[float], parts: Sequence[float], least: bool) -> list[float]:
    """Values that so many per cent do not exceed, or do not fall below of what is to be left."""
    return np.percentile(sizes, [100.0 - p if least else p for p in parts]).tolist()


def _held(demand: Demand, stated: Stated, size: float, failed: int = 0) -> dict[str, object]:
    """A demand over its capacity, and whether it passes; nothing of one without.

    Where runs failed, nobody knows whether it would.
    """
    capacity = dict(stated.capacities).get(demand.named.name)
    if capacity is None:
        return {}
    ratio = float(over_capacity(demand.named.name, np.array(size), capacity))
    passes = "not known" if failed or ratio != ratio else "yes"
    verdict = "no" if ratio > 1.0 else passes
    return {"capacity": capacity, "demand/capacity": ratio, "passes": verdict}


def _with_storeys(table: pd.DataFrame, scene: Scene) -> pd.DataFrame:
    """The table with the storey in which the largest drift of each structure is, in ``at``."""
    if table.empty or not table["quantity"].str.endswith(STOREY_DRIFT).any():
        return table
    rows, structures = table.set_index("quantity"), owners_of(scene, "structure")
    column = rows["largest" if "largest" in rows else "value"]
    found = []
    for name, of in zip(table["quantity"], table["of"], strict=True):
        storeys = storeys_of_structure(scene, structures.index(of)) if of in structures else []
        names = [scene.springs[k].name for k in storeys]
        at = max(names, key=lambda n: float(column[f"springs.{n}.drift_ratio"]), default="")
        found.append(at if name.endswith(STOREY_DRIFT) else "")
    return table.assign(at=found)
