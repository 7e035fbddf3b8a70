"""Impacts read off a sampled motion, as of a stepper that does not report any.

An impact of a contact with gap g and rate γ = g' lies where γ turns from closing to
opening while the gap is closed: between two rows of one instant with g near zero, within
a step in which the bodies get as far as each other, or, for a compliant contact, at the
row at which g < 0 began. A smooth near miss turns as well, but its γ at the rows beside
the turn is the acceleration times a step, so that it counts as a very slow impact.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.base import Event, EventKind

ROUNDING = 1e-9
"""Part of the largest rate below which a gap does not close."""
CLOSED = 1e-6
"""Part of the largest displacement that a gap at a double row may be off zero."""


def inferred_impacts(model: Model, t: Floats, u: Floats, v: Floats) -> tuple[Event, ...]:
    """Impacts of a sampled motion, in order of time.

    Parameters
    ----------
    model : Model
        The scene.
    t : ndarray, shape (n,)
        Times (s), not decreasing; two rows of one time are before and after a jump.
    u, v : ndarray, shape (n, N)
        Displacements (m) and velocities (m/s).

    Returns
    -------
    tuple of Event
        Impulses and lost energies are not known (NaN); every impact is a group of its own.
    """
    gaps = model.gap + differences(u, model.left, model.right)
    rates = differences(v, model.left, model.right)
    length = float(np.abs(u).max(initial=0.0))
    found = [
        (time, j, before, after)
        for j in range(model.contacts)
        for time, before, after in _turns(t, gaps[:, j], rates[:, j], length)
    ]
    return tuple(
        Event(time, EventKind.IMPACT, group, j, before, after, np.nan, np.nan)
        for group, (time, j, before, after) in enumerate(sorted(found))
    )


def differences(values: Floats, first: Ints, second: Ints) -> Floats:
    """Value at each second end less that at the first, the ground's zero; shape (n, k).

    Parameters
    ----------
    values : ndarray, shape (n, N)
        Of the bodies, a row an instant.
    first, second : ndarray of int, shape (k,)
        Bodies; -1 is the ground or a barrier.
    """
    extended = np.column_stack((values, np.zeros(values.shape[0])))
    return np.asarray(extended[:, second] - extended[:, first])


def _turns(
    t: Floats, gap: Floats, rate: Floats, length: float
) -> Iterator[tuple[float, float, float]]:
    """Time, closing and opening rate of the impacts of one contact."""
    slow = ROUNDING * float(np.abs(rate).max(initial=0.0))
    turning = np.flatnonzero((rate[:-1] < -slow) & (rate[1:] >= -slow))
    last_entry = -1
    for k in turning.tolist():
        if min(gap[k], gap[k + 1]) > _reach(t, rate, k, length):
            continue
        entry, leaving = _contact(t, gap, rate, k, slow)
        if entry == last_entry:
            continue
        last_entry = entry
        step = float(t[entry + 1] - t[entry])
        late = max(float(gap[entry]), 0.0) / -float(rate[entry])
        yield float(t[entry]) + min(late, step), float(rate[entry]), float(rate[leaving])


def _contact(t: Floats, gap: Floats, rate: Floats, k: int, slow: float) -> tuple[int, int]:
    """Last row before and first row after the closed stretch around a turn after row k."""
    entry, leaving = k, k + 1
    if t[k + 1] == t[k]:
        return entry, leaving
    while entry > 0 and gap[entry] < 0.0 and rate[entry - 1] < -slow:
        entry -= 1
    while leaving + 1 < t.size and gap[leaving] < 0.0 and rate[leaving + 1] > slow:
        leaving += 1
    return entry, leaving


def _reach(t: Floats, rate: Floats, k: int, length: float) -> float:
    """Gap (m) below which a contact may have closed between rows k and k + 1."""
    step = float(t[k + 1] - t[k])
    if step == 0.0:
        return CLOSED * length
    return step * max(abs(float(rate[k])), abs(float(rate[k + 1])))
