"""What the list of quantities is told of runs: extremes, final states, numbers of contacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eventpound.case.run_options import DEFAULTS, Stated
from eventpound.contact.event import STRIKES
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.scene.pi_columns import ScaleColumns
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes, Recording

if TYPE_CHECKING:
    from eventpound.quantities.between import Between

_WHOLE = ("run", "group", "contact", "number")


class Impacts(NamedTuple):
    """Events of several runs that are impacts or stand for some, in order of run and time, (E,).

    run: number of the run. t (s). group: number of the problem in its run. contact: position in
    the scene. before, after: rates of the gap (m/s). impulse (N s). lost (J). number of impacts.
    """

    run: Ints
    t: Floats
    group: Ints
    contact: Ints
    before: Floats
    after: Floats
    impulse: Floats
    lost: Floats
    number: Ints


def impacts_of(rows: Floats) -> Impacts:
    """Events from a row each, with the fields of `Impacts` as columns."""
    columns = zip(Impacts._fields, rows.T, strict=True)
    return Impacts(*(c.astype(np.int64) if name in _WHOLE else c for name, c in columns))


class ContactNumbers(NamedTuple):
    """Numbers of K contacts in n runs, shape (n, K); the list of quantities says what each is."""

    max_impulse: Floats
    t_max_impulse: Floats
    t_first_impact: Floats
    sum_impulse: Floats
    energy_lost: Floats
    fastest_closing: Floats
    t_fastest_closing: Floats
    impacts_faster: Floats
    max_force: Floats
    unique_force: Floats


def blank_numbers(runs: int, contacts: int) -> ContactNumbers:
    """Room for the numbers of runs that have none yet."""
    return ContactNumbers(*(np.full((runs, contacts), np.nan) for _ in ContactNumbers._fields))


def numbers_of_contacts(
    impacts: Impacts, max_force: Floats, unique: Bools, threshold: float
) -> ContactNumbers:
    """Numbers of the contacts.

    Parameters
    ----------
    impacts : Impacts
        Of all runs together.
    max_force : ndarray, shape (n, K)
        Largest forces while resting (N).
    unique : ndarray of bool, shape (n, K)
        Whether forces were always unique.
    threshold : float
        Closing speed above which impacts are counted (m/s).
    """
    shape = max_force.shape
    cell = impacts.run * shape[1] + impacts.contact
    closing = -impacts.before

    def total(of: Floats | Ints) -> Floats:
        # In the order of the impacts, so that sums are those of one run to the last bit.
        return np.bincount(cell, of, max_force.size).astype(float).reshape(shape)

    def largest(of: Floats) -> tuple[Floats, Floats]:
        """The largest of each contact and its time, the first of equals; 0 and NaN without any."""
        sizes, times = np.zeros(max_force.size), np.full(max_force.size, np.nan)
        order = np.lexsort((-of, cell))
        found, first = np.unique(cell[order], return_index=True)
        sizes[found], times[found] = of[order][first], impacts.t[order][first]
        return sizes.reshape(shape), times.reshape(shape)

    max_impulse, t_max_impulse = largest(impacts.impulse)
    fastest, t_fastest = largest(closing)
    return ContactNumbers(
        max_impulse,
        t_max_impulse,
        largest(-impacts.t)[1],
        total(impacts.impulse),
        _energy_lost(impacts, cell, max_force.size).reshape(shape),
        fastest,
        t_fastest,
        total(impacts.number * (closing > threshold)),
        np.where(unique, max_force, np.nan),
        unique.astype(float),
    )


def _energy_lost(impacts: Impacts, cell: Ints, cells: int) -> Floats:
    """Kinetic energy lost in each contact (J), shape (cells,).

    What a problem of several contacts loses is ``-1/2 sum_j L_j (g_j- + g_j+)``, with the
    impulses L and the rates g of the gaps before and after, so that each has its part. A row
    that stands for several impacts keeps what its problem lost.
    """
    problems = np.column_stack((impacts.run, impacts.group))
    _, first, which = np.unique(problems, axis=0, return_index=True, return_inverse=True)
    which = which.reshape(-1)
    single = np.bincount(which, impacts.number == 1, first.size) == np.bincount(which)
    shared = (single & (np.bincount(which) > 1))[which]
    share = np.where(
        shared, -0.5 * impacts.impulse * (impacts.before + impacts.after), impacts.lost
    )
    # Problem by problem, in the order in which they began.
    order = np.argsort(first[which], kind="stable")
    return np.bincount(cell[order], share[order], cells).astype(float)


def of_recordings(recordings: Sequence[Recording], threshold: float) -> ContactNumbers:
    """Numbers of the contacts in runs of which all was kept."""
    rows = [
        (i, e.t, e.group, e.contact, *e[4:])
        for i, recording in enumerate(recordings)
        for e in recording.events
        if e.kind in STRIKES
    ]
    impacts = impacts_of(np.array(rows, float).reshape(-1, len(Impacts._fields)))
    max_force = np.array([r.max_force for r in recordings], float)
    unique = np.array([r.unique_forces for r in recordings], bool)
    return numbers_of_contacts(impacts, max_force, unique, threshold)


@dataclass(frozen=True)
class Runs:
    """Runs of n variants of a scene, as arrays; `eventpound.BatchResponse` says what each is."""

    scene: Scene
    parameters: Mapping[str, Floats]
    success: Bools
    message: list[str]
    t: Floats
    u: Floats
    v: Floats
    z: Floats
    displacement: Extremes
    elongation: Extremes
    smallest_gap: Floats
    largest_gap: Floats
    impacts: Floats
    resting_time: Floats
    steps: Ints
    acceleration: Extremes | None
    base_shear: Extremes | None
    further: Mapping[str, Floats] = field(default_factory=dict)
    recordings: Sequence[Recording] = ()
    scales: ScaleColumns | None = None
    free: Callable[[str], Floats | None] | None = None
    between: Callable[[], Between] | None = None
    apart: Callable[[tuple[int, ...]], Floats] | None = None
    stated: Stated = DEFAULTS
    struck: ContactNumbers | None = None

    def values_of(self, name: str) -> Floats | None:
        """Values of a quantity by its name, shape (n,), which the list of quantities gives."""
        raise NotImplementedError

    @property
    def threshold(self) -> float:
        """Closing speed from which on an impact counts as faster (m/s)."""
        return self.stated.threshold_speed

    @cached_property
    def contact_numbers(self) -> ContactNumbers:
        """Numbers of the contacts; NaN where impacts were not kept."""
        if self.struck is not None:
            return self.struck
        if self.recordings:
            return of_recordings(self.recordings, self.threshold)
        return blank_numbers(self.t.size, len(self.scene.contacts))
