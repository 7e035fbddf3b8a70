"""A synthetic motion as a file that every reader of PEER files takes.

Motion n of a seed depends on the two numbers only, not on how many there are.
The motion used is the one the file holds: seven decimals of its exponent form.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.motion.readers.base import Given, RecordData, Source
from eventpound.motion.readers.dialects import AT2
from eventpound.motion.synthetic.filtered_noise import Filter, at_rest_in_the_end, unit_process
from eventpound.motion.synthetic.modulation import Modulation, modulation_of
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
