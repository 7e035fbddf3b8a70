"""Synthetic motions as files and as a table.

Motion n of a seed depends on the two numbers only, not on how many there are.
The motion used is the one the file holds: seven decimals of its exponent form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.motion.base import Scales
from eventpound.motion.readers.base import Given, RecordData, Source
from eventpound.motion.readers.dialects import AT2
from eventpound.motion.record import Record
from eventpound.motion.synthetic.filtered_noise import (
    Filter,
    Modulation,
    at_rest_in_the_end,
    modulation_of,
    unit_process,
)
from eventpound.motion.synthetic.population import Parameters, Site, draw_parameters, draw_site
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

TIME_STEP = 0.01
"""Distance of the samples (s)."""
SHARE_AT_END = 0.999
"""Share of the expected Arias intensity after which the noise ends."""
TAIL = 15.0
"""What follows (s): the ground comes to rest, omega_c TAIL = 9.4."""
_COLUMNS = 5


@dataclass(frozen=True)
class SyntheticMotion:
    """One synthetic motion.

    Parameters
    ----------
    seed, number : int
        What it is drawn with; the number counts from 1.
    site : Site
        Earthquake and place.
    parameters : Parameters
        Of the stochastic model.
    modulation : Modulation
        The modulating function.
    acceleration : ndarray, shape (n,)
        Before it is printed (m/s^2).
    """

    seed: int
    number: int
    site: Site
    parameters: Parameters
    modulation: Modulation
    acceleration: Floats

    @property
    def name(self) -> str:
        """Name of its file."""
        return f"synthetic-{self.seed}-{self.number:04d}.AT2"

    @cached_property
    def content(self) -> bytes:
        """Its file."""
        return _at2(self).encode("ascii")

    @cached_property
    def record(self) -> RecordData:
        """What a reader finds in its file."""
        (channel,) = AT2.reader().channels(Source(self.name, self.content), Given())
        return channel.read()


def synthetic_motion(seed: int, number: int) -> SyntheticMotion:
    """Motion `number` (from 1) of a seed.

    Parameters
    ----------
    seed : int
        Not negative.
    number : int
        From 1.

    Returns
    -------
    SyntheticMotion
        The same for the same two numbers.
    """
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
    site = draw_site(random)
    parameters = draw_parameters(site, random)
    modulation = modulation_of(parameters.I_a, parameters.D_5_95, parameters.t_mid)
    steps = int(np.ceil(modulation.time_of(SHARE_AT_END) / TIME_STEP))
    shape = Filter(
        parameters.omega_mid, parameters.omega_prime, parameters.t_mid, parameters.zeta_f
    )
    process = unit_process(shape, random.standard_normal(steps), TIME_STEP)
    shaking = modulation(TIME_STEP * np.arange(steps + 1, dtype=np.float64)) * process
    padded = np.concatenate((shaking, np.zeros(round(TAIL / TIME_STEP))))
    acceleration = at_rest_in_the_end(padded, TIME_STEP)
    return SyntheticMotion(seed, number, site, parameters, modulation, acceleration)


def _at2(motion: SyntheticMotion) -> str:
    """The text of a PEER file, with nothing in it that a reader could take for an event."""
    site = motion.site
    header = [
        "SYNTHETIC GROUND MOTION, NOT A RECORD (eventpound)",
        "synthetic: model of Rezaeian and Der Kiureghian, "
        f"seed {motion.seed}, number {motion.number}, M {site.M:.2f}, R {site.R:.1f} km",
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {motion.acceleration.size:6d}, DT= {TIME_STEP:7.4f} SEC",
    ]
    numbers = [f"{a:15.7E}" for a in (motion.acceleration / STANDARD_GRAVITY).tolist()]
    rows = ["".join(numbers[i : i + _COLUMNS]) for i in range(0, len(numbers), _COLUMNS)]
    return "\n".join([*header, *rows]) + "\n"


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
