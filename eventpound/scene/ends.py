"""Ends of springs, dashpots and contacts: bodies, what stands still, and points between bodies.

What is between two ends opens, or elongates, as the second moves to the right of the first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from eventpound.errors import InputError, told_of
from eventpound.numerics.arrays import Floats
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.point import Point, Weights

End = str | Point | PlanPoint
"""A body's or support's name, ``"ground"``, ``"barrier"``, a point between bodies or of a deck."""
GivenEnd = End | Mapping[str, Any]
"""An end as it may be given: a mapping of names to weights is a point."""
Direction = tuple[tuple[str, float], ...]
"""By how much each of some names opens what is between two ends."""


class Joining:
    """What is between two ends."""

    __slots__ = ()

    @property
    def sides(self) -> tuple[End, End]:
        """Its first or left end, and the other."""
        raise NotImplementedError

    @property
    def at_point(self) -> bool:
        """Whether an end of it is a point between bodies, or of a deck."""
        return any(not isinstance(end, str) for end in self.sides)

    @property
    def ends(self) -> tuple[str, ...]:
        """Names of all that it is between, those of the first end first."""
        return tuple(name for end in self.sides for name, _ in weights_of(end))

    @property
    def direction(self) -> Direction:
        """By how much each of its `ends` opens it: a column of W or B, as pairs."""
        return direction_of(self.sides)

    @property
    def written(self) -> list[str | Mapping[str, object]]:
        """Its two ends as a case writes them."""
        return [written(end) for end in self.sides]

    @property
    def label(self) -> str:
        """Its ends, as a name has them."""
        return "-".join(label_of(end) for end in self.sides)


def direction_of(sides: Sequence[End]) -> Direction:
    """By how much each name at two ends opens what is between them."""
    return tuple(
        (name, sign * weight)
        for end, sign in zip(sides, (-1.0, 1.0), strict=True)
        for name, weight in weights_of(end)
    )


def weights_of(end: End) -> Weights:
    """Names and weights of an end; of a body or what stands still the one it is."""
    return ((end, 1.0),) if isinstance(end, str) else end.parts


def label_of(end: End) -> str:
    """An end, as a name has it."""
    return end if isinstance(end, str) else end.label


def written(end: End) -> str | Mapping[str, object]:
    """An end as a case writes it."""
    return end if isinstance(end, str) else end.written


def renamed(end: End, names: Mapping[str, str]) -> End:
    """An end with other names for some of its own."""
    return names.get(end, end) if isinstance(end, str) else end.renamed(names)


def read_ends(owner: Any, key: str) -> None:
    """Make points of the mappings among the ends of a frozen dataclass that is being made."""
    given = getattr(owner, key)
    ends = given if isinstance(given, list | tuple) else (given,)
    if not any(isinstance(end, Mapping) for end in ends):
        return
    with told_of(f"{type(owner).__name__}: {key}: "):
        read = tuple(point_of(end) if isinstance(end, Mapping) else end for end in ends)
    object.__setattr__(owner, key, read[0] if ends is not given else read)


def point_of(given: Mapping[str, Any]) -> Point | PlanPoint:
    """A point as it is written: of a deck where it says so.

    Raises
    ------
    InputError
        Where it is none.
    """
    if "deck" not in given:
        return Point(given)
    keys = "deck", "at", "normal", "radius"
    if given.keys() != {*keys}:
        raise InputError(f"found {dict(given)!r}; accepted: a place with {', '.join(keys)}")
    return PlanPoint(*(given[key] for key in keys))


def opening(
    joining: Joining, start: Floats | float, displacements: Mapping[str, Floats | float]
) -> Floats | float:
    """Opening or elongation (m), a number or columns; NaN at ends that have no displacement.

    Parameters
    ----------
    joining : Joining
        What is between which ends.
    start : float or ndarray
        Its opening at zero displacements (m).
    displacements : mapping
        Of its ends, by their names (m); or whatever is a sum of these, as rates.
    """
    # The second end first, as everywhere: rounding is the same.
    for end, weight in joining.direction[::-1]:
        start = start + weight * displacements.get(end, math.nan)
    return start
