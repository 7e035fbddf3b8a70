"""Design numbers: separation, seat width, impulse, ductility, drift; over records with fractiles.

Of a run each demand is one number. Over many records it has fractiles, the values that so many per
cent of them do not exceed (linear between the demands in their order), and the largest with its
record. A record under which nothing touches counts with its zero impulse. Of a study all this
stands for each combination of its axes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from eventpound.basics.given import Count, checked
from eventpound.basics.progress import Counted, Reached
from eventpound.case.case import Case
from eventpound.case.loading import CASE_FILE
from eventpound.case.run_options import Stated
from eventpound.errors import ComputationError, InputError
from eventpound.quantities.base import TakenFrom
from eventpound.quantities.lookup import Named, all_of, unstated
from eventpound.quantities.owners import owners
from eventpound.response import Response
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Backfill, Hysteretic
from eventpound.simulation import simulate
from eventpound.study.engines.local import engine_of
from eventpound.study.large_scales import warn_of_scales
from eventpound.study.plan import RECORD, Plan
from eventpound.study.records import FAILED
from eventpound.study.running import run_study
from eventpound.study.study import Study
from eventpound.study.suite import plan_of, run_suite
from eventpound.study.table import SUCCESS, SUITE_TABLE, read_table

if TYPE_CHECKING:
    import pandas as pd

DESIGN_TABLE = "report.csv"
"""What the table is called."""
FRACTILES = (50.0, 84.0)
"""Per cent."""
_CONTACT, _SPRING = "contacts.<contact>.", "springs.<spring>."
_IMPACTS, _FORCE = _CONTACT + "impacts", _CONTACT + "max_force"
_FASTER = _CONTACT + "impacts_faster"
_ELONGATIONS = _SPRING + "abs_max_elongation", _SPRING + "residual_elongation"
_ENERGY = _SPRING + "dissipated_energy"
DEMANDS = (
    *(_CONTACT + word for word in ("separation_needed", "avoiding_gap", "avoiding_gap_alone")),
    *(_CONTACT + word for word in ("absolute_sum", "srss", "cqc")),
    *(_CONTACT + word for word in ("largest_gap", "seat_used", "impacts")),
    *(_FASTER, _CONTACT + "fastest_closing", _CONTACT + "max_impulse"),
    *(_CONTACT + "estimated_force", _FORCE, _CONTACT + "largest_overlap"),
    *(_SPRING + "ductility", *_ELONGATIONS, _SPRING + "slip_path"),
    *(_SPRING + word for word in ("passive_force", "passive_depth", "residual_gap")),
    *(_ENERGY, _SPRING + "strength_lost", _SPRING + "stiffness_lost"),
    *(_SPRING + word for word in ("drift_ratio", "stability_coefficient")),
    *("max_drift", "max_drift_ratio", "base_shear.abs_max"),
    *("peaks.<body>.abs_max", "residual.<body>", "acceleration.<body>.abs_max"),
)
"""Quantities that are design numbers, by paths, in their order: those of one owner together."""


def demands_of(scene: Scene, stated: Stated) -> list[Named]:
    """Design numbers that a scene has: of each contact, each spring, the whole and each body."""
    found = [
        named
        for named in all_of(scene)
        if named.quantity.path in DEMANDS and not unstated(named.name, stated)
        if _says_something(scene, named)
    ]
    kinds = list(dict.fromkeys(path.partition(".")[0] for path in DEMANDS))

    def place(named: Named) -> tuple[int, int, int]:
        path = named.quantity.path
        whole = not named.quantity.owner
        kind = len(kinds) if whole else kinds.index(path.partition(".")[0])
        return kind, named.i, DEMANDS.index(path)

    return sorted(found, key=place)


def _says_something(scene: Scene, named: Named) -> bool:
    """Whether a number is one of design, of its owner."""
    path = named.quantity.path
    if path == _FORCE:
        # Without a law of its own a contact has a force at rest only.
        return scene.contacts[named.i].law is not None
    if path == _ENERGY:
        # Of others it takes further runs.
        return named.quantity.source is TakenFrom.LAWS
    if path not in _ELONGATIONS:
        return True
    law = scene.springs[named.i].law
    # Soil is away from its wall at the end: of it depth and residual gap are told. What an elastic
    # spring has left is what still swings.
    left = path == _ELONGATIONS[1] and not isinstance(law, Hysteretic)
    return not left and not isinstance(law, Backfill)


def asking(case: Case) -> Case:
    """The case with its design numbers among the quantities that ``[run]`` asks for."""
    stated = case.run.stated
    names = [named.name for named in demands_of(case.scene, stated)]
    stated = replace(stated, quantities=tuple(dict.fromkeys((*stated.quantities, *names))))
    return replace(case, run=replace(case.run, stated=stated))


def plan_asking(plan: Plan) -> Plan:
    """The plan of a study that tabulates design numbers, too; of one in Π-terms there are none."""
    return replace(plan, quantities=tuple(dict.fromkeys((*plan.quantities, *_told(plan)))))


def _told(plan: Plan) -> dict[str, tuple[Case, Named]]:
    """Design numbers of the scenes of a study that are not in Π-terms, each with its case."""
    found: dict[str, tuple[Case, Named]] = {}
    for case in (base.at_first().case for base in plan.bases if base.case.pi is None):
        for named in demands_of(case.scene, case.run.stated):
            found.setdefault(named.name, (case, named))
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
        Where a single run fails, or all records of a suite; one that failed is left out.
    """
    if isinstance(case, Case) and not case.scene.bodies:
        file = case.directory / CASE_FILE
        raise InputError(f"{file}: [[body]]: missing; design numbers are of bodies that move")
    if isinstance(case, Scene) or (isinstance(case, Case) and case.suite is None):
        return made_of_run(case).table
    warn_of_scales(case if isinstance(case, Case) else case.plan.bases)
    with TemporaryDirectory() as scratch:
        out = Path(scratch if folder is None else folder)
        if isinstance(case, Case):
            return made_of_suite(case, out, progress, workers).table
        return made_of_study(case.plan, out, progress).table


