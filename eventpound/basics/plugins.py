"""What other packages bring along through entry points: solvers, readers of records.

An entry point names an object, or a class that can be made without arguments. What cannot be
loaded or is not as it has to be is left out and its trouble kept, so that it spoils nothing
else and can be named when it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Plugins(Generic[T]):
    """What the installed packages offer of one kind.

    Parameters
    ----------
    found : mapping of str to object
        What can be used, by name.
    troubles : mapping of str to str
        A sentence on each that cannot, by the name of its entry point.
    """

    found: Mapping[str, T]
    troubles: Mapping[str, str]


def plugged_in(
    group: str, kind: str, taken: Container[str], trouble: Callable[[Any], str]
) -> Plugins[Any]:
    """The objects behind the entry points of a group, by their attribute ``name``.

    Parameters
    ----------
    group : str
        The entry points.
    kind : str
        What they are, for messages.
    taken : container of str
        Names that are not free any more.
    trouble : callable
        What is wrong with an object, as a phrase; empty where nothing is.
    """
    found: dict[str, Any] = {}
    troubles: dict[str, str] = {}
    for entry in entry_points(group=group):
        try:
            made = _made(entry)
            wrong = trouble(made)
            name = "" if wrong else made.name
        # Whatever another package does wrong must not stop the others.
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            troubles[entry.name] = f"{_place(entry)} cannot be loaded: {what}"
            continue
        if not wrong and (name in taken or name in found):
            wrong = f"another {kind} is called {name!r}"
        if wrong:
            troubles[entry.name] = f"{_place(entry)}: {wrong}"
        else:
            found[name] = made
    return Plugins(found, troubles)


def _made(entry: EntryPoint) -> Any:
    loaded = entry.load()
    return loaded() if isinstance(loaded, type) else loaded


def _place(entry: EntryPoint) -> str:
    package = f" of {entry.dist.name}" if entry.dist is not None else ""
    return f"the entry point {entry.name} = {entry.value}{package}"
