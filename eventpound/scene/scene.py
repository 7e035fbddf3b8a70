"""A scene: everything that is needed to know how the bodies move."""

from __future__ import annotations

from dataclasses import dataclass, field

from eventpound.motion.base import GroundMotion
from eventpound.motion.free import NoMotion
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.force import Force
from eventpound.scene.spring import BoucWen, Spring
from eventpound.scene.support import Support


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
    supports : tuple of Support
        Ends that move otherwise than the ground.
    forces : tuple of Force
        What acts on bodies.
    """

    bodies: tuple[Body, ...]
    springs: tuple[Spring, ...] = ()
    dashpots: tuple[Dashpot, ...] = ()
    contacts: tuple[Contact, ...] = ()
    motion: GroundMotion = field(default_factory=NoMotion)
    supports: tuple[Support, ...] = ()
    forces: tuple[Force, ...] = ()

    @property
    def hysteretic_springs(self) -> list[str]:
        """Names of the Bouc-Wen springs, in the order of z."""
        return [spring.name for spring in self.springs if isinstance(spring.law, BoucWen)]
