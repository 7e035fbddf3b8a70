"""The table of docs/solvers.md, by what solvers refuse: `python -m tests.docs.solvers`."""

import re
from dataclasses import replace

from eventpound import (
    Backfill,
    Body,
    Contact,
    ContactLaw,
    Cosine,
    Dashpot,
    Deck,
    DegradingBoucWen,
    Force,
    InputError,
    Joint,
    Linear,
    Point,
    Scene,
    Slider,
    Spring,
    Support,
)
from eventpound.case.case import SolverOptions
from eventpound.case.solver_options import OWN_SOLVERS
from eventpound.scene.check import check_scene
from eventpound.scene.ends import End
from eventpound.scene.spring import Law
from eventpound.simulation import check_solver
from tests.models import DOCS

PAGE = DOCS / "solvers.md"
BLOCK = re.compile(r"(?<=<!-- table of solvers -->\n).*?(?=<!-- end of the table -->)", re.DOTALL)

_A, _B = Body("a", "1 t"), Body("b", "1 t")


def _scene(law: Law, left: End = "a", kind: ContactLaw | None = None) -> Scene:
    contact = Contact("joint", left, "b", "1 cm", None if kind else 0.5, law=kind)
    return Scene(
        (_A, _B, Body("c", "1 t")),
        springs=(Spring("s", ("ground", "a"), law), Spring("t", ("ground", "b"), Linear(1e6))),
        contacts=(contact,),
        motion=Cosine("1 m/s^2", "1 s"),
    )


def _rubbing() -> Scene:
    deck = Deck("deck", "1 t", "20 m", "8 m")
    joint = Joint("joint", ("deck", "barrier"), "1 cm", 0.5, 0.3)
    return Scene(deck.bodies(), contacts=joint.contacts({"deck": deck}), decks=[deck])


_PLAIN = _scene(Linear(1e6))
_SLIDER = Slider(0.1, "10 kN")
_POINT = Point({"a": 0.4, "c": 0.6})
_SUPPORT = Support("far", delay="0.1 s")
SCENES = {
    "friction bearings (`slider`)": _scene(_SLIDER),
    "soil behind abutments (`backfill`)": _scene(Backfill(1e7, 1e6, 0.8)),
    "springs that degrade": _scene(DegradingBoucWen(1e5, 1e5, 0.01, strength_degradation=0.1)),
    "supports that move otherwise than the ground": replace(_PLAIN, supports=(_SUPPORT,)),
    "forces on bodies": replace(_PLAIN, forces=(Force("a", "1 kN"),)),
    "contacts with a law of their own": _scene(Linear(1e6), kind=ContactLaw("hertz", 1e9)),
    "springs and contacts at points between floors": replace(
        _scene(Linear(1e6), _POINT), dashpots=(Dashpot((_POINT, "b"), "1 kN s/m"),)
    ),
    "the same beside friction bearings": _scene(_SLIDER, _POINT),
    "friction where decks in plan touch": _rubbing(),
    "the same on supports": replace(_scene(Linear(1e6), _POINT), supports=(_SUPPORT,)),
}
"""What a scene may have that not every solver takes."""


def takes(solver: str, scene: Scene) -> bool:
    """Whether a solver takes a scene."""
    try:
        check_scene(scene)
        check_solver(SolverOptions(solver), scene)
    except InputError:
        return False
    return True


def table() -> str:
    """It, in Markdown."""
    heads = " | ".join(f"`{name}`" for name in OWN_SOLVERS)
    lines = [f"| with | {heads} |", "|" + " --- |" * (len(OWN_SOLVERS) + 1)]
    for what, scene in SCENES.items():
        cells = " | ".join("yes" if takes(name, scene) else "no" for name in OWN_SOLVERS)
        lines.append(f"| {what} | {cells} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(BLOCK.sub(table(), PAGE.read_text(encoding="utf-8")), encoding="utf-8")
