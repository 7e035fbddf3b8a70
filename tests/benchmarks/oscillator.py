"""One body on one Bouc-Wen spring to the ground with a barrier to its right: its numbers.

    m u'' + k u + Q z = -m a_g(t),    z' = (u'/u_y) (1 - kappa |z|^20),    u <= delta

with beta = gamma = 1/2 (kappa = 1 while u' z > 0, else 0), from rest, under one period
of a sinusoid or a record. The programs under yardstick/ solve this and nothing else.
"""

import math
from dataclasses import dataclass

import numpy as np

from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, GROUND, BoucWen, Linear
from eventpound.solvers.base import Task


@dataclass(frozen=True)
class Oscillator:
    """The numbers.

    Parameters
    ----------
    mass, stiffness, strength, yield_displacement, gap, restitution : float
        m, k, Q, u_y, delta (SI) and Newton's coefficient; Q is zero for a linear spring.
    cosine, sine, omega, duration : float
        a_g = cosine cos(omega t) + sine sin(omega t) for 0 <= t <= duration.
    samples : ndarray
        A record, linear between samples; empty for a pulse.
    sample_step : float
        Its time step (s).
    end : float
        Length of the run (s).
    length, rate : float
        Scales of the motion: a_g / omega_g^2 (m) and omega_g (rad/s).
    """

    mass: float
    stiffness: float
    strength: float
    yield_displacement: float
    gap: float
    restitution: float
    cosine: float
    sine: float
    omega: float
    duration: float
    samples: Floats
    sample_step: float
    end: float
    length: float
    rate: float

    def breaks(self) -> list[float]:
        """Times (s) where the ground motion is not smooth and pieces of a run end."""
        if self.samples.size:
            inner = self.sample_step * np.arange(1, self.samples.size)
        else:
            inner = np.array([self.duration])
        return [*inner[inner < self.end].tolist(), self.end]


def oscillator_of(task: Task) -> Oscillator | None:
    """The numbers of a task, or None where it is another kind of scene."""
    scene = task.scene
    if not len(scene.bodies) == len(scene.springs) == len(scene.contacts) == 1 or scene.dashpots:
        return None
    (body,), (spring,), (contact,) = scene.bodies, scene.springs, scene.contacts
    law, motion, scales = spring.law, scene.motion, scene.motion.scales()
    if spring.between != (GROUND, body.name) or contact.right != BARRIER or scales is None:
        return None
    if not isinstance(law, Linear | BoucWen) or task.start != 0.0:
        return None
    strength, yield_displacement = 0.0, 1.0
    if isinstance(law, BoucWen):
        strength, yield_displacement = law.strength, law.yield_displacement
        if (law.exponent, law.beta, law.gamma, law.initial_z) != (20.0, 0.5, 0.5, 0.0):
            return None
    cosine = sine = duration = step = 0.0
    samples = np.empty(0)
    if isinstance(motion, Sine | Cosine):
        sign = -motion.amplitude if motion.reverse else motion.amplitude
        cosine, sine = (sign, 0.0) if isinstance(motion, Cosine) else (0.0, sign)
        duration = motion.duration
    elif isinstance(motion, Record):
        step = motion.time_step
        samples = np.ascontiguousarray(motion.values)
    else:
        return None
    return Oscillator(
        body.mass,
        law.stiffness,
        strength,
        yield_displacement,
        contact.gap,
        contact.restitution,
        cosine,
        sine,
        2.0 * math.pi / duration if duration else 0.0,
        duration,
        samples,
        step,
        task.end,
        scales.length,
        scales.omega_g,
    )
