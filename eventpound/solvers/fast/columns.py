"""Variants of one scene as columns: a row of numbers for each of them, never a scene.

A number of a scene that is a number of the arrays, too, is a column of them; a
ground motion and a spring in series are made anew for every value they have.
N bodies, L links, H hysteretic links, K contacts, D different ground motions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.backbone import hysteresis_of
from eventpound.mechanics.link_law import LinkLaw, z_bound
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.monitored import blank_extremes, distances_of, places_in
from eventpound.mechanics.numbers import numbers_of, put_numbers, with_numbers
from eventpound.motion.base import GroundMotion, Scales
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.scene.elastic_laws import ElasticLaws
from eventpound.scene.parameters import Place
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import (
    Attached,
    InitialState,
    body_tolerance,
    own_scales,
    push_of,
    scales_without,
    z_tolerance,
)
from eventpound.solvers.fast.constants import (
    begin_state,
    contacts_of,
    ground_of,
    links_of,
    order_for,
    small_difference,
    zero_state,
)
from eventpound.solvers.fast.run import FastPlan, FastState, Ground, Limits
from eventpound.solvers.fast.sdof.body import oscillators_of


class Motions(NamedTuple):
    """Different ground motions, `ends` (D, P) and `coefficients` (D, C), and whose is whose.

    `ground.samples` are those of all, once where they differ by `factor` (D,) only;
    `ground.first_sample` (D, P + 1) says where those of the pieces begin, counted from
    `begins` (D,). `of_variant` (n,): number of the motion. `scaled`: scratch for its samples.
    """

    ground: Ground
    begins: Ints
    factor: Floats
    of_variant: Ints
    scaled: Floats


@dataclass(frozen=True)
class Variants:
    """Variants of one scene, n of them.

    Parameters
    ----------
    task : Task
        The run of the scene itself: its tolerances and its start.
    values : mapping of Place to ndarray, shape (n,)
        What differs, checked.
    ends : ndarray, shape (n,)
        Ends of the runs (s).
    motions : sequence of GroundMotion, length D
        The different ground motions.
    motion_of : ndarray of int, shape (n,)
        Which of them each variant has.
    """

    task: Task
    values: Mapping[Place, Floats]
    ends: Floats
    motions: Sequence[GroundMotion]
    motion_of: Ints


class VariantArrays(NamedTuple):
    """Arrays of some variants, each with a leading axis.

    Scalars of `Limits` that differ and `Links.kinked` are arrays, too.
    """

    plan: FastPlan
    state: FastState
    motions: Motions
    extremes: Floats


def rows_of(variants: Variants, low: int, high: int) -> VariantArrays:
    """Arrays of the variants `low` to `high`, ready to run."""
    task, part = variants.task, slice(low, high)
    model = assemble(task.scene)
    numbers = {
        key: np.repeat(own[None], high - low, axis=0) for key, own in numbers_of(model).items()
    }
    put_numbers(task.scene, model, {p: v[part] for p, v in variants.values.items()}, numbers)
    law = LinkLaw(*(numbers[key] for key in LinkLaw._fields))
    links = links_of(model)._replace(
        law=law,
        compression=numbers["compression"],
        extension=numbers["extension"],
        offset=numbers["offset"],
        kinked=(numbers["compression"] != numbers["extension"]).any(axis=1),
    )
    used, of_variant = np.unique(variants.motion_of[part], return_inverse=True)
    used_motions = [variants.motions[m] for m in used.tolist()]
    of_motions = [motion.scales() for motion in used_motions]
    pushes = [push_of(motion) for motion in used_motions]
    of_variant = of_variant.reshape(-1)
    scales = _scales(variants, model, numbers, low, of_motions, pushes, of_variant)
    mass: Any = numbers["mass"].max(axis=1)
    small: Any = small_difference(task.rtol, law.memory, numbers["mass"], scales.acceleration)
    contacts = contacts_of(model, numbers["gap"], numbers["restitution"])
    motions = _motions(used_motions, of_variant)
    ends: Any = variants.ends[part].copy()
    shaken = (np.array(pushes) > 0.0)[of_variant]
    atol = _body_tolerances(task, model, numbers, scales, shaken)
    limits = Limits(
        ends,
        task.rtol,
        *atol,
        scales.length,
        scales.time,
        mass,
        order_for(task.rtol),
        small,
        False,
        z_tolerance(task, z_bound(law.memory.take(model.hysteretic, -2))),
    )
    hysteresis = hysteresis_of(law.memory, model.hysteretic, small)
    plan = FastPlan(
        numbers["mass"],
        links,
        hysteresis,
        contacts,
        motions.ground,
        limits,
        np.empty(0),
        oscillators_of(model, numbers["gap"], scales.length, links, energy=False),
        distances_of(model),
    )
    state = zero_state(model.counts, runs=(high - low,))
    begin_state(plan, numbers["u0"], numbers["v0"], numbers["z0"], task.start, state)
    scales = scales._replace(force=mass * scales.length / scales.squared_time)
    return VariantArrays(plan, state, motions, blank_extremes(places_in(model), scales))


class _ScaleColumns(NamedTuple):
    """Scales of some variants (SI), arrays in the place of scalars."""

    length: Any
    time: Any
    squared_time: Any
    acceleration: Any
    force: Any = None


def _scales(
    variants: Variants,
    model: Model,
    numbers: dict[str, Floats],
    low: int,
    of_motions: Sequence[Scales | None],
    pushes: Sequence[float],
    of_variant: Ints,
) -> _ScaleColumns:
    """Scales of variants from `low` on; those of a motion are computed once for all."""
    known = [
        None if own is None else _scale_numbers(own.length, 1.0 / own.omega_g) for own in of_motions
    ]
    if None not in known:
        return _ScaleColumns(*np.array(known)[of_variant].T.copy())
    lines = []
    for i, m in enumerate(of_variant.tolist()):
        line = known[m]
        if line is None:
            duration = float(variants.ends[low + i]) - variants.task.start
            variant = with_numbers(model, {key: rows[i] for key, rows in numbers.items()})
            line = _scale_numbers(*scales_without(variant, duration, pushes[m]))
        lines.append(line)
    return _ScaleColumns(*np.array(lines).T.copy())


def _scale_numbers(length: float, time: float) -> tuple[float, ...]:
    """L, T, T² and L/T² (SI); an OverflowError where energies are beyond all doubles."""
    _ = (length / time) ** 2
    return length, time, time**2, length / time**2


def _body_tolerances(
    task: Task, model: Model, numbers: dict[str, Floats], scales: _ScaleColumns, shaken: Bools
) -> tuple[Floats, Floats]:
    """Absolute tolerances of displacement (m) and velocity (m/s), shape (n, N) each."""
    links = Attached(
        model.link_ends,
        LinkLaw(*(numbers[key] for key in LinkLaw._fields)),
        *ElasticLaws(*(numbers[key] for key in ElasticLaws._fields)),
        model.weights,
    )
    start = InitialState(numbers["u0"], numbers["v0"], numbers["z0"], model.hysteretic)
    length, speed = own_scales(
        links, numbers["mass"], start, scales.length, scales.time, scales.acceleration, shaken
    )
    return body_tolerance(task, "displacement", length), body_tolerance(task, "velocity", speed)


def _motions(motions: Sequence[GroundMotion], of_variant: Ints) -> Motions:
    """Different motions as arrays, and which of them each variant has."""
    grounds = [ground_of(motion.pieces()) for motion in motions]
    # Records that differ by a factor have their samples in common.
    own = [motion.samples if isinstance(motion, Record) else np.empty(0) for motion in motions]
    parts = {id(samples): samples for samples in own}
    starts = accumulate((part.size for part in parts.values()), initial=0)
    begins = dict(zip(parts, starts, strict=False))
    return Motions(
        grounds[0]._replace(
            ends=np.stack([ground.ends for ground in grounds]),
            coefficients=np.stack([ground.coefficients for ground in grounds]),
            samples=np.concatenate(list(parts.values())),
            first_sample=np.stack([ground.first_sample for ground in grounds]),
        ),
        np.array([begins[id(samples)] for samples in own], np.int64),
        np.array([motion.factor if isinstance(motion, Record) else 1.0 for motion in motions]),
        of_variant.astype(np.int64),
        np.empty(max(samples.size for samples in own)),
    )
