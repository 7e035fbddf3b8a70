"""One thing that is wrong with a scene, and the element that it is found on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

from eventpound.basics.given import accepted_numbers

_KEYS = {word: f"initial.{word}" for word in ("displacement", "velocity")}
"""What a case calls numbers that it does not call by their fields."""
# To ask for a float, which nearly all are, takes less time.
_NUMBER = float, Real
_Condition = Callable[[float], bool]


@dataclass(frozen=True, slots=True)
class Part:
    """What is being checked; where it has no name, that is empty."""

    kind: str
    position: int
    name: str

    def problem(self, key: str, found: object, accepted: str) -> Problem:
        """Something that is wrong with it."""
        return Problem(self.kind, self.position, self.name, key, found, accepted)

    def number(
        self, key: str, value: object, accepted: str, condition: _Condition
    ) -> Iterator[Problem]:
        """A number that is none, or not finite, or does not meet a condition."""
        if not (isinstance(value, _NUMBER) and math.isfinite(value) and condition(float(value))):
            yield self.problem(key, value, accepted)

    def numbers(self, owner: Any, prefix: str = "") -> Iterator[Problem]:
        """Those of its numbers that are not what their fields say they may be."""
        for key, (accepted, fits) in accepted_numbers(owner.__class__):
            value = getattr(owner, key)
            if value is not None and not (math.isfinite(value) and fits(owner, value)):
                yield self.problem(prefix + _KEYS.get(key, key), value, accepted)


@dataclass(frozen=True, slots=True)
class Problem(Part):
    """One thing that is wrong with a scene.

    Parameters
    ----------
    kind : str
        ``"body"``, ``"spring"``, ``"dashpot"``, ``"contact"``, ``"excitation"``,
        ``"support"``, ``"force"``, ``"seat"`` or ``"deck"``; ``"scene"`` of what is one for all.
    position : int
        Which of its kind, from 1.
    name : str
        Its name; empty where it has none.
    key : str
        Which of its values.
    found : object
        The value (SI).
    accepted : str
        What would be right.
    """

    key: str
    found: object
    accepted: str

    def __str__(self) -> str:
        named = f" ({self.name})" if self.name else ""
        return (
            f"{self.kind} {self.position}{named}: {self.key}: "
            f"found {self.found!r}; accepted: {self.accepted}"
        )


def some_of(names: Sequence[str], others: Sequence[str] = ()) -> str:
    """Names as a message lists them: the first ones, and all others."""
    return ", ".join([*names[:8], *["..."] * (len(names) > 8), *others])
