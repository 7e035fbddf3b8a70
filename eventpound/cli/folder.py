"""What is made of each case of a folder."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from eventpound.cli.progress import Counter
from eventpound.cli.talk import complain
from eventpound.errors import ComputationError, EventpoundError, InputError, InterruptionError

if TYPE_CHECKING:
    from eventpound.report.gallery import GalleryEntry


T = TypeVar("T")


def of_each(
    folder: Path, one: Callable[[Path], T | None]
) -> tuple[dict[str, T], dict[str, EventpoundError]]:
    """What is made of each case, by its name, and why of some nothing is.

    Parameters
    ----------
    folder : Path
        That holds the directories of cases.
    one : callable
        Makes it of a directory; None where there is nothing to make.
    """
    from eventpound.study.kinds import CASES

    made: dict[str, T] = {}
    left_out: dict[str, EventpoundError] = {}
    for file in sorted(folder.glob(CASES)):
        name = file.parent.name
        try:
            if (found := one(file.parent)) is not None:
                made[name] = found
        except (ComputationError, InputError) as error:
            if isinstance(error, InterruptionError):
                raise
            complain(f"left out {name}: {error}")
            left_out[name] = error
    return made, left_out


def worst_code(left_out: dict[str, EventpoundError]) -> int:
    """The exit code of what was left out."""
    return max((error.exit_code for error in left_out.values()), default=0)


def plot_folder(folder: Path, out: Path) -> int:
    """Make the runs and figures of every case with a figure, and an index page; the exit code."""
    from eventpound.report.gallery import index_page
    from eventpound.results.files import check_writable, write_together

    check_writable(out)

    def one(directory: Path) -> GalleryEntry | None:
        started = time.monotonic()
        make = _maker(directory)
        entry = make and make(directory, out)
        if entry is not None:
            seconds = time.monotonic() - started
            print(f"{entry.name:<22} {entry.runs:>7} runs {seconds:>7.1f} s", flush=True)
        return entry

    entries, left_out = of_each(folder, one)
    if not entries and not left_out:
        raise InputError(f"{folder}: no case with a [figure] in this folder")
    said = {name: str(error) for name, error in left_out.items()}
    write_together(out, {"index.html": index_page("Figures", list(entries.values()), said)})
    print(out / "index.html")
    return worst_code(left_out)


def _maker(directory: Path) -> Callable[[Path, Path], GalleryEntry] | None:
    """What makes the figures of a case; None where it has none."""
    from eventpound.study.kinds import kind_of

    kind, document = kind_of(directory)
    of_suite = _suite_entry if "figure" in document else None
    of_study = _study_entry if {"figure", "intensity"} & set(document) else None
    return kind.choose(run=of_suite, suite=of_suite, study=of_study, folder=None)


def _suite_entry(directory: Path, out: Path) -> GalleryEntry:
    """Run one suite and draw it."""
    from eventpound.case import load_case
    from eventpound.report.gallery import GalleryEntry, about_case
    from eventpound.report.suite_plot import plot_suite
    from eventpound.study.forms import SUITE_TABLE
    from eventpound.study.suite import simulate_suite

    case = load_case(directory)
    results = out / directory.name
    table = simulate_suite(case, folder=results)
    files = [results / SUITE_TABLE, *plot_suite(case, table, results)]
    claims = [figure.claim for figure in case.figures if figure.claim]
    return GalleryEntry(
        directory.name, "run", case.title, about_case(directory), len(table),
        [file.relative_to(out) for file in files], claims,
    )  # fmt: skip


def _study_entry(directory: Path, out: Path) -> GalleryEntry:
    """Make one study and draw it."""
    from eventpound.report.gallery import GalleryEntry, about_case
    from eventpound.report.study_files import draw
    from eventpound.study.engine import engine_of
    from eventpound.study.forms import TABLE
    from eventpound.study.reading import load_study
    from eventpound.study.running import run_study

    case = load_study(directory)
    results = out / directory.name
    with Counter("runs") as progress:
        run_study(case.study, results, engine_of(case.study.solver), progress)
    files = [results / TABLE, *draw(case, results)]
    return GalleryEntry(
        directory.name, "study", case.study.title, about_case(directory), case.study.size,
        [file.relative_to(out) for file in files],
        [plan.claim for plan in case.figures if plan.claim],
    )  # fmt: skip
