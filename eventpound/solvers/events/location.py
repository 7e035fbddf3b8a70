"""The first event within a step, and who has part in it, on the dense output of the step.

A *quantity* is a value and its rate. Between two samples the Bernstein coefficients of
the Hermite cubic bound it; while they leave room for a crossing the stretch is halved,
so that a dip that begins and ends inside a step is found, and one that misses by more
than the interpolant's own error is not reported.

A contact force follows the ground, too, so it is no polynomial of the step's, and one through its
values would err by more than the noise of a length (`eventpound.numerics.polynomial` is for what
is known by coefficients: the gaps of a local series).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from eventpound.contact.kinks import passes_kink
from eventpound.contact.modes import force_vanishes
from eventpound.mechanics.monitored import Running, motion_of, update_extreme, update_turning_point
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.hermite import cubic_bernstein
from eventpound.solvers.events.dense import DenseStep, observe_at
from eventpound.solvers.events.event_bounds import (
    Guards,
    Marks,
    margin_at_rest,
    margin_on_branch,
    noise_on_branch,
)
from eventpound.solvers.events.run import Located, Rules
from eventpound.tolerances import EPS

DEPTH = 12
"""Halvings after which a stretch without a change of sign counts as clear."""
PARTS = 4
"""Equal parts of a step between whose ends turning points are looked for first."""
MOST_ITERATIONS = 100
"""Iterations after which a bracket of a root is taken as it is."""
NEWTON = 12
"""Of these by Newton's rule; then the bracket is halved. Where rounding keeps a quantity from
changing, as the force on a stiff body that rests on one far from its origin, Newton's steps
creep along and leave one end of the bracket where it was."""
_GAP, _FORCE, _KINK, _MONITORED = 0, 1, 2, 3


class EventFunction(NamedTuple):
    """An event function, which may fall below zero, or what may turn.

    kind: a gap, the force of a resting contact, the margin of a link on its branch; or a quantity
    of which extremes are recorded. index: of the contact or link, or its column of the extremes.
    noise: depth below zero that means nothing. level: what counts as zero.
    """

    kind: int
    index: int  # type: ignore[assignment]  # hides the method of tuples
    noise: float
    level: float


class Sample(NamedTuple):
    """Time (s, local), value and rate of a quantity."""

    tau: float
    value: float
    rate: float


@kernel
def _sample(tau: float, g: EventFunction, step: DenseStep) -> Sample:
    """The quantity at `tau` (s)."""
    observe_at(tau, step)
    observed, i = step.observed, g.index
    if g.kind == _GAP:
        return Sample(tau, observed.gap[0, i], observed.gap[1, i])
    if g.kind == _FORCE:
        force, rate = margin_at_rest(i, step.dynamics.guards, observed.contact_force)
        return Sample(tau, force - g.level, rate)
    if g.kind == _MONITORED:
        value, rate, _ = motion_of(i, step.dynamics.guards.at, observed)
        return Sample(tau, value, rate)
    margin, rate = margin_on_branch(i, step.dynamics.guards, observed.elongation)
    return Sample(tau, margin - g.level, rate)


@kernel
def first_below(g: EventFunction, end: float, step: DenseStep) -> float:
    """First time at which a quantity falls below zero.

    Parameters
    ----------
    g : EventFunction
        What is watched; at the start of the step it counts as not below.
    end : float
        End of the search (s), within the step.
    step : DenseStep
        Where to look.

    Returns
    -------
    float
        Time at which the quantity passes zero, to fall below it by more
        than its noise (s); inf where it does not.
    """
    noise, dense = g.noise, step.dense
    a = _sample(dense.start, g, step)
    a = Sample(a.tau, max(a.value, 0.0), a.rate)
    width = end - a.tau
    shortest = max(width * 2.0**-DEPTH, 8.0 * EPS * abs(end))
    while True:
        b = _sample(a.tau + width if a.tau + width < end - shortest else end, g, step)
        below, short = b.value < -noise, width <= shortest
        c = cubic_bernstein(a.value, a.rate, b.value, b.rate, b.tau - a.tau)
        changes = 0
        for i in range(3):
            changes += (c[i] < 0.0) != (c[i + 1] < 0.0)
        # With one change of sign there is one root between a and b.
        if below and (changes <= 1 or short):
            return _falling_root(a, b, g, step)
        # The cubic is not the quantity itself: its bound counts with room for what it errs by.
        clear = not below and (short or min(c) > 0.05 * (max(c) - min(c)) - noise)
        # A dip, whose lowest point decides at once what halving would go on about.
        if not (clear or below) and a.rate < 0.0 < b.rate:
            bracket = Bracket(a.tau, a.rate, b.tau, b.rate)
            tau = turning_point(_rate_at, (g, step), bracket, 2.0 * EPS * b.tau)
            lowest = _sample(tau, g, step)
            if lowest.value < -noise:
                return _falling_root(a, lowest, g, step)
            clear = True
        if not clear:
            width *= 0.5
        elif b.tau == end:
            return np.inf
        else:
            # Behind a clear stretch a longer one is tried again.
            a, width = b, 2.0 * width


@kernel
def _falling_root(a: Sample, b: Sample, g: EventFunction, step: DenseStep) -> float:
    """Root between a (not below) and b (below): Newton's iteration kept inside the bracket."""
    low, high = a.tau, b.tau
    tau = high if b.rate == 0.0 else high - b.value / b.rate
    for i in range(MOST_ITERATIONS):
        if not low < tau < high or i > NEWTON:
            tau = 0.5 * (low + high)
        # No number lies between them: `high` is the first at which the quantity is below zero.
        if tau <= low or tau >= high:
            return high
        s = _sample(tau, g, step)
        if s.value < 0.0:
            high = tau
        else:
            low = tau
        new = tau - s.value / s.rate if s.rate != 0.0 else 0.5 * (low + high)
        if s.value == 0.0 or abs(new - tau) <= 2.0 * EPS * abs(tau):
            return tau
        tau = new
    return high


