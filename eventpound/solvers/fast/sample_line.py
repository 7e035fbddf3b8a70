"""The straight line that the ground acceleration follows, and steps where it is none at all."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import next_sample, sample_time
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.run import Piece

_ZERO, _SAMPLES = int(Family.ZERO), int(Family.SAMPLES)


class Line(NamedTuple):
    """Where the ground is, and where it goes.

    end: where the next step ends at the latest (s), inf where there is none. since: time since
    the line began (s). g, slope: acceleration at present (m/s²) and its slope (m/s³).
    """

    end: float
    since: float
    g: float
    slope: float


@compiled
def first_segment(family: int, coefficients: Floats, t: float, piece_end: float) -> int:
    """Number of the sample at which the line of a record begins that t (s) is on."""
    if family != _SAMPLES:
        return 0
    following = next_sample(coefficients, t, piece_end)
    return math.floor((following - coefficients[0]) / coefficients[1] + 0.5) - 1


@compiled
def slope_of(segment: int, dt: float, samples: Floats) -> float:
    """Slope of the line that begins at a sample (m/s³)."""
    return float((samples[segment + 1] - samples[segment]) / dt)


@compiled
def line_at(
    segment: int,
    longest: float,
    piece: Piece,
    t: float,
) -> Line:
    """The line that begins at the sample `segment`, on which t (s) is.

    Where the ground stands still it begins anywhere, and steps are `longest` (s) at most. The
    last line of a record, and whatever is not on a line, has no next step.
    """
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    if family == _ZERO:
        return Line(t + longest, 0.0, 0.0, 0.0)
    if family != _SAMPLES or segment + 2 >= samples.size:
        return Line(np.inf, 0.0, 0.0, 0.0)
    origin, dt = coefficients[0], coefficients[1]
    since = t - sample_time(origin, dt, segment)
    slope = slope_of(segment, dt, samples)
    g = samples[segment] + slope * since
    return Line(sample_time(origin, dt, segment + 1), since, g, slope)
