"""A scene: everything that is needed to know how the bodies move."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field
from typing import Annotated

from eventpound.basics.given import Given, Number, converting, default
from eventpound.motion.base import GroundMotion
from eventpound.motion.free import NoMotion
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import NEWTON
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.deck import Deck
from eventpound.scene.force import Force
from eventpound.scene.plan_point import ALONG
from eventpound.scene.seat import Seat
from eventpound.scene.spring import Hysteretic, LawName, Spring
from eventpound.scene.support import Support
from eventpound.units import Dimension


@converting
class Scene:
    """Bodies on a line or in plan, what joins and parts them, and the motion of the ground.

    Parameters
    ----------
    bodies : sequence of Body
        At least one.
    springs, dashpots, contacts : sequence
        Kept as tuples. May be empty; what a scene does not have is not computed.
    motion : GroundMotion
        The ground acceleration; free motion by default.
    supports : sequence of Support
        Ends that move otherwise than the ground.
    forces : sequence of Force
        What acts on bodies.
    seats : sequence of Seat
        What carries ends of decks; they move nothing.
    decks : sequence of Deck
        Shapes of the decks in plan, whose coordinates are among the bodies.
    across : GroundMotion
        The second component of the ground motion, a quarter turn to the left of `motion`.
    attack : float
        Angle (rad) from x to the direction of `motion`, to the left; or a string, ``"30 deg"``.
    impact_law : str
        ``"newton"``, or ``"poisson"`` where contacts have friction.

    Examples
    --------
    >>> scene = Scene(
    ...     [Body("deck", "1000 t")],
    ...     springs=[Spring("piers", ("ground", "deck"), Linear("100 MN/m"))],
    ...     contacts=[Contact("joint", "deck", "barrier", gap="1 cm", restitution=0.6)],
    ...     motion=Cosine("0.4 g", "0.8 s"),
    ... )
    >>> [spring.name for spring in scene.springs]
    ['piers']
    """

    bodies: Given[tuple[Body, ...], Iterable[Body]]
    springs: Given[tuple[Spring, ...], Iterable[Spring]] = default(())
    dashpots: Given[tuple[Dashpot, ...], Iterable[Dashpot]] = default(())
    contacts: Given[tuple[Contact, ...], Iterable[Contact]] = default(())
    motion: GroundMotion = field(default_factory=NoMotion)
    supports: Given[tuple[Support, ...], Iterable[Support]] = default(())
    forces: Given[tuple[Force, ...], Iterable[Force]] = default(())
    seats: Given[tuple[Seat, ...], Iterable[Seat]] = default(())
    decks: Given[tuple[Deck, ...], Iterable[Deck]] = default(())
    across: GroundMotion = field(default_factory=NoMotion)
    attack: Annotated[Number, Dimension.ANGLE] = default(0.0)
    impact_law: str = NEWTON

    @property
    def in_plan(self) -> bool:
        """Whether bodies move otherwise than along the line of the ground motion."""
        turned = self.attack != 0.0 or not isinstance(self.across, NoMotion)
        return turned or any(body.direction != ALONG for body in self.bodies)

    @property
    def motions(self) -> tuple[GroundMotion, ...]:
        """The ground motion, its second component, and those of supports."""
        moved = (support.moved_by(self.motion) for support in self.supports)
        return (self.motion, self.across, *moved)

    @property
    def is_driven(self) -> bool:
        """Whether the engine has it otherwise than it is: with supports, forces, or in plan."""
        return bool(self.supports or self.forces or self.in_plan)

    @property
    def hysteretic_springs(self) -> list[str]:
        """Names of the Bouc-Wen springs, in the order of z."""
        return [spring.name for spring in self.springs if isinstance(spring.law, Hysteretic)]

    @property
    def at_points(self) -> list[str]:
        """What has an end at a point between bodies, as messages call it."""
        kinds = (("spring", self.springs), ("contact", self.contacts))
        found = [f"{kind} {x.name!r}" for kind, every in kinds for x in every if x.at_point]
        return found + [f"dashpot {d.label!r}" for d in self.dashpots if d.at_point]

    @property
    def rubbing(self) -> list[str]:
        """Names of the contacts with friction."""
        return [contact.name for contact in self.contacts if contact.friction > 0.0]

    @property
    def memory(self) -> list[tuple[str, str]]:
        """Spring and name of each internal variable, in the order of z."""
        found = [(name, "z") for name in self.hysteretic_springs]
        laws = [(spring.name, spring.law) for spring in self.springs]
        seconds = [(s, law.second) for s, law in laws if isinstance(law, Hysteretic)]
        return found + [(spring, name) for spring, name in seconds if name]

    @property
    def branched_springs(self) -> dict[str, LawName]:
        """Laws of the springs whose memory has branches, or a second number, by their names."""
        loops = {s.name: s.law for s in self.springs if isinstance(s.law, Hysteretic)}
        return {name: law.word for name, law in loops.items() if law.beyond_bouc_wen}
