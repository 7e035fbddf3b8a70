"""The parameters and scales of synthetic motions as a table."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from eventpound.motion.base import Scales
from eventpound.motion.record import Record
from eventpound.motion.synthetic.files import SyntheticMotion
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

QUANTITIES = ("PGA (g)", "T_m (s)", "L_e (cm)")
"""What `spread` gives."""
_HEADER = (
    "file,kind,seed,number,M,F,R (km),V_S30 (m/s),I_a (m/s),D_5-95 (s),t_mid (s),"
    "omega_mid (rad/s),omega_prime (rad/s^2),zeta_f,alpha_1,alpha_2,alpha_3 (1/s),"
    "PGA (m/s^2),T_m (s),L_e (m)"
)


def parameter_table(motions: Sequence[SyntheticMotion]) -> bytes:
    """CSV with a row a motion: what it was drawn with and what its scales are."""
    return "\n".join([_HEADER, *map(_row, motions), ""]).encode("ascii")


def spread(motions: Sequence[SyntheticMotion]) -> Floats:
    """Least, median and largest of `QUANTITIES`, shape (3, 3)."""
    found = [_scales(motion) for motion in motions]
    rows = [(s.a_g / STANDARD_GRAVITY, s.period, 100.0 * s.length) for s in found]
    values: Floats = np.quantile(rows, [0.0, 0.5, 1.0], axis=0).T
    return values


def _row(motion: SyntheticMotion) -> str:
    site, p, q, scales = motion.site, motion.parameters, motion.modulation, _scales(motion)
    numbers = [
        *(site.M, site.F, site.R, site.V),
        *(p.I_a, p.D_5_95, p.t_mid, p.omega_mid, p.omega_prime, p.zeta_f),
        *(q.alpha_1, q.alpha_2, q.alpha_3),
        *(scales.a_g, 2.0 * math.pi / scales.omega_g, scales.length),
    ]
    return ",".join(
        [motion.name, "synthetic", str(motion.seed), str(motion.number), *map(repr, numbers)]
    )


def _scales(motion: SyntheticMotion) -> Scales:
    scales = Record(motion.record.acceleration, motion.record.time_step).scales()
    assert scales is not None, "it has motion in the band of T_m"
    return scales
