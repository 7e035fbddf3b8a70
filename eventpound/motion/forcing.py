"""The acceleration of one piece of a ground motion and its Taylor series, compiled.

The formulas are those of `eventpound.motion.base.Family`, a in m/s^2, t in s:

    ZERO       a = 0
    SINUSOIDS  a = sum_k A_k cos(w_k s + p_k),                             s = t - t_r
    GAUSSIAN   a = (c_0 + c_1 s + c_2 s^2 + c_3 s^3) exp(-q s^2),           s = t - t_c
    SAMPLES    a = a_i + (a_{i+1} - a_i) (t - t_i) / dt,                    t_i = t_0 + i dt

A Taylor coefficient is a^(k)(t) / k!. Every formula is continued beyond the
ends of its piece; SAMPLES by its first and its last straight line. A piece LOADED holds a
ground of one of these and loads on bodies (`eventpound.motion.loads`): everything here
is then about the ground.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from eventpound.motion.base import QUIET, Family
from eventpound.motion.loaded import FIRST_ROW, ROW_WIDTH
from eventpound.motion.parametric import ZERO_OF_PHASE
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import deferred_kernel, scalar_kernel
from eventpound.tolerances import SAME_SAMPLE

_SINUSOIDS = int(Family.SINUSOIDS)
_GAUSSIAN = int(Family.GAUSSIAN)
_SAMPLES = int(Family.SAMPLES)
_LOADED = int(Family.LOADED)
GAUSSIAN_STEP = 0.5
"""Longest step under a Gaussian pulse, in its own time 1/sqrt(q)."""
_SAMPLES_AT_ONCE = 8
"""Time steps of a record that one step may pass over."""


class Formula(Protocol):
    """A group that holds a piece of a ground motion, as compiled functions hand it on."""

    @property
    def family(self) -> int:
        """A `Family`."""

    @property
    def coefficients(self) -> Floats:
        """`Piece.coefficients`, shape (c,)."""

    @property
    def samples(self) -> Floats:
        """`Piece.samples`, shape (n,) (m/s²)."""


class CurrentPiece(NamedTuple):
    """The `Piece` that a run is in, as compiled functions hand it on, and where the run leaves it.

    samples (n,): m/s². stop (s).
    """

    family: int
    coefficients: Floats
    samples: Floats
    stop: float


@scalar_kernel
def places_of(row: int, coefficients: Floats) -> tuple[int, int, int, int, int]:
    """Family of one signal of a LOADED piece, and the ends of its coefficients and samples.

    Row 0 is that of the ground. Parts of arrays are taken by who uses them: a function that
    counts no references cannot hand any to one that does.
    """
    at = FIRST_ROW + ROW_WIDTH * row
    low, high = int(coefficients[at + 1]), int(coefficients[at + 2])
    return int(coefficients[at]), low, high, int(coefficients[at + 3]), int(coefficients[at + 4])


@scalar_kernel
def ground_acceleration(piece: Formula, t: float) -> float:
    """Ground acceleration of a piece at one time; see `signal_value`."""
    coefficients, samples = piece.coefficients, piece.samples
    if piece.family == _LOADED:
        own, low, high, first, last = places_of(0, coefficients)
        return signal_value(own, coefficients[low:high], samples[first:last], t)
    return signal_value(piece.family, coefficients, samples, t)


@scalar_kernel
def signal_value(family: int, coefficients: Floats, samples: Floats, t: float) -> float:
    """Acceleration (or force) of a formula at one time.

    Parameters
    ----------
    family : int
        A `Family` but LOADED.
    coefficients : ndarray, shape (c,)
        `Piece.coefficients`.
    samples : ndarray, shape (n,)
        `Piece.samples` (m/s^2); n >= 2 for SAMPLES, else empty.
    t : float
        Time (s).

    Returns
    -------
    float
        Acceleration (m/s^2).
    """
    if family == _SINUSOIDS:
        s = t - coefficients[0]
        total = 0.0
        for k in range(1, coefficients.size, 3):
            # By two angles, so that exact zeros of the phase stay exact at the start of a pulse.
            cosine, _ = _turned(coefficients[k + 1] * s, coefficients[k + 2])
            total += coefficients[k] * cosine
        return total
    if family == _GAUSSIAN:
        s = t - coefficients[0]
        c_0, c_1, c_2, c_3 = coefficients[2:6]
        value: float = c_0 + s * (c_1 + s * (c_2 + s * c_3))
        return value * math.exp(-coefficients[1] * s * s)
    if family == _SAMPLES:
        return _straight_line(coefficients[0], coefficients[1], samples, t)[0]
    return 0.0


@scalar_kernel
def sample_time(t_0: float, dt: float, i: int) -> float:
    """``t_i = t_0 + i dt`` (s), rounded the same for whoever asks.

    A product and a sum in one rounding would be another number, at which a
    record may still be on the line to the left of its sample.
    """
    return t_0 + i * dt


@scalar_kernel
def next_sample(coefficients: Floats, t: float, stop: float) -> float:
    """Time of the first sample of a record after t, or `stop` where that comes before (s).

    A stretch that rounding makes of no length is left out.

    Parameters
    ----------
    coefficients : ndarray, shape (2,)
        `Piece.coefficients` of the family SAMPLES.
    t, stop : float
        Times (s).
    """
    origin, dt = coefficients[0], coefficients[1]
    i = math.floor((t - origin) / dt) + 1
    # The quotient may be rounded down to the sample at which t is, or just before it.
    while sample_time(origin, dt, i) <= t + SAME_SAMPLE * dt:
        i += 1
    following: float = sample_time(origin, dt, i)
    return following if following < stop - SAME_SAMPLE * dt else stop


@scalar_kernel
def next_corner(piece: Formula, t: float, stop: float) -> float:
    """Time of the first sample of any signal of a piece after t, or `stop` (s).

    As `next_sample`, for pieces of any family.
    """
    if piece.family == _SAMPLES:
        return next_sample(piece.coefficients, t, stop)
    if piece.family == _LOADED:
        return _next_corner_of_any(piece.coefficients, t, stop)
    # Other formulas are smooth.
    return stop


@deferred_kernel
def _next_corner_of_any(coefficients: Floats, t: float, stop: float) -> float:
    """`next_corner` of a LOADED piece."""
    for row in range(int(coefficients[0]) + 1):
        at = FIRST_ROW + ROW_WIDTH * row
        if coefficients[at] == _SAMPLES:
            stop = next_sample(coefficients[int(coefficients[at + 1]) :], t, stop)
    return stop


@scalar_kernel
def longest_safe_step(piece: Formula, t: float) -> float:
    """Longest step from t (s) that misses nothing of what comes, inf where nothing can be missed.

    What an integrator knows of a step are its ends: after a rest, when steps are as long as can be,
    a whole pulse or a record behind its leading zeros may lie between them.
    """
    if piece.family == _LOADED:
        return _safe_step_of_loaded(piece.coefficients, t)
    return _safe_step_of_signal(piece.family, piece.coefficients, t)


@deferred_kernel
def _safe_step_of_loaded(coefficients: Floats, t: float) -> float:
    """`longest_safe_step` of a LOADED piece."""
    shortest = math.inf
    for row in range(int(coefficients[0]) + 1):
        family, low, _, _, _ = places_of(row, coefficients)
        shortest = min(shortest, _safe_step_of_signal(family, coefficients[low:], t))
    return shortest


@scalar_kernel
def _safe_step_of_signal(family: int, coefficients: Floats, t: float) -> float:
    """`longest_safe_step` of one signal."""
    if family == _SAMPLES:
        return _SAMPLES_AT_ONCE * coefficients[1]
    if family != _GAUSSIAN or coefficients[1] <= 0.0:
        return math.inf
    width, to_center = 1.0 / math.sqrt(coefficients[1]), coefficients[0] - t
    # Half its own time shows it while it lasts. Before, a step ends where it begins, as an
    # integrator at rest would step over all of it; afterwards nothing comes.
    if abs(to_center) < (QUIET + GAUSSIAN_STEP) * width:
        return GAUSSIAN_STEP * width
    return to_center - QUIET * width if to_center > 0.0 else math.inf


@scalar_kernel
def ground_taylor(piece: Formula, t: float, order: int, out: Floats) -> None:
    """Taylor coefficients of the ground acceleration of a piece; see `signal_taylor`."""
    coefficients, samples = piece.coefficients, piece.samples
    if piece.family == _LOADED:
        own, low, high, first, last = places_of(0, coefficients)
        signal_taylor(own, coefficients[low:high], samples[first:last], t, order, out)
    else:
        signal_taylor(piece.family, coefficients, samples, t, order, out)


@scalar_kernel
def signal_taylor(
    family: int, coefficients: Floats, samples: Floats, t: float, order: int, out: Floats
) -> None:
    """Taylor coefficients of a formula.

    At a sample of a record the coefficients are those of the line to its right.

    Parameters
    ----------
    family : int
        A `Family` but LOADED.
    coefficients : ndarray, shape (c,)
        `Piece.coefficients`.
    samples : ndarray, shape (n,)
        `Piece.samples` (m/s^2); n >= 2 for SAMPLES, else empty.
    t : float
        Time of expansion (s).
    order : int
        Number of coefficients wanted, at least 1.
    out : ndarray, shape (order,) or longer
        Filled with a^(k)(t) / k! for k = 0 ... order - 1 (m/s^(2+k)).
    """
    out[:order] = 0.0
    if family == _SINUSOIDS:
        _sinusoids_taylor(coefficients, t, order, out)
    elif family == _GAUSSIAN:
        _gaussian_taylor(coefficients, t, order, out)
    elif family == _SAMPLES:
        value, slope = _straight_line(coefficients[0], coefficients[1], samples, t)
        out[0] = value
        if order > 1:
            out[1] = slope


@scalar_kernel
def ground_onset(piece: Formula, t: float, order: int, work: Floats) -> float:
    """First Taylor coefficient of the ground acceleration that is not zero, or zero.

    It has the sign of what the ground is about to do. The arguments are those of
    `ground_taylor`, whose result goes into `work`.
    """
    ground_taylor(piece, t, order, work)
    for k in range(order):
        if work[k] != 0.0:
            return work[k]
    return 0.0


@scalar_kernel
def decay_time(piece: Formula, t: float) -> float:
    """Time in which a motion that dies away, or grows from nothing, changes by its own size.

    Parameters
    ----------
    piece : Formula
        The piece.
    t : float
        Present time (s).

    Returns
    -------
    float
        ``1 / (2 q |s|)`` of a GAUSSIAN (s), the shortest of several, inf of others.
    """
    coefficients = piece.coefficients
    if piece.family == _LOADED:
        shortest = math.inf
        for row in range(int(coefficients[0]) + 1):
            at = FIRST_ROW + ROW_WIDTH * row
            if coefficients[at] == _GAUSSIAN:
                shortest = min(
                    shortest, _gaussian_decay(coefficients[int(coefficients[at + 1]) :], t)
                )
        return shortest
    return _gaussian_decay(coefficients, t) if piece.family == _GAUSSIAN else math.inf


@scalar_kernel
def _gaussian_decay(coefficients: Floats, t: float) -> float:
    """`decay_time` of a GAUSSIAN; a cubic without decay (q = 0) has none."""
    # The logarithm of exp(-q s²) changes by 2 q |s| a second.
    pace = coefficients[1] * abs(t - coefficients[0])
    return 0.5 / pace if pace > 0.0 else math.inf


@scalar_kernel
def _turned(angle: float, phase: float) -> tuple[float, float]:
    """Cosine and sine of angle + phase, exact zeros of the phase kept."""
    cosine_p = math.cos(phase)
    sine_p = math.sin(phase)
    # In floating point the cosine of π/2 is 6e-17: a pulse would begin with a jump.
    if abs(cosine_p) < ZERO_OF_PHASE:
        cosine_p = 0.0
    if abs(sine_p) < ZERO_OF_PHASE:
        sine_p = 0.0
    cosine = math.cos(angle)
    sine = math.sin(angle)
    return cosine * cosine_p - sine * sine_p, sine * cosine_p + cosine * sine_p


@scalar_kernel
def _sinusoids_taylor(coefficients: Floats, t: float, order: int, out: Floats) -> None:
    """Add a^(k)/k! = sum A w^k/k! cos(w s + p + k pi/2)."""
    s = t - coefficients[0]
    for k in range(1, coefficients.size, 3):
        amplitude = coefficients[k]
        frequency = coefficients[k + 1]
        cosine, sine = _turned(frequency * s, coefficients[k + 2])
        factor = amplitude
        for j in range(order):
            out[j] += factor * cosine
            # cos(x + pi/2) = -sin x, sin(x + pi/2) = cos x
            cosine, sine = -sine, cosine
            factor *= frequency / (j + 1)


@scalar_kernel
def _gaussian_taylor(coefficients: Floats, t: float, order: int, out: Floats) -> None:
    """Product of the shifted cubic with the series of exp(-q (s + h)^2) in h.

    The exponential E obeys E' = -2 q (s + h) E, hence
    (j + 1) E_{j+1} = -2 q (s E_j + E_{j-1}).
    """
    s = t - coefficients[0]
    q = coefficients[1]
    c_0, c_1, c_2, c_3 = coefficients[2:6]
    # Taylor coefficients of the cubic about s.
    cubic = (
        c_0 + s * (c_1 + s * (c_2 + s * c_3)),
        c_1 + s * (2.0 * c_2 + s * 3.0 * c_3),
        c_2 + 3.0 * c_3 * s,
        c_3,
    )
    before = 0.0
    exponential = math.exp(-q * s * s)
    for j in range(order):
        for i in range(min(4, order - j)):
            out[i + j] += cubic[i] * exponential
        before, exponential = exponential, -2.0 * q * (s * exponential + before) / (j + 1)


@scalar_kernel
def _straight_line(t_0: float, dt: float, samples: Floats, t: float) -> tuple[float, float]:
    """Value and slope at t of the line through the samples around it.

    A line reaches from t_i, included, to t_{i+1}, with t_i = t_0 + i dt as
    rounded: so a solver that stops at t_i finds the line to its right.
    """
    i = math.floor((t - t_0) / dt)
    # The quotient may be rounded to either side of a sample.
    if t >= sample_time(t_0, dt, i + 1):
        i += 1
    elif t < sample_time(t_0, dt, i):
        i -= 1
    # Beyond its ends a record goes on by its first and its last line.
    i = min(max(i, 0), samples.size - 2)
    slope = (samples[i + 1] - samples[i]) / dt
    return samples[i] + slope * (t - sample_time(t_0, dt, i)), slope
