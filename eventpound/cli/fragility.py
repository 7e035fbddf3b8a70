r"""Fit and draw curves of fragility: the probability that a demand exceeds a limit.

Lognormal curves over an intensity are fitted to the finished table of a study or a suite, by
maximum likelihood. In a study that scales each record through intensities the capacity of each
record is found; a record that never exceeds the limit is censored at its largest intensity. In a
suite, or with --counts, runs are counted. More: the page "spectra" of the documentation.

Files: fragility.csv and fragility.png.

Examples
--------
  eventpound study fragility ida --measure excitation.psa --demand peaks.deck.abs_max --limit "5 cm"
  eventpound study fragility suite --measure L_e --demand contacts.joint.max_impulse \
      --limit "20 kN s" --limit "60 kN s"
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.basics.given import number
from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.errors import InputError, told_of

if TYPE_CHECKING:
    import pandas as pd

_RECORDS = ("excitation.file", "record")
"""Columns that may name the record of a row."""
_FRAGILITY = "fragility"
"""Of the files."""
_SHOWN, _MOST_CURVES = 8, 12
"""Values that a message lists; that have a curve each."""


def add_fragility(commands: Commands) -> None:
    """Add the command to the parser."""
    command = add_command(commands, "study fragility", _fragility, __doc__)
    command.case()
    command.option("--measure COLUMN", "the intensity", required=True)
    command.option("--demand COLUMN", "what has a limit", required=True)
    several: dict[str, Any] = {"action": "append"}
    command.option("--limit VALUE", 'as "5 cm"; may be repeated', required=True, **several)
    command.option("--counts", "count the runs, do not follow each record")
    rows = 'these rows only, as contact.joint.gap="5 cm"'
    command.option("--where COLUMN=VALUE", rows, default=[], **several)
    command.option("--by COLUMN", "a curve for each of its values, as of an axis")
    command.out("where the results are and the curves go (CASE/results)")
    command.paper()


def _fragility(options: Options) -> int:
    import pandas as pd

    from eventpound.report.study_curves import fragility_figure
    from eventpound.report.style import on_paper
    from eventpound.report.symbols import dimension_of
    from eventpound.results.tables import table_csv
    from eventpound.study.fragility import fragility_table
    from eventpound.study.stated import PSA, psa_at
    from eventpound.study.table import read_many

    out, paper = options.results, options.paper()
    table, excitations = read_many(out)
    table = _where(table, options.where, out)
    of_demand = dimension_of(options.demand)
    limits = [number("--limit", text, of_demand) for text in options.limit]
    by = options.by
    groups = {None: table} if by is None else dict(iter(_by(table, by, out)))
    parts = []
    for value, rows in groups.items():
        records = None if options.counts else _records(rows, options.measure)
        said = "" if by is None else f"{by} = {value}: "
        with told_of(f"{out}: {said}"):
            part = fragility_table(rows, options.measure, options.demand, limits, records)
        parts.append(part if by is None else part.assign(**{by: value}))
    curves = pd.concat(parts, ignore_index=True)
    at = {psa_at(excitation) for excitation in excitations} if options.measure == PSA else {""}
    at_one = at.pop() if len(at) == 1 else ""
    figure = fragility_figure(curves, table, (options.measure, options.demand), at_one, by or "")
    units = [f" {dimension_of(key).unit}".rstrip() for key in (options.measure, options.demand)]
    for _, row in curves.iterrows():
        found = row["note"] or (
            f"theta {row['theta']:.5g}{units[0]} "
            f"(standard error of ln theta {row['error_ln_theta']:.2g}), "
            f"beta {row['beta']:.4g} ({row['error_beta']:.2g})"
        )
        counts = f"{row['exceeded']} of {row['count']} exceed"
        where = "" if by is None else f"{by} = {_shown(row[by])}, "
        print(f"{where}limit {row['limit']:.5g}{units[1]}: {counts}; {found}")
    if left := int(curves["left_out"].max()):
        print(f"{left} rows without a demand, as of runs that failed, are left out")
    of = {"measure": options.measure, "demand": options.demand, "rows": "; ".join(options.where)}
    made = table_csv(curves.assign(**of))
    _set_aside(out, made)
    figures = on_paper({f"{_FRAGILITY}.png": figure}, paper)
    arguments.write_and_print(out, {f"{_FRAGILITY}.csv": made} | figures)
    return 0


def _by(table: pd.DataFrame, name: str, out: Path) -> Iterable[tuple[Any, pd.DataFrame]]:
    """Rows of each value of a column."""
    if name not in table.columns:
        raise InputError(f"--by: found {name!r}; accepted: of {out}: {', '.join(table.columns)}")
    groups = table.groupby(name, sort=False)
    if groups.ngroups > _MOST_CURVES:
        found = f"--by: found {name!r}, which has {groups.ngroups} values"
        raise InputError(f"{found}; accepted: a column of at most {_MOST_CURVES}")
    return groups


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _set_aside(out: Path, made: bytes) -> None:
    """Keep curves that are there and differ, under a name with a number."""
    there = out / f"{_FRAGILITY}.csv"
    if not there.is_file() or there.read_bytes() == made:
        return
    name = next(n for i in count(1) if not (out / f"{(n := f'{_FRAGILITY}-{i}')}.csv").exists())
    for path in sorted(out.glob(f"{_FRAGILITY}.*")):
        path.rename(out / f"{name}{path.suffix}")
    print(f"moved     the curves that were in {there} are in {name}.csv")


def _records(table: pd.DataFrame, measure: str) -> str | None:
    """Column of the records that have several intensities each; None where there is none."""
    there = [name for name in _RECORDS if name in table.columns and measure in table.columns]
    return next((n for n in there if table.groupby(n)[measure].nunique().max() > 1), None)


def _where(table: pd.DataFrame, wanted: list[str], out: Path) -> pd.DataFrame:
    """Rows with these values, numbers or words."""
    from pandas.api.types import is_bool_dtype, is_numeric_dtype

    from eventpound.report.symbols import dimension_of

    for text in wanted:
        name, equals, value = text.partition("=")
        if not equals or name not in table.columns:
            known = ", ".join(table.columns)
            raise InputError(f"--where: found {text!r}; accepted: COLUMN=VALUE, of {out}: {known}")
        column = table[name]
        if is_numeric_dtype(column) and not is_bool_dtype(column):
            size = number(f"--where: {name}", value, dimension_of(name))
            there = abs(column - size) <= 1e-9 * abs(size)
        else:
            there = column.astype(str) == value
        if not there.any():
            values = [_shown(v) for v in column.unique()]
            some = ", ".join(values[:_SHOWN] + ["..."] * (len(values) > _SHOWN))
            raise InputError(f"--where: no row has {text!r}; accepted: {name} of {some}")
        table = table[there]
    return table
