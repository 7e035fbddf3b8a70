"""The command line: words to calls, one module a command.

Exit codes: 0 done; 1 the computation failed; 2 the input is wrong (one message
on stderr, nothing written); 130 interrupted. Everything but the standard
library is imported by the command that needs it.

Examples
--------
  eventpound new pulse           write a commented case, pulse/case.toml, that runs
  eventpound check pulse         read it and say what was understood or is wrong
  eventpound run pulse           compute it; results and figures go to pulse/results/
  eventpound run pulse --rtol 1e-11 --out fine
  eventpound report pulse        separation, seats, forces, ductility: two pages to hand in
  eventpound verify pulse        certify it: an error bound for every number
  eventpound compare pulse       speed against error of solvers and other programs

A case is a directory with a case.toml and the files of its records.
Exit codes: 0 done, 1 the computation failed, 2 the input is wrong, 130 interrupted.
"""

from __future__ import annotations

import argparse
import gc
import sys
import textwrap
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from eventpound.basics.interruption import Terminable, is_interruption
from eventpound.basics.told import show_warning
from eventpound.cli.arguments import EXAMPLES, Command, Commands, Options
from eventpound.cli.progress import CompilationLine
from eventpound.cli.talk import Output, add_loudness, complain, located, set_loudness, tell_step
from eventpound.errors import ComputationError, InputError, InterruptionError
from eventpound.numerics.compiling import watched

_TASKS = {
    "one case": ("new", "check", "run", "report", "plot", "floor_spectrum"),
    "many runs": ("study",),
    "records and motions": ("records",),
    "how sure, how fast": ("verify", "compare", "problems"),
    "this installation": ("solvers",),
}
"""Commands, one a module, by what they are for: the order of the help."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``eventpound``; those of the process by default.

    Returns
    -------
    int
        Exit code.
    """
    with Output() as output:
        parser = _parser()
        options = parser.parse_args(arguments, Options())
        if options.command is None:
            parser.print_help(sys.stderr)
            return InputError.exit_code
        if options.quiet:
            output.quieten()
        set_loudness(options.quiet, options.verbose)
        code = _run(options)
        tell_step(f"ended with exit code {code}")
    if output.trouble:
        complain(f"stdout: cannot be written to: {output.trouble}")
    if arguments is None:
        # The process ends: to look for cycles among all modules takes a tenth of a short run.
        gc.freeze()
    return code or int(bool(output.trouble))


def _run(options: Options) -> int:
    """Run the command of the options; the exit code."""
    try:
        with Terminable(), watched(CompilationLine()), warnings.catch_warnings():
            warnings.showwarning = show_warning
            return int(options.command(options))
    except (InputError, ComputationError) as error:
        complain(f"{located(str(error))}")
        return error.exit_code
    except (KeyboardInterrupt, SystemError, RuntimeError) as error:
        if not is_interruption(error):
            raise
        complain("interrupted")
        return InterruptionError.exit_code


class _Parser(Command):
    """Takes a command of two words for one."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        words = list(sys.argv[1:] if args is None else args)
        # What holds for every command may stand before it.
        at = next((i for i, word in enumerate(words) if not word.startswith("-")), len(words))
        two = " ".join(words[at : at + 2])
        if two in self._subparsers._group_actions[0].choices:  # type: ignore[union-attr, operator]
            words[at : at + 2] = [two]
        return super().parse_known_args(words, namespace)


def _parser() -> Command:
    parser = _Parser(
        prog="eventpound",
        usage="eventpound [-h] [--version] [-q] [-v] COMMAND ...",
        epilog=f"an example:\n{str(__doc__).partition(EXAMPLES)[2]}",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    add_loudness(parser, default=False)
    parser.set_defaults(command=None)
    commands = parser.add_subparsers(
        metavar="COMMAND", prog="eventpound", help=argparse.SUPPRESS, parser_class=Command
    )
    lines = ["Earthquake response of structures that collide, every impact located."]
    for task, modules in _TASKS.items():
        lines += ["", f"{task}:"]
        for module in modules:
            getattr(import_module(f"eventpound.cli.{module}"), f"add_{module}")(commands)
            lines.append(_line_of(commands))
    parser.description = "\n".join(lines)
    return parser


def _line_of(commands: Commands) -> str:
    """Name and help of the command that was added last, as a line of the help."""
    added = commands._choices_actions[-1]
    indent = " " * 18
    text = textwrap.fill(added.help or "", 78, initial_indent=indent, subsequent_indent=indent)
    return f"  {added.dest:<16}{text[18:]}"


class _Version(argparse.Action):
    """Print the version; looked up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"eventpound {version('eventpound')}")
        parser.exit()
