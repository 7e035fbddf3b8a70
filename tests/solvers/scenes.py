"""Scenes that pound, yield and rest, and copies of them seen otherwise."""

from dataclasses import replace

from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Scene,
    Spring,
)
from eventpound.scene.contact_law import ContactLaw, Element
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task


def pounding_pair() -> Scene:
    """Two yielding decks, a slack cable between them, barriers on both sides (6 s)."""
    return Scene(
        bodies=(Body("a", 1.2, 0.01, 0.05), Body("b", 3.0, -0.02, 0.0)),
        springs=(
            Spring("frame a", (GROUND, "a"), BoucWen(20.0, 4.0, 0.03, 20.0)),
            Spring("frame b", (GROUND, "b"), BoucWen(90.0, 6.0, 0.02, 2.0, 0.3, 0.7, 0.1)),
            Spring("cable", ("a", "b"), BilinearElastic(0.0, 60.0, 0.015)),
        ),
        dashpots=(Dashpot((GROUND, "a"), 0.3), Dashpot(("a", "b"), 0.1)),
        contacts=(
            Contact("left", BARRIER, "a", 0.06, 0.4),
            Contact("joint", "a", "b", 0.04, 0.7),
            Contact("right", "b", BARRIER, 0.05, 0.5),
        ),
        motion=Ricker(5.0, 1.1, center=1.3),
    )


def with_springs(scene: Scene, element: Element, stiffness: float) -> Scene:
    """The scene with a contact element in the place of each contact under Newton's law."""
    law = ContactLaw(element.word, stiffness)
    contacts = tuple(
        replace(c, restitution=c.restitution if element.damped else None, law=law)
        for c in scene.contacts
    )
    return replace(scene, contacts=contacts)


def run(
    scene: Scene,
    rtol: float,
    end: float = 6.0,
    start: float = 0.0,
    *,
    solver: str,
    energy: bool = False,
) -> Recording:
    """The recording of a run without samples in between."""
    return solver_named(solver).solve(Task(scene, start, end, rtol, energy=energy))
