"""What may have happened within one accepted step.

Every monitored quantity is known at both ends of the step with its
derivatives (`eventpound.mechanics.observables`). The Bernstein coefficients
of the Hermite polynomial through them bound it on the whole step, so that a
gap that closes and opens again inside is seen as well as a change of sign.
What the bounds cannot exclude is marked, and looked at on the integrator's
own interpolant by `eventpound.solvers.events.location`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.hermite import cubic_bernstein, quintic_bernstein
from eventpound.tolerances import FLAT_TURN, SETTLED

DOUBT = 0.03
"""Part of a quantity's spread over the step by which its Hermite bound is widened."""


class Watched(NamedTuple):
    """What the present mode has to watch.

    open_contacts (K,): gaps that may close. unlocked (K,): resting contacts
    that may detach. follows: whether a contact element is closed: then every step is looked at
    again, for what it does in it. kink_low, kink_high (L,): elongations at which a link
    changes branch. force_noise: contact forces below which the sign
    means nothing (N). springs: S, the links whose elongation is recorded.
    """

    open_contacts: Bools
    unlocked: Bools
    follows: bool
    kink_low: Floats
    kink_high: Floats
    force_noise: float
    springs: int


class Found(NamedTuple):
    """Marks left by an inspection: what the bounds could not exclude."""

    closing: Bools
    detaching: Bools
    kink: Bools
    peak: Bools


class Running(NamedTuple):
    """Extremes so far of M quantities and their times.

    Order: displacements (N), elongations (S), gaps (K), absolute
    accelerations (N), base shear (1), contact forces (K). Values that differ by `rounding` are
    the same attainment, as at the second touch of a barrier.
    """

    maximum: Floats
    time_of_maximum: Floats
    minimum: Floats
    time_of_minimum: Floats
    rounding: Floats


@kernel
def unpack_running(table: Floats) -> Running:
    """Extremes as views of the rows of a table (5, M)."""
    return Running(table[0], table[1], table[2], table[3], table[4])


def blank_extremes(rounding: Floats) -> Floats:
    """Extremes before anything was seen, shape (..., 5, M) for `rounding` of shape (..., M).

    The five rows are those of `Running`.
    """
    nothing, at = np.full(rounding.shape, np.inf), np.zeros(rounding.shape)
    return np.stack((-nothing, at, nothing, at, rounding), axis=-2)


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
def update_settled(
    u: Floats, elongation: Floats, gap: Floats, springs: int, t: float, running: Running
) -> None:
    """Take the displacements of a settled instant into the extremes.

    Bodies in touch have just been put exactly on their constraints, so a place
    that a cascade only approached is attained here, by however little.
    """
    for b in range(u.size):
        update_beyond(b, u[b], t, SETTLED * running.rounding[b], running)
    place = u.size
    for s in range(springs):
        same = SETTLED * running.rounding[place + s]
        update_beyond(place + s, elongation[s], t, same, running)
    place += springs
    for j in range(gap.size):
        update_beyond(place + j, gap[j], t, SETTLED * running.rounding[place + j], running)


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
def update_extremes(seen: Observed, springs: int, t: float, running: Running) -> None:
    """Take all values of one instant into the extremes."""
    place = 0
    for b in range(seen.u.size):
        update_extreme(place, seen.u[b], t, running)
        place += 1
    for s in range(springs):
        update_extreme(place, seen.elongation[0, s], t, running)
        place += 1
    for j in range(seen.gap.shape[1]):
        update_extreme(place, seen.gap[0, j], t, running)
        place += 1
    for b in range(seen.u.size):
        update_extreme(place, seen.acceleration[0, b], t, running)
        place += 1
    update_extreme(place, seen.shear[0], t, running)
    for j in range(seen.gap.shape[1]):
        update_extreme(place + 1 + j, seen.contact_force[0, j], t, running)


@kernel
def _may_peak(
    bounds: tuple[float, float],
    start: tuple[float, float],
    end: tuple[float, float],
    h: float,
    flat: float,
    i: int,
    running: Running,
) -> bool:
    """Whether the bounds allow an extreme inside the step beyond those known.

    `start` and `end` are value and rate at the ends; a change of sign of the
    rate tells of a turning point even where its value differs from that of an
    end by rounding only, unless it gains less than `flat` or the rates
    themselves are rounding.
    """
    low, high = bounds
    rounding = running.rounding[i]
    margin = DOUBT * (high - low) + rounding
    turns = start[1] * end[1] < 0.0 and max(abs(start[1]), abs(end[1])) * h > flat
    above = (turns or high > max(start[0], end[0]) + flat) and (high + margin > running.maximum[i])
    below = (turns or low < min(start[0], end[0]) - flat) and (low - margin < running.minimum[i])
    return above or below


