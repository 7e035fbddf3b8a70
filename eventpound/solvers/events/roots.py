"""Event functions of the state in a mode, for integrators that find roots themselves.

Every gap that may close, contact force that may vanish and link that may pass its kink is a
*value*, positive while nothing has happened, and gives two functions: the value, whose fall
through zero is the event, and its rate, whose rise through zero is the turning point of a dip.
A root finder that compares signs at the ends of a step sees a dip within the step by the
latter, and searching for it meets the former.

No function is ever zero where a search begins. A value is lifted by its noise, below which
a sign means nothing, or by what it lacks at the start of a segment, so that one that is zero there
and falls is found at once; and what is zero, or has died away to numbers without digits, counts as
positive. So no root
is inactive at a start, and none is found again where the motion goes on from it.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python, scalar_kernel
from eventpound.solvers.events.event_bounds import (
    Guards,
    margin_at_rest,
    margin_on_branch,
    noise_on_branch,
)
from eventpound.solvers.settings import Settings, word
from eventpound.tolerances import GAP, NO_ZERO

OWN, SUNDIALS = EVENTS = ("own", "sundials")
"""Who finds events, in `[solver]`: the event loop, or the root finder of the integrator."""


def finders(default: str) -> str:
    """What `events` means, for ``eventpound solvers``."""
    return (
        f'who finds events: "{OWN}", on the polynomial of each step with bounds, '
        f'or "{SUNDIALS}", the root finder of the library (default "{default}")'
    )


def sundials_finds(settings: Settings, default: str) -> bool:
    """Whether the root finder of the library is to find events.

    Raises
    ------
    InputError
        For a word that is none.
    """
    return word(settings, "events", EVENTS, default) == SUNDIALS


@scalar_kernel
def values_and_rates(observed: Observed, guards: Guards, pairs: Floats) -> None:
    """Fill `pairs` (n, 2), a value and its rate each, in the order of `owners`."""
    place = 0
    for j in range(observed.gap.shape[1]):
        if guards.open_contacts[j]:
            pairs[place, 0], pairs[place, 1] = observed.gap[0, j], observed.gap[1, j]
            place += 1
        elif guards.unlocked[j]:
            pairs[place, 0], pairs[place, 1] = margin_at_rest(j, guards, observed.contact_force)
            place += 1
    for i in range(observed.elongation.shape[1]):
        if guards.kink_low[i] > -np.inf or guards.kink_high[i] < np.inf:
            pairs[place, 0], pairs[place, 1] = margin_on_branch(i, guards, observed.elongation)
            place += 1


@scalar_kernel
def lift(pairs: Floats, noise: Floats, lifted: Floats) -> None:
    """What every value is to be lifted by, (n,), from what it is at a start and its noise."""
    for i in range(lifted.size):
        lifted[i] = max(noise[i], noise[i] - pairs[i, 0])


@scalar_kernel
def root_functions(pairs: Floats, lifted: Floats) -> None:
    """Make `pairs` (n, 2) functions without a zero: lifted values, and rates."""
    for i in range(lifted.size):
        pairs[i, 0] += lifted[i]
        for k in range(2):
            # SUNDIALS leaves a function that is zero at a start out of its search.
            if abs(pairs[i, k]) < NO_ZERO:
                pairs[i, k] = NO_ZERO


@scalar_kernel
def any_fell(pairs: Floats) -> bool:
    """Whether a value is below zero."""
    lowest = np.inf
    for i in range(pairs.shape[0]):
        lowest = min(lowest, pairs[i, 0])
    return lowest < 0.0


@scalar_kernel
def on_the_root(pairs: Floats, noise: Floats, start: float, tau: float, reach: float) -> float:
    """Where the first of the values that have fallen was zero, by one step of Newton's method.

    A root finder returns the far side of a bracket: values are below zero there by what they
    fall within it, which is more than rounding late in a run, and have their noise on top.

    Parameters
    ----------
    pairs, noise : ndarray, shape (n, 2) and (n,)
        The functions at the root, and what values were lifted by at least.
    start, tau : float
        Start of the step and time of the root (s).
    reach : float
        Width of the bracket (s). A value that is not zero within it, and the time in which it
        falls twice by its noise, is left where it is.
    """
    first = tau
    for i in range(noise.size):
        value, rate = pairs[i]
        if value < 0.0 and rate < 0.0:
            back = (value - noise[i]) / rate
            # One noise is what it was lifted by, the other its rounding, as beside a mass of 1e7.
            if back <= reach - 2.0 * noise[i] / rate:
                first = min(first, tau - back)
    return first if first > start else tau


def owners(guards: Guards) -> tuple[Bools, Bools, Bools]:
    """Contacts (K,) whose gap and whose force is a value, and links (L,) with one."""
    kinked = np.isfinite(guards.kink_low) | np.isfinite(guards.kink_high)
    return guards.open_contacts, guards.unlocked & ~guards.open_contacts, kinked


def noise_of(guards: Guards, length: float, time: float) -> Floats:
    """Noise of every value of a mode, (n,); `length` (m) and `time` (s) are the scene's own."""
    gaps, forces, kinked = owners(guards)
    of_contacts = np.where(gaps, GAP * length, guards.force_noise)[gaps | forces]
    of_link = in_python(noise_on_branch)
    of_links = [of_link(i, guards, length, time) for i in np.flatnonzero(kinked).tolist()]
    return np.concatenate((of_contacts, of_links))


def located_of(guards: Guards, fallen: Bools) -> tuple[Bools, Bools, Bools]:
    """The events, from which values (n,) fell: closing (K,), released (K,), kinked (L,)."""
    gaps, forces, kinked = owners(guards)
    whose = gaps | forces
    count = int(whose.sum())
    fell, passed = np.zeros_like(whose), np.zeros_like(kinked)
    fell[whose], passed[kinked] = fallen[:count], fallen[count:]
    return gaps & fell, forces & fell, passed
