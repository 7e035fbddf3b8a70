"""How much of an answer its inputs decide: the same scene with its last digits changed.

Every number of the scene that is not zero is multiplied by ``1 + η r``, r drawn
evenly from [-1, 1]. With Δ(η) the largest change of a quantity over some draws,

    amplification = Δ(η)/(η scale)       at η = 1e-10 or 1e-13, the larger one
    p = log10[Δ(1e-10)/Δ(1e-13)] / 3     1 smooth, 1/2 a graze, 0 a jump

so that rounding of the inputs, one part in 2⁵³, changes it by Δ(1e-13) (2⁻⁵³/1e-13)^p.
A contact closed at the start stays closed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from eventpound.errors import ComputationError
from eventpound.motion.base import GroundMotion
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER
from eventpound.scene.linkage import starts_of_supports
from eventpound.scene.parameters import Place, number_places, value_at, with_values
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Law

LARGE, SMALL = 1e-10, 1e-13
"""Relative changes of the inputs."""
DRAWS = 8
"""Scenes at each of them."""
ROUNDING = 2.0**-53
"""Relative rounding of an input."""


def perturbed(scene: Scene, size: float, rng: np.random.Generator) -> Scene:
    """The scene with every number changed by a relative part of itself.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    size : float
        Largest relative change, η.
    rng : Generator
        Where the changes are drawn from.
    """
    changes = {
        place: value * (1.0 + size * rng.uniform(-1.0, 1.0))
        for place, value in _measured(scene)
        if value != 0.0
    }
    changed = with_values(_other_samples(scene, size, rng), changes)
    return _admissible(scene, _otherwise_driven(changed, size, rng))


def _measured(scene: Scene) -> Iterator[tuple[Place, float]]:
    """Numbers of a scene that are measured: no counts, and no scale of a record beside a peak."""
    fixed = _counts(scene.motion)
    for place in number_places(scene).values():
        value = value_at(scene, place)
        counted = place.kind == "excitation" and place.field in fixed
        if isinstance(value, float) and not counted:
            yield place, value


def _other_samples(scene: Scene, size: float, rng: np.random.Generator) -> Scene:
    """The scene with the samples of its record, of both components, changed one by one."""

    def other(motion: GroundMotion) -> GroundMotion:
        if not isinstance(motion, Record):
            return motion
        factors = 1.0 + size * rng.uniform(-1.0, 1.0, motion.samples.size)
        return replace(motion, samples=motion.samples * factors)

    return replace(scene, motion=other(scene.motion), across=other(scene.across))


def _counts(motion: GroundMotion) -> set[str]:
    """Numbers of a motion that are not measured: counts, and a scale beside a peak."""
    fixed: set[str] = set()
    if is_dataclass(motion):
        fixed = {f.name for f in fields(motion) if "int" in str(f.type)}
    if isinstance(motion, Record) and (motion.pga, motion.psa) != (None, None):
        fixed.add("scale")
    return fixed


def _otherwise_driven(scene: Scene, size: float, rng: np.random.Generator) -> Scene:
    """The scene with own motions of supports and forces whose numbers are changed."""
    return replace(
        scene,
        supports=tuple(
            s if s.motion is None else replace(s, motion=_other_motion(s.motion, size, rng))
            for s in scene.supports
        ),
        forces=tuple(replace(f, history=_other_motion(f.history, size, rng)) for f in scene.forces),
    )


def _other_motion(motion: GroundMotion, size: float, rng: np.random.Generator) -> GroundMotion:
    """A motion with its numbers, and its samples, changed by a relative part of themselves."""
    changes: dict[str, Any] = {}
    for name in [f.name for f in fields(motion)] if is_dataclass(motion) else list[str]():
        value = getattr(motion, name)
        if isinstance(value, np.ndarray):
            changes[name] = value * (1.0 + size * rng.uniform(-1.0, 1.0, value.shape))
        elif isinstance(value, float) and name not in _counts(motion):
            changes[name] = value * (1.0 + size * rng.uniform(-1.0, 1.0))
    return replace(motion, **changes) if changes else motion  # type: ignore[type-var]


def _admissible(before: Scene, after: Scene) -> Scene:
    """The changed scene with what stood at the border of what is accepted still there.

    A contact under Newton's law that was closed stays closed, ε stays at most 1 and z within its
    bound.
    """
    closed, closing = _closings(before), _closings(after)
    held = [
        contact.law is None and contact.gap <= closed[i]
        for i, contact in enumerate(before.contacts)
    ]
    contacts = tuple(
        replace(
            contact,
            gap=closing[i] if held[i] else contact.gap,
            restitution=None if contact.restitution is None else min(contact.restitution, 1.0),
        )
        for i, contact in enumerate(after.contacts)
    )
    springs = tuple(replace(spring, law=_within_bound(spring.law)) for spring in after.springs)
    return replace(after, contacts=contacts, springs=springs)


def _within_bound(law: Law) -> Law:
    """A law with its initial z, if it has one, within its bound."""
    if not isinstance(law, BoucWen):
        return law
    bound = law.bound
    return replace(law, initial_z=float(np.clip(law.initial_z, -bound, bound)))


def _closings(scene: Scene) -> list[float]:
    """The gap with which each contact would be closed at the start (m)."""
    u = {body.name: body.displacement for body in scene.bodies} | {BARRIER: 0.0, GROUND: 0.0}
    u |= starts_of_supports(scene, 0.0)
    return [-sum(w * u[end] for end, w in contact.direction) for contact in scene.contacts]


@dataclass(frozen=True)
class Conditioning:
    """How quantities answer to changes of the inputs; shape (n,) each.

    Parameters
    ----------
    large, small : ndarray
        Δ at `LARGE` and `SMALL`, in the unit of the quantity; NaN where it was
        in no changed run.
    lost : ndarray of bool
        Whether some run with the small changes did not have it: an event that
        rounding can make or unmake.
    growth : ndarray, shape (times,)
        Largest change of any displacement at `LARGE` (m), at the times of the
        history.
    """

    large: Floats
    small: Floats
    lost: np.ndarray
    growth: Floats

    @property
    def slope(self) -> Floats:
        """Δ/η at the large changes: unit of the quantity for a relative change of one."""
        return self.large / LARGE

    @property
    def largest_slope(self) -> Floats:
        """The larger one of Δ/η at the large and at the small changes."""
        return np.asarray(np.fmax(self.large / LARGE, self.small / SMALL))

    @property
    def exponent(self) -> Floats:
        """p, between 0 and 1; 1 where nothing moved."""
        ratio = np.full(self.large.size, LARGE / SMALL)
        moved = (self.small > 0.0) & (self.large > 0.0)
        ratio[moved] = self.large[moved] / self.small[moved]
        exponent: Floats = np.clip(np.log10(ratio) / np.log10(LARGE / SMALL), 0.0, 1.0)
        return exponent

    @property
    def of_rounding(self) -> Floats:
        """Change that the rounding of the inputs makes, in the unit of the quantity."""
        return self.of_change(ROUNDING)

    def of_change(self, size: float) -> Floats:
        """Change that a relative change of the inputs by `size` makes, in the quantities' units."""
        change: Floats = self.small * (size / SMALL) ** self.exponent
        return change


