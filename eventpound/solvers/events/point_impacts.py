"""Impacts of one instant where contacts may be at points between bodies.

The rules are those of `eventpound.solvers.events.impacts`, and so is what ends a cascade; the
matrix ``Wᵀ M⁻¹ W`` is dense, its columns are those of whole contacts, and Python does it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.impact import CANCELLED, QUIET
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lcp import solve_dense
from eventpound.solvers.events.cascade import (
    EVENTS,
    FADED,
    FASTEST_HERE,
    HERE,
    LAST_SPEED,
    LOST_HERE,
    PASSED_ON,
    WINDOW,
    is_endless,
)
from eventpound.solvers.events.impacts import (
    DONE,
    ENDLESS,
    FULL,
    NO_IMPACT,
    Closed,
    close_collapsed,
    is_last,
    list_impacts,
)

NO_DIRECTION = 1e-12
"""Singular values below this part of the largest are zero."""


class Impact(NamedTuple):
    """What an impact does: Λ (N s) and who has part in it, (K,); what is lost (J); if solved."""

    impulse: Floats
    involved: Bools
    lost: float
    solved: bool


def settle_closed_at_points(rows: Floats, closed: Closed) -> int:
    """Put closed contacts on their constraints, and impacts until none approaches.

    Parameters
    ----------
    rows : ndarray, shape (K, N)
        Directions of the gaps, Wᵀ.
    closed : Closed
        As `eventpound.solvers.events.impacts.settle_closed` has it.
    """
    in_python(close_collapsed)(closed)
    shut = closed.gap == 0.0
    if not shut.any():
        return DONE
    _put_on(rows[shut], closed.opening[shut], closed.mass, closed.u)
    ended = _impacts(rows, shut, closed)
    still = shut & (closed.gap_rate == 0.0)
    if ended == DONE and still.any():
        _put_on(rows[still], np.zeros(int(still.sum())), closed.mass, closed.v)
    return ended


def _put_on(rows: Floats, opening: Floats, mass: Floats, x: Floats) -> None:
    """Move bodies the least, weighted by mass, so that ``opening + Wᵀ x`` vanishes."""
    away = opening + rows @ x
    root = np.sqrt(mass)
    x -= np.linalg.lstsq(rows / root, away, NO_DIRECTION)[0] / root


def _impacts(rows: Floats, shut: Bools, closed: Closed) -> int:
    """Impact problems of this instant, until no closed contact approaches."""
    gap_rate, clock, count = closed.gap_rate, closed.clock, closed.count
    while True:
        # What the instant has seen so far outlives a pause in which the record gets more room.
        if count[EVENTS] + 3 * shut.size > closed.events.shape[0]:
            return FULL
        approach = -float(gap_rate[shut].min())
        if approach <= 0.0:
            return DONE
        fastest = clock[FASTEST_HERE] = max(clock[FASTEST_HERE], approach)
        if approach <= FADED * fastest:
            gap_rate[shut & (np.abs(gap_rate) <= 10.0 * FADED * fastest)] = 0.0
            return DONE
        if is_endless(count[HERE], clock[LOST_HERE], clock[PASSED_ON]):
            return ENDLESS
        if count[HERE] % WINDOW == 0:
            clock[LOST_HERE] = clock[PASSED_ON] = 0.0
        plastic = in_python(is_last)(approach, closed)
        restitution = np.zeros(shut.size) if plastic else closed.restitution
        before = gap_rate.copy()
        done = impact_over(rows, closed.mass, restitution, shut, gap_rate, closed.v)
        if not done.solved:
            return NO_IMPACT
        if plastic:
            # Beside a last impact nothing opens more slowly than such impacts are: else two
            # contacts of one body open each other until no number is small enough.
            least = LAST_SPEED * closed.length / closed.time
            gap_rate[shut & (gap_rate > 0.0) & (gap_rate <= least)] = 0.0
        clock[LOST_HERE] += done.lost
        clock[PASSED_ON] -= float(done.impulse @ before)
        in_python(list_impacts)(plastic, before, done.impulse, done.involved, done.lost, closed)


def impact_over(
    rows: Floats, mass: Floats, restitution: Floats, closed: Bools, gap_rate: Floats, v: Floats
) -> Impact:
    """Newton's law over the closed contacts, as `eventpound.mechanics.impact.impact_law`.

    Parameters
    ----------
    rows : ndarray, shape (K, N)
        Directions of the gaps, Wᵀ.
    mass, restitution, closed
        Of the bodies (N,) (kg) and the contacts (K,).
    gap_rate, v : ndarray, shape (K,), (N,)
        Rates of the gaps and velocities (m/s); overwritten.
    """
    impulse, involved = np.zeros(gap_rate.size), closed & (gap_rate <= 0.0)
    W, before = rows[involved], gap_rate[involved]
    eps = restitution[involved]
    noise = QUIET * float(np.max(-before))
    x, w, solved = solve_dense(W / mass @ W.T, (1.0 + eps) * before, noise)
    impulse[involved] = x
    change = W.T @ x / mass
    v += change
    rounding = CANCELLED * (np.abs(gap_rate) + np.abs(rows) @ np.abs(change))
    gap_rate += rows @ change
    # A closed contact that neither opens nor approaches but for rounding stands still.
    gap_rate[closed & (np.abs(gap_rate) <= rounding)] = 0.0
    after = np.where(w > rounding[involved], w, 0.0) - eps * before
    gap_rate[involved] = np.where((before == 0.0) & (after <= noise), 0.0, after)
    # Λ (γ⁻ + γ⁺)/2 with Λ > 0 only where γ⁺ = -ε γ⁻: exactly none for ε = 1.
    lost = -0.5 * float(np.sum(x * (1.0 - eps) * before))
    return Impact(impulse, involved, lost, bool(solved))
