"""A point between bodies, as of a column between two floors, that a contact may be at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from eventpound.errors import InputError
from eventpound.units import Dimension, quantity

WHOLE = 1e-9
"""What the weights of a point may miss 1 by, since thirds have no end in decimals."""


@dataclass(frozen=True, slots=True)
class Point:
    """A point whose displacement is a weighted mean, ``Σ w_b u_b``, of those of bodies.

    A column that a floor strikes at 0.4 of the storey's height below the upper floor is, where
    it is straight, at 0.4 of the lower and 0.6 of the upper floor.

    Parameters
    ----------
    weights : mapping of str to float
        Positive weights w by the names of the bodies, 1 in sum; ``"ground"`` may be one of them.
        Kept as a tuple of pairs.
    """

    weights: tuple[tuple[str, float], ...]

    def __init__(self, weights: Mapping[str, float | str] | Iterable[tuple[str, float]]) -> None:
        pairs = weights.items() if isinstance(weights, Mapping) else weights
        read: list[tuple[str, float]] = []
        for name, weight in pairs:
            try:
                read.append((name, quantity(weight, Dimension.NUMBER)))
            except InputError as error:
                raise InputError(f"Point: {name}: {error}") from None
        object.__setattr__(self, "weights", tuple(read))

    def __str__(self) -> str:
        return " + ".join(f"{weight:.6g} {name}" for name, weight in self.weights)

    @property
    def label(self) -> str:
        """Its bodies, as a name of a contact has them."""
        return "+".join(name for name, _ in self.weights)

    @property
    def total(self) -> float:
        """Sum of the weights."""
        return sum(weight for _, weight in self.weights)
