"""Report what a case decides: separations, seats, forces, ductility, on two pages.

CASE is a run, a suite or a study. First comes, for each joint, the gap with which nothing touches
anywhere ("separation needed"), then contacts, springs, storeys and bodies. A suite gets 50 and
84 % fractiles over its records, the largest value, and its record. What each row is: the page
"design" of the documentation.

Files, in CASE/results/report: report.pdf, two pages of A4; report.html, these
pages and an appendix with all figures, tables and quantities; report.xlsx, all numbers in the
units of the report; report.csv, a row a demand (of a study: for each combination of its axes), SI;
motion.html, histories, gaps and loops that zoom, with events to click, and decks as they move;
and the results of the runs. Further runs are made: one without contact, and one for
each contact. A suite or a study that was stopped goes on. Records alone and a study in Π-terms have
the appendix only.

A folder of cases gets a report each, in FOLDER/reports, and a page with links to them.

Examples
--------
  eventpound report bridge
  eventpound report bridge --suite "records/*.AT2"
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.folder import of_each, worst_code
from eventpound.cli.progress import Counter, Progress, Watch
from eventpound.cli.talk import complain, going_on, tell_step

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case import Case
    from eventpound.report.design_report import Told
    from eventpound.report.html import Section
    from eventpound.report.sheets import Sheet
    from eventpound.results.tables import Row
    from eventpound.study.reading import StudyCase

_Made: TypeAlias = "tuple[str, pd.DataFrame, dict[str, bytes]]"
"""Title, design numbers and files of a report."""
_FOLDER, _FOLDERS, PRINTED, WORKBOOK = "report", "reports", "report.pdf", "report.xlsx"


def add_report(commands: Commands) -> None:
    """Add the command to the parser."""
    report = add_command(commands, "report", _report, __doc__)
    help_text = "directory of the case, or of cases"
    report.add_argument("case", metavar="CASE|FOLDER", type=Path, help=help_text)
    report.option("--suite FILES", 'other records: "folder/*.AT2", in quotes, or a list of files')
    report.option("--no-pages", "write the table only")
    report.out("where table, pages and runs go (CASE/results/report)")


def _report(options: Options) -> int:
    from eventpound.study.kinds import is_folder

    if not is_folder(options.case):
        _one(options, options.out or options.results / _FOLDER)
        return 0
    options.refuse_others("--out", "is for a single case, and this is a folder of cases")
    from eventpound.report.gallery import links_page
    from eventpound.report.html import PAGE

    out, case = options.out or options.case / _FOLDERS, options.case

    def one(directory: Path) -> str:
        options.case = directory
        return _one(options, out / directory.name)

    titles, left_out = of_each(case, one)
    arguments.write_and_print(out, {"index.html": links_page("Reports", titles, PAGE, left_out)})
    return worst_code(left_out)


def _one(options: Options, out: Path) -> str:
    """Make the report of one case; its title."""
    from eventpound.results.tables import table_csv
    from eventpound.study.design import DESIGN_TABLE

    make = (partial(of, options, out) for of in (_of_run, _of_study, _of_suite))
    title, table, pages = arguments.by_kind(options.case, *make, records=options.suite)
    files = {DESIGN_TABLE: table_csv(table)} if len(table) else {}
    arguments.write_and_print(out, files | pages)
    return title


def _pages(
    title: str,
    sheets: Sequence[Sheet],
    sections: Sequence[Section],
    tables: Mapping[str, Sequence[Row]],
) -> dict[str, bytes]:
    """The files of a report."""
    from eventpound.report.html import PAGE
    from eventpound.report.sheets import as_html, as_pdf
    from eventpound.results.tables import workbook

    files = {PAGE: as_html(title, sheets, sections)}
    files |= {PRINTED: as_pdf(title, sheets)} if sheets else {}
    return files | ({WORKBOOK: workbook(tables)} if tables else {})


def _pages_of(
    case: Case, table: pd.DataFrame, appendix: Sequence[Section], tell: Callable[[], Told]
) -> dict[str, bytes]:
    """The report of a run or a suite, and a page of the motion under what governs."""
    from eventpound.report import design_report as report
    from eventpound.report.view import View
    from eventpound.report.zoom import ZOOM_PAGE, zoom_page
    from eventpound.results import gather

    tell_step("draw the report")
    if table.empty:
        return _pages(case.title, [], appendix, {})
    told = tell()
    sections = [report.all_numbers(told), *appendix]
    tables = report.sheets_of_workbook(told)
    files = _pages(case.title, report.design_sheets(told), sections, tables)
    title = ": ".join(filter(None, [case.title, told.governs]))
    view = View(gather(told.response, case), told.response.scene)
    return files | {ZOOM_PAGE: zoom_page(view, title, told.units)}


def _of_run(options: Options, out: Path, case: Case) -> _Made:
    """Run a case, and what its design numbers need, and make its report."""
    from eventpound import results
    from eventpound.report.design_report import Told
    from eventpound.report.run_appendix import run_sections
    from eventpound.study.design import made_of_run

    arguments.check_solver_of(case)
    results.check_writable(out)
    with Progress(case) as progress, Watch(None, progress) as watch:
        again = partial(progress.begins, "again, without contacts")
        table, response = made_of_run(case, watch, again)
    results.write(response, out, case=case)
    print("\n".join(_lines(case, table, {})))
    if options.no_pages:
        return case.title, table, {}
    directory = options.results if options.out is None else out
    appendix = run_sections(case, results.read(out), directory, options.case / "comparison")
    tell = partial(Told, case, table, response)
    return case.title, table, _pages_of(case, table, appendix, tell)


def _of_suite(options: Options, out: Path, case: Case) -> _Made:
    """Run a case under every record, and make its report; records that failed are named."""
    from eventpound.report.design_report import told_of_suite
    from eventpound.report.many_appendix import suite_sections
    from eventpound.report.record_tables import record_names
    from eventpound.study.design import made_of_suite
    from eventpound.study.table import read_suite

    plan = arguments.checked_suite(case)
    with going_on(), Counter("records") as progress:
        case, table, runs = made_of_suite(case, out, progress)
    arguments.complain_of_scales(plan.bases)
    for record, why in zip(runs["record"], runs["failed"], strict=True):
        if why:
            complain(f"{record} failed, and is left out: {why}")
    print("\n".join(_lines(case, table, record_names(runs))))
    if options.no_pages:
        return case.title, table, {}
    appendix = suite_sections(case, *read_suite(out))
    tell = partial(told_of_suite, case, table, runs)
    return case.title, table, _pages_of(case, table, appendix, tell)


def _of_study(options: Options, out: Path, case: StudyCase) -> _Made:
    """Make the runs of a study, and its report."""
    from eventpound.report.design_study import study_cells, study_sheets, study_workbook
    from eventpound.report.design_tables import capacity_words
    from eventpound.report.many_appendix import study_sections
    from eventpound.results.shown_units import units_of_scene
    from eventpound.results.tables import lines_of
    from eventpound.study.design import made_of_study, plan_asking
    from eventpound.study.table import manifest_there

    options.refuse(["--suite"], "is for a case without a [study]")
    plan = plan_asking(case.study)
    # Where nothing is asked for beyond it, the table of the study is taken.
    runs = options.results if plan == case.study else out
    with going_on(), Counter("runs") as progress:
        table, made = made_of_study(plan, runs, progress)
    arguments.complain_of_scales(plan.bases)
    if failed := int((~made["success"]).sum()):
        complain(f"{failed} of {len(made)} runs failed, and are left out")
    first = case.study.bases[0].at_first().case
    units = units_of_scene(first.scene, first.run.stated)
    if len(table):
        print("\n".join(capacity_words(table, first.run.stated.fractile)))
        print("\n".join(lines_of(study_cells(plan, table, units))))
    if options.no_pages:
        return plan.title, table, {}
    sheets = study_sheets(plan, table, units, case.warnings) if len(table) else []
    sections = study_sections(case, made, manifest_there(runs) or {})
    return plan.title, table, _pages(plan.title, sheets, sections, study_workbook(table, units))


def _lines(case: Case, table: pd.DataFrame, names: Mapping[str, str]) -> Iterator[str]:
    """What an engineer asks, to be read: a table a part, in units of the trade."""
    from eventpound.report.design_tables import capacity_words, screen_tables
    from eventpound.report.record_tables import scaling_words
    from eventpound.results.shown_units import units_of_scene
    from eventpound.results.tables import lines_of

    units = units_of_scene(case.scene, case.run.stated)
    if scaling := scaling_words(case, units):
        yield f"scaling   {scaling}"
    yield from capacity_words(table, case.run.stated.fractile)
    for heading, cells in screen_tables(case.scene, table, names, units) if len(table) else ():
        yield from ("", heading, *lines_of(cells))
