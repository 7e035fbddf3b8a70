"""``eventpound export``: write matrices and motion for other programs."""

from __future__ import annotations

import argparse

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, load
from eventpound.errors import InputError


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "write matrices and motion for other programs"
    export = add_command(commands, "export", _export, text)
    add_case(export)
    add_out(export, "where they go (CASE/export)")


def _export(options: argparse.Namespace) -> int:
    case = load(options.case)
    if case.suite is not None:
        raise InputError(f"{options.case}: holds a suite; export writes one motion")
    from eventpound.results import export

    out = options.out or case.directory / "export"
    export(case, out)
    print(f"wrote {out}")
    return 0
