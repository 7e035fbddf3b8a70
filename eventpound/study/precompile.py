"""Every kernel that any scene may need, made beforehand.

A kernel depends on the types of its arguments, not on their values, and these are the same
for all scenes of one body and for all of several. So a few short runs that meet whatever
there is (impacts of one contact and of several, rests, locked contacts, kinks, friction at the
edge of a deck, a record, an energy ledger) compile all that a solver has.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import replace
from itertools import pairwise
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np

from eventpound.basics.cores import cores
from eventpound.errors import ComputationError
from eventpound.motion.base import GroundMotion
from eventpound.motion.constant import Constant
from eventpound.motion.pulses import Cosine
from eventpound.motion.record import Record
from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    ContactLaw,
    Dashpot,
    Deck,
    DegradingBoucWen,
    Force,
    Joint,
    Linear,
    Point,
    Scene,
    Slider,
    Spring,
    Support,
)
from eventpound.scene.contact_law import IMPACT_LAWS
from eventpound.scene.spring import Law
from eventpound.simulation import response_of
from eventpound.solvers import knows_scene, solver_named, takes_loads
from eventpound.solvers.events.roots import EVENTS
from eventpound.study.many import simulate_many

_LAW = BoucWen(1.0, 0.3, 0.05)
_EVENT_DRIVEN, _FIXED_STEP = ("cvode", "ida", "fast"), ("moreau", "penalty")


def _record() -> Record:
    t = 0.05 * np.arange(60)
    return Record(np.sin(3.0 * t) * np.exp(-0.3 * t), 0.05)


def _motions() -> tuple[GroundMotion, ...]:
    return Cosine(1.0, 2.0), Ricker(1.0, 1.0, center=2.0), _record()


def _one_body(motion: GroundMotion, restitution: float, gap: float = 0.1) -> Scene:
    return Scene(
        bodies=(Body("a", 1.0),),
        springs=(Spring("s", (GROUND, "a"), _LAW),),
        dashpots=(Dashpot((GROUND, "a"), 0.05),),
        contacts=(
            Contact("right", "a", BARRIER, gap, restitution),
            Contact("left", BARRIER, "a", 0.2, restitution),
        ),
        motion=motion,
    )


def _row(motion: GroundMotion, restitution: float, gap: float) -> Scene:
    """Three bodies in a row between two barriers, their links of every kind."""
    kinked = BilinearElastic(compression=0.5, extension=2.0, offset=0.01)
    return Scene(
        bodies=(Body("a", 1.0), Body("b", 2.0), Body("c", 3.0)),
        springs=(
            Spring("sa", (GROUND, "a"), _LAW),
            Spring("sb", (GROUND, "b"), Linear(2.0)),
            Spring("sc", (GROUND, "c"), kinked),
            Spring("ab", ("a", "b"), kinked),
            Spring("bc", ("b", "c"), _LAW),
        ),
        dashpots=(Dashpot(("a", "b"), 0.05),),
        contacts=tuple(
            Contact(f"{left}-{right}", left, right, gap, restitution)
            for left, right in pairwise((BARRIER, "a", "b", "c", BARRIER))
        ),
        motion=motion,
    )


def _moved(motion: GroundMotion) -> Scene:
    """The row between two supports, a force on one body; it begins and ends at rest."""
    row = _row(motion, 0.0, 0.02)
    own = Support("right", motion=Cosine(0.5, 1.0))
    left, *inner, right = row.contacts
    ends = replace(left, left="left", gap=0.5), replace(right, right="right", gap=0.5)
    return replace(
        row,
        contacts=(*inner, *ends),
        supports=(Support("left", delay=0.3), own),
        forces=(Force("b", Constant(0.2)),),
    )


def _remembering(scene: Scene) -> Scene:
    """The scene with springs whose memory is more than Bouc-Wen's in the place of three."""
    laws: dict[str, Law] = {
        "sa": Backfill(2.0, 0.3, 0.7, 0.01),
        "sb": DegradingBoucWen(1.0, 0.3, 0.05),
        "ab": Slider(0.5, 0.2),
    }
    springs = (replace(s, law=laws.get(s.name, s.law)) for s in scene.springs)
    return replace(scene, springs=tuple(springs))


def _with_laws(scene: Scene) -> Scene:
    """The scene with a law of its own for each contact, as many as there are."""
    laws = (
        (ContactLaw("kelvin-voigt", 1e3), 0.5),
        (ContactLaw("kelvin-voigt", 1e3, tension=False), 0.5),
        (ContactLaw("jankowski", 1e3), 0.5),
        (ContactLaw("hertz", 1e3), None),
    )
    pairs = zip(scene.contacts, laws, strict=False)
    contacts = (replace(contact, law=law, restitution=e) for contact, (law, e) in pairs)
    return replace(scene, contacts=tuple(contacts))


def _at_points(scene: Scene) -> Scene:
    """The scene with contacts at points halfway between each body and the ground."""
    halves = {BARRIER: BARRIER} | {b.name: Point({GROUND: 0.5, b.name: 0.5}) for b in scene.bodies}
    ends = [(halves[str(c.left)], halves[str(c.right)]) for c in scene.contacts]
    contacts = [replace(c, left=a, right=b) for c, (a, b) in zip(scene.contacts, ends, strict=True)]
    return replace(scene, contacts=tuple(contacts))


