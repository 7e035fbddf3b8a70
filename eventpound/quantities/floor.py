"""Floor spectra: the largest responses of oscillators that stand on a body which may be struck.

For an oscillator of period T = 2 pi/w and damping ratio xi on a body of absolute displacement
U = u + u_g, so light that the body does not feel it, with q its elongation,

    q'' + 2 xi w q' + w^2 q = -U'',       q = q' = 0 at the start

    SD = max |q|    PSV = w SD    PSA = w^2 SD    SA = max |w^2 q + 2 xi w q'|

SA is the absolute acceleration of the oscillator. An impact of the body is an impulse on the
oscillator: where U' jumps, q' jumps by as much the other way, and q goes on. Nothing stands in
for the impact, so nothing of its force has to be resolved in time.

Between two rows U is the quintic of U, U', U'' at both, and what an oscillator makes of it is
known to rounding (`eventpound.motion.swing`). The quintic meets U and U' at the rows, so what it
errs by, e = O(h^6), acts through two integrations by parts as w^2 e: the error of q is O(h^6) of
the motion, not the O(h^4) of the accelerations. Rows are doubled until no number changes by more
than `between.AGREEMENT`.

Source of SD, PSV, PSA: A. K. Chopra, Dynamics of Structures, chapter 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.motion.base import GroundMotion
from eventpound.motion.oscillators import spectrum_columns
from eventpound.motion.swing import largest_swings
from eventpound.numerics.arrays import Floats
from eventpound.quantities.between import Between, quintic_parts

if TYPE_CHECKING:
    import pandas as pd


def floor_table(
    rows: Between,
    motion: GroundMotion,
    bodies: Sequence[str],
    periods: Floats,
    ratios: Sequence[float],
) -> pd.DataFrame:
    """Floor spectra of some bodies.

    Parameters
    ----------
    rows : Between
        Their motion relative to the ground.
    motion : GroundMotion
        That of the ground.
    bodies : sequence of str
        Which.
    periods : ndarray, shape (k,)
        T (s).
    ratios : sequence of float
        xi, each below 1.

    Returns
    -------
    DataFrame
        Columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2), PSA_g (g) and
        SA (m/s^2).
    """
    import pandas as pd

    # Of a scene with supports the rows have these before the bodies.
    columns = [body.name for body in rows.scene.bodies]
    t = rows.t
    ground = motion.displacement(t), motion.velocity(t), motion.acceleration(t)
    parts = []
    for name in bodies:
        place = columns.index(name)
        own = (rows.u[:, place], rows.v[:, place], rows.a[:, place])
        u, v, a = (x + x_g for x, x_g in zip(own, ground, strict=True))
        for ratio in ratios:
            largest = _largest_responses(t, u, v, a, periods, ratio)
            table = pd.DataFrame(spectrum_columns(periods, largest[:, 0]))
            table.insert(0, "damping", ratio)
            table.insert(0, "body", name)
            parts.append(table.assign(SA=largest[:, 1]))
    return pd.concat(parts, ignore_index=True)


def _largest_responses(
    t: Floats, u: Floats, v: Floats, a: Floats, periods: Floats, ratio: float
) -> Floats:
    """Largest |q| (m) and |q'' + U''| (m/s^2) of oscillators on a moving body, shape (k, 2)."""
    h = np.diff(t)
    c3, c4, c5 = quintic_parts(u, v, a, h)
    push = np.stack([h**2 * a[:-1], 6.0 * c3, 12.0 * c4, 20.0 * c5], axis=1)
    found = np.zeros((periods.size, 2))
    largest_swings(h, push, np.diff(v), 2.0 * math.pi / periods, ratio, found)
    return found
