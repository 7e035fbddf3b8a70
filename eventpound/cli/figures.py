"""``eventpound figures``: make the figures of all studies in a folder, with an index page."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_command
from eventpound.cli.progress import StudyProgress
from eventpound.errors import ComputationError, InputError

if TYPE_CHECKING:
    from eventpound.report.gallery import Entry


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "make the figures of all studies in a folder of cases, with an index page"
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

    names = _studies(options.cases)
    if not names:
        raise InputError(f"{options.cases}: no case with a [study] and a [figure] in this folder")
    check_writable(options.out)
    entries, failed = [], False
    for directory in names:
        started = time.monotonic()
        try:
            entry = _entry(directory, options.out)
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


def _studies(folder: Path) -> list[Path]:
    """Directories of the cases that are studies with figures."""
    from eventpound.case.loading import read_document

    found = []
    for file in sorted(folder.glob("*/case.toml")):
        document, _, _ = read_document(file.parent)
        if "study" in document and ("figure" in document or "intensity" in document):
            found.append(file.parent)
    return found


def _entry(directory: Path, out: Path) -> Entry:
    """Make one study and draw it."""
    from eventpound.cli.study import engine_of
    from eventpound.report.gallery import Entry, about_case
    from eventpound.report.study_files import draw
    from eventpound.study.reading import load_study
    from eventpound.study.running import run_study

    case = load_study(directory)
    results = out / directory.name
    progress = StudyProgress(case.study.size) if sys.stderr.isatty() else None
    try:
        run_study(case.study, results, engine_of(case.study.solver), progress)
    finally:
        if progress is not None:
            progress.clear()
    pictures = [path.relative_to(out) for path in draw(case, results) if path.suffix == ".png"]
    return Entry(directory.name, case.study.title, about_case(directory), case.study.size, pictures)
