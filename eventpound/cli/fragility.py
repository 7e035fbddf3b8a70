"""``eventpound fragility``: probability of exceeding a limit over an intensity."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_case, add_command, add_out
from eventpound.cli.paper_words import add_paper, paper_of
from eventpound.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

_ABOUT = """\
Fit lognormal curves of fragility to the finished table of a study or of a suite: the
probability that a demand exceeds a limit, over an intensity, by maximum likelihood.
"""
_EXAMPLES = """\
examples:
  eventpound fragility ida --measure excitation.psa --demand peaks.deck.abs_max --limit "5 cm"
  eventpound fragility suite --measure L_e --demand contacts.joint.max_impulse \\
      --limit "20 kN s" --limit "60 kN s"

Of a study that scales each record through intensities, the capacity of each record is found, and
a record that never exceeds the limit is censored at its largest intensity. Of a suite, or with
--counts, runs are counted. Files: fragility.csv and fragility.png. What is done: docs/spectra.md.
"""
_RECORDS = ("excitation.file", "record")
"""Columns that may name the record of a row."""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "fit fragility curves to a finished study or suite"
    fragility = add_command(commands, "fragility", _fragility, text, _ABOUT, _EXAMPLES)
    add_case(fragility)
    fragility.add_argument("--measure", required=True, metavar="COLUMN", help="the intensity")
    fragility.add_argument("--demand", required=True, metavar="COLUMN", help="what has a limit")
    fragility.add_argument(
        "--limit",
        required=True,
        action="append",
        metavar="VALUE",
        help='the limit, as "5 cm"; may be given several times',
    )
    fragility.add_argument(
        "--counts", action="store_true", help="count the runs, do not follow each record"
    )
    fragility.add_argument(
        "--where", metavar="COLUMN=VALUE", action="append", default=[], help="these rows only"
    )
    add_out(fragility, "where the results are and the curves go (CASE/results)")
    add_paper(fragility)


def _fragility(options: argparse.Namespace) -> int:
    from eventpound.report.fragility_figure import fragility_figure
    from eventpound.report.style import on_paper
    from eventpound.report.symbols import dimension_of
    from eventpound.results import write_together
    from eventpound.results.tables import table_csv
    from eventpound.study.fragility import fragility_table

    paper = paper_of(options)
    out = options.out or options.case / "results"
    table = _where(_read(out), options.where, out)
    limits = [_limit(options.demand, text) for text in options.limit]
    records = None if options.counts else _records(table, options.measure)
    try:
        curves = fragility_table(table, options.measure, options.demand, limits, records)
    except InputError as error:
        raise InputError(f"{out}: {error}") from None
    figure = fragility_figure(curves, table, options.measure, options.demand)
    of_measure, of_demand = (
        f" {dimension_of(key).unit}".rstrip() for key in (options.measure, options.demand)
    )
    for _, row in curves.iterrows():
        found = row["note"] or (
            f"theta {row['theta']:.5g}{of_measure} "
            f"(standard error of ln theta {row['error_ln_theta']:.2g}), "
            f"beta {row['beta']:.4g} ({row['error_beta']:.2g})"
        )
        counts = f"{row['exceeded']} of {row['count']} exceed"
        print(f"limit {row['limit']:.5g}{of_demand}: {counts}; {found}")
    if left := int(curves["left_out"].max()):
        print(f"{left} rows without a demand, as of runs that failed, are left out")
    files = {"fragility.csv": table_csv(curves)} | on_paper({"fragility.png": figure}, paper)
    for path in write_together(out, files):
        print(path)
    return 0


def _read(out: Path) -> pd.DataFrame:
    """The table of a study, else of a suite."""
    from eventpound.results.suite import SUITE_TABLE, read_suite
    from eventpound.study.table import TABLE, read_table

    if (out / TABLE).is_file():
        return read_table(out)
    if (out / SUITE_TABLE).is_file():
        return read_suite(out)[0]
    raise InputError(
        f"{out}: neither {TABLE} nor {SUITE_TABLE}; `eventpound study` or `eventpound run` of a "
        "suite writes it"
    )


def _records(table: pd.DataFrame, measure: str) -> str | None:
    """Column of the records that have several intensities each; None where there is none."""
    there = [name for name in _RECORDS if name in table.columns and measure in table.columns]
    return next((n for n in there if table.groupby(n)[measure].nunique().max() > 1), None)


def _where(table: pd.DataFrame, wanted: list[str], out: Path) -> pd.DataFrame:
    """Rows with these values, numbers or words."""
    for text in wanted:
        name, equals, value = text.partition("=")
        if not equals or name not in table.columns:
            raise InputError(f"--where: found {text!r}; accepted: COLUMN=VALUE, of {out}")
        try:
            table = table[abs(table[name] - float(value)) <= 1e-9 * abs(float(value))]
        except (TypeError, ValueError):
            table = table[table[name].astype(str) == value]
    return table


def _limit(demand: str, text: str) -> float:
    """A limit in SI."""
    from eventpound.report.symbols import dimension_of
    from eventpound.units import quantity

    try:
        return quantity(text, dimension_of(demand))
    except InputError as error:
        raise InputError(f"--limit: {error}") from None
