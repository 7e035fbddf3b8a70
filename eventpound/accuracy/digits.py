"""How many digits of the motion hold, moment by moment.

    digits(t)        = -log10(error(t)/L),  L the largest displacement
    amplification(t) = Δ(t)/(η L)

with error(t) the larger one of S times the difference of the reference's two
tolerances and the distance to the nearest independent route. Where the motion is
chaotic the amplification grows exponentially with the impacts, and digits are lost
at the same rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.bound import SAFETY
from eventpound.accuracy.conditioning import LARGE
from eventpound.accuracy.quantities import own_scale
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import History
from eventpound.tolerances import EPS

WINDOWS = 50
"""Moments at which digits are stated."""
LOST = 1e3
"""Amplification from which digits count as lost: three of them."""


@dataclass(frozen=True)
class DigitsOverTime:
    """Digits of the displacements, worst body, in stretches of time.

    Parameters
    ----------
    start : float
        Where the first stretch begins (s).
    t : ndarray, shape (n,)
        Ends of the stretches (s).
    digits : ndarray, shape (n,)
        Decimal digits on which the routes agree, at most 16.
    amplification : ndarray, shape (n,)
        Largest in the stretch.
    lost_from : float or None
        When the amplification first reached `LOST` (s), None where it never did.
    """

    start: float
    t: Floats
    digits: Floats
    amplification: Floats
    lost_from: float | None


def positions(history: History, times: Floats) -> Floats:
    """Displacements at some times of a history, shape (times, N) (m)."""
    return np.column_stack(
        [np.interp(times, history.t, history.u[:, i]) for i in range(history.u.shape[1])]
    )


def digits_over_time(
    times: Floats,
    reference: Floats,
    loose: Floats,
    others: Sequence[Floats],
    growth: Floats,
    of_scene: float,
) -> DigitsOverTime:
    """Digits and amplification in equal stretches of time.

    Parameters
    ----------
    times : ndarray, shape (m,)
        Of the positions (s).
    reference, loose : ndarray, shape (m, N)
        Displacements of the reference at both tolerances (m).
    others : sequence of ndarray, shape (m, N)
        Those of independent routes.
    growth : ndarray, shape (m,)
        Largest change of any displacement where inputs change by `LARGE` (m).
    of_scene : float
        Length that is L where no displacement is more than rounding (m).
    """
    length = float(own_scale(np.max(np.abs(reference), initial=0.0), of_scene))
    error = SAFETY * np.max(np.abs(reference - loose), axis=1)
    if others:
        apart = [np.max(np.abs(reference - other), axis=1) for other in others]
        error = np.maximum(error, np.min(apart, axis=0))
    amplification = growth / (LARGE * length)
    lost = np.flatnonzero(amplification >= LOST)
    parts = np.array_split(np.arange(times.size), min(WINDOWS, times.size))
    worst = np.array([max(float(np.max(error[part])) / length, EPS) for part in parts])
    return DigitsOverTime(
        float(times[0]),
        np.array([times[part[-1]] for part in parts]),
        np.minimum(16.0, -np.log10(worst)),
        np.array([float(np.max(amplification[part])) for part in parts]),
        float(times[lost[0]]) if lost.size else None,
    )
