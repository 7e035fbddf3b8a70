"""``eventpound plot``: draw the figures of results on disk."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, load
from eventpound.cli.paper_words import add_paper, paper_of
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.report.style import Paper


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, "draw the figures of results, or the scene")
    add_case(plot)
    add_out(plot, "where the results are and the figures go (CASE/results)")
    add_paper(plot)
    plot.add_argument(
        "--xlim", metavar="FROM,TO", type=_window, help="stretch of time that is drawn (s)"
    )
    plot.add_argument("--model", action="store_true", help="draw the scene only, model.png")


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
    suite = (out / SUITE_TABLE).is_file()
    if suite and options.xlim is not None:
        raise InputError("--xlim is for a single run; the figure of a suite has no time axis")
    drawn = _plot_suite(options.case, out, paper) if suite else plot(out, out, paper, options.xlim)
    for path in drawn:
        print(path)
    return 0


def _plot_model(directory: Path, out: Path, paper: Paper) -> int:
    """Draw the scene of a case, of a study its first one."""
    from eventpound.case.loading import read_document
    from eventpound.report.model_figure import model_figure
    from eventpound.report.style import on_paper
    from eventpound.results import write_together
    from eventpound.study.reading import load_study

    if "study" in read_document(directory)[0]:
        case = load_study(directory).study.bases[0].case
    else:
        case = load(directory)
    if not case.scene.bodies:
        raise InputError(f"{directory}: the case has no bodies to draw")
    figures = {"model.png": model_figure(case.scene, case.title)}
    for path in write_together(out, on_paper(figures, paper)):
        print(path)
    return 0


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
