"""``eventpound plot``: draw the figures of results on disk."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from eventpound.cli.arguments import Commands, add_case, add_command, add_out


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, "draw the figures of results on disk")
    add_case(plot)
    add_out(plot, "where the results are and the figures go (CASE/results)")


def _plot(options: argparse.Namespace) -> int:
    from eventpound.report import plot
    from eventpound.results.suite import SUITE_TABLE

    out = options.out or options.case / "results"
    drawn = _plot_suite(options.case, out) if (out / SUITE_TABLE).is_file() else plot(out, out)
    for path in drawn:
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
