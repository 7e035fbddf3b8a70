"""A unilateral contact between two bodies or a body and a rigid barrier."""

from __future__ import annotations

from dataclasses import dataclass

from eventpound.scene.contact_law import ContactLaw, damping_constant
from eventpound.units import Dimension, read_fields

BARRIER = "barrier"


@dataclass(frozen=True, slots=True)
class Contact:
    """A gap that can close: ``g = gap + u_right - u_left``.

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
    restitution : float, optional
        Newton's coefficient of restitution, 0 to 1; with a law what its constant of damping
        follows from.
    law : ContactLaw, optional
        A contact element in the place of Newton's law, under which the gap stays ``g >= 0``.
    """

    name: str
    left: str
    right: str
    gap: float
    restitution: float | None = None
    law: ContactLaw | None = None

    def __post_init__(self) -> None:
        read_fields(self, gap=Dimension.LENGTH, restitution=Dimension.NUMBER)

    @property
    def damping(self) -> float | None:
        """ζ, a or ξ of its law, as given or from its restitution; None for Newton's."""
        if self.law is None:
            return None
        if self.law.damping is not None:
            return self.law.damping
        return damping_constant(self.law.element, self.restitution or 0.0)