class Bracket(NamedTuple):
    """Two times (s) between which a rate changes its sign, and the rate at both."""

    a: float
    at_a: float
    b: float
    at_b: float


@scalar_kernel
def _next_inside(bracket: Bracket) -> float:
    """Where the chord of a bracket vanishes; its middle where rounding puts that outside."""
    a, at_a, b, at_b = bracket
    x = b - at_b * (b - a) / (at_b - at_a)
    return x if min(a, b) < x < max(a, b) else 0.5 * (a + b)


@scalar_kernel
def _narrowed(bracket: Bracket, x: float, at_x: float) -> Bracket:
    """The bracket with a rate known inside it, by Anderson and Björck's rule.

    The end that stays has its rate scaled down, so that the next chord comes from its side
    (BIT 13, 1973, p. 253-264): of order 1.7, and never outside.
    """
    a, at_a, b, at_b = bracket
    if (at_x < 0.0) != (at_b < 0.0):
        return Bracket(b, at_b, x, at_x)
    part = 1.0 - at_x / at_b
    # Half (the Illinois rule) where theirs would not keep the sign.
    return Bracket(a, at_a * (part if part > 0.0 else 0.5), x, at_x)


@kernel
def turning_point(
    rate_at: Callable[[float, Any], float], of: Any, bracket: Bracket, tolerance: float
) -> float:
    """Time inside a bracket at which a rate vanishes, to a tolerance (s).

    `rate_at` tells it at a time (s), from what it is the rate `of`.
    """
    for _ in range(MOST_ITERATIONS):
        x = _next_inside(bracket)
        rate = rate_at(x, of)
        if rate == 0.0 or abs(x - bracket.b) <= tolerance:
            return x
        bracket = _narrowed(bracket, x, rate)
    return bracket.b


@kernel
def _rate_at(tau: float, of: tuple[EventFunction, DenseStep]) -> float:
    return _sample(tau, of[0], of[1]).rate


@kernel
def first_event(
    marks: Marks, guards: Guards, rules: Rules, located: Located, step: DenseStep
) -> float:
    """The earliest closing, release or change of branch among what an inspection marked.

    Parameters
    ----------
    marks : Marks
        Of the inspection.
    guards : Guards
        What was inspected.
    rules : Rules
        Constants of the run: which sizes mean nothing.
    located : Located
        Overwritten: who has part in it.
    step : DenseStep
        The step.

    Returns
    -------
    float
        When (s, local); inf where there is none.
    """
    released, kinked = located.released.copy(), located.kinked.copy()
    clear_located(located)
    first = step.dense.end
    any_event = False
    for kind in range(3):
        of_kind = marks.closing if kind == _GAP else marks.detaching
        if kind == _KINK:
            of_kind = marks.kink
        for i in range(of_kind.size):
            if not of_kind[i]:
                continue
            noise = guards.force_noise if kind == _FORCE else rules.length_noise
            if kind == _KINK:
                noise = noise_on_branch(i, guards, rules.length, rules.time)
            g = EventFunction(kind, i, noise, 0.0)
            if (kind == _FORCE and released[i]) or (kind == _KINK and kinked[i]):
                g = EventFunction(kind, i, noise, _level_of_kept(g, step))
            # No further than to the first so far, of which only what comes as early has part.
            tau = first_below(g, first, step)
            if tau == np.inf:
                continue
            # Those found before come later.
            if tau < first:
                clear_located(located)
            first, any_event = tau, True
            if kind == _GAP:
                located.closing[i] = True
            elif kind == _FORCE:
                located.released[i] = True
            else:
                located.kinked[i] = True
    if not any_event:
        return np.inf
    # The searches have looked elsewhere since.
    observe_at(first, step)
    add_vanished(step.observed, guards, rules, located)
    return first


@kernel
def _level_of_kept(g: EventFunction, step: DenseStep) -> float:
    """What counts as zero of a force or margin that has just passed zero and is as it was before.

    Where an instant decides nothing, or decides otherwise, what is below zero is so by rounding:
    it must fall further, or the same instant would come again for ever.
    """
    value = _sample(step.dense.start, g, step).value
    return value - g.noise if value < 0.0 else 0.0


