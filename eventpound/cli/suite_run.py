"""``eventpound run`` of a case with a suite: a row a record, figures, what failed at the end."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Options, complain_of_scales
from eventpound.cli.progress import Counter
from eventpound.cli.talk import complain, going_on, located
from eventpound.errors import told_of

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case import Case
    from eventpound.response import Response
    from eventpound.study.suite import Keep

_HISTORIES = "records"
"""Folder of the results of every record, in that of the suite's."""


def run_and_tell_suite(case: Case, options: Options, out: Path, told: str) -> int:
    """Run a scene under every record, write the table and the figures.

    Where it cannot be run the message begins as told.
    """
    from eventpound.study import suite
    from eventpound.study.forms import SUITE_TABLE
    from eventpound.study.suite_statistics import INTENSITY_TABLE
    from eventpound.study.table import read_table

    estimate = True if options.error_estimate else None
    with told_of(told):
        plan = suite.suite_plan(case, estimate, intensities=True)
    keep = _keeper(out / _HISTORIES) if options.histories else None
    with going_on(lambda: _kept(out, plan.size)), Counter("records") as progress:
        moved = suite.run_suite(plan, case, out, progress, keep)
    if moved is not None:
        print(f"moved     what was in {out} before is in {moved}")
    table = read_table(out, SUITE_TABLE)
    orders = suite.orders_of(table, case)
    for line in (*_summary(case, table), *(() if orders.empty else _orders(orders, table))):
        print(line)
    print(f"results   {out / SUITE_TABLE}" + ("" if orders.empty else f", {INTENSITY_TABLE}"))
    if options.histories:
        print(f"histories {out / _HISTORIES}, a folder a record")
    if not options.no_figures:
        from eventpound.report.suite_plot import plot_suite

        for path in plot_suite(case, table, out):
            print(f"figure    {path}")
    _say_what_is_unlikely(table)
    _say_what_failed(table)
    complain_of_scales(plan.bases)
    return 0


def _kept(out: Path, size: int) -> str:
    """What there is of a suite that was stopped."""
    from eventpound.study.forms import SUITE_MANIFEST, SUITE_TABLE
    from eventpound.study.table import manifest_there

    manifest = manifest_there(out, SUITE_MANIFEST) or {}
    if manifest.get("complete", True):
        return f"0 of {size} records were done"
    done = manifest["records"]
    return f"{done} of {size} records are in {out / SUITE_TABLE}, marked incomplete"


def _orders(intensity: pd.DataFrame, table: pd.DataFrame) -> Iterator[str]:
    """How well measures of intensity order the peaks, a line a body, and which of them cannot."""
    from eventpound.study.suite_statistics import MEASURES

    for demand, rows in intensity.groupby("demand", sort=False):
        keys = ("measure", "rank_correlation", "rank_low", "rank_high", "dispersion")
        found = zip(*(rows[key] for key in keys), strict=True)
        each = ", ".join(_order(*row) for row in found)
        yield f"{str(demand).removeprefix('peaks.').removesuffix('.abs_max'):<16} ordered by {each}"
    yield "          rank correlation, its 95 % interval, in brackets the dispersion of ln u"
    same = [name for name in MEASURES if name in table and name not in set(intensity["measure"])]
    if same:
        yield f"          {', '.join(same)} the same for all records: orders nothing"


def _order(measure: str, rank: float, low: float, high: float, spread: float) -> str:
    within = f" [{low:.2f} to {high:.2f}]" if low < high else ""
    return f"{measure} {rank:.2f}{within} ({spread:.2f})"


def _keeper(folder: Path) -> Keep:
    """What writes the results of every record to a folder of its own."""
    from eventpound import results

    def keep(name: str, case: Case, response: Response) -> None:
        results.write(response, folder / name.replace("/", "__"), case=case)

    return keep


def _summary(case: Case, table: pd.DataFrame) -> Iterator[str]:
    """What the suite did, to be read."""
    done = table[table["failed"] == ""]
    yield f"records   {len(done)} of {len(table)}"
    if done.empty:
        return
    if scaling := case.size.words():
        yield f"scaling   {scaling}"
    for key, unit in (("PGA", "m/s^2"), ("T_m", "s"), ("L_e", "m")):
        if key in done:
            low, middle, high = done[key].quantile([0.0, 0.5, 1.0])
            yield f"{key:<9} {low:.4g} to {high:.4g} {unit}, median {middle:.4g}"
    for body in case.scene.bodies:
        peaks = done[f"peaks.{body.name}.abs_max"]
        yield f"{body.name:<16} largest |u| {peaks.min():.3e} to {peaks.max():.3e} m"
    if case.scene.contacts:
        struck = int((done["impacts"] > 0).sum())
        faster = sum(done[f"contacts.{c.name}.impacts_faster"].sum() for c in case.scene.contacts)
        counted = f"{int(done['impacts'].sum())}, {int(faster)} {case.run.stated.faster}"
        yield f"impacts   {counted}, under {struck} of {len(done)} records"
    if "error_estimate" in done:
        yield f"error     {done['error_estimate'].max():.1e} of the peaks, estimated, at most"
    if case.scene.bodies:
        read, solve = (1e3 * done[f"seconds.{part}"].median() for part in ("read", "solve"))
        yield f"time      {read:.2f} ms to read, {solve:.2f} ms to solve a record (medians)"


def _say_what_is_unlikely(table: pd.DataFrame) -> None:
    from eventpound.study.records import UNLIKELY

    noted = table[table["notes"].fillna("").str.contains(UNLIKELY)]
    if not noted.empty:
        record, note = noted.iloc[0][["record", "notes"]]
        more = f"; {len(noted) - 1} more as their notes say" if len(noted) > 1 else ""
        complain(f"warning: {record}: {note.partition(UNLIKELY)[2]}{more}")


def _say_what_failed(table: pd.DataFrame) -> None:
    failed = table[table["failed"] != ""]
    if failed.empty:
        return
    complain(f"{len(failed)} of {len(table)} records failed; they are marked in the table:")
    for record, reason in zip(failed["record"], failed["failed"], strict=True):
        print(f"  {record}: {reason}", file=sys.stderr)
    if failed["failed"].str.contains("; give |say which").any():
        print(
            located(
                "what a file does not say can stand in a list; `eventpound records FOLDER` writes "
                'one (the page "suites" of the documentation)'
            ),
            file=sys.stderr,
        )
