"""A scene: everything that is needed to know how the bodies move."""

from __future__ import annotations

from dataclasses import dataclass, field

from eventpound.motion.base import GroundMotion
from eventpound.motion.free import NoMotion
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.spring import BoucWen, Spring


@dataclass(frozen=True, slots=True)
class Scene:
    """Bodies on a line, what joins and parts them, and the motion of the ground.

    Parameters
    ----------
    bodies : tuple of Body
        At least one.
    springs, dashpots, contacts : tuple
        May be empty; what a scene does not have is not computed.
    motion : GroundMotion
        The ground acceleration; free motion by default.
    """

    bodies: tuple[Body, ...]
    springs: tuple[Spring, ...] = ()
    dashpots: tuple[Dashpot, ...] = ()
    contacts: tuple[Contact, ...] = ()
    motion: GroundMotion = field(default_factory=NoMotion)

    @property
    def hysteretic_springs(self) -> list[str]:
        """Names of the Bouc-Wen springs, in the order of z."""
        return [spring.name for spring in self.springs if isinstance(spring.law, BoucWen)]
