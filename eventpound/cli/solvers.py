"""``eventpound solvers``: list the solvers and their settings."""

from __future__ import annotations

import argparse
import sys

from eventpound.cli.arguments import Commands, add_command


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    add_command(commands, "solvers", _solvers, "list the solvers and their settings")


def _solvers(_: argparse.Namespace) -> int:
    from eventpound.solvers import available, plugins

    for name, solver in available().items():
        print(f"{name:<10} {solver.summary}")
        for key, meaning in solver.settings.items():
            print(f"{'':<10}   {key}: {meaning}")
    for trouble in plugins().troubles.values():
        print(f"eventpound: warning: left out: {trouble}", file=sys.stderr)
    return 0
