"""What may have happened within one accepted step.

Every monitored quantity is known at both ends of the step with its
derivatives (`eventpound.mechanics.observables`). The Bernstein coefficients
of the Hermite polynomial through them bound it on the whole step, so that a
gap that closes and opens again inside is found as well as a change of sign.
What the bounds cannot exclude is marked, and searched for on the integrator's
own interpolant by `eventpound.solvers.events.location`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.kinks import still_rate
from eventpound.mechanics.monitored import Places, Running, contact_pressed, is_motion, motion_of
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.hermite import cubic_bernstein, quintic_bernstein
from eventpound.tolerances import FLAT_TURN, LENGTH

DOUBT = 0.03
"""Part of a quantity's spread over the step by which its Hermite bound is widened."""


class Guards(NamedTuple):
    """What the present mode has to watch.

    open_contacts (K,): gaps that may close. unlocked (K,): resting contacts
    that may detach. follows: whether a contact element is closed: then every step is searched,
    for what it does. force_low, force_high (K,): forces between which a contact stays
    at rest (N). kink_low, kink_high (L,): elongations at which a link
    changes branch, of those that `turns` (L,) marks rates of elongation. force_noise: contact
    forces below which the sign means nothing (N). at: columns of the extremes. presses, friction
    (K,): of one that holds what sticks, the contact whose force bounds its own, and μ; else -1.
    """

    open_contacts: Bools
    unlocked: Bools
    follows: bool
    force_low: Floats
    force_high: Floats
    kink_low: Floats
    kink_high: Floats
    turns: Bools
    force_noise: float
    at: Places
    presses: Ints
    friction: Floats


class Marks(NamedTuple):
    """What the bounds of an inspection could not exclude."""

    closing: Bools
    detaching: Bools
    kink: Bools
    peak: Bools


@kernel
def _bounds(
    x: tuple[float, float, float], y: tuple[float, float, float], h: float, motion: bool
) -> tuple[float, float]:
    """Bounds in the step, by the Bernstein coefficients, of what is x and y at its ends.

    x and y are a value and two rates; only that of a `motion` has the second.
    """
    if motion:
        quintic = quintic_bernstein(x, y, h)
        return min(quintic), max(quintic)
    cubic = cubic_bernstein(x[0], x[1], y[0], y[1], h)
    return min(cubic), max(cubic)


@kernel
def _may_peak(i: int, a: Observed, b: Observed, h: float, running: Running) -> bool:
    """Whether the bounds allow an extreme inside the step beyond those known.

    A change of sign of the rate tells of a turning point even where its value differs from that
    of an end by rounding only, unless it gains less than `flat` or the rates themselves are
    rounding.
    """
    start, end = motion_of(i, running.at, a), motion_of(i, running.at, b)
    rounding, motion = running.rounding[i], is_motion(i, running.at)
    low, high = _bounds(start, end, h, motion)
    flat = FLAT_TURN * rounding if motion else rounding
    doubt = DOUBT * (high - low) + rounding
    turns = start[1] * end[1] < 0.0 and max(abs(start[1]), abs(end[1])) * h > flat
    # What cannot exceed the extremes so far is not worth a search.
    above = (turns or high > max(start[0], end[0]) + flat) and (high + doubt > running.maximum[i])
    below = (turns or low < min(start[0], end[0]) - flat) and (low - doubt < running.minimum[i])
    return above or below


@kernel
def _inspect_contacts(a: Observed, b: Observed, h: float, guards: Guards, marks: Marks) -> None:
    at = guards.at
    for j in range(a.gap.shape[1]):
        marks.closing[j] = False
        marks.detaching[j] = False
        if guards.open_contacts[j]:
            i = at.gap + j
            low, high = _bounds(motion_of(i, at, a), motion_of(i, at, b), h, True)
            marks.closing[j] = low <= DOUBT * (high - low)
        elif guards.unlocked[j] and guards.presses[j] >= 0:
            marks.detaching[j] = _may_slip(j, a, b, h, guards)
        elif guards.unlocked[j]:
            i = at.contact_force + j
            low, high = _bounds(motion_of(i, at, a), motion_of(i, at, b), h, False)
            doubt = DOUBT * (high - low)
            marks.detaching[j] = (
                low - doubt < guards.force_low[j] - guards.force_noise
                or high + doubt > guards.force_high[j] + guards.force_noise
            )


