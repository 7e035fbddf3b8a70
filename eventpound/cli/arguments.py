"""Arguments that commands share, and how a case is loaded for them."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.talk import add_loudness, say
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.case import Case

Commands = argparse._SubParsersAction
"""What a parser's commands are added to."""


def add_command(
    commands: Commands[argparse.ArgumentParser],
    name: str,
    command: Callable[[argparse.Namespace], int],
    text: str,
    about: str | None = None,
    examples: str | None = None,
) -> argparse.ArgumentParser:
    """Add a command with one line of help; its parser.

    Its own ``--help`` begins with `about`, or that line, and ends with `examples`, set as they are.
    """
    parser = commands.add_parser(name, help=text, description=about or text, epilog=examples)
    add_loudness(parser)
    if about or examples:
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.set_defaults(command=command)
    return parser


def add_case(parser: argparse.ArgumentParser) -> None:
    """Add the directory of a case."""
    parser.add_argument("case", metavar="CASE", type=Path, help="directory of the case")


def add_out(parser: argparse.ArgumentParser, text: str) -> None:
    """Add ``--out``, described by a text that names the default."""
    parser.add_argument("--out", metavar="DIR", type=Path, help=text)


def tolerance(text: str) -> float:
    """Read a relative tolerance from the command line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a number between 0 and 1")
    return value


def seconds(text: str) -> float:
    """Read a stretch of time from the command line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a number of seconds")
    return value


def count_argument(text: str) -> int:
    """Read a positive whole number from the command line."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a whole number from 1")
    return int(text)


def load(path: Path, suite: str | None = None) -> Case:
    """Load a case, perhaps with other records, and show its warnings."""
    from eventpound.case import load_case

    case = load_case(path, suite)
    scene = case.scene
    say(f"read {path}: {len(scene.bodies)} bodies, {len(scene.contacts)} contacts")
    show_warnings(case.warnings)
    if any(case.run.stated.named()):
        from eventpound.case.loading import CASE_FILE
        from eventpound.quantities import asked

        try:
            asked([(case.scene, case.run.stated)])
        except InputError as error:
            where = f"{case.directory / CASE_FILE}: [run]: "
            raise InputError([where + problem for problem in error.problems]) from error
    return case


def show_warnings(warnings: Iterable[str]) -> None:
    """Say on stderr what is computed as it is asked for, but hardly meant so."""
    for warning in warnings:
        print(f"eventpound: warning: {warning}", file=sys.stderr)


def check_solver_of(case: Case, in_file: bool = True) -> None:
    """Refuse what no solver can be asked, before anything runs.

    Parameters
    ----------
    case : Case
        Whose solver, settings and tolerance are looked at.
    in_file : bool
        Whether they are those of its file, which messages then name.

    Raises
    ------
    InputError
        Where there is no such solver, setting or tolerance.
    """
    from eventpound.case.options import OWN_SOLVERS

    scene = case.scene
    plain = case.solver.name in OWN_SOLVERS and not case.solver.settings
    special = any(c.law or c.at_point for c in scene.contacts)
    for_all = not (scene.supports or scene.forces or special)
    if in_file and plain and for_all:
        # The tolerance was checked when it was read; the solvers take long to import.
        return
    from eventpound.case.loading import CASE_FILE
    from eventpound.simulation import check_solver

    try:
        check_solver(case.solver, scene)
    except InputError as error:
        where = f"{case.directory / CASE_FILE}: " if in_file else ""
        raise InputError([f"{where}{problem}" for problem in error.problems]) from error
