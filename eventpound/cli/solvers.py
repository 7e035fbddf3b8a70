"""List the solvers and their settings; compile their kernels.

--compile makes the kernels of the solvers beforehand: for an image, the nodes of a cluster, or
an installation that others use. A first run compiles what it needs by itself, so nobody has to
do this. Kernels are kept beside the
sources, or, where that folder cannot be written, in the user's cache folder; NUMBA_CACHE_DIR
names another. They hold for one kind of processor.

Examples
--------
  eventpound solvers
  eventpound solvers --compile
  eventpound solvers --compile fast cvode --processes 2
"""

from __future__ import annotations

import time

from eventpound.cli.arguments import Commands, Options, add_command, count_argument
from eventpound.cli.progress import duration_text
from eventpound.cli.talk import complain, is_quiet
from eventpound.errors import InputError


def add_solvers(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "solvers", _solvers, __doc__)
    names = "make the kernels of these solvers: cvode, ida, fast, moreau, penalty (all)"
    parser.option("--compile NAME", names, nargs="*")
    parser.option("--processes N", "how many compile side by side (all cores)", count_argument)


def _solvers(options: Options) -> int:
    if options.compile is not None:
        return _compile(options.compile, options.processes)
    options.refuse(["--processes"], "is for --compile")
    from eventpound.solvers import available, plugins

    for name, solver in available().items():
        print(f"{name:<10} {solver.summary}")
        for key, meaning in solver.settings.items():
            print(f"{'':<10}   {key}: {meaning}")
    for trouble in plugins().troubles.values():
        complain(f"warning: left out: {trouble}")
    return 0


def _compile(names: list[str], processes: int | None) -> int:
    from eventpound.study.precompile import SOLVERS, compile_kernels

    unknown = [name for name in names if name not in SOLVERS]
    if unknown:
        raise InputError(
            f"--compile {unknown[0]}: there is nothing to compile for it; "
            f"accepted: {', '.join(SOLVERS)}"
        )
    began = time.monotonic()

    def show(share: float, name: str) -> None:
        passed = time.monotonic() - began
        if share > 0.0 and not is_quiet():
            rest = passed / share * (1.0 - share)
            left = f", about {duration_text(rest)} left" if share < 1.0 else ""
            complain(f"{share:4.0%}  {name}{left}")

    if not is_quiet():
        complain("compiling; a minute or two on two cores")
    compile_kernels(names or SOLVERS, processes, show)
    print(f"compiled in {duration_text(time.monotonic() - began)}, or found")
    return 0
