"""Impacts read off a sampled motion, as of a stepper that does not report any.

How one is known is said where a contact's are found (`eventpound.score.turns`). A near miss that
coarse rows do not show to be one has a rate of the acceleration times a step there, so that it
counts as a very slow impact.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.score import turns
from eventpound.solvers.base import Event, EventKind


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
    gaps, rates = model.gaps(u), model.rates(v)
    length = float(np.abs(u).max(initial=0.0))
    found = [
        (time, j, before, after)
        for j in range(model.contacts)
        for time, before, after in turns(t, gaps[:, j], rates[:, j], length)
    ]
    return tuple(
        Event(time, EventKind.IMPACT, group, j, before, after, np.nan, np.nan)
        for group, (time, j, before, after) in enumerate(sorted(found))
    )
