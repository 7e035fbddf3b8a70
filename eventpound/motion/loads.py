"""Loads on bodies beside the ground motion, compiled: forces, and the motions of supports.

A piece of the family LOADED holds several signals, each of another family. Its coefficients are

    [rows, first link, t_0, row 0, row 1 ... row n, numbers of all signals]
    row: family, range of its numbers (2), range of its samples (2), factor, body, driven, d_0, v_0

Row 0 is the ground acceleration. Another row is a load, factor times its signal (N), on one
body; each has a *load link* from the body to the ground, the links from `first link` on, which
has no law of its own: so a mode knows what moves with whom.

The rows of supports come first, and are no forces: they are driven, which means that the signal
is the acceleration of the support in space (m/s²). The ground and they have gone
``d_0 + v_0 (t - t_0)`` beyond the integrals of their formulas (`eventpound.motion.travel`).
"""

from __future__ import annotations

from eventpound.motion.base import Family
from eventpound.motion.forcing import Formula, places_of, signal_taylor, signal_value
from eventpound.motion.loaded import FIRST_ROW, ROW_WIDTH
from eventpound.motion.travel import signal_travel
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel

LOADED = int(Family.LOADED)
_GAUSSIAN, _SINUSOIDS = int(Family.GAUSSIAN), int(Family.SINUSOIDS)
_SAMPLES = int(Family.SAMPLES)
_FACTOR, _BODY, _DRIVEN, _PLACE, _SPEED = range(5, ROW_WIDTH)


@scalar_kernel
def rows_of(coefficients: Floats) -> int:
    """How many loads there are; they are numbered from 1."""
    return int(coefficients[0])


@scalar_kernel
def row_of_link(link: int, coefficients: Floats) -> int:
    """The load of a link of a mode; below 1 where it carries none, as those of contact elements.

    They stand behind the links of the model.
    """
    row = link - int(coefficients[1]) + 1
    return row if row <= rows_of(coefficients) else 0


@scalar_kernel
def body_of(row: int, coefficients: Floats) -> int:
    """The body on which a load acts."""
    return int(coefficients[FIRST_ROW + ROW_WIDTH * row + _BODY])


@scalar_kernel
def is_driven(row: int, coefficients: Floats) -> bool:
    """Whether a load drives a support."""
    return coefficients[FIRST_ROW + ROW_WIDTH * row + _DRIVEN] != 0.0


@scalar_kernel
def support_motion(row: int, piece: Formula, t: float) -> tuple[float, float]:
    """Displacement (m) and velocity (m/s) of a support relative to the ground at the time t (s)."""
    d, v = _travel(row, piece, t)
    d_of_ground, v_of_ground = _travel(0, piece, t)
    # Coordinates are relative to the ground, which has travelled, too.
    return d - d_of_ground, v - v_of_ground


@scalar_kernel
def _travel(row: int, piece: Formula, t: float) -> tuple[float, float]:
    """Displacement (m) and velocity (m/s) in space of the ground, row 0, or of a support."""
    coefficients, samples = piece.coefficients, piece.samples
    family, low, high, first, last = places_of(row, coefficients)
    # Behind the samples stand their running sums, v and d.
    own = samples[first : first + 3 * (last - first)]
    d, v = signal_travel(family, coefficients[low:high], own, t)
    at = FIRST_ROW + ROW_WIDTH * row
    v_0 = coefficients[at + _SPEED]
    return d + coefficients[at + _PLACE] + v_0 * (t - coefficients[2]), v + v_0


@scalar_kernel
def load_value(row: int, piece: Formula, t: float) -> float:
    """A load of a LOADED piece (N), or the acceleration of a support (m/s²), at the time t (s)."""
    coefficients, samples = piece.coefficients, piece.samples
    family, low, high, first, last = places_of(row, coefficients)
    factor = coefficients[FIRST_ROW + ROW_WIDTH * row + _FACTOR]
    return factor * signal_value(family, coefficients[low:high], samples[first:last], t)


@scalar_kernel
def load_taylor(row: int, piece: Formula, t: float, order: int, out: Floats) -> None:
    """Taylor coefficients of `load_value` into `out` (order or more,)."""
    coefficients, samples = piece.coefficients, piece.samples
    family, low, high, first, last = places_of(row, coefficients)
    signal_taylor(family, coefficients[low:high], samples[first:last], t, order, out)
    factor = coefficients[FIRST_ROW + ROW_WIDTH * row + _FACTOR]
    for k in range(order):
        out[k] *= factor


@scalar_kernel
def add_body_loads(piece: Formula, t: float, force: Floats, driven: Floats) -> None:
    """Add every force at the time t (s) to the forces on the bodies (N,), in N.

    The accelerations of supports in space (m/s²) go into `driven` (N,).
    """
    for row in range(1, rows_of(piece.coefficients) + 1):
        b, load = body_of(row, piece.coefficients), load_value(row, piece, t)
        if is_driven(row, piece.coefficients):
            driven[b] = load
        else:
            force[b] += load


@scalar_kernel
def add_load_series(piece: Formula, t: float, order: int, work: Floats, force: Floats) -> None:
    """Add the Taylor coefficients of every force to those of the bodies, `force` (order, N).

    Those of a support become those of its acceleration in space (m/s²). `work` (order or more,)
    is overwritten.
    """
    coefficients = piece.coefficients
    for row in range(1, rows_of(coefficients) + 1):
        load_taylor(row, piece, t, order, work)
        b, driven = body_of(row, coefficients), is_driven(row, coefficients)
        for k in range(order):
            # No force counts for a support: its row is its acceleration.
            force[k, b] = work[k] if driven else force[k, b] + work[k]


@scalar_kernel
def shortest_times(family: int, coefficients: Floats) -> tuple[float, float, bool]:
    """Shortest 1/sqrt(q) of any Gaussian and 1/w of any sinusoid of a piece (s), or inf.

    Last, whether any signal has samples.
    """
    if family != LOADED:
        gaussian, sinusoid = _times_of(family, coefficients, 0, coefficients.size)
        return gaussian, sinusoid, family == _SAMPLES
    gaussian = sinusoid = float("inf")
    sampled = False
    for row in range(rows_of(coefficients) + 1):
        of, low, high, _, _ = places_of(row, coefficients)
        one, other = _times_of(of, coefficients, low, high)
        gaussian, sinusoid = min(gaussian, one), min(sinusoid, other)
        sampled = sampled or of == _SAMPLES
    return gaussian, sinusoid, sampled


@scalar_kernel
def _times_of(family: int, coefficients: Floats, low: int, high: int) -> tuple[float, float]:
    """The first two of `shortest_times` of one signal, whose numbers are those from `low` on."""
    gaussian = sinusoid = float("inf")
    if family == _GAUSSIAN and coefficients[low + 1] > 0.0:
        gaussian = coefficients[low + 1] ** -0.5
    if family == _SINUSOIDS:
        for k in range(low + 1, high, 3):
            if coefficients[k + 1] > 0.0:
                sinusoid = min(sinusoid, 1.0 / coefficients[k + 1])
    return gaussian, sinusoid
