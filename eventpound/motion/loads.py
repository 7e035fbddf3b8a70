"""Loads on bodies beside the ground motion, compiled: forces, and what drives supports.

A piece of the family LOADED holds several signals, each of another family. Its coefficients are

    [rows, first link, M, row 0, row 1 ... row n, numbers of all signals]
    row: family, range of its numbers (2), range of its samples (2), factor, body, mass, driven,
         s and s' where the piece starts

Row 0 is the ground acceleration. Another row is a load, factor times its signal (N), on one
body; each has a *load link* from the body to the ground, the links from `first link` on, which
has no law of its own: so a mode knows what moves with whom. A support is a body so heavy,
M (kg), that nothing moves it but its load, M times its acceleration in space; M is a power of
two, so that the product is exact. Mass is that of a body that is no support, on the
first of its rows, else zero. s and s' of a support are relative to the ground.
"""

from __future__ import annotations

from eventpound.motion.base import Family
from eventpound.motion.forcing import Formula, places_of, signal_taylor, signal_value
from eventpound.motion.loaded import FIRST_ROW, ROW_WIDTH
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel

LOADED = int(Family.LOADED)
_GAUSSIAN, _SINUSOIDS = int(Family.GAUSSIAN), int(Family.SINUSOIDS)
_SAMPLES = int(Family.SAMPLES)
_FACTOR, _BODY, _MASS, _DRIVEN, _PLACE, _SPEED = range(5, ROW_WIDTH)


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
def heavy_mass(coefficients: Floats) -> float:
    """M (kg)."""
    return coefficients[2]


@scalar_kernel
def body_of(row: int, coefficients: Floats) -> int:
    """The body on which a load acts."""
    return int(coefficients[FIRST_ROW + ROW_WIDTH * row + _BODY])


@scalar_kernel
def own_mass(row: int, coefficients: Floats) -> float:
    """Mass of the body of a load (kg), zero of a support and after its first load."""
    return coefficients[FIRST_ROW + ROW_WIDTH * row + _MASS]


@scalar_kernel
def is_driven(row: int, coefficients: Floats) -> bool:
    """Whether a load drives a support."""
    return coefficients[FIRST_ROW + ROW_WIDTH * row + _DRIVEN] != 0.0


@scalar_kernel
def place_supports(coefficients: Floats, u: Floats, v: Floats) -> None:
    """Put supports where they are as a piece starts, displacements u and velocities v (N,).

    What an integrator has left of their motion is its error.
    """
    for row in range(1, rows_of(coefficients) + 1):
        if is_driven(row, coefficients):
            at, b = FIRST_ROW + ROW_WIDTH * row, body_of(row, coefficients)
            u[b], v[b] = coefficients[at + _PLACE], coefficients[at + _SPEED]


@scalar_kernel
def load_value(row: int, piece: Formula, t: float) -> float:
    """A load of a LOADED piece (N) at the time t (s)."""
    coefficients, samples = piece.coefficients, piece.samples
    family, low, high, first, last = places_of(row, coefficients)
    factor = coefficients[FIRST_ROW + ROW_WIDTH * row + _FACTOR]
    return factor * signal_value(family, coefficients[low:high], samples[first:last], t)


@scalar_kernel
def load_taylor(row: int, piece: Formula, t: float, order: int, out: Floats) -> None:
    """Taylor coefficients of a load into `out` (order or more,) (N/s^k)."""
    coefficients, samples = piece.coefficients, piece.samples
    family, low, high, first, last = places_of(row, coefficients)
    signal_taylor(family, coefficients[low:high], samples[first:last], t, order, out)
    factor = coefficients[FIRST_ROW + ROW_WIDTH * row + _FACTOR]
    for k in range(order):
        out[k] *= factor


@scalar_kernel
def add_body_loads(piece: Formula, t: float, force: Floats) -> None:
    """Add every load at the time t (s) to the forces on the bodies (N,), in N.

    On a support nothing else counts.
    """
    coefficients = piece.coefficients
    for row in range(1, rows_of(coefficients) + 1):
        b, load = body_of(row, coefficients), load_value(row, piece, t)
        force[b] = load if is_driven(row, coefficients) else force[b] + load


@scalar_kernel
def add_load_series(piece: Formula, t: float, order: int, work: Floats, force: Floats) -> None:
    """Add the Taylor coefficients of every load to those of the bodies, `force` (order, N).

    On a support nothing else counts. `work` (order or more,) is overwritten.
    """
    coefficients = piece.coefficients
    for row in range(1, rows_of(coefficients) + 1):
        load_taylor(row, piece, t, order, work)
        b = body_of(row, coefficients)
        driven = is_driven(row, coefficients)
        for k in range(order):
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
