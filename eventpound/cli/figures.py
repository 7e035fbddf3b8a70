"""``eventpound figures``: make the figures of a folder of cases, with an index page.

They are the figures of studies, and those of suites of records.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_command
from eventpound.cli.progress import StudyProgress
from eventpound.errors import ComputationError, InputError

if TYPE_CHECKING:
    from eventpound.report.gallery import Entry


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "make the figures of all studies and suites in a folder of cases, with an index page"
    figures = add_command(commands, "figures", _figures, text)
    figures.add_argument(
        "cases", metavar="CASES", type=Path, nargs="?", default=Path("cases"), help="(cases)"
    )
    figures.add_argument(
        "--out", metavar="DIR", type=Path, default=Path("figures"), help="where they go (figures)"
    )


def _figures(options: argparse.Namespace) -> int:
    from eventpound.report.gallery import index_page
    from eventpound.results.files import check_writable, write_together

    makers = _figure_cases(options.cases)
    if not makers:
        raise InputError(f"{options.cases}: no case with a [figure] in this folder")
    check_writable(options.out)
    entries, failed = [], False
    for directory, make in makers.items():
        started = time.monotonic()
        try:
            entry = make(directory, options.out)
        except ComputationError as error:
            print(f"eventpound: {directory}: {error}", file=sys.stderr)
            failed = True
            continue
        entries.append(entry)
        seconds = time.monotonic() - started
        print(f"{entry.name:<22} {entry.runs:>7} runs {seconds:>7.1f} s", flush=True)
    write_together(options.out, {"index.html": index_page("Figures", entries)})
    print(options.out / "index.html")
    return int(failed)


def _figure_cases(folder: Path) -> dict[Path, Callable[[Path, Path], Entry]]:
    """Directories of the cases that have figures, and what makes those."""
    from eventpound.case.loading import read_document

    found: dict[Path, Callable[[Path, Path], Entry]] = {}
    for file in sorted(folder.glob("*/case.toml")):
        document, _, _ = read_document(file.parent)
        if "study" in document and ("figure" in document or "intensity" in document):
            found[file.parent] = _study_entry
        elif "figure" in document:
            found[file.parent] = _suite_entry
    return found


def _suite_entry(directory: Path, out: Path) -> Entry:
    """Run one suite and draw it."""
    from eventpound.case import load_case
    from eventpound.report.gallery import Entry, about_case
    from eventpound.report.suite_plot import plot_suite
    from eventpound.results.suite import SUITE_TABLE, write_suite
    from eventpound.study.suite import simulate_suite

    case = load_case(directory)
    results = out / directory.name
    name, rtol = case.solver.name, case.solver.rtol
    table = simulate_suite(case, solver=name, rtol=rtol)
    write_suite(table, results, case)
    files = [results / SUITE_TABLE, *plot_suite(case, table, results, solver=name, rtol=rtol)]
    claims = [case.figure.claim] if case.figure and case.figure.claim else []
    return Entry(
        directory.name, "run", case.title, about_case(directory), len(table),
        [file.relative_to(out) for file in files], claims,
    )  # fmt: skip


def _study_entry(directory: Path, out: Path) -> Entry:
    """Make one study and draw it."""
    from eventpound.report.gallery import Entry, about_case
    from eventpound.report.study_files import draw
    from eventpound.study.engines.local import engine_of
    from eventpound.study.reading import load_study
    from eventpound.study.running import run_study
    from eventpound.study.table import TABLE

    case = load_study(directory)
    results = out / directory.name
    progress = StudyProgress(case.study.size) if sys.stderr.isatty() else None
    try:
        run_study(case.study, results, engine_of(case.study.solver), progress)
    finally:
        if progress is not None:
            progress.clear()
    files = [results / TABLE, *draw(case, results)]
    return Entry(
        directory.name, "study", case.study.title, about_case(directory), case.study.size,
        [file.relative_to(out) for file in files],
        [plan.claim for plan in case.figures if plan.claim],
    )  # fmt: skip
