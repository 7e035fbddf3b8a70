"""Response spectra: the largest responses of elastic oscillators to a ground motion.

    u'' + 2 xi w u' + w^2 u = -a_g(t),    w = 2 pi/T
    SD = max |u|        PSV = w SD        PSA = w^2 SD

A record is linear between its samples, and the fast solver follows each stretch by its closed
form, so that a peak between samples counts. A run goes on for a period after the motion, in
which a free vibration is largest. Source: A. K. Chopra, Dynamics of Structures, chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.many import simulate_many
from eventpound.motion.base import GroundMotion
from eventpound.numerics.arrays import Floats
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Linear, Spring
from eventpound.units import STANDARD_GRAVITY, Dimension, quantity

if TYPE_CHECKING:
    import pandas as pd

PERIODS = np.geomspace(0.05, 10.0, 200)
"""Where a spectrum is computed that does not say (s)."""
_RTOL = 1e-8


def response_spectrum(
    motion: GroundMotion,
    damping: float | str = 0.05,
    periods: Sequence[float] | Floats = PERIODS,
) -> pd.DataFrame:
    """Compute the response spectrum of a ground motion.

    Parameters
    ----------
    motion : GroundMotion
        One that ends.
    damping : float
        Ratio of critical damping, 0.05 or ``"5 %"``; below 1.
    periods : sequence of float
        T (s), positive.

    Returns
    -------
    DataFrame
        Columns period (s), SD (m), PSV (m/s), PSA (m/s^2) and PSA_g (g).

    Raises
    ------
    InputError
        Where the motion has no end, or a number is out of its range.
    """
    import pandas as pd

    ratio = quantity(damping, Dimension.NUMBER)
    period = np.asarray(periods, dtype=np.float64)
    if not 0.0 <= ratio < 1.0:
        raise InputError(f"damping: found {damping!r}; accepted: a ratio from 0 to below 1")
    if period.ndim != 1 or not period.size or not (np.isfinite(period) & (period > 0.0)).all():
        raise InputError("periods: accepted: positive times (s), one at least")
    if not np.isfinite(motion.end):
        raise InputError(f"a spectrum needs a motion that ends, and {motion.kind} does not")
    omega = 2.0 * np.pi / period
    scene = Scene(
        (Body("oscillator", 1.0),),
        (Spring("spring", (GROUND, "oscillator"), Linear(1.0)),),
        (Dashpot((GROUND, "oscillator"), 1.0),),
        motion=motion,
    )
    many = simulate_many(
        scene,
        {
            "spring.spring.stiffness": omega**2,
            f"dashpot.{GROUND}-oscillator.coefficient": 2.0 * ratio * omega,
        },
        rtol=_RTOL,
        duration=motion.end + period,
    )
    largest = np.maximum(many.displacement.maximum, -many.displacement.minimum)[:, 0]
    acceleration = omega**2 * largest
    return pd.DataFrame(
        {
            "period": period,
            "SD": largest,
            "PSV": omega * largest,
            "PSA": acceleration,
            "PSA_g": acceleration / STANDARD_GRAVITY,
        }
    )
