"""``eventpound study --spectrum`` and ``--fragility``: what is made of a finished table."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.basics.given import number
from eventpound.cli.arguments import PAPER, Command, Options
from eventpound.errors import InputError, told_of

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.units import Dimension

SPECTRUM = "--spectrum --out --amplitude --period"
FRAGILITY = "--fragility --out --measure --demand --limit --counts --where" + PAPER
"""Options that go together."""
_RECORDS = ("excitation.file", "record")
"""Columns that may name the record of a row."""


def add(study: Command) -> None:
    """Add the options to the parser."""
    study.group("the response spectrum of a pulse")
    study.option("--spectrum", "write and draw it")
    study.option("--amplitude A", 'a_g of the pulse, "0.4 g" or m/s²')
    study.option("--period T", 'T_p of the pulse, "0.8 s" or s')
    study.group("curves of fragility")
    study.option("--fragility", "fit and draw them")
    study.option("--measure COLUMN", "the intensity")
    study.option("--demand COLUMN", "what has a limit")
    study.option("--limit VALUE", 'as "5 cm"; may be repeated', action="append", default=[])
    study.option("--counts", "count the runs, do not follow each record")
    study.option("--where COLUMN=VALUE", "these rows only", action="append", default=[])
    study.paper()


def fit_fragility(options: Options, out: Path) -> dict[str, bytes]:
    """Fit, print and draw the curves; the files."""
    from eventpound.report.fragility_figure import fragility_figure
    from eventpound.report.style import on_paper
    from eventpound.report.symbols import dimension_of
    from eventpound.results.tables import table_csv
    from eventpound.study.fragility import fragility_table

    paper = options.paper()
    table = _where(_read(out), options.where, out)
    of_demand = dimension_of(options.demand)
    limits = [number("--limit", text, of_demand) for text in options.limit]
    records = None if options.counts else _records(table, options.measure)
    with told_of(f"{out}: "):
        curves = fragility_table(table, options.measure, options.demand, limits, records)
    figure = fragility_figure(curves, table, options.measure, options.demand)
    units = [f" {dimension_of(key).unit}".rstrip() for key in (options.measure, options.demand)]
    for _, row in curves.iterrows():
        found = row["note"] or (
            f"theta {row['theta']:.5g}{units[0]} "
            f"(standard error of ln theta {row['error_ln_theta']:.2g}), "
            f"beta {row['beta']:.4g} ({row['error_beta']:.2g})"
        )
        counts = f"{row['exceeded']} of {row['count']} exceed"
        print(f"limit {row['limit']:.5g}{units[1]}: {counts}; {found}")
    if left := int(curves["left_out"].max()):
        print(f"{left} rows without a demand, as of runs that failed, are left out")
    return {"fragility.csv": table_csv(curves)} | on_paper({"fragility.png": figure}, paper)


def _read(out: Path) -> pd.DataFrame:
    """The table of a study, else of a suite."""
    from eventpound.study.table import SUITE_TABLE, TABLE, read_suite, read_table

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


def draw_spectrum(options: Options, out: Path) -> list[Path]:
    """Write and draw the spectrum; the files."""
    from eventpound.motion.base import Scales
    from eventpound.report.study_files import draw_spectrum
    from eventpound.study.reading import load_finished
    from eventpound.units import Dimension

    a_g = _positive("--amplitude", options.amplitude, Dimension.ACCELERATION)
    period = _positive("--period", options.period, Dimension.TIME)
    case, _, _ = load_finished(options.case, out)
    return draw_spectrum(case, out, Scales(a_g, 2.0 * math.pi / period))


def _positive(name: str, text: str, dimension: Dimension) -> float:
    """A positive number, with or without a unit."""
    value = number(name, text, dimension)
    if value <= 0.0:
        raise InputError(f"{name}: found {text!r}; accepted: a positive one")
    return value