Measure = Callable[[Scene], tuple[Floats, Floats]]
"""Values of all quantities of a scene, NaN for what it does not have, and displacements (m)
at the times of the history, shape (times, N)."""


def conditioning(scene: Scene, measure: Measure, seed: int = 0) -> Conditioning:
    """Measure how the quantities of a scene answer to changes of its numbers.

    Parameters
    ----------
    scene : Scene
        The scene.
    measure : callable
        Runs a scene.
    seed : int
        Of the changes.

    Raises
    ------
    ComputationError
        Where no scene changed by one of the sizes can be run, or not the scene itself.
    """
    rng = np.random.default_rng(seed)
    values, motion = measure(scene)
    spread = {}
    for size in (LARGE, SMALL):
        runs = _runs(measure, [perturbed(scene, size, rng) for _ in range(DRAWS)])
        changes = np.abs(np.array([other for other, _ in runs]) - values)
        if size == LARGE:
            paths = np.abs(np.array([path for _, path in runs]) - motion)
            growth = np.max(paths, axis=(0, 2))
        # A quantity that is not in a run says nothing by its value, but by its absence.
        lost = np.asarray(np.isnan(changes).any(axis=0))
        spread[size] = np.where(
            np.isnan(changes).all(axis=0), np.nan, np.max(np.nan_to_num(changes), axis=0)
        )
    return Conditioning(spread[LARGE], spread[SMALL], lost, growth)


def _runs(measure: Measure, scenes: list[Scene]) -> list[tuple[Floats, Floats]]:
    """What can be run of some scenes.

    Raises
    ------
    ComputationError
        Where nothing can: the last failure.
    """
    runs, failure = [], None
    for scene in scenes:
        try:
            runs.append(measure(scene))
        except ComputationError as error:
            failure = error
    if not runs and failure is not None:
        raise failure
    return runs