@kernel
def _peak_of_quintic(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    h: float,
    i: int,
    running: Running,
) -> bool:
    b = quintic_bernstein(start, end, h)
    flat = FLAT_TURN * running.rounding[i]
    return _may_peak((min(b), max(b)), start[:2], end[:2], h, flat, i, running)


@kernel
def _peak_of_cubic(
    start: tuple[float, float], end: tuple[float, float], h: float, i: int, running: Running
) -> bool:
    b = cubic_bernstein(start[0], start[1], end[0], end[1], h)
    return _may_peak((min(b), max(b)), start, end, h, running.rounding[i], i, running)


@kernel
def _inspect_contacts(a: Observed, b: Observed, h: float, watched: Watched, found: Found) -> bool:
    any_found = False
    for j in range(a.gap.shape[1]):
        found.closing[j] = False
        found.detaching[j] = False
        if watched.open_contacts[j]:
            c = quintic_bernstein(
                (a.gap[0, j], a.gap[1, j], a.gap[2, j]),
                (b.gap[0, j], b.gap[1, j], b.gap[2, j]),
                h,
            )
            found.closing[j] = min(c) <= DOUBT * (max(c) - min(c))
        elif watched.unlocked[j]:
            f = cubic_bernstein(
                a.contact_force[0, j],
                a.contact_force[1, j],
                b.contact_force[0, j],
                b.contact_force[1, j],
                h,
            )
            low = min(f) - DOUBT * (max(f) - min(f))
            found.detaching[j] = low < -watched.force_noise
        any_found = any_found or found.closing[j] or found.detaching[j]
    return any_found


@kernel
def _inspect_kinks(a: Observed, b: Observed, h: float, watched: Watched, found: Found) -> bool:
    any_found = False
    for link in range(found.kink.size):
        found.kink[link] = False
        low, high = watched.kink_low[link], watched.kink_high[link]
        if low == -np.inf and high == np.inf:
            continue
        x0, x1 = a.elongation[:, link], b.elongation[:, link]
        c = quintic_bernstein((x0[0], x0[1], x0[2]), (x1[0], x1[1], x1[2]), h)
        doubt = DOUBT * (max(c) - min(c))
        found.kink[link] = min(c) - doubt < low or max(c) + doubt > high
        any_found = any_found or found.kink[link]
    return any_found


@kernel
def inspect_step(
    a: Observed, b: Observed, h: float, watched: Watched, running: Running, found: Found
) -> bool:
    """Mark what may have happened between two instants.

    Parameters
    ----------
    a, b : Observed
        Both ends of the step, in the same mode.
    h : float
        Length of the step (s).
    watched : Watched
        What to look for.
    running : Running
        Extremes known so far; a peak is marked only where it may exceed them.
    found : Found
        Overwritten.

    Returns
    -------
    bool
        Whether anything is marked.
    """
    any_found = _inspect_contacts(a, b, h, watched, found)
    any_found = _inspect_kinks(a, b, h, watched, found) or any_found
    place = 0
    for i in range(a.u.size):
        found.peak[place] = _peak_of_quintic(
            (a.u[i], a.v[i], a.a[i]), (b.u[i], b.v[i], b.a[i]), h, place, running
        )
        place += 1
    for of_a, of_b, count in (
        (a.elongation, b.elongation, watched.springs),
        (a.gap, b.gap, a.gap.shape[1]),
    ):
        for i in range(count):
            found.peak[place] = _peak_of_quintic(
                (of_a[0, i], of_a[1, i], of_a[2, i]),
                (of_b[0, i], of_b[1, i], of_b[2, i]),
                h,
                place,
                running,
            )
            place += 1
    for i in range(a.u.size):
        found.peak[place] = _peak_of_cubic(
            (a.acceleration[0, i], a.acceleration[1, i]),
            (b.acceleration[0, i], b.acceleration[1, i]),
            h,
            place,
            running,
        )
        place += 1
    found.peak[place] = _peak_of_cubic(
        (a.shear[0], a.shear[1]), (b.shear[0], b.shear[1]), h, place, running
    )
    for j in range(a.gap.shape[1]):
        found.peak[place + 1 + j] = not watched.open_contacts[j] and _peak_of_cubic(
            (a.contact_force[0, j], a.contact_force[1, j]),
            (b.contact_force[0, j], b.contact_force[1, j]),
            h,
            place + 1 + j,
            running,
        )
    return any_found or bool(found.peak.any()) or watched.follows
