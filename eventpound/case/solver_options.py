"""The table ``[solver]`` of a case, and a solver with its settings as one word.

``penalty:contact_steps=20:time_step=1e-3`` is the solver ``penalty`` with the two settings; a
value may carry a unit where a case may, ``time_step=0.5 ms``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from eventpound.basics.given import number as given_number
from eventpound.basics.given import positive
from eventpound.case.keys import Bound, keys_of, number_key, read_keys
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion.base import LARGEST
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene
from eventpound.units import Dimension

REFERENCE, FAST = "cvode", "fast"
"""The solver of one run, and that of many, where none is named."""
OWN_SOLVERS = (REFERENCE, "ida", FAST, "moreau", "penalty")
"""Solvers that need no other package, by their names."""
LARGEST_RTOL, SMALLEST_RTOL = 1e-2, 1e-14
"""Relative tolerances that a solver is given; beyond, they mean nothing in doubles."""
HERTZIAN = tuple(element.word for element in Element if element.hertzian)
"""Values of ``contact`` with which ``contact_stiffness`` is that of a force k δ^1.5."""
_ATOL = {"displacement": Dimension.LENGTH, "velocity": Dimension.VELOCITY, "z": Dimension.NUMBER}
# Solvers' own keys that have a dimension; any other is taken as it is.
_SETTINGS = {"time_step": Dimension.TIME, "contact_stiffness": Dimension.STIFFNESS}


@dataclass(frozen=True, slots=True)
class SolverOptions:
    """What computes it, and how accurately.

    Parameters
    ----------
    name : str
        The solver.
    rtol : float
        Relative tolerance.
    atol : mapping of str to float
        Absolute tolerances by ``"displacement"`` (m), ``"velocity"`` (m/s) and
        ``"z"``, where they were given.
    settings : mapping
        Keys of the solver's own (SI).
    """

    name: str = REFERENCE
    rtol: float = number_key(
        "relative tolerance, from 1e-14 to 1e-2",
        Dimension.NUMBER,
        1e-9,
        Bound(
            f"a number from {SMALLEST_RTOL:g} to {LARGEST_RTOL:g}",
            lambda rtol: SMALLEST_RTOL <= rtol <= LARGEST_RTOL,
        ),
        "1e-9",
    )
    atol: Mapping[str, float] = field(default_factory=dict)
    settings: Mapping[str, object] = field(default_factory=dict)


def default_solver(scenes: Iterable[Scene], many: bool) -> str:
    """The solver where none is named.

    Parameters
    ----------
    scenes : iterable of Scene
        What is run.
    many : bool
        Whether they are run many times, as in a suite or a study. Contacts with a law of their own
        are left to the reference then, too.
    """
    plain = all(contact.law is None for scene in scenes for contact in scene.contacts)
    return FAST if many and plain else REFERENCE


def read_solver(table: Table, default: str = REFERENCE) -> SolverOptions:
    """Read ``[solver]``, which may be empty."""
    name = table.text("name", "the name of a solver; `eventpound solvers` lists them", default)
    found = read_keys(table, SolverOptions)
    atol_table = table.table("atol")
    atol: dict[str, float] = {}
    for key, dimension in _ATOL.items():
        value = atol_table.optional_quantity(key, dimension, "a positive tolerance")
        if value is not None:
            atol[key] = value
    atol_table.close()
    known = ("name", "rtol", "atol")
    settings = {key: _setting(table, key) for key in table.data if key not in known}
    table.close()
    return SolverOptions(name, atol=atol, settings=settings, **found)


def rtol_problems(rtol: float) -> list[str]:
    """What is wrong with a relative tolerance."""
    key, _ = keys_of(SolverOptions)["rtol"]
    return [f"rtol: {problem}" for problem in key.problems(rtol, rtol, None)]


def settings_in_si(settings: Mapping[str, object]) -> dict[str, object]:
    """Settings of a call, those with a dimension read as a case reads them.

    Raises
    ------
    InputError
        Naming the setting whose text is no such number.
    """
    found = dict(settings)
    for key, value in settings.items():
        if (dimension := _dimension_of(key, settings)) is not None:
            found[key] = given_number(f"settings: {key}", value, dimension)
    return found


def _dimension_of(key: str, settings: Mapping[str, object]) -> Dimension | None:
    """Of a setting, None of one that is taken as it is."""
    if key == "contact_stiffness" and settings.get("contact") in HERTZIAN:
        return Dimension.HERTZ_STIFFNESS
    return _SETTINGS.get(key)


def _setting(table: Table, key: str) -> object:
    dimension = _dimension_of(key, table.data)
    if dimension is not None:
        return table.quantity(key, dimension)
    table.has(key)
    value = table.data[key]
    if not isinstance(value, bool | int | float | str):
        table.reject(key, "a number, a text, true or false")
    elif isinstance(value, int) and not isinstance(value, bool) and abs(value) > LARGEST:
        table.reject(key, f"a number up to {LARGEST:g}")
    return value


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


def solver_given(
    own: SolverOptions, solver: str | None, rtol: float | str | None, option: str = "solver"
) -> SolverOptions:
    """Options with the solver and the relative tolerance of a call, where it gives some."""
    number = positive("rtol", rtol, Dimension.NUMBER)
    named = own if solver is None else solver_instead(own, solver, option)
    return named if number is None else replace(named, rtol=number)


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
