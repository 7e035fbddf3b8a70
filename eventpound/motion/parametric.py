"""Ground motions given by an amplitude and a period, and sums of sinusoids among them.

Amplitude a_p (m/s^2) and period T_p (s) are also the scales of the motion:
a_g = a_p, omega_g = omega_p = 2 pi / T_p. A sum of sinusoids that acts for
0 <= s <= D, s = t - start, and is zero outside,

    a(s) = sum_k A_k cos(w_k s + p_k)
    v(s) = sum_k A_k / w_k [sin(w_k s + p_k) - sin p_k]
    d(s) = sum_k A_k / w_k^2 [cos p_k - cos(w_k s + p_k)] - A_k / w_k s sin p_k

starts from rest; after D the ground keeps the velocity it has then.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eventpound.basics.given import Number, accepted_numbers, converting_base, default, read_fields
from eventpound.errors import InputError
from eventpound.motion.base import LARGEST, SMALLEST, Family, Piece, Scales
from eventpound.numerics.arrays import Floats
from eventpound.units import Dimension

# No double lies closer than this to the zero of a cosine other than 0 itself,
# so a smaller value stands for an exact zero (a sine pulse starts at 0).
ZERO_OF_PHASE = 1.0e-15


def require_positive(kind: str, key: str, value: float) -> None:
    """Refuse a value that is not a positive number of a size that can be computed with.

    Raises
    ------
    InputError
        Naming the motion, the key and the value.
    """
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(f"excitation '{kind}': {key} = {value!r}; a positive number is needed")
    if not SMALLEST <= value <= LARGEST:
        raise InputError(
            f"excitation '{kind}': {key} = {value!r}; "
            f"a number from {SMALLEST:g} to {LARGEST:g} is needed"
        )


def require_finite(kind: str, key: str, value: float) -> None:
    """Refuse a value that is not a number of a size that can be computed with.

    Raises
    ------
    InputError
        Naming the motion, the key and the value.
    """
    if not math.isfinite(value):
        raise InputError(f"excitation '{kind}': {key} = {value!r}; a finite number is needed")
    if abs(value) > LARGEST:
        raise InputError(
            f"excitation '{kind}': {key} = {value!r}; a number within {LARGEST:g} is needed"
        )


def require_accepted(motion: Any) -> None:
    """Refuse numbers of a motion that its fields, declared with either of these, do not accept."""
    for key, require in accepted_numbers(motion.__class__):
        if (value := getattr(motion, key)) is not None:
            require(motion.kind, key, value)


@converting_base()
class Parametric:
    """A motion with an amplitude and a period.

    Parameters
    ----------
    amplitude : float
        a_p (m/s^2), positive: the peak of the absolute acceleration.
    period : float
        T_p (s), positive.
    reverse : bool
        Whether the motion is turned round, a -> -a.
    start : float
        When it begins (s).

    Raises
    ------
    InputError
        For a number that is not finite, or an amplitude or period not positive.
    """

    amplitude: Annotated[Number, Dimension.ACCELERATION, require_positive]
    period: Annotated[Number, Dimension.TIME, require_positive]
    reverse: bool = False
    start: Annotated[Number, Dimension.TIME, require_finite] = default(0.0)

    def __post_init__(self) -> None:
        read_fields(self)
        require_accepted(self)

    kind: ClassVar[str]
    """The word a case names it by."""

    @property
    def signed_amplitude(self) -> float:
        """a_p, negative where the motion is reversed (m/s^2)."""
        return -self.amplitude if self.reverse else self.amplitude

    @property
    def omega(self) -> float:
        """omega_p = 2 pi / T_p (rad/s)."""
        return 2.0 * math.pi / self.period

    def scales(self) -> Scales:
        """a_g = a_p and omega_g = omega_p."""
        return Scales(self.amplitude, self.omega)


@dataclass(frozen=True)
class Sinusoid:
    """One term A cos(w s + p).

    Parameters
    ----------
    amplitude, frequency, phase : float
        A (m/s^2), w (rad/s, positive), p (rad).
    """

    amplitude: float
    frequency: float
    phase: float


@converting_base()
class SinusoidMotion(Parametric, ABC):
    """A motion that is a sum of sinusoids over a stretch of time, zero outside."""

    @property
    @abstractmethod
    def duration(self) -> float:
        """D (s); inf for a motion without end."""

    def sinusoids(self) -> tuple[Sinusoid, ...]:
        """The terms, in s = t - start, with the sign of `reverse`; a sine is cos(x - pi/2)."""
        return (Sinusoid(self.signed_amplitude, self.omega, -0.5 * math.pi),)

    @property
    def end(self) -> float:
        """Time after which the acceleration stays zero (s)."""
        return self.start + self.duration

    def pieces(self) -> list[Piece]:
        """Zero, the sinusoids, zero (unless they never end)."""
        numbers = [self.start]
        for term in self.sinusoids():
            numbers += [term.amplitude, term.frequency, term.phase]
        pieces = [
            Piece(-math.inf, self.start, Family.ZERO),
            Piece(self.start, self.end, Family.SINUSOIDS, np.array(numbers)),
        ]
        if math.isfinite(self.end):
            pieces.append(Piece(self.end, math.inf, Family.ZERO))
        return pieces

    def acceleration(self, t: Floats) -> Floats:
        """Ground acceleration, shape of `t` (m/s^2)."""
        t = np.asarray(t, dtype=float)
        a = np.zeros(t.shape)
        for term in self.sinusoids():
            a += term.amplitude * _cosine_sine(term, t - self.start)[0]
        return np.where((t >= self.start) & (t < self.end), a, 0.0)

    def velocity(self, t: Floats) -> Floats:
        """Ground velocity, shape of `t` (m/s); zero up to the start."""
        s = np.clip(np.asarray(t, dtype=float) - self.start, 0.0, self.duration)
        v = np.zeros(s.shape)
        for term in self.sinusoids():
            sine_p = _cosine_sine(term, np.zeros(()))[1]
            v += term.amplitude / term.frequency * (_cosine_sine(term, s)[1] - sine_p)
        return v

    def displacement(self, t: Floats) -> Floats:
        """Ground displacement, shape of `t` (m); zero up to the start."""
        t = np.asarray(t, dtype=float)
        s = np.clip(t - self.start, 0.0, self.duration)
        d = np.zeros(s.shape)
        for term in self.sinusoids():
            w = term.frequency
            cosine_p, sine_p = _cosine_sine(term, np.zeros(()))
            d += term.amplitude / w**2 * (cosine_p - _cosine_sine(term, s)[0] - w * s * sine_p)
        if not math.isfinite(self.end):
            return d
        past = np.maximum(t - self.end, 0.0)
        return d + self.velocity(np.asarray(self.end)) * past


def _cosine_sine(term: Sinusoid, s: Floats) -> tuple[Floats, Floats]:
    """Cosine and sine of w s + p, exact zeros of the phase kept."""
    cosine_p, sine_p = math.cos(term.phase), math.sin(term.phase)
    cosine_p = 0.0 if abs(cosine_p) < ZERO_OF_PHASE else cosine_p
    sine_p = 0.0 if abs(sine_p) < ZERO_OF_PHASE else sine_p
    cosine, sine = np.cos(term.frequency * s), np.sin(term.frequency * s)
    return cosine * cosine_p - sine * sine_p, sine * cosine_p + cosine * sine_p
