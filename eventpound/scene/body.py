"""A body: a mass that moves along the line of the scene."""

from __future__ import annotations

from dataclasses import dataclass

from eventpound.units import Dimension, read_fields


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid mass with one coordinate, its displacement relative to the ground.

    Parameters
    ----------
    name : str
        Unique in the scene; not ``"ground"`` and not ``"barrier"``.
    mass : float
        Mass (kg), positive; any number here may be a string with a unit, ``"1301 t"``.
    displacement, velocity : float
        State at the start of the run, relative to the ground (m, m/s),
        positive to the right.
    """

    name: str
    mass: float
    displacement: float = 0.0
    velocity: float = 0.0

    def __post_init__(self) -> None:
        read_fields(
            self, mass=Dimension.MASS, displacement=Dimension.LENGTH, velocity=Dimension.VELOCITY
        )
