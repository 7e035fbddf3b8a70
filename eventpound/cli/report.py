"""``eventpound report``: one HTML page of a run, of a suite or of a study."""

from __future__ import annotations

import argparse
from pathlib import Path

from eventpound.cli.arguments import Commands, add_case, add_command, add_out


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    report = add_command(
        commands, "report", _report, "write one self-contained page of a run, a suite or a study"
    )
    add_case(report)
    add_out(report, "where the results are and the page goes (CASE/results)")


def _report(options: argparse.Namespace) -> int:
    from eventpound.case.loading import CASE_FILE, read_case
    from eventpound.errors import InputError
    from eventpound.report.html import PAGE
    from eventpound.report.page import report_page
    from eventpound.report.suite_page import suite_page
    from eventpound.results import read, write_together
    from eventpound.results.suite import SUITE_TABLE, read_suite
    from eventpound.study.table import TABLE

    out = options.out or options.case / "results"
    if (out / SUITE_TABLE).is_file():
        table, manifest = read_suite(out)
        case = read_case(manifest["case"], options.case / CASE_FILE)
        for path in write_together(out, {PAGE: suite_page(case, table, manifest)}):
            print(path)
        return 0
    if (out / TABLE).is_file():
        return _report_study(options.case, out)
    results = read(out)
    understood = results.manifest.get("case")
    if not isinstance(understood, dict):
        raise InputError(f"{out}: its manifest has no case; run the case with `eventpound run`")
    # The case as it was run, whatever became of its file since.
    case = read_case(understood, options.case / CASE_FILE)
    page = report_page(case, results, out, options.case / "comparison")
    for path in write_together(out, {PAGE: page}):
        print(path)
    return 0


def _report_study(directory: Path, out: Path) -> int:
    """The page of a study, of the very state of its case."""
    from eventpound.report.html import PAGE
    from eventpound.report.study_page import study_page
    from eventpound.results import write_together
    from eventpound.study.reading import load_finished
    from eventpound.study.table import read_table

    case, _, manifest = load_finished(directory, out)
    for path in write_together(out, {PAGE: study_page(case, read_table(out), manifest)}):
        print(path)
    return 0
