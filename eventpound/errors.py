"""The errors a user can meet, each with the exit code the command line gives it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_LONGEST = 600
"""Characters of a problem that are shown."""


class EventpoundError(Exception):
    """Base of every error eventpound raises on purpose.

    Attributes
    ----------
    exit_code : int
        What the command line exits with when this error ends a command.
    """

    exit_code = 1


class InputError(EventpoundError):
    """The input is wrong: a case, a record, an option or a scene.

    Parameters
    ----------
    problems : str or list of str
        One line per problem, each naming the file, the key, the value found
        and what is accepted. All problems of a case are reported together.
    """

    exit_code = 2

    def __init__(self, problems: str | list[str]) -> None:
        given = [problems] if isinstance(problems, str) else list(problems)
        self.problems = [_readable(problem) for problem in given]
        super().__init__("\n".join(self.problems))


@contextmanager
def told_of(where: str) -> Iterator[None]:
    """Begin every problem of an InputError from within by where it is."""
    try:
        yield
    except InputError as error:
        raise InputError([where + problem for problem in error.problems]) from None


def _readable(problem: str) -> str:
    """A problem on one line, without the middle of a value too long to be read."""
    problem = " ".join(problem.splitlines())
    if len(problem) <= _LONGEST:
        return problem
    half = _LONGEST // 2 - 10
    return f"{problem[:half]} [...] {problem[-half:]}"


class ComputationError(EventpoundError):
    """The computation failed: when, in which state, and what to try.

    Parameters
    ----------
    message : str
        What happened, in one sentence.
    time : float
        Time of the failure (s).
    recording : Recording, optional
        What was computed up to then, marked incomplete.
    """

    exit_code = 1

    def __init__(self, message: str, time: float, recording: Any = None) -> None:
        self.time = time
        self.recording = recording
        super().__init__(f"at t = {time:.17g} s: {message}")


class AccuracyWarning(UserWarning):
    """A number or an event of a run is uncertain, or its error is not known."""


class InterruptionError(ComputationError):
    """A run was left because somebody asked for it."""

    exit_code = 130
