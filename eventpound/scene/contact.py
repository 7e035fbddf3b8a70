"""A unilateral contact between two bodies or a body and a rigid barrier."""

from __future__ import annotations

from dataclasses import dataclass

from eventpound.units import Dimension, read_fields

BARRIER = "barrier"


@dataclass(frozen=True, slots=True)
class Contact:
    """A gap that can close: ``g = gap + u_right - u_left >= 0``.

    A barrier moves with the ground, so its displacement is zero: with a
    barrier on the right ``g = gap - u_left``, on the left ``g = gap + u_right``.

    Parameters
    ----------
    name : str
        Unique among the contacts of the scene.
    left, right : str
        Names of the bodies; one may be ``"barrier"``.
    gap : float
        Opening at zero displacements, delta (m); or a string with a unit, ``"1.27 cm"``.
    restitution : float
        Newton's coefficient of restitution, 0 to 1.
    """

    name: str
    left: str
    right: str
    gap: float
    restitution: float

    def __post_init__(self) -> None:
        read_fields(self, gap=Dimension.LENGTH, restitution=Dimension.NUMBER)
