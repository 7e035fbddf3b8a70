"""``eventpound plot``: draw the figures of results on disk."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, load
from eventpound.cli.paper_words import add_paper, paper_of
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.report.style import Paper
    from eventpound.response import Response


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, "draw the figures of results, or the scene")
    add_case(plot)
    add_out(plot, "where the results are and the figures go (CASE/results)")
    add_paper(plot)
    plot.add_argument(
        "--xlim", metavar="FROM,TO", type=_window, help="stretch of time that is drawn (s)"
    )
    plot.add_argument(
        "--without-contact",
        action="store_true",
        help="draw the same run without contact beside it, pale; it is computed for this",
    )
    plot.add_argument(
        "--beside", metavar="DIR", type=Path, help="other results, drawn beside these, pale"
    )
    plot.add_argument("--pi", action="store_true", help="axes in Π-terms: L_e, 1/ω_g, m a_g")
    plot.add_argument(
        "--model",
        action="store_true",
        help="draw the scene only, with its springs' laws, model.png",
    )


def _window(text: str) -> tuple[float, float]:
    try:
        low, high = map(float, text.split(","))
    except ValueError:
        low, high = 0.0, 0.0
    if not low < high:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: two times (s), as 2,6.5")
    return low, high


def _plot(options: argparse.Namespace) -> int:
    from eventpound.report import plot
    from eventpound.results.suite import SUITE_TABLE

    out = options.out or options.case / "results"
    paper = paper_of(options)
    if options.model:
        return _plot_model(options.case, out, paper)
    many = "a suite" if (out / SUITE_TABLE).is_file() else "a study" if _is_study(options) else ""
    if not many:
        pi = options.pi or _in_pi(options.case)
        drawn = plot(out, out, paper, options.xlim, _beside(options, out), pi)
    else:
        for word in ("xlim", "without_contact", "beside", "pi"):
            if getattr(options, word):
                raise InputError(
                    f"--{word.replace('_', '-')} is for a single run, and these are the results "
                    f"of {many}"
                )
        draw = _plot_suite if many == "a suite" else _plot_study
        drawn = draw(options.case, out, paper)
    for path in drawn:
        print(path)
    return 0


def _is_study(options: argparse.Namespace) -> bool:
    """Whether the results are those of a study, or would be."""
    from eventpound.study.table import TABLE

    out = options.out or options.case / "results"
    return (out / TABLE).is_file() or _has(options.case, "study")


def _in_pi(directory: Path) -> bool:
    """Whether a case is written in Π-terms, if it is still there."""
    return _has(directory, "pi")


def _has(directory: Path, table: str) -> bool:
    """Whether a case has a table, if it is still there."""
    from eventpound.case.loading import read_document

    try:
        return table in read_document(directory)[0]
    except InputError:
        return False


def _beside(options: argparse.Namespace, out: Path) -> tuple[Path | Response, str] | None:
    """What is drawn beside the results, and its name."""
    if options.beside is not None:
        if options.without_contact:
            raise InputError("--beside and --without-contact: accepted: one of them")
        return options.beside, str(options.beside)
    if not options.without_contact:
        return None
    from eventpound.case import read_case
    from eventpound.case.loading import CASE_FILE
    from eventpound.results import read
    from eventpound.simulation import simulate

    # The case as it was run, whatever became of its file since.
    case = read_case(read(out).manifest["case"], options.case / CASE_FILE)
    return simulate(case.apart(replace(case.scene, contacts=()))), "without contact"


def _plot_model(directory: Path, out: Path, paper: Paper) -> int:
    """Draw the scene of a case, of a study its first one."""
    from eventpound.report.model_figure import model_figure
    from eventpound.report.style import on_paper
    from eventpound.results import write_together
    from eventpound.study.reading import load_study

    if _has(directory, "study"):
        case = load_study(directory).study.bases[0].case
    else:
        case = load(directory)
    if not case.scene.bodies:
        raise InputError(f"{directory}: the case has no bodies to draw")
    figures = {"model.png": model_figure(case.scene, case.title, with_laws=True)}
    for path in write_together(out, on_paper(figures, paper)):
        print(path)
    return 0


def _plot_study(directory: Path, out: Path, paper: Paper) -> list[Path]:
    """Draw the figures of a study from its table."""
    from eventpound.report.study_files import draw
    from eventpound.study.reading import load_finished

    case, _, _ = load_finished(directory, out)
    if not (case.figures or case.intensities):
        raise InputError(
            f"{directory}: [figure]: missing; a study is drawn as it says (docs/studies.md)"
        )
    return draw(case, out, paper)


def _plot_suite(directory: Path, out: Path, paper: Paper) -> list[Path]:
    """Draw the figure of a suite, of the records it was run with."""
    from eventpound.case import read_case
    from eventpound.report.suite_plot import plot_suite
    from eventpound.results.suite import read_suite

    table, manifest = read_suite(out)
    if not manifest.get("complete", True):
        print(
            f"eventpound: warning: {len(table)} of {manifest.get('records_of_suite')} records "
            "of the suite were run before it was stopped; the figure shows no more",
            file=sys.stderr,
        )
    case = read_case(manifest["case"], directory / "case.toml")
    options = manifest["options"]
    return plot_suite(
        case, table, out, solver=options.get("solver"), rtol=options.get("rtol"), paper=paper
    )
