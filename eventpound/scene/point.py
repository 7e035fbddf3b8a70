"""A point between bodies, as of a column between two floors, that an end may be at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated

from eventpound.basics.given import Given, converting, number, read_fields
from eventpound.units import Dimension

_Pair = tuple[str, Annotated[float, Dimension.NUMBER]]
_Given = Mapping[str, float | str] | Iterable[tuple[str, float | str]]
Weights = tuple[tuple[str, float], ...]
"""Names and the parts that they have in something."""

WHOLE = 1e-9
"""What the weights of a point may miss 1 by, since thirds have no end in decimals."""


@converting
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

    weights: Given[tuple[_Pair, ...], _Given]

    def __post_init__(self) -> None:
        given: object = self.weights
        if isinstance(given, Mapping):
            read = [(b, number(f"Point: {b}", w, Dimension.NUMBER)) for b, w in given.items()]
            object.__setattr__(self, "weights", read)
        read_fields(self)

    def __str__(self) -> str:
        return " + ".join(f"{weight:.6g} {name}" for name, weight in self.weights)

    @property
    def label(self) -> str:
        """Its bodies, as a name of what it is an end of has them."""
        return "+".join(name for name, _ in self.weights)

    @property
    def parts(self) -> Weights:
        """Names and weights, 1 in sum."""
        # One to rounding, so that a motion of all bodies together opens nothing.
        return tuple((name, weight / (self.total or 1.0)) for name, weight in self.weights)

    @property
    def written(self) -> dict[str, float]:
        """Itself as a case writes it."""
        return dict(self.weights)

    def renamed(self, names: Mapping[str, str]) -> Point:
        """The same point with other names for some of its own."""
        return Point(tuple((names.get(name, name), weight) for name, weight in self.weights))

    @property
    def total(self) -> float:
        """Sum of the weights."""
        return sum(weight for _, weight in self.weights)
