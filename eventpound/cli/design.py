"""Give the design numbers: separation, seat, impulse, ductility, drift.

Of a run, a suite or a study. For each joint the gap with which nothing touches anywhere
("separation needed"). For each contact: what it takes up of that, and the gap if only this contact
is opened; what codes combine from the peaks without contact; opening, seat width used, impulse.
Then springs, storeys and bodies. Of a suite the 50 and 84 % fractiles over the records, the
largest, and its record. What each row is: the page "design" of the documentation.

Files, in CASE/results/design: design.pdf and design.html, a report of two pages of A4 (of a study
one page); design.csv, a row a demand (of a study: for each combination of its axes), which a
spreadsheet opens; beside it all that the runs gave. Further runs are made for it: one without
contact, and one for each contact. A suite or a study that was stopped goes on.

Examples
--------
  eventpound design bridge
  eventpound design bridge --suite "records/*.AT2"
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Counter, Progress, StudyProgress, Watch
from eventpound.cli.talk import complain, going_on, say

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case import Case
    from eventpound.study.design import DesignRuns
    from eventpound.study.plan import Plan

_FOLDER, REPORT, PRINTED = "design", "design.html", "design.pdf"


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    design = add_command(commands, "design", _design, __doc__)
    design.case()
    design.option("--suite FILES", 'other records: "folder/*.AT2", in quotes, or a list of files')
    design.option("--no-report", "write the table only")
    design.out("where table, report and runs go (CASE/results/design)")


def _design(options: Options) -> int:
    from eventpound.case.loading import read_document
    from eventpound.results.tables import table_csv
    from eventpound.study.design import DESIGN_TABLE

    out, report = options.out or options.results / _FOLDER, dict[str, bytes]()
    if "study" in read_document(options.case)[0]:
        options.refuse(["--suite"], "is for a case without a [study]")
        study = arguments.load_study(options.case).study
        table = _of_study(study, out)
        if not options.no_report and len(table):
            report = _report_of_study(study, table)
        print(f"design    {len(table)} rows: each demand at each combination of the axes")
    else:
        case = arguments.load(options.case, options.suite)
        arguments.check_solver_of(case)
        made = _of_run(case, out) if case.suite is None else _of_suite(case, out)
        assert made.case is not None
        table = made.table
        print("\n".join(_lines(made.case, table)))
        if not options.no_report:
            report = _report(made)
    arguments.write(out, {DESIGN_TABLE: table_csv(table)} | report)
    return 0


def _report(made: DesignRuns) -> dict[str, bytes]:
    """The two sheets, as HTML and PDF; of a suite with the motion under the governing record."""
    from eventpound.report.design_report import Told, design_sheets, governing_record, motion_under
    from eventpound.report.sheets import as_html, as_pdf

    say("draw the report")
    case, response, record = made.case, made.response, ""
    assert case is not None
    if response is None:
        record = governing_record(case.scene, made.table)
        response = motion_under(case, record)
    sheets = design_sheets(Told(case, made.table, made.runs, response, record))
    return {REPORT: as_html(case.title, sheets), PRINTED: as_pdf(case.title, sheets)}


def _of_run(case: Case, out: Path) -> DesignRuns:
    """Run a case, and what its design numbers need."""
    from eventpound import results
    from eventpound.study.design import made_of_run

    results.check_writable(out)
    with Progress(case) as progress, Watch(None, progress) as watch:
        made = made_of_run(case, watch, lambda: progress.begins("again, without contacts"))
    assert made.response is not None
    results.write(made.response, out, case=case)
    return made


def _of_suite(case: Case, out: Path) -> DesignRuns:
    """Run a case under every record; those that failed are named."""
    from eventpound.study.design import made_of_suite

    with going_on(), Counter("records") as progress:
        made = made_of_suite(case, out, progress)
    assert made.runs is not None
    arguments.warn_of_scales(case)
    for record, why in zip(made.runs["record"], made.runs["failed"], strict=True):
        if why:
            complain(f"{record} failed, and is left out: {why}")
    return made


def _report_of_study(study: Plan, table: pd.DataFrame) -> dict[str, bytes]:
    """One sheet, as HTML and PDF."""
    from eventpound.report.design_study import study_sheet
    from eventpound.report.sheets import as_html, as_pdf
    from eventpound.results.trade import trade_of

    say("draw the report")
    case = study.bases[0].at_first().case
    sheet = study_sheet(study, table, trade_of(case.scene, case.run.stated))
    return {REPORT: as_html(study.title, [sheet]), PRINTED: as_pdf(study.title, [sheet])}


def _of_study(plan: Plan, out: Path) -> pd.DataFrame:
    """Make the runs of a study; how many failed is said."""
    from eventpound.study.design import made_of_study

    with going_on(), StudyProgress(plan.size) as progress:
        made = made_of_study(plan, out, progress)
    assert made.runs is not None
    arguments.warn_of_scales(plan.bases)
    if failed := int((~made.runs["success"]).sum()):
        complain(f"{failed} of {len(made.runs)} runs failed, and are left out")
    return made.table


def _lines(case: Case, table: pd.DataFrame) -> Iterator[str]:
    """What an engineer asks, to be read: a table a part, in units of the trade."""
    from eventpound.report.design_tables import design_cells, scaling_words
    from eventpound.results.cells import lines_of
    from eventpound.results.trade import trade_of

    trade = trade_of(case.scene, case.run.stated)
    if scaling := scaling_words(case, trade):
        yield f"scaling   {scaling}"
    for heading, cells in design_cells(case.scene, table, trade):
        yield from ("", heading, *lines_of(cells))