@dataclass(frozen=True)
class DesignRuns:
    """Design numbers, with what they come from.

    Parameters
    ----------
    table : DataFrame
        A row a demand.
    case : Case or None
        As it was run; None of a scene and of a study.
    response : Response or None
        Of a run.
    runs : DataFrame or None
        The table of all runs, of a suite or a study.
    """

    table: pd.DataFrame
    case: Case | None = None
    response: Response | None = None
    runs: pd.DataFrame | None = None


def made_of_run(
    case: Case | Scene,
    progress: Reached | None = None,
    again: Callable[[], None] | None = None,
) -> DesignRuns:
    """Run a case once, then what its design numbers need; `again` is called in between."""
    asked = case if isinstance(case, Scene) else asking(case)
    response = simulate(asked, progress=progress)
    if again is not None:
        again()
    table = design_of_run(response)
    return DesignRuns(table, None if isinstance(case, Scene) else case, response)


def made_of_suite(
    case: Case,
    out: Path,
    progress: Counted | None = None,
    workers: int | None = None,
) -> DesignRuns:
    """Run a case under every record, with what its design numbers need."""
    plan, own = plan_of(asking(case), None, None, None, intensities=True)
    run_suite(plan, own, out, progress, workers=workers)
    runs = read_table(out, SUITE_TABLE)
    return DesignRuns(design_of_suite(runs, own), own, runs=runs)


def made_of_study(plan: Plan, out: Path, progress: Counted | None = None) -> DesignRuns:
    """Make the runs of a study, with what its design numbers need."""
    plan = plan_asking(plan)
    run_study(plan, out, engine_of(plan.solver, None), progress)
    runs = read_table(out)
    return DesignRuns(design_of_study(runs, plan), runs=runs)


def design_of_run(response: Response) -> pd.DataFrame:
    """Design numbers of a run: a row a demand, with its ``value``."""
    import pandas as pd

    demands = demands_of(response.scene, response.stated)
    values = [response.quantity(named.name) for named in demands]
    rows = [
        {
            **_words(response.scene, named, response.stated),
            "value": np.nan if value is None else abs(value),
        }
        for named, value in zip(demands, values, strict=True)
    ]
    return pd.DataFrame(rows)


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
    demands = demands_of(case.scene, case.run.stated)
    return _tabled(pd.DataFrame(list(_rows(done, case.scene, case.run.stated, demands))))


def design_of_study(table: pd.DataFrame, plan: Plan) -> pd.DataFrame:
    """Design numbers of a study, from its table, for each combination of its axes."""
    import pandas as pd

    axes = [name for name in plan.columns if name != RECORD]
    demands, done, rows = _told(plan), table[table[SUCCESS]], []
    groups = done.groupby(axes, sort=False, dropna=False) if axes else [((), done)]
    for values, group in groups:
        at = dict(zip(axes, values, strict=True))
        for case, named in demands.values():
            rows += [at | row for row in _rows(group, case.scene, case.run.stated, [named])]
    return _tabled(pd.DataFrame(rows))


def _tabled(table: pd.DataFrame) -> pd.DataFrame:
    """The table with whole numbers of records, where there are some."""
    return table.astype({"pounding": "Int64"}) if "pounding" in table else table


def _rows(
    done: pd.DataFrame, scene: Scene, stated: Stated, demands: Sequence[Named]
) -> Iterator[dict[str, object]]:
    """A row a demand: over how many records, its fractiles, the largest and its record."""
    for named in demands:
        if named.name not in done:
            continue
        sizes = done[named.name].abs().dropna()
        row = {**_words(scene, named, stated), "records": len(sizes)}
        if named.quantity.owner == "contact":
            struck = done[_IMPACTS.replace("<contact>", str(row["of"]))]
            row["pounding"] = int((struck > 0).sum())
        if len(sizes):
            parts = np.percentile(sizes, FRACTILES).tolist()
            row |= {f"{p:g} %": value for p, value in zip(FRACTILES, parts, strict=True)}
            row |= {"largest": float(sizes.max())}
            if RECORD in done:
                row["under"] = done[RECORD][sizes.idxmax()]
        yield row


def _words(scene: Scene, named: Named, stated: Stated) -> dict[str, object]:
    """What a demand is, of what, and its unit."""
    quantity = named.quantity
    called = quantity.called
    if quantity.path == _FASTER:
        called = f"impacts faster than {100.0 * stated.threshold_speed:.4g} cm/s"
    return {
        "quantity": named.name,
        "of": owners(scene, quantity.owner)[named.i],
        "demand": called,
        "unit": quantity.dimension.unit,
    }
