"""Judge programs by a set of problems with certified answers, and pack such a set.

  eventpound problems score PROBLEM ...   judge an answer, or a program, by a problem or a set
  eventpound problems pack SET            certify, freeze and pack a set

Each says more with --help. What the problems are, and the answers: the page "problems" of
the documentation.
"""

from __future__ import annotations

import sys

from eventpound.cli import pack, score
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.errors import InputError


def add_problems(commands: Commands) -> None:
    """Add the commands to the parser."""
    add_command(commands, "problems", _problems, __doc__)
    pack.add_pack(commands)
    score.add_score(commands)


def _problems(options: Options) -> int:
    options.parser.print_help(sys.stderr)
    return InputError.exit_code
