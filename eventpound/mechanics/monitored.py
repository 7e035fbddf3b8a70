"""Extremes of a run: of which quantities, in which order, and how a value becomes one of them.

A run keeps a table of extremes (5, M). Its columns are the monitored quantities, one kind after
the other as in `Places`, the only place that knows their order; whoever takes or reads an extreme
asks there. Kinds of which two rates are known (distances) come before those with one (forces).
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import in_python, kernel, scalar_kernel
from eventpound.tolerances import ATTAINED_ANEW, SETTLED


class Places(NamedTuple):
    """First column of each kind of quantity in a table of extremes, and their number M at last."""

    gap: int
    displacement: int
    elongation: int
    acceleration: int
    base_shear: int
    contact_force: int
    end: int


KINDS = Places._fields[:-1]
"""Of displacements and absolute accelerations there are N, of elongations S, of gaps and contact
forces K, of the base shear one."""
SCALES = ("length", "length", "length", "acceleration", "force", "force")
"""By which of a scene's scales each kind is rounded."""


@scalar_kernel
def places_of(bodies: int, springs: int, contacts: int) -> Places:
    """Columns of the extremes of a scene with N coordinates, S springs and K contacts."""
    displacement = contacts
    elongation = displacement + bodies
    acceleration = elongation + springs
    base_shear = acceleration + bodies
    contact_force = base_shear + 1
    end = contact_force + contacts
    return Places(0, displacement, elongation, acceleration, base_shear, contact_force, end)


def places_in(model: Model) -> Places:
    """Columns of the extremes of an assembled scene."""
    return in_python(places_of)(model.coordinates, model.springs, model.contacts)


class Distances(NamedTuple):
    """Of the first D quantities, which are distances, from whom to whom (D,), -1 the ground.

    With one end there a distance turns where its body does.
    """

    first: Ints
    second: Ints


def distances_of(model: Model) -> Distances:
    """Gaps, displacements and elongations, in the order of their columns."""
    bodies, springs = np.arange(model.coordinates), model.link_ends[: model.springs]
    return Distances(
        np.concatenate((model.left, np.full_like(bodies, -1), springs[:, 0])),
        np.concatenate((model.right, bodies, springs[:, 1])),
    )


def columns_of_kind(kind: str, at: Places) -> slice:
    """Columns of one of `KINDS` in a table of extremes."""
    first = KINDS.index(kind)
    return slice(at[first], at[first + 1])


@scalar_kernel
def is_motion(i: int, at: Places) -> bool:
    """Whether `motion_of` tells two rates of quantity i: no force, nor what forces make."""
    return i < at.acceleration


@scalar_kernel
def contact_pressed(i: int, at: Places) -> int:
    """The contact whose force quantity i is, or -1."""
    return max(i - at.contact_force, -1)


@scalar_kernel
def value_of(i: int, at: Places, observed: Observed) -> float:
    """Quantity i (SI)."""
    if i < at.displacement:
        return observed.gap[0, i - at.gap]
    if i < at.elongation:
        return observed.u[i - at.displacement]
    if i < at.acceleration:
        return observed.elongation[0, i - at.elongation]
    if i < at.base_shear:
        return observed.acceleration[0, i - at.acceleration]
    if i < at.contact_force:
        return observed.shear[0]
    return observed.contact_force[0, i - at.contact_force]


@scalar_kernel
def motion_of(i: int, at: Places, observed: Observed) -> tuple[float, float, float]:
    """Quantity i with its first two rates (SI); the second is 0 where it `is_motion` not."""
    if i < at.displacement:
        x, j = observed.gap, i - at.gap
        return x[0, j], x[1, j], x[2, j]
    if i < at.elongation:
        b = i - at.displacement
        return observed.u[b], observed.v[b], observed.a[b]
    if i < at.acceleration:
        x, s = observed.elongation, i - at.elongation
        return x[0, s], x[1, s], x[2, s]
    if i < at.base_shear:
        x, b = observed.acceleration, i - at.acceleration
        return x[0, b], x[1, b], 0.0
    if i < at.contact_force:
        return observed.shear[0], observed.shear[1], 0.0
    x, j = observed.contact_force, i - at.contact_force
    return x[0, j], x[1, j], 0.0


