"""What an entry of the list of quantities is, and the six numbers of an extreme."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import Any

import numpy as np

from eventpound.motion.base import Scales
from eventpound.numerics.arrays import Floats
from eventpound.quantities.owners import owners_of
from eventpound.quantities.runs import Runs
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes
from eventpound.units import Dimension


class TakenFrom(StrEnum):
    """What a quantity is taken from."""

    EXTREMES = "every run"
    ACCELERATIONS = "every run; of many, where accelerations are asked for"
    CONTACTS = "every run; of many, where named"
    FORCES = "every run; of many, where named"
    LAWS = "runs that have one; of many, where named"
    ENERGY = "the ledger (energy = true)"
    BETWEEN = "further runs with rows close together, where named"
    FREE = "one more run, without contact, where named"
    APART = "one more run, in which no contact can close, where named"
    APART_ALONE = "one more run for each joint that is named, in which it cannot close"
    CAPACITIES = "the quantities that have a capacity"


FROM_FURTHER = (TakenFrom.FREE, TakenFrom.APART, TakenFrom.APART_ALONE, TakenFrom.CAPACITIES)
"""What needs a run of another scene, or quantities that may."""
FROM_ONE = (TakenFrom.FORCES, TakenFrom.LAWS, TakenFrom.ENERGY, TakenFrom.BETWEEN)
"""What needs all of a run, not its extremes only."""

Value = Callable[[Runs, int], Any]
"""Values of a quantity of owner i in n runs, shape (n,)."""


def _always(_scene: Scene, _i: int) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class Quantity:
    """One entry of the list.

    Parameters
    ----------
    path : str
        Where it stands, as ``contacts.<contact>.smallest_gap``.
    called : str
        What an axis calls it, perhaps with mathtext.
    dimension : Dimension
        Its unit, and what makes a Π-term of it (`pi_unit`).
    text : str
        What it is, a sentence.
    value : callable
        How it is computed.
    source : TakenFrom
        What from.
    only : callable
        Whether owner i of a scene has it.
    kind : type
        ``float``, ``int`` of a count, ``bool`` of a flag.
    tabled : bool
        Whether it stands in tables without being named.
    six : str
        Of the six numbers of an extreme, their paths with ``*`` in the place of `SIX`.
    symbol : str
        What an axis calls it instead, where the field has a symbol for it (mathtext).
    """

    path: str
    called: str
    dimension: Dimension
    text: str
    value: Value
    source: TakenFrom = TakenFrom.EXTREMES
    only: Callable[[Scene, int], bool] = _always
    kind: type = float
    tabled: bool = True
    six: str = ""
    symbol: str = ""

    @property
    def owner(self) -> str:
        """Kind of its owner, as ``body``; empty where that is the run."""
        return parts_of(self.path)[1]

    def name(self, owner: str) -> str:
        """Its name, of one owner."""
        return _with_owner(self.path, owner)


@cache
def parts_of(path: str) -> tuple[str, str, str]:
    """A path without its angle brackets: what stands before, the kind of owner, what follows."""
    before, _, rest = path.partition("<")
    kind, _, after = rest.partition(">")
    return before, kind, after


def path_of_owner(path: str, scene: Scene, i: int) -> str:
    """A path with the name of owner i in the place of its kind."""
    return _with_owner(path, owners_of(scene, parts_of(path)[1])[i])


def _with_owner(path: str, owner: str) -> str:
    before, _, after = parts_of(path)
    return before + owner + after


def least_governs(name: str) -> bool:
    """Whether a quantity is the worse the less it is: its fractiles are what so many keep."""
    return name.endswith((".slack_left", ".strength_left", ".stiffness_left", ".smallest_gap"))


def over_capacity(name: str, values: Floats, capacity: float) -> Floats:
    """A demand over its capacity; of what has to be left, what has to be over what is."""
    with np.errstate(divide="ignore"):
        return capacity / values if least_governs(name) else np.abs(values) / capacity


def pi_unit(dimension: Dimension, scales: Scales, mass: float) -> float:
    """What a quantity is divided by to be a Π-term.

    Parameters
    ----------
    dimension : Dimension
        Of the quantity.
    scales : Scales
        a_g and omega_g of the motion.
    mass : float
        Of the body looked at (kg).

    Returns
    -------
    float
        SI: L_e = a_g/omega_g^2 of a length, m a_g of a force, and so on; 1 of a number.
    """
    a, w = scales.a_g, scales.omega_g
    return {
        Dimension.LENGTH: a / w**2,
        Dimension.VELOCITY: a / w,
        Dimension.ACCELERATION: a,
        Dimension.TIME: 1.0 / w,
        Dimension.ANGULAR_FREQUENCY: w,
        Dimension.FORCE: mass * a,
        Dimension.IMPULSE: mass * a / w,
        Dimension.ENERGY: mass * a**2 / w**2,
    }.get(dimension, 1.0)


def _upward(x: Extremes, i: int) -> Any:
    """Whether the maximum is the larger in size, or the earlier of two of one size."""
    high, low = x.maximum[:, i], x.minimum[:, i]
    earlier = x.time_of_maximum[:, i] <= x.time_of_minimum[:, i]
    return (high > -low) | ((high == -low) & earlier)


SIX: dict[str, tuple[str, Callable[[Extremes, int], Floats]]] = {
    "max": ("greatest", lambda x, i: x.maximum[:, i]),
    "t_max": ("time of the greatest", lambda x, i: x.time_of_maximum[:, i]),
    "min": ("least", lambda x, i: x.minimum[:, i]),
    "t_min": ("time of the least", lambda x, i: x.time_of_minimum[:, i]),
    "abs_max": ("peak", lambda x, i: np.where(_upward(x, i), x.maximum[:, i], -x.minimum[:, i])),
    "t_abs_max": (
        "time of the peak",
        lambda x, i: np.where(_upward(x, i), x.time_of_maximum[:, i], x.time_of_minimum[:, i]),
    ),
}
"""Numbers that an extreme has: both extremes, and the larger in size."""


def column(name: str, of: str = "") -> Value:
    """A column of a field of `Runs`, or of what one holds."""
    return lambda many, i: getattr(getattr(many, of) if of else many, name)[:, i]


def sum_of(name: str) -> Value:
    """The sum of all columns of a field of `Runs`."""
    return lambda many, _: getattr(many, name).sum(axis=1)


def of_contact(
    key: str, called: str, dimension: Dimension, text: str, kind: type = float
) -> Quantity:
    """A field of `ContactNumbers` as a quantity."""
    path = f"contacts.<contact>.{key}"
    return Quantity(
        path, called, dimension, text, column(key, "contact_numbers"), TakenFrom.CONTACTS, kind=kind
    )


def six_of(
    path: str,
    what: str,
    dimension: Dimension,
    text: str,
    extremes: str | Callable[[Runs, int], Extremes] = "",
    source: TakenFrom = TakenFrom.BETWEEN,
    only: Callable[[Scene, int], bool] = _always,
    symbol: str = "",
) -> Iterator[Quantity]:
    """The six numbers of an extreme; ``*`` of the path is which.

    Of a field of `Runs` by its name, of a function of runs and owner, else of close rows. The
    symbol is that of the largest in size.
    """

    def value(pick: Callable[[Extremes, int], Floats]) -> Value:
        def values(many: Runs, i: int) -> Floats:
            if callable(extremes):
                return pick(extremes(many, i), 0)
            if extremes:
                kept = getattr(many, extremes)
                return many.t * np.nan if kept is None else pick(kept, i)
            assert many.between is not None
            found = many.between().extremes(path_of_owner(path, many.scene, i))
            return pick(found.at(np.s_[:, None]), 0)

        return values

    for word, (which, pick) in SIX.items():
        own = Dimension.TIME if word.startswith("t_") else dimension
        called, sign = f"{which} {what}", symbol if word == "abs_max" else ""
        sentence = f"{called[0].upper()}{called[1:]}{text}."
        own_path, values = path.replace("*", word), value(pick)
        yield Quantity(own_path, called, own, sentence, values, source, only, six=path, symbol=sign)
