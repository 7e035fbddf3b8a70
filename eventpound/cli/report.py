"""``eventpound report``: one HTML page of a run."""

from __future__ import annotations

import argparse

from eventpound.cli.arguments import Commands, add_case, add_command, add_out


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    report = add_command(commands, "report", _report, "write one self-contained page of a run")
    add_case(report)
    add_out(report, "where the results are and the page goes (CASE/results)")


def _report(options: argparse.Namespace) -> int:
    from eventpound.case.loading import CASE_FILE, read_case
    from eventpound.errors import InputError
    from eventpound.report.page import PAGE, report_page
    from eventpound.results import read, write_together

    out = options.out or options.case / "results"
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