class Running(NamedTuple):
    """Extremes so far of M quantities, their times (s), and which column is whose.

    Values that differ by `rounding` are the same attainment, as at the second touch of a barrier.
    """

    maximum: Floats
    time_of_maximum: Floats
    minimum: Floats
    time_of_minimum: Floats
    rounding: Floats
    at: Places


@kernel
def running_of(table: Floats, at: Places) -> Running:
    """Extremes as views of the rows of a table (5, M)."""
    return Running(table[0], table[1], table[2], table[3], table[4], at)


class Sizes(Protocol):
    """Scales of a scene, or columns (n,) of those of many."""

    @property
    def length(self) -> float | Floats:
        """Of displacements (m)."""
        ...

    @property
    def acceleration(self) -> float | Floats:
        """Of accelerations (m/s²)."""
        ...

    @property
    def force(self) -> float | Floats:
        """Of forces (N)."""
        ...


def blank_extremes(at: Places, scales: Sizes) -> Floats:
    """Extremes before anything was seen, shape (5, M), or (n, 5, M) for columns of scales.

    The five rows are those of `Running`.
    """
    sizes = [np.asarray(getattr(scales, scale)) for scale in SCALES]
    table = np.zeros((*sizes[0].shape, 5, at.end))
    table[..., 0, :], table[..., 2, :] = -np.inf, np.inf
    for first, end, size in zip(at[:-1], at[1:], sizes, strict=True):
        table[..., 4, first:end] = ATTAINED_ANEW * size[..., None]
    return table


@scalar_kernel
def copy_extremes(source: Floats, target: Floats) -> None:
    """Copy extremes and their times from one table to another of the same columns."""
    for row in range(4):
        copy_numbers(source[row], target[row])


@scalar_kernel
def update_beyond(i: int, value: float, t: float, same: float, running: Running) -> None:
    """Take a value into the extremes of quantity i where it exceeds them by more than `same`."""
    if value > running.maximum[i] + same:
        running.maximum[i] = value
        running.time_of_maximum[i] = t
    if value < running.minimum[i] - same:
        running.minimum[i] = value
        running.time_of_minimum[i] = t


@scalar_kernel
def update_extreme(i: int, value: float, t: float, running: Running) -> None:
    """Take a value into the extremes of quantity i; the first attainment stays."""
    update_beyond(i, value, t, running.rounding[i], running)


@scalar_kernel
def update_all(first: int, values: Floats, t: float, running: Running) -> None:
    """Take values of the quantities from `first` on into the extremes."""
    for k in range(values.size):
        update_extreme(first + k, values[k], t, running)


@scalar_kernel
def update_settled(i: int, value: float, t: float, running: Running) -> None:
    """Take a distance at a settled instant into the extremes.

    Bodies in touch have just been put exactly on their constraints, so a place
    that a cascade only approached is attained here, by however little.
    """
    update_beyond(i, value, t, SETTLED * running.rounding[i], running)


@scalar_kernel
def update_turning_point(i: int, value: float, t: float, near: float, running: Running) -> None:
    """Take a located turning point into the extremes of quantity i.

    The end of a step just before it (within `near` s) may have come within
    rounding of its value, and is replaced.
    """
    same = running.rounding[i]
    if value > running.maximum[i] - same and t - running.time_of_maximum[i] < near:
        running.maximum[i] = value
        running.time_of_maximum[i] = t
    if value < running.minimum[i] + same and t - running.time_of_minimum[i] < near:
        running.minimum[i] = value
        running.time_of_minimum[i] = t
    update_extreme(i, value, t, running)


@scalar_kernel
def update_extremes(observed: Observed, t: float, running: Running) -> None:
    """Take all values of one instant into the extremes."""
    for i in range(running.at.gap, running.at.end):
        update_extreme(i, value_of(i, running.at, observed), t, running)
