"""Keys of a table of a case, each declared once by a field of a dataclass.

    start: float = number_key("time of the first sample (s)", Dimension.TIME, 0.0)

What is declared is all that is read of a table, checked of an argument in Python, and told on the
page of the reference. What follows from several numbers stays code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any, NamedTuple

from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.scene import Scene
from eventpound.units import Dimension, quantity

_DECLARED = "key"


class Bound(NamedTuple):
    """Which values are accepted, in words and as a condition."""

    words: str
    fits: Callable[[Any], bool]


@dataclass(frozen=True, slots=True)
class Key:
    """What is declared of a key.

    Parameters
    ----------
    says : str
        What it is, for the page of the reference.
    read : callable
        Reads it from a table in which it stands; what is wrong is noted there.
    default : str
        As the page says it.
    dimension : Dimension, optional
        Of a number.
    bound : Bound, optional
        Which values are accepted.
    of_scene : callable
        What is wrong with a value beside a scene.
    asks : callable
        Paths of the quantities that a value asks for.
    name : str
        The key, where it is not called as the field.
    called : str
        At an axis.
    holds : frozenset of str
        The ways to run in which it does what it says.
    refused : mapping of str to str
        The ways that refuse it, and what is accepted there. Others leave it out.
    """

    says: str
    read: Callable[[Table, str], Any]
    default: str
    dimension: Dimension | None = None
    bound: Bound | None = None
    of_scene: Callable[[Any, Scene], Iterable[str]] = lambda value, scene: ()
    asks: Callable[[Any], Iterable[str]] = lambda value: ()
    name: str = ""
    called: str = ""
    holds: frozenset[str] = frozenset()
    refused: Mapping[str, str] = field(default_factory=dict)

    def problems(self, given: object, value: Any, scene: Scene | None) -> Iterator[str]:
        """What is wrong with a value that was read, of a scene where that is known."""
        if self.bound is not None and not self.bound.fits(value):
            yield f"found {given!r}; accepted: {self.bound.words}"
        elif scene is not None:
            yield from self.of_scene(value, scene)


def number_key(
    says: str,
    dimension: Dimension,
    usual: float | None,
    bound: Bound | None = None,
    default: str = "none",
    **more: Any,
) -> Any:
    """Declare a number in SI, perhaps given with a unit; `usual` where it is not given."""

    def read(table: Table, name: str) -> Any:
        return table.quantity(name, dimension)

    return _field(usual, Key(says, read, default, dimension, bound, **more))


def flag_key(says: str, usual: bool | None = False, default: str = "`false`", **more: Any) -> Any:
    """Declare what is true or false; `usual` where it is not given."""
    return _field(usual, Key(says, Table.flag, default, **more))


def texts_key(says: str, accepted: str, bound: Bound | None = None, **more: Any) -> Any:
    """Declare a list of texts, empty where it is not given."""

    def read(table: Table, name: str) -> tuple[str, ...]:
        found = table.texts(name, accepted)
        return found if bound else tuple(dict.fromkeys(found))

    default = more.pop("default", "none")
    return _field((), Key(says, read, default, None, bound, **more))


def read_elsewhere(says: str, usual: Any, default: str, **more: Any) -> Any:
    """Declare what more than its own value decides, and other code reads."""
    return _field(usual, Key(says, lambda table, name: usual, default, **more))


def text_key(accepted: str, says: str, usual: str | None = "") -> Any:
    """Declare a text; `usual` where it is not given."""
    return declared(says, lambda table, name: table.text(name, accepted), usual)


def declared(
    says: str, read: Callable[[Table, str], Any], usual: Any = (), *, name: str = ""
) -> Any:
    """Declare what a function reads; `usual` where it is not given."""
    return _field(usual, Key(says, read, "", name=name))


def _field(usual: Any, key: Key) -> Any:
    return field(default=usual, metadata={_DECLARED: key})


@cache
def keys_of(made: Any) -> dict[str, tuple[Key, Any]]:
    """What a class declares, by the names of its fields, each with its default."""
    of = ((each, each.metadata.get(_DECLARED)) for each in fields(made))
    return {each.name: (key, each.default) for each, key in of if key is not None}


def read_keys(table: Table, made: type, scene: Scene | None = None) -> dict[str, Any]:
    """Values by the fields of a class, of the keys that a table has; problems are noted."""
    found = {}
    for field_name, (key, _) in keys_of(made).items():
        name = key.name or field_name
        if table.has(name):
            found[field_name] = value = key.read(table, name)
            if not table.noted(name):
                for problem in key.problems(table.data[name], value, scene):
                    table.report(name, problem)
    return found


def read_given(made: type, given: Mapping[str, Any], scene: Scene | None = None) -> dict[str, Any]:
    """Values by the fields of a class of what a call gives; None where it gives nothing.

    Raises
    ------
    InputError
        With a line for every problem.
    """
    found, problems = {}, []
    for name, value in given.items():
        if value is not None:
            key, _ = keys_of(made)[name]
            try:
                read = value if key.dimension is None else quantity(value, key.dimension)
                found[name] = read
                shown = list(value) if isinstance(value, tuple) else value
                problems += [f"{name}: {text}" for text in key.problems(shown, read, scene)]
            except InputError as error:
                problems += [f"{name}: {text}" for text in error.problems]
    if problems:
        raise InputError(problems)
    return found
