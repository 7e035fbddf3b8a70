"""``eventpound new``: write a commented case that runs."""

from __future__ import annotations

import argparse
from pathlib import Path

from eventpound.cli.arguments import Commands, add_command


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    new = add_command(commands, "new", _new, "write a commented case that runs")
    new.add_argument("directory", metavar="DIR", type=Path, help="made where it is missing")


def _new(options: argparse.Namespace) -> int:
    from eventpound.case import write_template

    print(f"wrote {write_template(options.directory)}")
    return 0