@scalar_kernel
def clear_located(located: Located) -> None:
    """Nothing is located."""
    for j in range(located.closing.size):
        located.closing[j] = False
        located.released[j] = False
    for a in range(located.kinked.size):
        located.kinked[a] = False


@scalar_kernel
def any_located(located: Located) -> bool:
    """Whether an event is located."""
    some = False
    for j in range(located.closing.size):
        some = some or located.closing[j] or located.released[j]
    for a in range(located.kinked.size):
        some = some or located.kinked[a]
    return some


@kernel
def add_vanished(observed: Observed, guards: Guards, rules: Rules, located: Located) -> None:
    """Add what happens in the instant in which a contact force vanishes.

    Of links that pass their kink in it, what follows is told by the other branch.
    """
    slowest, level = np.inf, guards.force_noise
    for j in range(located.released.size):
        if located.released[j]:
            _, rate = margin_at_rest(j, guards, observed.contact_force)
            slowest = min(slowest, abs(rate))
    if slowest == np.inf:
        return
    for j in range(located.released.size):
        force, rate = margin_at_rest(j, guards, observed.contact_force)
        if guards.unlocked[j] and force_vanishes(force, rate, level, slowest, rules.time):
            located.released[j] = True
    for a in range(located.kinked.size):
        margin, rate = margin_on_branch(a, guards, observed.elongation)
        # A speed that vanishes is a length in the scene's own time.
        unit = rules.time if guards.turns[a] else 1.0
        if passes_kink(unit * margin, -unit * rate, rules.length, rules.time):
            located.kinked[a] = True


@kernel
def update_peaks(peak: Bools, end: float, near: float, running: Running, step: DenseStep) -> None:
    """Locate the turning points of marked quantities and take them into the extremes.

    Parameters
    ----------
    peak : ndarray of bool, shape (M,)
        Marks of an inspection.
    end : float
        End of the search (s), within the step.
    near : float
        See `Rules`.
    running : Running
        The extremes.
    step : DenseStep
        The step.
    """
    marked = False
    for k in range(peak.size):
        marked = marked or peak[k]
    if not marked:
        return
    start = step.dense.start
    times, samples = np.empty(PARTS + 1), np.empty((2, PARTS + 1, peak.size))
    for i in range(PARTS + 1):
        times[i] = start + (end - start) * i / PARTS if i < PARTS else end
        observe_at(times[i], step)
        for k in range(running.at.gap, running.at.end):
            samples[0, i, k], samples[1, i, k], _ = motion_of(k, running.at, step.observed)
    for k in range(running.at.gap, running.at.end):
        if not peak[k]:
            continue
        g = EventFunction(_MONITORED, k, running.rounding[k], 0.0)
        a = Sample(times[0], samples[0, 0, k], samples[1, 0, k])
        for i in range(1, PARTS + 1):
            b = Sample(times[i], samples[0, i, k], samples[1, i, k])
            if a.rate * b.rate < 0.0:
                _take_turn(a, b, near, g, running, step)
            else:
                between = _other_way(a, b, g, running, step)
                _take_turn(a, between, near, g, running, step)
                _take_turn(between, b, near, g, running, step)
            a = b


@kernel
def _other_way(a: Sample, b: Sample, g: EventFunction, running: Running, step: DenseStep) -> Sample:
    """Where a quantity goes the other way than at both ends, at one of which it may stand still.

    So does a body that starts from rest one way and soon turns to the other. Such a place is looked
    for as long as the cubic through two samples may go beyond them and the extremes so far by more
    than the noise; returned is b where there is none.
    """
    last = b
    for _ in range(DEPTH):
        if _beyond(a, b, g.index, running) <= g.noise:
            break
        middle = _sample(0.5 * (a.tau + b.tau), g, step)
        if middle.rate * (a.rate + b.rate) < 0.0:
            return middle
        # The half that may go further beyond is looked into.
        if _beyond(a, middle, g.index, running) > _beyond(middle, b, g.index, running):
            b = middle
        else:
            a = middle
    return last


@scalar_kernel
def _beyond(a: Sample, b: Sample, i: int, running: Running) -> float:
    """How far the cubic through two samples may go beyond them and the extremes of quantity i."""
    c = cubic_bernstein(a.value, a.rate, b.value, b.rate, b.tau - a.tau)
    high = max(a.value, b.value, running.maximum[i])
    low = min(a.value, b.value, running.minimum[i])
    return max(max(c) - high, low - min(c))


@kernel
def _take_turn(
    a: Sample, b: Sample, near: float, g: EventFunction, running: Running, step: DenseStep
) -> None:
    """Take the turning point between two samples, if any, into the extremes."""
    if a.rate * b.rate < 0.0:
        bracket = Bracket(a.tau, a.rate, b.tau, b.rate)
        # To the rounding of the time, by whose square the value errs.
        tau = turning_point(_rate_at, (g, step), bracket, 4.0 * EPS * step.dense.end)
        value = _sample(tau, g, step).value
        update_turning_point(g.index, value, step.forcing.start + tau, near, running)
    elif b.rate == 0.0:
        # It turns at the sample itself, as between two supports in the middle of a time step.
        update_extreme(g.index, b.value, step.forcing.start + b.tau, running)
