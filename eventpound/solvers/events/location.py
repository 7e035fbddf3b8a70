"""When within a step something happens, on the integrator's own interpolant.

`look(τ)` returns everything observed at a time of the step; a *quantity* picks
a value and its rate from it. Between two looks the Bernstein coefficients of
the Hermite cubic bound the quantity; while they leave room for a crossing the
stretch is divided, so a dip that begins and ends inside a step is found, and
one that misses by more than the interpolant's own error is not reported.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Protocol

from scipy.optimize import brentq

from eventpound.mechanics.observables import Observed
from eventpound.numerics.compiled import in_python
from eventpound.numerics.complementarity import EPS
from eventpound.numerics.hermite import cubic_bernstein

Quantity = Callable[[Observed], tuple[float, float]]
Sample = tuple[float, float, float]
"""Time, value and rate."""
DEPTH = 12
"""Halvings after which a stretch without a change of sign counts as clear."""


class Step(Protocol):
    """A stretch of the motion that can be looked at anywhere."""

    @property
    def start(self) -> float:
        """Where the step begins (s, local)."""
        ...

    @property
    def end(self) -> float:
        """Where the step ends (s, local)."""
        ...

    def look(self, tau: float) -> Observed:
        """Everything observed at `tau` (s); valid until the next look."""
        ...


def first_below(step: Step, quantity: Quantity, end: float, noise: float) -> float | None:
    """First time at which a quantity falls below zero.

    Parameters
    ----------
    step : Step
        Where to look; at its start the quantity counts as not below.
    quantity : callable
        Value and rate of what is watched.
    end : float
        End of the search (s), within the step.
    noise : float
        Depth below zero that means nothing.

    Returns
    -------
    float or None
        Time at which the quantity passes zero, to fall below it by more
        than the noise (s).
    """

    def sample(tau: float) -> Sample:
        value, rate = quantity(step.look(tau))
        return tau, value, rate

    first = sample(step.start)
    shortest = 8.0 * EPS * (step.end - step.start)
    start = (first[0], max(first[1], 0.0), first[2])
    return _search(sample, start, sample(end), noise, shortest, DEPTH)


def _search(
    sample: Callable[[float], Sample],
    a: Sample,
    b: Sample,
    noise: float,
    shortest: float,
    depth: int,
) -> float | None:
    """`first_below` between two samples, the first of them not below."""
    width = b[0] - a[0]
    bound = in_python(cubic_bernstein)(a[1], a[2], b[1], b[2], width)
    changes = sum((p < 0.0) != (q < 0.0) for p, q in pairwise(bound))
    if b[1] < -noise and changes <= 1:
        return _falling_root(sample, a, b)
    if b[1] >= -noise and min(bound) > 0.05 * (max(bound) - min(bound)) - noise:
        return None
    if depth == 0 or width <= max(8.0 * EPS * abs(b[0]), shortest):
        return _falling_root(sample, a, b) if b[1] < -noise else None
    if a[2] < 0.0 < b[2] and b[1] >= -noise:
        lowest = sample(brentq(lambda tau: sample(tau)[2], a[0], b[0], xtol=2 * EPS * b[0]))
        return _falling_root(sample, a, lowest) if lowest[1] < -noise else None
    middle = sample(a[0] + 0.5 * width)
    if middle[1] < -noise:
        return _search(sample, a, middle, noise, shortest, depth - 1)
    found = _search(sample, a, middle, noise, shortest, depth - 1)
    return found if found is not None else _search(sample, middle, b, noise, shortest, depth - 1)


def _falling_root(
    sample: Callable[[float], Sample],
    a: Sample,
    b: Sample,
) -> float:
    """Root between a (not below) and b (below): Newton's iteration kept inside the bracket."""
    low, high = a[0], b[0]
    tau = high if b[2] == 0.0 else high - b[1] / b[2]
    for _ in range(100):
        if not low < tau < high:
            tau = 0.5 * (low + high)
        if tau <= low or tau >= high:
            return high
        _, value, rate = sample(tau)
        if value < 0.0:
            high = tau
        else:
            low = tau
        new = tau - value / rate if rate != 0.0 else 0.5 * (low + high)
        if value == 0.0 or abs(new - tau) <= 2.0 * EPS * abs(tau):
            return tau
        tau = new
    return high


def turning_points(step: Step, quantities: Sequence[Quantity], end: float) -> list[list[float]]:
    """Times at which the rate of each quantity changes sign, up to `end`.

    Parameters
    ----------
    step : Step
        Where to look.
    quantities : sequence of callable
        Value and rate.
    end : float
        End of the search (s).

    Returns
    -------
    list of list of float
        In order, for each quantity; found between four equal parts of the stretch.
    """
    parts = 4
    times = [step.start + (end - step.start) * i / parts for i in range(parts)] + [end]
    rates = []
    for tau in times:
        seen = step.look(tau)
        rates.append([quantity(seen)[1] for quantity in quantities])

    def found(k: int) -> list[float]:
        def rate(tau: float) -> float:
            return quantities[k](step.look(tau))[1]

        return [
            float(brentq(rate, times[i], times[i + 1], xtol=4.0 * EPS * end))
            for i in range(parts)
            if rates[i][k] * rates[i + 1][k] < 0.0
        ]

    return [found(k) for k in range(len(quantities))]
