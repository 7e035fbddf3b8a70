"""The ground motion under a single body.

The coefficients of a series are ``g[k] even`` and ``g[k] odd``: for a single
sinusoid, a record between samples and no motion, even and odd are the
acceleration and its rate, and g stays the same for the whole piece.
"""

from __future__ import annotations

import math

from eventpound.motion.base import Family
from eventpound.motion.forcing import (
    ground_acceleration,
    ground_taylor,
    next_sample,
    sample_time,
)
from eventpound.motion.parametric import ZERO_OF_PHASE
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.single_places import COSINE, OF_G, PIECE_KNOWN, ROOM, SINE
from eventpound.solvers.fast.single_series import INVERSE_PAIRS

_ZERO, _SINUSOIDS, _SAMPLES = int(Family.ZERO), int(Family.SINUSOIDS), int(Family.SAMPLES)


@compiled
def is_pair(family: int, coefficients: Floats) -> bool:
    """Whether acceleration and rate tell the whole series."""
    return family in (_ZERO, _SAMPLES) or (family == _SINUSOIDS and coefficients.size == 4)


@compiled_apart
def know_piece(piece: int, family: int, coefficients: Floats, w: Floats) -> None:
    """Fill g for a piece where it is the same throughout."""
    w[PIECE_KNOWN] = piece + 1.0
    if not is_pair(family, coefficients):
        return
    g = w[OF_G : OF_G + ROOM]
    g[:] = 0.0
    g[0] = g[1] = 1.0
    if family == _SINUSOIDS:
        square = coefficients[2] * coefficients[2]
        for k in range(ROOM - 2):
            g[k + 2] = -square * g[k] * INVERSE_PAIRS[k]
        cosine, sine = math.cos(coefficients[3]), math.sin(coefficients[3])
        w[COSINE] = cosine if abs(cosine) >= ZERO_OF_PHASE else 0.0
        w[SINE] = sine if abs(sine) >= ZERO_OF_PHASE else 0.0


@compiled
def pair_at(
    t: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    segment: int,
    w: Floats,
) -> tuple[float, float]:
    """Acceleration (m/s²) and its rate at t (s), a record's on the line after sample `segment`."""
    if family == _SAMPLES:
        dt = coefficients[1]
        rate = (samples[segment + 1] - samples[segment]) / dt
        return samples[segment] + rate * (t - sample_time(coefficients[0], dt, segment)), rate
    if family == _SINUSOIDS:
        frequency = coefficients[2]
        angle = frequency * (t - coefficients[0])
        c, s = math.cos(angle), math.sin(angle)
        cosine = c * w[COSINE] - s * w[SINE]
        sine = s * w[COSINE] + c * w[SINE]
        return coefficients[1] * cosine, -coefficients[1] * frequency * sine
    return 0.0, 0.0


@compiled_apart
def expand_ground(
    t: float, order: int, family: int, coefficients: Floats, samples: Floats, g: Floats
) -> float:
    """Fill g at t (s) for the other motions, for which even and odd are 1; the acceleration."""
    ground_taylor(family, coefficients, samples, t, order, g)
    return float(g[0])


@compiled_apart
def other_acceleration(t: float, family: int, coefficients: Floats, samples: Floats) -> float:
    """Acceleration of the other motions (m/s²)."""
    return float(ground_acceleration(family, coefficients, samples, t))


@compiled
def sample_after(
    coefficients: Floats, samples: Floats, t: float, piece_end: float
) -> tuple[float, int]:
    """Next sample of a record after t (s), or the end of the piece; the sample before."""
    stop = next_sample(coefficients, t, piece_end)
    origin, dt = coefficients[0], coefficients[1]
    segment = math.floor((stop - origin) / dt - 0.5)
    if stop == piece_end:
        segment = math.floor((t - origin) / dt + 1e-9)
    return stop, min(max(segment, 0), samples.size - 2)
