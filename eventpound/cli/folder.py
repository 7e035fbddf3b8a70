"""Something made of each case of a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from eventpound.cli.talk import complain
from eventpound.errors import ComputationError, EventpoundError, InputError, InterruptionError

T = TypeVar("T")


def of_each(
    folder: Path, one: Callable[[Path], T | None]
) -> tuple[dict[str, T], dict[str, EventpoundError]]:
    """What is made of each case, by its name, and why of some nothing is.

    Parameters
    ----------
    folder : Path
        That holds the directories of cases.
    one : callable
        Makes it of a directory; None where there is nothing to make.
    """
    from eventpound.study.kinds import CASES

    made: dict[str, T] = {}
    left_out: dict[str, EventpoundError] = {}
    for file in sorted(folder.glob(CASES)):
        name = file.parent.name
        try:
            if (found := one(file.parent)) is not None:
                made[name] = found
        except (ComputationError, InputError) as error:
            if isinstance(error, InterruptionError):
                raise
            complain(f"left out {name}: {error}")
            left_out[name] = error
    return made, left_out


def worst_code(left_out: dict[str, EventpoundError]) -> int:
    """The exit code of what was left out."""
    return max((error.exit_code for error in left_out.values()), default=0)
