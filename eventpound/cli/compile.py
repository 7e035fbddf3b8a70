"""``eventpound compile``: make all kernels that any scene may need."""

from __future__ import annotations

import argparse
import sys
import time

from eventpound.cli.arguments import Commands, add_command, count_argument
from eventpound.cli.forecast import duration_text
from eventpound.cli.talk import is_quiet
from eventpound.errors import InputError

_TEXT = """\
Compile the kernels of the solvers beforehand: for an image, the nodes of a cluster, or an
installation that others use. A first run compiles what it needs by itself, so nobody has to
do this; what a run seldom needs Python itself runs at first. Kernels are kept beside the
sources, or, where that folder cannot be written, in the user's cache folder; NUMBA_CACHE_DIR
names another. They hold for one kind of processor."""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "compile", _compile, "make all kernels beforehand", _TEXT)
    parser.add_argument(
        "--solver",
        metavar="NAME",
        nargs="+",
        help="only those of these solvers: cvode, ida, fast, moreau, penalty (all)",
    )
    parser.add_argument(
        "--processes",
        type=count_argument,
        metavar="N",
        help="how many compile side by side (as many as there are cores)",
    )


def _compile(options: argparse.Namespace) -> int:
    from eventpound.precompile import SOLVERS, compile_kernels

    solvers = options.solver or SOLVERS
    unknown = [name for name in solvers if name not in SOLVERS]
    if unknown:
        raise InputError(
            f"--solver {unknown[0]}: there is nothing to compile for it; "
            f"accepted: {', '.join(SOLVERS)}"
        )
    began = time.monotonic()

    def show(share: float, name: str) -> None:
        passed = time.monotonic() - began
        if share > 0.0 and not is_quiet():
            rest = passed / share * (1.0 - share)
            left = f", about {duration_text(rest)} left" if share < 1.0 else ""
            print(f"eventpound: {share:4.0%}  {name}{left}", file=sys.stderr, flush=True)

    if not is_quiet():
        print("eventpound: compiling; a minute or two on two cores", file=sys.stderr)
    compile_kernels(solvers, options.processes, show)
    print(f"compiled in {duration_text(time.monotonic() - began)}, or found")
    return 0
