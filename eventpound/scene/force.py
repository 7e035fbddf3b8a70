"""A force on a body that is known beforehand: gravity, a constant, a history, a pulse."""

from __future__ import annotations

from eventpound.basics.given import Given, converting, read_fields
from eventpound.errors import InputError, told_of
from eventpound.motion.base import GroundMotion
from eventpound.motion.constant import Constant
from eventpound.units import Dimension, quantity


@converting
class Force:
    """A force on one body, positive to the right.

    Parameters
    ----------
    body : str
        Name of the body; several forces may act on one.
    history : GroundMotion
        The force as a motion of `eventpound.motion` whose numbers are in N in the place of
        m/s², or a number (N) for a constant one; or a string with a unit, ``"-12 kN"``, or an
        acceleration, ``"-9.81 m/s^2"``, which is a force of that much for each unit of mass.
    per_mass : bool
        Whether the numbers of `history` are accelerations (m/s²), to be multiplied by the mass.
    """

    body: str
    history: Given[GroundMotion, GroundMotion | float | str]
    per_mass: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.history, GroundMotion):
            with told_of("Force: history: "):
                value, per_mass = constant_force(self.history)
            object.__setattr__(self, "history", Constant(value))
            if per_mass:
                object.__setattr__(self, "per_mass", True)
        read_fields(self)


def constant_force(given: object) -> tuple[float, bool]:
    """A constant force in SI, and whether it is one for each unit of mass.

    Raises
    ------
    InputError
        Where it is neither a force nor an acceleration.
    """
    try:
        return quantity(given, Dimension.FORCE), False
    except InputError as error:
        if not isinstance(given, str):
            raise
        try:
            return quantity(given, Dimension.ACCELERATION), True
        except InputError:
            raise error from None
