"""``eventpound plot``: draw the figures of results on disk."""

from __future__ import annotations

import argparse

from eventpound.cli.arguments import Commands, add_case, add_command, add_out


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, "draw the figures of results on disk")
    add_case(plot)
    add_out(plot, "where the results are and the figures go (CASE/results)")


def _plot(options: argparse.Namespace) -> int:
    from eventpound.report import plot

    out = options.out or options.case / "results"
    for path in plot(out, out):
        print(path)
    return 0
