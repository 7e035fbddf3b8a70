"""What is made of each case of a folder."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from eventpound.cli.progress import Counter
from eventpound.cli.talk import complain
from eventpound.errors import ComputationError, EventpoundError, InputError, InterruptionError

if TYPE_CHECKING:
    from eventpound.case.figure import Figure
    from eventpound.study.figure import FigurePlan

T = TypeVar("T")
_Drawn: TypeAlias = "tuple[str, int, list[Path], Sequence[Figure | FigurePlan]]"
"""Title, number of runs, files and figures of a case."""


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
    from eventpound.report.gallery import GalleryEntry, about_case, index_page
    from eventpound.results.files import check_writable, write_together
    from eventpound.study.kinds import kind_of

    check_writable(out)

    def one(directory: Path) -> GalleryEntry | None:
        started = time.monotonic()
        kind, document = kind_of(directory)
        if not document.keys() & {"figure", "intensity"}:
            return None
        make = kind.choose(run=_of_suite, suite=_of_suite, study=_of_study, folder=_of_suite)
        title, runs, files, figures = make(directory, out / directory.name)
        command = kind.choose(run="run", suite="run", study="study", folder="plot")
        shown = [file.relative_to(out) for file in files]
        claims = [figure.claim for figure in figures if figure.claim]
        about = about_case(directory)
        seconds = time.monotonic() - started
        print(f"{directory.name:<22} {runs:>7} runs {seconds:>7.1f} s", flush=True)
        return GalleryEntry(directory.name, command, title, about, runs, shown, claims)

    entries, left_out = of_each(folder, one)
    if not entries and not left_out:
        raise InputError(f"{folder}: no case with a [figure] in this folder")
    said = {name: str(error) for name, error in left_out.items()}
    write_together(out, {"index.html": index_page("Figures", list(entries.values()), said)})
    print(out / "index.html")
    return worst_code(left_out)


def _of_suite(directory: Path, results: Path) -> _Drawn:
    """Run one suite and draw it."""
    from eventpound.case import load_case
    from eventpound.report.suite_plot import plot_suite
    from eventpound.study.forms import SUITE_TABLE
    from eventpound.study.suite import simulate_suite

    case = load_case(directory)
    table = simulate_suite(case, folder=results)
    files = [results / SUITE_TABLE, *plot_suite(case, table, results)]
    return case.title, len(table), files, case.figures


def _of_study(directory: Path, results: Path) -> _Drawn:
    """Make one study and draw it."""
    from eventpound.report.study_files import draw
    from eventpound.study.engine import engine_of
    from eventpound.study.forms import TABLE
    from eventpound.study.reading import load_study
    from eventpound.study.running import run_study

    case = load_study(directory)
    with Counter("runs") as progress:
        run_study(case.study, results, engine_of(case.study.solver), progress)
    return case.study.title, case.study.size, [results / TABLE, *draw(case, results)], case.figures
