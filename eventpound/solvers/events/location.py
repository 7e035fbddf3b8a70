"""When within a step something happens, on the integrator's own interpolant.

`look(τ)` returns everything observed at a time of the step; a *quantity* picks
a value and its rate from it. Between two looks the Bernstein coefficients of
the Hermite cubic bound the quantity; while they leave room for a crossing the
stretch is divided, so a dip that begins and ends inside a step is found, and
one that misses by more than the interpolant's own error is not reported.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Protocol

from scipy.optimize import brentq

from eventpound.mechanics.observables import Observed
from eventpound.numerics.complementarity import EPS
from eventpound.numerics.hermite import cubic_bernstein

Quantity = Callable[[Observed], tuple[float, float]]
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

    def sample(tau: float) -> tuple[float, float, float]:
        value, rate = quantity(step.look(tau))
        return tau, value, rate

    def search(
        a: tuple[float, float, float], b: tuple[float, float, float], depth: int
    ) -> float | None:
        width = b[0] - a[0]
        bound = cubic_bernstein(a[1], a[2], b[1], b[2], width)
        changes = sum((p < 0.0) != (q < 0.0) for p, q in pairwise(bound))
        if b[1] < -noise and changes <= 1:
            return _falling_root(sample, a, b)
        if b[1] >= -noise and min(bound) > 0.05 * (max(bound) - min(bound)) - noise:
            return None
        if depth == 0 or width <= 8.0 * EPS * max(abs(b[0]), step.end - step.start):
            return _falling_root(sample, a, b) if b[1] < -noise else None
        if a[2] < 0.0 < b[2] and b[1] >= -noise:
            lowest = sample(brentq(lambda tau: sample(tau)[2], a[0], b[0], xtol=2 * EPS * b[0]))
            return _falling_root(sample, a, lowest) if lowest[1] < -noise else None
        middle = sample(a[0] + 0.5 * width)
        if middle[1] < -noise:
            return search(a, middle, depth - 1)
        found = search(a, middle, depth - 1)
        return found if found is not None else search(middle, b, depth - 1)

    first = sample(step.start)
    return search((first[0], max(first[1], 0.0), first[2]), sample(end), DEPTH)


def _falling_root(
    sample: Callable[[float], tuple[float, float, float]],
    a: tuple[float, float, float],
    b: tuple[float, float, float],
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


def turning_points(step: Step, quantity: Quantity, end: float) -> list[float]:
    """Times at which the rate of a quantity changes sign, up to `end`.

    Parameters
    ----------
    step : Step
        Where to look.
    quantity : callable
        Value and rate.
    end : float
        End of the search (s).

    Returns
    -------
    list of float
        In order; found between four equal parts of the stretch.
    """
    parts = 4

    def rate(tau: float) -> float:
        return quantity(step.look(tau))[1]

    times = [step.start + (end - step.start) * i / parts for i in range(parts)] + [end]
    rates = [rate(tau) for tau in times]
    found = []
    for i in range(parts):
        if rates[i] * rates[i + 1] < 0.0:
            found.append(float(brentq(rate, times[i], times[i + 1], xtol=4.0 * EPS * end)))
    return found
