"""Whether a scene can be computed: every problem it has, found together."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from eventpound.basics.given import numbers_of
from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.scene.at_rest import stiffness_of
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.contact_law import BY_WORD, IMPACT_LAWS, NEWTON, ContactLaw, Element
from eventpound.scene.end_check import end_problems, plan_problems
from eventpound.scene.ends import opening
from eventpound.scene.grounded import grounded
from eventpound.scene.linkage import starts_of_supports
from eventpound.scene.periods import joined
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.problem import Part, Problem, some_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import (
    GROUND,
    BoucWen,
    DegradingBoucWen,
    Law,
    Linear,
    Series,
    Slider,
    Spring,
)
from eventpound.scene.stability import unstable
from eventpound.tolerances import EPS, PENETRATED

_SEPARATORS = frozenset(',;"')


def check_scene(scene: Scene, start: float | None = 0.0) -> None:
    """Refuse a scene that cannot be computed.

    Parameters
    ----------
    scene : Scene
        Built in Python or read from a case.
    start : float, optional
        When the run starts (s): supports may have gone apart before. None where bodies are yet to
        be placed: their contacts may be penetrated.

    Raises
    ------
    InputError
        With one line for every problem, such as a negative mass, a contact
        that names no body, a coefficient of restitution outside 0 to 1 or a
        contact that is penetrated at the start.
    """
    problems = scene_problems(scene, start)
    if problems:
        raise InputError([str(problem) for problem in problems])


def scene_problems(scene: Scene, start: float | None = 0.0) -> list[Problem]:
    """All problems, of bodies, decks, springs and whatever else a scene has."""
    springs = [*_spring_problems(scene)]
    return [
        *_body_problems(scene),
        *_deck_problems(scene),
        *(springs or _stability_problems(scene, start or 0.0)),
        *_dashpot_problems(scene),
        *_contact_problems(scene, start),
        *_impact_law_problems(scene),
        *motion_problems(scene.motion),
        *motion_problems(scene.across),
        *_support_problems(scene),
        *_force_problems(scene),
        *_seat_problems(scene),
    ]


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """What is computed as it is asked for, but hardly meant so."""
    return tuple(
        f"spring {position} ({spring.name}): gamma = {spring.law.gamma!r} is less than "
        f"|beta| = {abs(spring.law.beta)!r}: the law creates energy on part of its loop"
        for position, spring in enumerate(scene.springs, 1)
        if isinstance(spring.law, BoucWen) and spring.law.gamma < abs(spring.law.beta)
    )


TOGETHER = ("exponent", "beta", "gamma", "initial_z", "gap", "initial_gap")
"""Numbers of a spring that are accepted only beside its others: z in its bound, wider gaps."""


def _name_problems(elements: Iterable[Part]) -> Iterator[Problem]:
    positions: dict[str, int] = {}
    for element in elements:
        name = element.name
        if not name or not name.isprintable() or not _SEPARATORS.isdisjoint(name):
            yield element.problem("name", name, "some text without comma, semicolon or quote")
        elif name in (GROUND, BARRIER):
            yield element.problem("name", name, f"any name but {GROUND!r} and {BARRIER!r}")
        elif name in positions:
            yield element.problem(
                "name", name, f"a name of its own ({element.kind} {positions[name]} has this one)"
            )
        positions.setdefault(name, element.position)


def _body_problems(scene: Scene) -> Iterator[Problem]:
    elements = [Part("body", i, body.name) for i, body in enumerate(scene.bodies, 1)]
    if not elements:
        yield Problem("body", 1, "", "name", None, "at least one body")
    yield from _name_problems(elements)
    for element, body in zip(elements, scene.bodies, strict=True):
        yield from element.numbers(body)


def _deck_problems(scene: Scene) -> Iterator[Problem]:
    elements = [Part("deck", i, deck.name) for i, deck in enumerate(scene.decks, 1)]
    yield from _name_problems(elements)
    for element, deck in zip(elements, scene.decks, strict=True):
        yield from element.numbers(deck)
    yield from plan_problems(scene)


def _spring_problems(scene: Scene) -> Iterator[Problem]:
    elements = [Part("spring", i, spring.name) for i, spring in enumerate(scene.springs, 1)]
    yield from _name_problems(elements)
    for element, spring in zip(elements, scene.springs, strict=True):
        yield from end_problems(element, spring.sides, scene, GROUND)
        yield from _law_problems(element, spring.law)
        yield from element.numbers(spring)
        if spring.weight is not None:
            yield from _weight_problems(element, spring)


def _weight_problems(element: Part, spring: Spring) -> Iterator[Problem]:
    """What P-Delta needs beside a weight."""
    if spring.height is None:
        yield element.problem("height", None, "the height of a storey (m), beside its weight")
    if not isinstance(spring.law, Linear | BoucWen):
        accepted = "none beside this law; P-Delta is of linear and Bouc-Wen springs"
        yield element.problem("weight", spring.weight, accepted)


def _stability_problems(scene: Scene, start: float) -> Iterator[Problem]:
    """A spring by which a scene gives way at rest."""
    gives = unstable(scene, start)
    if gives is None:
        return
    spring = scene.springs[gives.spring]
    element = Part("spring", gives.spring + 1, spring.name)
    if spring.weight is None:
        found = stiffness_of(spring)
        accepted = f"stiffnesses with which the structure stands at rest; {gives.moves}"
        yield element.problem("stiffness", found, accepted)
        return
    most = stiffness_of(replace(spring, weight=None)) * (spring.height or math.nan)
    alone = f" (below k h = {most:.6g} N)" if spring.weight >= most > 0.0 else ""
    accepted = (
        f"a weight{alone} under which the structure stands at rest; with P-Delta {gives.moves}"
    )
    yield element.problem("weight", spring.weight, accepted)


def _seat_problems(scene: Scene) -> Iterator[Problem]:
    elements = [Part("seat", i, seat.name) for i, seat in enumerate(scene.seats, 1)]
    yield from _name_problems(elements)
    for element, seat in zip(elements, scene.seats, strict=True):
        yield from end_problems(element, seat.between, scene, GROUND)


def _law_problems(element: Part, law: Law) -> Iterator[Problem]:
    if isinstance(law, Series):
        if not law.parts:
            yield element.problem("parts", [], "at least one part")
        for number, part in enumerate(law.parts, 1):
            yield from element.numbers(part, f"parts {number}: ")
        return
    found = [*element.numbers(law)]
    if isinstance(law, BoucWen) and not any(problem.key in TOGETHER for problem in found):
        # A bound reached to rounding is a spring that has yielded.
        bound = law.bound
        accepted = f"a number of at most (beta + gamma)^(-1/exponent) = {bound:.6g} in size"
        most = bound * (1.0 + 4.0 * math.ulp(1.0))
        found += element.number("initial_z", law.initial_z, accepted, lambda z: abs(z) <= most)
        found.sort(key=lambda problem: [*numbers_of(type(law))].index(problem.key))
    yield from found
    if isinstance(law, DegradingBoucWen):
        # Else epsilon could fall, and nu and eta with it.
        accepted = "|beta| <= gamma of a law that degrades"
        yield from element.number("beta", law.beta, accepted, lambda beta: abs(beta) <= law.gamma)


def _dashpot_problems(scene: Scene) -> Iterator[Problem]:
    found = list[Problem]()
    for position, dashpot in enumerate(scene.dashpots, 1):
        element = Part("dashpot", position, "")
        found += end_problems(element, dashpot.sides, scene, GROUND)
        found += element.numbers(dashpot)
    yield from found
    negative = [i for i, d in enumerate(scene.dashpots) if d.coefficient < 0.0]
    if negative and not found and not _dissipates(scene):
        accepted = (
            "a coefficient >= 0 (N s/m); a negative one only where all dashpots together never "
            "drive a motion"
        )
        first = scene.dashpots[negative[0]].coefficient
        yield Part("dashpot", negative[0] + 1, "").problem("coefficient", first, accepted)


def _dissipates(scene: Scene) -> bool:
    """Whether the damping matrix is positive semidefinite, but for rounding."""
    links = [(d.direction, d.coefficient) for d in grounded(scene).dashpots]
    matrix = joined([body.name for body in scene.bodies], links)
    values = np.linalg.eigvalsh(matrix)
    return bool(values[0] >= -values.size * EPS * values[-1])


def _support_problems(scene: Scene) -> Iterator[Problem]:
    elements = [Part("support", i, s.name) for i, s in enumerate(scene.supports, 1)]
    yield from _name_problems(elements)
    bodies = {body.name for body in scene.bodies}
    for element, support in zip(elements, scene.supports, strict=True):
        if support.name in bodies:
            yield element.problem("name", support.name, "a name that no body has")
        if (support.delay is None) == (support.motion is None):
            found = "neither" if support.delay is None else "both"
            yield element.problem("delay", found, "one of delay and excitation")
        yield from element.numbers(support)
        if support.motion is not None:
            for problem in motion_problems(support.motion):
                yield element.problem("excitation", problem.found, problem.accepted)


def _force_problems(scene: Scene) -> Iterator[Problem]:
    names = [body.name for body in scene.bodies]
    for position, force in enumerate(scene.forces, 1):
        element = Part("force", position, force.body)
        if force.body not in names:
            yield element.problem("body", force.body, f"one of {some_of(names)}")
        for problem in motion_problems(force.history):
            yield element.problem("value", problem.found, problem.accepted)


def _overlaps(scene: Scene, start: float) -> dict[int, float]:
    """Openings of the contacts that are penetrated as a run starts (m), by their places."""
    displacements = {body.name: body.displacement for body in scene.bodies}
    displacements |= {BARRIER: 0.0, GROUND: 0.0, **starts_of_supports(scene, start)}
    # Bodies at rest on each other stand at sums of the coordinates and gaps of their row.
    largest = max((abs(contact.gap) for contact in scene.contacts), default=0.0)
    largest += 2.0 * max(map(abs, displacements.values()))
    rounding = 4.0 * math.ulp(1.0) * largest + PENETRATED * _scale_of_motions(scene)
    found = {}
    for i, contact in enumerate(scene.contacts):
        gap = float(opening(contact, contact.gap, displacements))
        if contact.law is None and gap < -rounding:
            found[i] = gap
    return found


def _scale_of_motions(scene: Scene) -> float:
    """Length of which what a motion left, or the way of a support in a tail, is rounding (m)."""
    scales = [motion.scales() for motion in scene.motions]
    return max((each.length for each in scales if each is not None), default=0.0)


def _contact_problems(scene: Scene, start: float | None) -> Iterator[Problem]:
    elements = [Part("contact", i, c.name) for i, c in enumerate(scene.contacts, 1)]
    yield from _name_problems(elements)
    penetrated = {} if start is None else _overlaps(scene, start)
    for i, (element, contact) in enumerate(zip(elements, scene.contacts, strict=True)):
        yield from end_problems(element, contact.sides, scene, BARRIER)
        if contact.at_point and contact.law is not None:
            accepted = f"{NEWTON} alone for a contact at a point between bodies"
            yield element.problem("law", contact.law.kind, accepted)
        if contact.law is None:
            yield from _restitution(element, contact)
        else:
            yield from _contact_law_problems(element, contact, contact.law)
        yield from element.numbers(contact)
        if contact.friction > 0.0:
            yield from _friction_problems(element, contact, scene)
        if i in penetrated:
            accepted = (
                "a gap that is not penetrated at the start; with the initial displacements it "
                f"is {penetrated[i]:.6g} m open"
            )
            yield element.problem("gap", contact.gap, accepted)


def _friction_problems(element: Part, contact: Contact, scene: Scene) -> Iterator[Problem]:
    """What friction at a contact asks for."""
    if not all(isinstance(end, PlanPoint) or end == BARRIER for end in contact.sides):
        accepted = "0 but between places of decks in plan: nothing else slides along a contact"
        yield element.problem("friction", contact.friction, accepted)
    laws = [repr(c.name) for c in scene.contacts if c.law is not None]
    if laws:
        accepted = f"0 beside a law of contact ({', '.join(laws)}); friction is of {NEWTON}'s law"
        yield element.problem("friction", contact.friction, accepted)
    sliders = [repr(s.name) for s in scene.springs if isinstance(s.law, Slider)]
    if sliders:
        accepted = f"0 beside sliders ({', '.join(sliders)})"
        yield element.problem("friction", contact.friction, accepted)


def _impact_law_problems(scene: Scene) -> Iterator[Problem]:
    element, law = Part("scene", 1, ""), scene.impact_law
    if law not in IMPACT_LAWS:
        yield element.problem("impact_law", law, f"one of {', '.join(IMPACT_LAWS)}")
    elif law != NEWTON and scene.contacts and not scene.rubbing:
        yield element.problem("impact_law", law, f"{NEWTON} where no contact has friction")


def _restitution(element: Part, contact: Contact) -> Iterator[Problem]:
    return element.number(
        "restitution", contact.restitution, "a number from 0 to 1", lambda e: 0.0 <= e <= 1.0
    )


def _contact_law_problems(element: Part, contact: Contact, law: ContactLaw) -> Iterator[Problem]:
    """What is wrong with a contact element."""
    kind = BY_WORD.get(law.kind)
    if kind is None:
        yield element.problem("law", law.kind, f"one of {NEWTON}, {', '.join(BY_WORD)}")
        return
    accepted = f"a stiffness > 0 ({kind.dimension.unit})"
    yield from element.number("stiffness", law.stiffness, accepted, lambda k: k > 0.0)
    if not law.tension and kind is not Element.KELVIN_VOIGT:
        yield element.problem("tension", law.tension, "none: only kelvin-voigt has it")
    given = {"restitution": contact.restitution, "damping": law.damping}
    if not kind.damped:
        for key, value in given.items():
            if value is not None:
                yield element.problem(key, value, f"none: {kind.word} loses no energy")
        return
    if (contact.restitution is None) == (law.damping is None):
        wanted = f"one of restitution and damping ({kind.symbol}), and not both"
        yield element.problem("restitution", contact.restitution, wanted)
    elif law.damping is not None:
        accepted = f"a number >= 0 ({kind.symbol})"
        yield from element.number("damping", law.damping, accepted, lambda x: x >= 0.0)
    elif kind is Element.JANKOWSKI and contact.restitution == 0.0:
        accepted = f"a number above 0, to 1: the {kind.symbol} of jankowski divides by it"
        yield element.problem("restitution", contact.restitution, accepted)
    else:
        yield from _restitution(element, contact)


def motion_problems(motion: GroundMotion) -> Iterator[Problem]:
    """Problems of a ground motion that it does not refuse itself."""
    with np.errstate(all="ignore"):
        pieces = motion.pieces()
    for piece in pieces:
        numbers = piece.coefficients, piece.samples
        if not all(np.isfinite(each).all() for each in numbers if each.size > 0):
            found = "an acceleration that is not finite"
            yield Problem("excitation", 1, motion.kind, "values", found, "finite numbers")
