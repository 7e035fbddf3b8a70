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
from eventpound.motion.base import GroundMotion
from eventpound.motion.scaling import PERIODS, read_damping, read_periods, spectrum_columns
from eventpound.numerics.arrays import Floats
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Linear, Spring
from eventpound.study.many import simulate_many

if TYPE_CHECKING:
    import pandas as pd

_RTOL = 1e-8


def response_spectrum(
    motion: GroundMotion, damping: float | str = 0.05, periods: Sequence[float] | Floats = PERIODS
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

    ratio, period = read_damping(damping), read_periods(periods)
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
    return pd.DataFrame(spectrum_columns(period, largest))
