"""Usual sizes of every number of a scene and its run: one table, each row with its reason.

What lies outside is possible and is computed, with a warning. Zero is never doubted: it says that
there is none. Periods, ground motions and what must fit together stand in
`eventpound.scene.plausibility`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from eventpound.basics.given import numbers_of
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.grounded import grounded
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Backfill, BilinearElastic, Law, Series, Slider
from eventpound.scene.structures import structures_of
from eventpound.units import STANDARD_GRAVITY, Dimension


class Usual(NamedTuple):
    """From where to where a size is usual (SI), its unit, and why."""

    least: float
    most: float
    unit: str
    why: str


SMALLEST_RATIO = 1e-3
"""Of critical damping, where there is some."""
USUAL: Mapping[str, Usual] = {
    "body.mass": Usual(1e-3, 1e9, "kg", "a model on a small shaking table to the longest deck"),
    "body.displacement": Usual(0.0, 5.0, "m", "structures fall before"),
    "body.velocity": Usual(0.0, 20.0, "m/s", "the ground moves at up to 3 m/s"),
    "spring.height": Usual(0.3, 30.0, "m", "of a storey, perhaps of a model"),
    "spring.offset": Usual(1e-5, 2.0, "m", "slack of a cable, opening of a stop"),
    "spring.yield_displacement": Usual(1e-6, math.inf, "m", "bearings slip after a millimetre"),
    "spring.exponent": Usual(1.0, 200.0, "", "from 20 on the knee is sharp"),
    "spring.beta": Usual(1e-3, 10.0, "", "beta + gamma is 1 where z ends at 1"),
    "spring.gamma": Usual(1e-3, 10.0, "", "beta + gamma is 1 where z ends at 1"),
    "spring.strength_degradation": Usual(1e-6, 2.0, "", "tests of members gave 0 to 0.3"),
    "spring.stiffness_degradation": Usual(1e-6, 2.0, "", "tests of members gave 0 to 0.3"),
    "spring.initial_loss": Usual(1e-3, 1e4, "Q u_y", "a hundred large cycles"),
    "spring.failure_ratio": Usual(0.3, 1.0, "", "soils have 0.7 to 0.98"),
    "spring.gap": Usual(1e-5, 2.0, "m", "an expansion joint"),
    "spring.initial_gap": Usual(1e-5, 2.0, "m", "an expansion joint, pushed wider"),
    "spring.friction": Usual(1e-3, 1.5, "", "PTFE has 0.02 to 0.15, rubber on concrete 1"),
    "spring.radius": Usual(0.1, 100.0, "m", "of a pendulum; N over its stiffness"),
    "spring.ultimate_force / initial_stiffness": Usual(
        1e-4, 2.0, "m", "soil yields within centimetres"
    ),
    "spring.wall_width": Usual(1.0, 100.0, "m", "of an abutment"),
    "contact.gap": Usual(1e-5, math.inf, "m", "nobody builds an opening to 0.01 mm"),
    "contact.damping": Usual(1e-3, 10.0, "", "1 is critical for kelvin-voigt"),
    "support.delay": Usual(1e-4, 30.0, "s", "waves of 100 m/s along a bridge of 3 km"),
    "damping.ratio": Usual(SMALLEST_RATIO, math.inf, "", "5 % is 0.05"),
    "excitation.start": Usual(1e-6, 1e4, "s", "a motion lasts seconds to minutes"),
    "excitation.center": Usual(1e-6, 1e4, "s", "a motion lasts seconds to minutes"),
    "excitation.phase": Usual(0.0, 4.0 * math.pi, "rad", "2 pi is a whole turn"),
    "excitation.gamma": Usual(1.0, 15.0, "", "pulses of records have 1 to 5"),
    "excitation.cycles": Usual(0.1, 1000.0, "", "a motion lasts seconds to minutes"),
    "excitation.psa_damping": Usual(1e-3, 0.3, "", "5 % is 0.05"),
    "force.period": Usual(1e-3, 1e3, "s", "of a shock, a machine or a train"),
    "force.start": Usual(1e-6, 1e4, "s", "a motion lasts seconds to minutes"),
    "force.phase": Usual(0.0, 4.0 * math.pi, "rad", "2 pi is a whole turn"),
    "excitation.rest": Usual(0.1, 1000.0, "s", "until a structure stands still"),
    "run.start_time": Usual(1e-6, 1e4, "s", "a motion lasts seconds to minutes"),
    "run.duration": Usual(1e-2, 1e4, "s", "a motion lasts seconds to minutes"),
    "run.threshold_speed": Usual(1e-6, 10.0, "m/s", "impacts close at up to a few m/s"),
}
"""By the kind of the element and the key."""
LEAST_OF_STIFFEST, LEAST_OF_HEAVIEST = 1e-7, 1e-6
"""Parts of the largest stiffness and mass of a scene below which others hardly count."""
FASTEST, SLOWEST = 1e-3, 2.0
"""Period of the lightest end of a spring or a contact on it alone (s); the longest of contacts."""
LEAST_FORCE, MOST_FORCE = 1e-5, 20.0
"""Forces, over the weight of the structure on which they act."""


def unusual(scene: Scene, given: Mapping[str, tuple[str, float]]) -> list[str]:
    """Sentences on sizes that are hardly meant, one a key.

    Parameters
    ----------
    scene : Scene
        Without problems.
    given : mapping of str to (str, float)
        Numbers that a case gives and no scene has, by their rows of `USUAL`: where, and SI.

    Returns
    -------
    list of str
        The first of a key stands for the others.
    """
    found: dict[str, str] = {}
    for key, where, value in (*_numbers(scene), *((k, *each) for k, each in given.items())):
        row = USUAL.get(key)
        if row and value and not row.least <= abs(value) <= row.most:
            usual = f"from {row.least:g}" + f" to {row.most:g}" * (row.most < math.inf)
            usual = f"{usual} {row.unit}".rstrip()
            said = f"{where}: {key.partition('.')[2]} = {value:.4g} {row.unit}".rstrip()
            found.setdefault(key, f"{said}; usual is {usual}: {row.why}")
    for kind, text in _beside_others(grounded(scene)):
        found.setdefault(kind, text)
    names = {end for spring in scene.springs for end in spring.ends}
    names |= {end for dashpot in scene.dashpots for end in dashpot.ends}
    names |= {end for contact in scene.contacts for end in contact.ends}
    for support in scene.supports:
        if support.name not in names:
            found.setdefault("support", f"support '{support.name}': nothing stands on it")
    return list(found.values())


def _numbers(scene: Scene) -> Iterator[tuple[str, str, float]]:
    """Rows, places and values of all numbers that a scene has."""
    parts: list[tuple[str, str, object]] = [("body", b.name, b) for b in scene.bodies]
    for spring in scene.springs:
        law = spring.law
        laws = law.parts if isinstance(law, Series) else (law,)
        parts += [("spring", spring.name, each) for each in (spring, *laws)]
        if isinstance(law, Slider) and law.stiffness:
            yield "spring.radius", f"spring '{spring.name}'", law.normal_force / law.stiffness
        if isinstance(law, Backfill):
            depth = law.ultimate_force / law.initial_stiffness
            yield "spring.ultimate_force / initial_stiffness", f"spring '{spring.name}'", depth
    for contact in scene.contacts:
        parts += [("contact", contact.name, each) for each in (contact, contact.law) if each]
    parts += [("support", support.name, support) for support in scene.supports]
    motions = [scene.motion, scene.across]
    motions += [s.motion for s in scene.supports if s.motion is not None]
    parts += [("excitation", "", motion) for motion in motions]
    parts += [("force", force.body, force.history) for force in scene.forces]
    for kind, name, part in parts:
        where = f"{kind} '{name}'" if name else kind
        for key in numbers_of(type(part)):
            if (value := getattr(part, key)) is not None:
                yield f"{kind}.{key}", where, float(value)


def _stiffest(law: Law) -> float:
    """Largest stiffness that a law can have (N/m)."""
    if isinstance(law, BilinearElastic | Series):
        whole = reduced(law)
        return max(whole.compression, whole.extension)
    return abs(float(getattr(law, "initial_stiffness", getattr(law, "stiffness", 0.0))))


def _forces(scene: Scene) -> Iterator[tuple[str, tuple[str, ...], float]]:
    """Places, bodies and sizes (N) of forces that laws and loads have."""
    for spring in scene.springs:
        for owner in (spring, spring.law):
            for key, dimension in numbers_of(type(owner)).items():
                if dimension is Dimension.FORCE:
                    size = float(getattr(owner, key) or 0.0)
                    yield f"spring '{spring.name}': {key}", spring.ends, size
    for force in scene.forces:
        history = force.history
        sizes = (getattr(history, key, None) for key in ("value", "amplitude", "peak"))
        size = next((each for each in sizes if each is not None), 0.0)
        mass = next(b.mass for b in scene.bodies if b.name == force.body)
        yield f"force on '{force.body}'", (force.body,), size * (mass if force.per_mass else 1.0)


def _beside_others(scene: Scene) -> Iterator[tuple[str, str]]:
    """Kinds and sentences on masses, stiffnesses and forces that do not go with the others."""
    mass = {body.name: body.mass for body in scene.bodies}
    heaviest = max(mass.values())
    whole = {name: sum(mass[n] for n in group) for group in structures_of(scene) for name in group}
    for name, value in mass.items():
        if value < LEAST_OF_HEAVIEST * heaviest:
            part = f"a mass of {value:.4g} kg beside one of {heaviest:.4g} kg"
            yield "lightest", f"body '{name}': {part}; usual is from {LEAST_OF_HEAVIEST:g} of it"
    pairs: list[tuple[str, tuple[str, ...], float]] = [
        (f"spring '{s.name}'", s.ends, _stiffest(s.law)) for s in scene.springs if s.frame is None
    ]
    stiffest = max((k for *_, k in pairs), default=0.0)
    pairs += [
        (f"contact '{c.name}'", c.ends, c.law.stiffness)
        for c in scene.contacts
        if c.law is not None and not c.law.element.hertzian
    ]
    for where, ends, k in pairs:
        lightest = min((mass[end] for end in ends if end in mass), default=math.inf)
        period = 2.0 * math.pi * math.sqrt(lightest / k) if k else math.nan
        slowest = SLOWEST if where.startswith("contact") else math.inf
        if period < FASTEST or period > slowest:
            swings = f"{lightest:.4g} kg on {k:.4g} N/m swing in {period:.3g} s"
            usual = f"from {FASTEST:g}" + f" to {slowest:g}" * (slowest < math.inf)
            yield "stiffness", f"{where}: {swings}; usual is {usual} s"
        if 0.0 < k < LEAST_OF_STIFFEST * stiffest:
            part = f"a stiffness of {k:.4g} N/m beside one of {stiffest:.4g} N/m"
            yield "softest", f"{where}: {part}; usual is from {LEAST_OF_STIFFEST:g} of it"
    for where, ends, force in _forces(scene):
        on = max((whole[end] for end in ends if end in whole), default=math.nan)
        share = abs(force) / (on * STANDARD_GRAVITY)
        # A larger strength is doubted by what yields.
        most = math.inf if where.endswith("strength") else MOST_FORCE
        if force and not LEAST_FORCE <= share <= most:
            size = f"{force:.4g} N is {share:.3g} times the weight of {on:.4g} kg"
            yield "force", f"{where}: {size}; usual are {LEAST_FORCE:g} to {MOST_FORCE:g}"
