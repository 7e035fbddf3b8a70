"""A body: a mass that moves along the line of the scene."""

from __future__ import annotations

from typing import Annotated

from eventpound.given import Number, converting, default, read_fields
from eventpound.units import Dimension


@converting
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
    mass: Annotated[Number, Dimension.MASS]
    displacement: Annotated[Number, Dimension.LENGTH] = default(0.0)
    velocity: Annotated[Number, Dimension.VELOCITY] = default(0.0)

    def __post_init__(self) -> None:
        read_fields(self)
