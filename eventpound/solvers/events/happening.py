"""The first thing that happens within a step: when, and to whom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools
from eventpound.solvers.events.inspection import Found, Watched
from eventpound.solvers.events.location import Step, first_below

VANISHED_WITHIN = 1e3
"""Instants within which a force that is nothing must have become so to be one that vanishes."""


@dataclass(frozen=True)
class Noise:
    """Sizes below which a gap or elongation (m) or a contact force (N) has no sign.

    `instant`: time within which what happens does so together (s).
    """

    length: float
    force: float
    instant: float


@dataclass(frozen=True)
class Happening:
    """What happens at one time of a step.

    Parameters
    ----------
    tau : float
        Local time (s).
    closing : ndarray of bool, shape (K,)
        Contacts whose gap closes.
    released : ndarray of bool, shape (K,)
        Resting contacts whose force vanishes.
    kinked : ndarray of bool, shape (L,)
        Links that change branch.
    """

    tau: float
    closing: Bools
    released: Bools
    kinked: Bools


@dataclass(frozen=True)
class Gap:
    """The gap of a contact and its rate (m, m/s)."""

    contact: int

    def __call__(self, seen: Observed) -> tuple[float, float]:
        """Value and rate."""
        return seen.gap[0, self.contact], seen.gap[1, self.contact]


@dataclass(frozen=True)
class ContactForce:
    """The force of a resting contact and its rate (N, N/s)."""

    contact: int

    def __call__(self, seen: Observed) -> tuple[float, float]:
        """Value and rate."""
        return seen.contact_force[0, self.contact], seen.contact_force[1, self.contact]


@dataclass(frozen=True)
class SideOfKink:
    """Distance of a link's elongation from its kink, positive on its present branch (m)."""

    link: int
    kink: float
    sign: float

    def __call__(self, seen: Observed) -> tuple[float, float]:
        """Value and rate."""
        x, x_rate = seen.elongation[0, self.link], seen.elongation[1, self.link]
        return self.sign * (x - self.kink), self.sign * x_rate


def first_happening(step: Step, found: Found, watched: Watched, noise: Noise) -> Happening | None:
    """The earliest closing, release or change of branch among what an inspection marked.

    Parameters
    ----------
    step : Step
        The step.
    found : Found
        Marks of its inspection.
    watched : Watched
        What was inspected.
    noise : Noise
        What means nothing.
    """
    first, happened = step.end, False
    marks = [np.zeros_like(m) for m in (found.closing, found.detaching, found.kink)]
    for kind, index, quantity, level in _candidates(found, watched, noise):
        tau = first_below(step, quantity, first, level)
        if tau is None:
            continue
        if tau < first:
            for other in marks:
                other[:] = False
        first, happened = tau, True
        marks[kind][index] = True
    return happening_with(first, step, watched, noise, *marks) if happened else None


def happening_with(
    tau: float,
    step: Step,
    watched: Watched,
    noise: Noise,
    closing: Bools,
    released: Bools,
    kinked: Bools,
) -> Happening:
    """What was found at a time of a step, and what vanishes in the same instant.

    Parameters
    ----------
    tau, closing, released, kinked
        Of `Happening`, as found; the last two are added to.
    step, watched, noise
        As for `first_happening`.
    """
    if released.any():
        # Forces that vanish together do so within rounding of each other; one that dies away
        # is small, but does not vanish.
        seen = step.look(tau)
        force, rate = np.abs(seen.contact_force)[:2]
        falls = force <= rate * (VANISHED_WITHIN * noise.instant)
        released |= watched.unlocked & (force <= noise.force) & falls
        kinked |= _at_kink(seen, watched, noise)
    return Happening(tau, closing, released, kinked)


def _at_kink(seen: Observed, watched: Watched, noise: Noise) -> Bools:
    """Links (L,) that pass their kink in this instant: what follows is told by the other branch."""
    x, x_rate = seen.elongation[0], seen.elongation[1]
    reach = noise.length + noise.instant * np.abs(x_rate)
    falls = (x_rate < 0.0) & (x - watched.kink_low <= reach)
    rises = (x_rate > 0.0) & (watched.kink_high - x <= reach)
    return np.asarray(falls | rises)


def _candidates(
    found: Found, watched: Watched, noise: Noise
) -> list[tuple[int, int, Gap | ContactForce | SideOfKink, float]]:
    """Everything marked: its kind, index, the quantity that falls below zero, and its noise."""
    result: list[tuple[int, int, Gap | ContactForce | SideOfKink, float]] = [
        (0, int(j), Gap(int(j)), noise.length) for j in np.flatnonzero(found.closing)
    ]
    result += [
        (1, int(j), ContactForce(int(j)), noise.force) for j in np.flatnonzero(found.detaching)
    ]
    for link in np.flatnonzero(found.kink):
        low, high = watched.kink_low[link], watched.kink_high[link]
        kink, sign = (low, 1.0) if low > -np.inf else (high, -1.0)
        result.append((2, int(link), SideOfKink(int(link), kink, sign), noise.length))
    return result
