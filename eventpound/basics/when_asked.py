"""Fields of a frozen dataclass whose values are made when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")


def made_when_asked(*names: str) -> Callable[[type[T]], type[T]]:
    """What lets fields of a class be given as functions, each of which is called once."""

    def changed(made: type[T]) -> type[T]:
        # Once the class is made, for which these would be defaults of the fields.
        for name in names:
            setattr(made, name, _MadeWhenAsked(name))
        return made

    return changed


class _MadeWhenAsked:
    """A field that may be given as a function."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, owner: object, kind: type | None = None) -> Any:
        if owner is None:
            return self
        value = owner.__dict__[self._name]
        if callable(value):
            value = owner.__dict__[self._name] = value()
        return value

    def __set__(self, owner: object, value: object) -> None:
        owner.__dict__[self._name] = value
