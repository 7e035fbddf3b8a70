"""What is possible in a scene but hardly meant: slips of a unit or of a factor.

The limits are wide: what real bridges, buildings and records have lies within them. Nothing
is refused here. A scene in Π-terms has no sizes that could be doubted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.motion.intensity import peak_displacement, peak_velocity
from eventpound.motion.plausible import LENGTH, PEAK, PERIOD, PGD, PGV, STEP
from eventpound.motion.record import Record
from eventpound.scene.at_rest import at_rest, stiffness_of, theta_at_rest
from eventpound.scene.damping import ratio_coefficient
from eventpound.scene.grounded import grounded
from eventpound.scene.periods import local_periods, longest_period
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Backfill, BoucWen, Slider
from eventpound.scene.structures import isolated, joined_groups, of_frames, structures_of
from eventpound.scene.support import Support
from eventpound.units import STANDARD_GRAVITY

LARGEST_RATIO = 0.3
"""Of critical damping."""
LIKE_G = 0.05, 1.0
"""Numbers without a unit, so in m/s^2, that are weak motions, and usual ones in g."""
LARGEST_YIELD_FORCE = 2.0
"""As a part of the weight of everything that springs join to it."""
LARGEST_STRENGTH = 5.0
"""Q over mass and peak ground acceleration, Pi_Q."""
LEAST_LOAD, LARGEST_LOAD = 0.5, 5.0
"""Normal forces of sliders over the weight that nothing else holds: it may carry more."""
LARGEST_THETA = 0.3
"""Stability coefficient of a storey (EN 1998-1, 4.4.2.2)."""
LARGEST_YIELD_DISPLACEMENT, LARGEST_GAP = 0.5, 1.0
"""(m)"""
ROWS_A_PERIOD = 10.0
"""Rows of a history in the shortest period."""
_MOST_BODIES = 300
"""Of a scene whose periods are looked for: their cost grows with the third power."""

Doubt = tuple[str, str]
"""Which kind of doubt it is, and the sentence."""


def doubts(
    scene: Scene,
    run: Mapping[str, float] | None = None,
    ratios: Sequence[tuple[str, float]] = (),
    bare: Sequence[tuple[str, float]] = (),
    start: float = 0.0,
) -> list[str]:
    """Sentences on what is hardly meant, one for each kind of doubt.

    Parameters
    ----------
    scene : Scene
        Without problems.
    run : mapping of str to float, optional
        Numbers that somebody chose for ``[run]``, by their keys (SI).
    ratios : sequence of tuple of str and float
        Damping ratios that were given, and what each stands in.
    bare : sequence of tuple of str and float
        Keys and numbers of accelerations of the ground that were given without a unit (m/s^2).
    start : float
        When the run starts (s).

    Returns
    -------
    list of str
        The first of a kind stands for the others, which it counts.
    """
    kinds: dict[str, list[str]] = {}
    supports, standing = scene.supports, grounded(at_rest(scene, start))
    scene = grounded(scene)
    found: Iterable[Doubt] = (
        *_unit_doubts(bare),
        *_motion_doubts("excitation", scene.motion),
        *_motion_doubts("across", scene.across),
        *_support_doubts(supports),
        *_spring_doubts(scene),
        *_storey_doubts(scene),
        *_load_doubts(scene),
        *(_ratio_doubts(ratios) or _damping_doubts(standing)),
        *_isolation_doubts(scene),
        *_period_doubts(standing, (run or {}).get("output_step")),
        *_gap_doubts(scene),
    )
    for kind, text in found:
        kinds.setdefault(kind, []).append(text)
    return [
        first + (f" (and {len(others)} more like it)" if others else "")
        for first, *others in kinds.values()
    ]


def _unit_doubts(bare: Sequence[tuple[str, float]]) -> Iterator[Doubt]:
    low, high = LIKE_G
    for key, value in bare:
        if low <= value < high:
            yield (
                "forgotten g",
                f"{key} = {value!r} has no unit and is in m/s^2, {value / STANDARD_GRAVITY:.2g} g; "
                f'write "{value!r} g" or "{value!r} m/s^2"',
            )


def _motion_doubts(where: str, motion: GroundMotion) -> Iterator[Doubt]:
    for kind, text in motion_doubts(motion):
        yield kind, f"{where}: {text}"


def _support_doubts(supports: Iterable[Support]) -> Iterator[Doubt]:
    for support in supports:
        if support.motion is not None:
            yield from _motion_doubts(f"support '{support.name}'", support.motion)


def motion_doubts(motion: GroundMotion) -> Iterator[Doubt]:
    """What is hardly meant of a ground motion by itself.

    Parameters
    ----------
    motion : GroundMotion
        As it is scaled.
    """
    scales = motion.scales()
    if scales is not None:
        peak = scales.a_g / STANDARD_GRAVITY
        if peak not in PEAK:
            yield "peak", f"a peak of {scales.a_g:.4g} m/s^2 is {peak:.3g} g; {PEAK.usual}"
        if text := PERIOD.doubt(scales.period):
            yield "motion's period", text
    if isinstance(motion, Record):
        sampled = [(STEP, motion.time_step)]
        sampled += [(PGV, peak_velocity(motion)), (PGD, peak_displacement(motion))]
        if not motion.begins.size:
            sampled.append((LENGTH, motion.end - motion.start))
        for usual, value in sampled:
            if text := usual.doubt(value):
                yield usual.what, text


def _spring_doubts(scene: Scene) -> Iterator[Doubt]:
    scales, masses = scene.motion.scales(), _masses_joined(scene)
    for spring in scene.springs:
        law = spring.law
        if not isinstance(law, BoucWen):
            continue
        mass = max(masses.get(end, 0.0) for end in spring.ends)
        yield_force = law.yield_force
        part = yield_force / (mass * STANDARD_GRAVITY)
        if part > LARGEST_YIELD_FORCE:
            yield (
                "yield force",
                f"spring '{spring.name}': a yield force of {yield_force:.4g} N is {part:.3g} times "
                f"the weight of {mass:.4g} kg; usual is up to {LARGEST_YIELD_FORCE:g}",
            )
        elif scales is not None and law.strength > LARGEST_STRENGTH * mass * scales.a_g:
            share = law.strength / (mass * scales.a_g)
            yield (
                "strength",
                f"spring '{spring.name}': a strength of {law.strength:.4g} N is {share:.3g} times "
                f"mass x peak ground acceleration; above {LARGEST_STRENGTH:g} it hardly yields",
            )
        if law.yield_displacement > LARGEST_YIELD_DISPLACEMENT:
            yield (
                "yield displacement",
                f"spring '{spring.name}': a yield displacement of {law.yield_displacement:.4g} m; "
                f"usual is up to {LARGEST_YIELD_DISPLACEMENT:g} m",
            )


def _storey_doubts(scene: Scene) -> Iterator[Doubt]:
    """Storeys that P-Delta softens much, or after yield altogether."""
    for spring in scene.springs:
        theta = theta_at_rest(spring)
        if theta is None:
            continue
        if theta > LARGEST_THETA:
            yield (
                "P-Delta",
                f"spring '{spring.name}': P-Delta takes {theta:.3g} of its "
                f"stiffness (theta = P/(k h)); Eurocode 8 accepts up to {LARGEST_THETA:g}",
            )
        if (after := stiffness_of(spring, yielded=True)) < 0.0 < stiffness_of(spring):
            yield (
                "P-Delta after yield",
                f"spring '{spring.name}': after yield P-Delta leaves it {after:.4g} N/m: the "
                "storey leans on, and may not come back",
            )


def _load_doubts(scene: Scene) -> Iterator[Doubt]:
    """Loads of sliders, where bodies stand on them and on nothing else."""
    names = [GROUND, *(body.name for body in scene.bodies)]
    bearings = [
        ({*spring.ends}, law.normal_force)
        for spring in scene.springs
        if isinstance(law := spring.law, Slider)
    ]
    beside = [s.ends for s in scene.springs if not isinstance(s.law, Slider | Backfill)]
    for group in joined_groups(names, beside):
        under = [force for ends, force in bearings if len(ends.intersection(group)) == 1]
        if GROUND in group or not under:
            continue
        mass = sum(body.mass for body in scene.bodies if body.name in group)
        part = sum(under) / (mass * STANDARD_GRAVITY)
        if not LEAST_LOAD <= part <= LARGEST_LOAD:
            usual = f"usual are {LEAST_LOAD:g} to {LARGEST_LOAD:g}"
            carried = f"on sliders with normal forces of {part:.3g} times its weight"
            yield "normal force", f"body '{group[0]}': stands {carried}; {usual}"


def _ratio_doubts(ratios: Sequence[tuple[str, float]]) -> list[Doubt]:
    return [
        (
            "damping",
            f"{where}: ratio = {ratio:.4g} is {100.0 * ratio:.4g} % of critical damping; usual is "
            f'up to {100.0 * LARGEST_RATIO:g} % (5 % is 0.05 or "5 %")',
        )
        for where, ratio in ratios
        if ratio > LARGEST_RATIO
    ]


def _damping_doubts(scene: Scene) -> Iterator[Doubt]:
    """Bodies overdamped by their dashpots together, while all other bodies are held."""
    damped = dict.fromkeys((body.name for body in scene.bodies), 0.0)
    held = dict(damped)
    for dashpot in scene.dashpots:
        for end, weight in dashpot.direction:
            if end != GROUND:
                damped[end] += weight**2 * dashpot.coefficient
    for spring in scene.springs:
        for end, weight in spring.direction:
            if end != GROUND:
                held[end] += weight**2 * stiffness_of(spring)
    for body in (body for body in scene.bodies if body.name not in of_frames(scene)):
        critical = ratio_coefficient(1.0, max(held[body.name], 0.0), body.mass)
        if damped[body.name] > critical > 0.0:
            yield (
                "damping",
                f"body '{body.name}': its dashpots are {damped[body.name] / critical:.3g} times "
                f"critical; usual is a ratio up to {LARGEST_RATIO:g}",
            )


def _isolation_doubts(scene: Scene) -> Iterator[Doubt]:
    """Bodies above isolators that a dashpot joins to the ground and no spring does."""
    damped = {end for d in scene.dashpots if GROUND in d.ends for end in d.ends}
    past = damped - {end for s in scene.springs if GROUND in s.ends for end in s.ends}
    for name in sorted(past & isolated(scene)) if past else ():
        yield (
            "isolation",
            f"body '{name}': a dashpot joins it to the ground past the springs that yield below "
            "it: it damps the isolated mode, which no storey does; usual are dashpots beside "
            "the storeys ([[rayleigh]] springs, or [[modal_damping]] on a base)",
        )


def _period_doubts(scene: Scene, step: float | None) -> Iterator[Doubt]:
    frames = of_frames(scene)
    shortest = {name: T for name, T in local_periods(scene).items() if name not in frames}
    for name, period in shortest.items():
        if period < PERIOD.least:
            yield (
                "short period",
                f"body '{name}': a period of {period:.3g} s on its springs; {PERIOD.usual}",
            )
    if len(scene.bodies) <= _MOST_BODIES:
        try:
            longest = longest_period(scene)
        except InputError:
            longest = None
        if longest is not None and longest > PERIOD.most:
            yield "long period", PERIOD.doubt(longest)
    least = min(shortest.values(), default=0.0)
    if step is not None and step > least / ROWS_A_PERIOD:
        yield (
            "output step",
            f"run: an output_step of {step:.3g} s leaves fewer than {ROWS_A_PERIOD:g} rows "
            f"of the history to the shortest period, {least:.3g} s (peaks and events are exact "
            "all the same)",
        )


def _gap_doubts(scene: Scene) -> Iterator[Doubt]:
    for contact in scene.contacts:
        if contact.gap > LARGEST_GAP:
            yield (
                "gap",
                f"contact '{contact.name}': a gap of {contact.gap:.4g} m; "
                f"usual is up to {LARGEST_GAP:g} m",
            )


def _masses_joined(scene: Scene) -> Mapping[str, float]:
    """Mass (kg) of the whole structure that each body is part of, by the names of the bodies."""
    mass = {body.name: body.mass for body in scene.bodies}
    return {
        name: sum(mass[other] for other in group)
        for group in structures_of(scene)
        for name in group
    }
