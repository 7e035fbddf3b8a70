"""A solver with its settings, as one word.

``penalty:contact_steps=20:time_step=1e-3`` is the solver ``penalty`` with the two settings; a
value may carry a unit where a case may, ``time_step=0.5 ms``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eventpound.case.solver_options import SolverOptions
from eventpound.errors import InputError

_WORDS = {"true": True, "false": False}


def solver_words(text: str) -> list[tuple[str, Mapping[str, object]]]:
    """Solvers and their settings (SI) from a list with commas.

    Parameters
    ----------
    text : str
        As ``cvode,moreau:theta=1``.

    Raises
    ------
    InputError
        Where a word is not of this form or a value is not what a case accepts.
    """
    return [
        solver_word(word.strip(), "--solvers", {"time_step": "--steps"}) for word in text.split(",")
    ]


def solver_instead(own: SolverOptions, word: str, option: str) -> SolverOptions:
    """Options with the solver that a word names in the place of their own.

    Their settings are those of their own solver; another one is not given them.
    """
    name, settings = solver_word(word, option, {})
    kept = own.settings if name == own.name else {}
    return replace(own, name=name, settings={**kept, **settings})


def solver_word(
    word: str, option: str, elsewhere: Mapping[str, str]
) -> tuple[str, Mapping[str, object]]:
    """A solver and its settings (SI) from one word.

    Parameters
    ----------
    word : str
        As ``moreau:theta=1``.
    option : str
        The option it was given to, for messages.
    elsewhere : mapping of str to str
        Settings that another option gives, and that option.

    Raises
    ------
    InputError
        Where it is not of this form or a value is not what a case accepts.
    """
    name, *pairs = word.split(":")
    if not name:
        raise InputError(f"{option}: found {word!r}; accepted: NAME or NAME:key=value:...")
    settings: dict[str, object] = {}
    if not pairs:
        return name, settings
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not (key and equals and value):
            raise InputError(f"{option}: {word}: found {pair!r}; accepted: key=value")
        settings[key] = _value(value)
    options = {"rtol": "--rtol", **elsewhere}
    for key in ("name", "atol", *options):
        if key in settings:
            where = f"give it to {options[key]}" if key in options else "it stands in the case"
            raise InputError(f"{option}: {word}: {key} cannot stand here; {where}")
    return name, _checked(f"{option}: {word}", name, settings)


def _checked(where: str, name: str, settings: dict[str, object]) -> Mapping[str, object]:
    """Settings in SI, read as those of a case are."""
    from eventpound.case.solver_options import read_solver
    from eventpound.case.table import CaseProblem, Table

    problems: list[CaseProblem] = []
    options = read_solver(Table({"name": name, **settings}, where, problems))
    if problems:
        raise InputError([str(problem) for problem in problems])
    return options.settings


def _value(text: str) -> object:
    """A number, true, false or a text."""
    if text in _WORDS:
        return _WORDS[text]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
