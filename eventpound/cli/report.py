"""Write one self-contained page of a run, a suite or a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, Options, add_command, case_of_results, write

if TYPE_CHECKING:
    from pathlib import Path


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    report = add_command(commands, "report", _report, __doc__)
    report.case()
    report.out("where the results are and the page goes (CASE/results)")


def _report(options: Options) -> int:
    from eventpound.report.html import PAGE

    out = options.results
    write(out, {PAGE: _page(options, out)})
    return 0


def _page(options: Options, out: Path) -> bytes:
    """The page of what is in the folder."""
    from eventpound.report.page import report_page
    from eventpound.report.study_page import study_page
    from eventpound.report.suite_page import suite_page
    from eventpound.results import read
    from eventpound.study.reading import load_finished
    from eventpound.study.table import SUITE_TABLE, TABLE, read_suite, read_table

    if (out / SUITE_TABLE).is_file():
        table, manifest = read_suite(out)
        return suite_page(case_of_results(manifest, out, options), table, manifest)
    if (out / TABLE).is_file():
        # Of the very state of its case.
        study, _, found = load_finished(options.case, out)
        return study_page(study, read_table(out), found)
    results = read(out)
    case = case_of_results(results.manifest, out, options)
    return report_page(case, results, out, options.case / "comparison")