def _free() -> Scene:
    """Two bodies that fall together, without a spring: accumulation and rest."""
    return Scene(
        bodies=(Body("a", 1.0, velocity=0.5), Body("b", 2.0, velocity=-0.5)),
        contacts=(Contact("joint", "a", "b", 0.1, 0.5), Contact("stop", "b", BARRIER, 0.1, 0.5)),
        motion=Cosine(1.0, 2.0),
    )


def _rubbing(impact_law: str) -> Scene:
    """A skew deck that strikes a rough wall, is pressed to it, and slides along it and sticks."""
    deck = Deck("deck", 1.0, 2.0, 1.0, 0.3)
    bodies = deck.bodies()
    return Scene(
        bodies,
        [Spring(body.name, (GROUND, body.name), Linear(2.0)) for body in bodies],
        contacts=Joint("edge", ("deck", BARRIER), 0.02, 0.3, 0.3).contacts({"deck": deck}),
        motion=Cosine(1.0, 2.0),
        forces=[Force("deck.x", Constant(0.5))],
        decks=[deck],
        across=Ricker(1.0, 1.0, center=2.0),
        impact_law=impact_law,
    )


def _run(solver: str, scene: Scene, energy: bool = False, events: str | None = None) -> None:
    settings: dict[str, object] = {"time_step": 0.01} if solver in _FIXED_STEP else {}
    if events is not None:
        settings["events"] = events
    most = None if solver in _FIXED_STEP else 20_000
    # What cannot be computed has been compiled all the same.
    with contextlib.suppress(ComputationError):
        response_of(
            scene, solver, 1e-6, duration=3.0, energy=energy, settings=settings, max_steps=most
        )


def _one(solver: str) -> None:
    for motion in _motions():
        _run(solver, _one_body(motion, 0.5))
        for energy in (False, True):
            _run(solver, _one_body(motion, 0.0, 0.0), energy=energy)


def _several(solver: str) -> None:
    for motion in _motions():
        for gap in (0.0, 0.02):
            _run(solver, _row(motion, 0.0, gap), energy=gap > 0.0)
            _run(solver, _row(motion, 0.6, gap))
        if takes_loads(solver_named(solver), _moved(motion)):
            _run(solver, _moved(motion), energy=True)
        between = _at_points(_row(motion, 0.0, 0.02))
        if knows_scene(solver_named(solver), between):
            _run(solver, between, energy=True)
    _run(solver, _free())
    for gap in (0.0, 0.02):
        elements = _with_laws(_row(_record(), 0.5, gap))
        if knows_scene(solver_named(solver), elements):
            _run(solver, elements, energy=True)
    for rubbing in map(_rubbing, IMPACT_LAWS):
        if knows_scene(solver_named(solver), rubbing):
            _run(solver, rubbing, energy=True)


def _many(scene: Scene) -> None:
    key = f"contact.{scene.contacts[0].name}.gap"
    simulate_many(scene, {key: np.array([0.05, 0.06])}, rtol=1e-4, workers=1, accelerations=True)


def _fast_of_several(solver: str) -> None:
    _several(solver)
    _run(solver, _remembering(_row(_record(), 0.0, 0.02)), energy=True)
    _many(_row(_record(), 0.5, 0.02))


def _fast_of_one(solver: str) -> None:
    _one(solver)
    _many(_one_body(_record(), 0.5))


def _event_driven(solver: str) -> None:
    _one(solver)
    _several(solver)
    for events in EVENTS:
        _run(solver, _one_body(_record(), 0.5), events=events)


class _Job(NamedTuple):
    """What is done in one process, whose kernels share their parts.

    seconds: what each of its solvers takes (s). work: done for each that is asked for.
    """

    seconds: dict[str, float]
    work: Callable[[str], None]


_JOBS = {
    "cvode, ida": _Job({"cvode": 35.0, "ida": 25.0}, _event_driven),
    "fast, several bodies": _Job({"fast": 36.0}, _fast_of_several),
    "fast, one body": _Job({"fast": 15.0}, _fast_of_one),
    "moreau": _Job({"moreau": 10.0}, _several),
    "penalty": _Job({"penalty": 10.0}, _several),
}
"""Those that take long come first. What instants demand is the same for `cvode` and `ida`."""
SOLVERS = (*_EVENT_DRIVEN, *_FIXED_STEP)
"""Those that compile anything."""


def compile_kernels(
    solvers: Sequence[str] = SOLVERS,
    processes: int | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> None:
    """Compile all kernels of some solvers, where they are not kept already.

    Parameters
    ----------
    solvers : sequence of str
        Names, of `SOLVERS`.
    processes : int, optional
        How many compile side by side; as many as there are cores.
    progress : callable, optional
        Called with the share of the work that is done, and what was done last.
    """
    asked = {name: [each for each in job.seconds if each in solvers] for name, job in _JOBS.items()}
    lengths = {name: sum(_JOBS[name].seconds[each] for each in asked[name]) for name in asked}
    jobs = [name for name in asked if asked[name]]
    workers = min(processes or cores(), len(jobs))
    whole, done = sum(lengths.values()), 0.0
    if progress is not None:
        progress(0.0, "")
    # A process that was forked from one with threads may hang.
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        waiting: dict[Future[Any], str] = {
            pool.submit(_do, name, asked[name]): name for name in jobs
        }
        try:
            for future in as_completed(waiting):
                future.result()
                name = waiting[future]
                done += lengths[name]
                if progress is not None:
                    progress(done / whole, name)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _do(name: str, solvers: Sequence[str]) -> None:
    for solver in solvers:
        _JOBS[name].work(solver)
