"""``eventpound plot``: draw the figures of results on disk."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, load


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, "draw the figures of results, or the scene")
    add_case(plot)
    add_out(plot, "where the results are and the figures go (CASE/results)")
    plot.add_argument("--model", action="store_true", help="draw the scene only, model.png")


def _plot(options: argparse.Namespace) -> int:
    from eventpound.report import plot
    from eventpound.results.suite import SUITE_TABLE

    out = options.out or options.case / "results"
    if options.model:
        return _plot_model(options.case, out)
    drawn = _plot_suite(options.case, out) if (out / SUITE_TABLE).is_file() else plot(out, out)
    for path in drawn:
        print(path)
    return 0


def _plot_model(directory: Path, out: Path) -> int:
    """Draw the scene of a case, of a study its first one."""
    from eventpound.case.loading import read_document
    from eventpound.errors import InputError
    from eventpound.report.model_figure import model_figure
    from eventpound.report.style import png
    from eventpound.results import write_together
    from eventpound.study.reading import load_study

    if "study" in read_document(directory)[0]:
        case = load_study(directory).study.bases[0].case
    else:
        case = load(directory)
    if not case.scene.bodies:
        raise InputError(f"{directory}: the case has no bodies to draw")
    for path in write_together(out, {"model.png": png(model_figure(case.scene, case.title))}):
        print(path)
    return 0


def _plot_suite(directory: Path, out: Path) -> list[Path]:
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
    return plot_suite(case, table, out, solver=options.get("solver"), rtol=options.get("rtol"))
