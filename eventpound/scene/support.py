"""A support with a motion of its own: an end for springs, dashpots and contacts."""

from __future__ import annotations

from typing import Annotated

from eventpound.basics.given import Accepted, OptionalNumber, converting, default, not_negative
from eventpound.motion.base import GroundMotion
from eventpound.motion.delayed import Delayed
from eventpound.units import Dimension


@converting
class Support:
    """A place on ground that moves otherwise than the reference, which `Scene.motion` moves.

    Its name may stand wherever ``"ground"`` or ``"barrier"`` may. Displacements of bodies
    stay relative to the reference ground, and ``s = d - d_ref`` is that of the support.

    Parameters
    ----------
    name : str
        Unique among supports and bodies; not ``"ground"`` and not ``"barrier"``.
    delay : float, optional
        The motion of the scene, that much later (s), not negative; or a string with a unit.
    motion : GroundMotion, optional
        A motion of its own in the place of a delay, as an instrument there records it.
    """

    name: str
    delay: Annotated[
        OptionalNumber, Dimension.TIME, Accepted("a time that is not negative (s)", not_negative)
    ] = default(None)
    motion: GroundMotion | None = None

    def moved_by(self, reference: GroundMotion) -> GroundMotion:
        """Its motion in space, the motion of the scene given."""
        if self.motion is not None:
            return self.motion
        return Delayed(reference, self.delay) if self.delay else reference

    @property
    def moves_apart(self) -> bool:
        """Whether it does anything but move with the reference ground."""
        return self.motion is not None or self.delay != 0.0
