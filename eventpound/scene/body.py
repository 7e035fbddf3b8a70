"""A body: a mass that moves along the line of the scene."""

from __future__ import annotations

from typing import Annotated

from eventpound.basics.given import Accepted, Number, above_zero, converting, default
from eventpound.scene.plan_point import ALONG
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
    structure : str
        What the structure that it belongs to is called; by default as its first body.
    direction : str
        ``"x"``, the line of the scene and of its ground motion; ``"y"``, across it; or ``"turn"``
        of a deck in plan (`eventpound.scene.deck`), which no ground motion turns.

    Examples
    --------
    >>> Body("deck", mass="1301 t").mass
    1301000.0
    """

    name: str
    mass: Annotated[Number, Dimension.MASS, Accepted("a positive mass (kg)", above_zero)]
    displacement: Annotated[Number, Dimension.LENGTH, Accepted("a number (m)")] = default(0.0)
    velocity: Annotated[Number, Dimension.VELOCITY, Accepted("a number (m/s)")] = default(0.0)
    structure: str = ""
    direction: str = ALONG