@kernel
def _may_slip(j: int, a: Observed, b: Observed, h: float, guards: Guards) -> bool:
    """Whether what sticks may come to the bound of friction inside a step."""
    i, mu, may = guards.presses[j], guards.friction[j], False
    x, y = a.contact_force, b.contact_force
    for way in (1.0, -1.0):
        start = mu * x[0, i] + way * x[0, j], mu * x[1, i] + way * x[1, j], 0.0
        end = mu * y[0, i] + way * y[0, j], mu * y[1, i] + way * y[1, j], 0.0
        low, high = _bounds(start, end, h, False)
        may |= low - DOUBT * (high - low) < -guards.force_noise
    return may


@kernel
def _inspect_kinks(a: Observed, b: Observed, h: float, guards: Guards, marks: Marks) -> None:
    for link in range(marks.kink.size):
        marks.kink[link] = False
        if guards.kink_low[link] == -np.inf and guards.kink_high[link] == np.inf:
            continue
        # Of contact elements, which are links too, no extremes are kept.
        x0, x1 = a.elongation[:, link], b.elongation[:, link]
        if guards.turns[link]:
            low, high = _bounds((x0[1], x0[2], 0.0), (x1[1], x1[2], 0.0), h, False)
        else:
            low, high = _bounds((x0[0], x0[1], x0[2]), (x1[0], x1[1], x1[2]), h, True)
        doubt = DOUBT * (high - low)
        marks.kink[link] = low - doubt < guards.kink_low[link]
        marks.kink[link] = marks.kink[link] or high + doubt > guards.kink_high[link]


@scalar_kernel
def margin_on_branch(link: int, guards: Guards, elongation: Floats) -> tuple[float, float]:
    """How far a link is from the end of its branch, positive inside (m, or m/s), and the rate."""
    order = 1 if guards.turns[link] else 0
    x, x_rate = elongation[order, link], elongation[order + 1, link]
    return _margin_between(guards.kink_low[link], guards.kink_high[link], x, x_rate)


@scalar_kernel
def margin_at_rest(j: int, guards: Guards, contact_force: Floats) -> tuple[float, float]:
    """How far the force of a resting contact is from where its rest ends (N), and the rate."""
    i, mu = guards.presses[j], guards.friction[j]
    if i >= 0:
        bound, rate = mu * contact_force[0, i], mu * contact_force[1, i]
        return _margin_of_stick(bound, rate, contact_force[0, j], contact_force[1, j])
    low, high = guards.force_low[j], guards.force_high[j]
    return _margin_between(low, high, contact_force[0, j], contact_force[1, j])


@scalar_kernel
def _margin_of_stick(
    bound: float, bound_rate: float, force: float, force_rate: float
) -> tuple[float, float]:
    """How far a force is inside of a bound that moves (N), and the rate; smooth as below."""
    below, above = bound + force, bound - force
    if min(below, above) <= 0.0:
        way = 1.0 if below <= above else -1.0
        return min(below, above), bound_rate + way * force_rate
    value = 0.5 * below * above / bound
    rate = below * (bound_rate - force_rate) + above * (bound_rate + force_rate)
    return value, (0.5 * rate - value * bound_rate) / bound


@scalar_kernel
def _margin_between(low: float, high: float, x: float, x_rate: float) -> tuple[float, float]:
    """How far x is inside of two ends, and the rate: the product of both distances over theirs."""
    below, above = x - low, high - x
    if above == np.inf:
        return below, x_rate
    if below == np.inf:
        return above, -x_rate
    # Zero at both ends and smooth between, with the slope of a distance at either.
    width = below + above
    return below * above / width, x_rate * (above - below) / width


@scalar_kernel
def noise_on_branch(link: int, guards: Guards, length: float, time: float) -> float:
    """Size of `margin_on_branch` that means nothing, of a scene's own scales (m, s)."""
    return still_rate(length, time) if guards.turns[link] else LENGTH * length


@kernel
def inspect_step(
    a: Observed, b: Observed, h: float, guards: Guards, running: Running, marks: Marks
) -> bool:
    """Mark what may have happened between two instants.

    Parameters
    ----------
    a, b : Observed
        Both ends of the step, in the same mode.
    h : float
        Length of the step (s).
    guards : Guards
        What to look for.
    running : Running
        Extremes known so far; a peak is marked only where it may exceed them.
    marks : Marks
        Overwritten.

    Returns
    -------
    bool
        Whether anything is marked.
    """
    _inspect_contacts(a, b, h, guards, marks)
    _inspect_kinks(a, b, h, guards, marks)
    at = running.at
    for i in range(at.gap, at.end):
        j = contact_pressed(i, at)
        # An open contact has no force to peak.
        marks.peak[i] = not (j >= 0 and guards.open_contacts[j]) and _may_peak(i, a, b, h, running)
    some = marks.closing.any() or marks.detaching.any() or marks.kink.any() or marks.peak.any()
    return bool(some or guards.follows)
