"""The pulse in a record: which pulse, of which amplitude, period and start, fits it best.

With y_k the velocity of the record at its samples (or its acceleration) and
w(t; T_p, start) that of a pulse of amplitude 1, the fit minimises

    sum_k [y_k - a_p w(t_k; T_p, start)]^2

over a_p, T_p and start; for the pulse of Mavroeidis and Papageorgiou over its
gamma and phase, too. For a given w the best a_p is (y w) / (w w), and the share
of the sum of squares of y that the pulse explains is (y w)^2 / ((y y) (w w)).

**Velocity is the default**, because a pulse is the coherent, long part of a
motion: the squares of the acceleration are mostly those of frequencies that no
pulse is meant to follow, those of the velocity are not (its spectrum is that of
the acceleration over omega). A record whose velocity drifts has to be corrected
first, or fitted on its acceleration.

The search takes every period of a geometric grid, the best start for each by
correlation, and refines the best few by least squares in all parameters.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, TypeAlias

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.parametric import SinusoidMotion
from eventpound.motion.pulses import Cosine, Sine, TypeC
from eventpound.motion.record import Record
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.numerics.arrays import Floats

On = Literal["velocity", "acceleration"]
Pulse: TypeAlias = Ricker | AntisymmetricRicker | SinusoidMotion

PULSES: Mapping[str, Callable[..., Pulse]] = {
    "sine": Sine,
    "cosine": Cosine,
    "type-c": TypeC,
    "ricker": Ricker,
    "antisymmetric-ricker": AntisymmetricRicker,
    "mavroeidis-papageorgiou": MavroeidisPapageorgiou,
}
"""What can be fitted, by the words of a case."""

SHORTEST, LONGEST = 0.1, 15.0
"""Periods that are tried (s), as far as the record holds the pulse and ten samples a period."""
_RATIO = 1.06
_SAMPLES_A_PERIOD = 10
_REFINED = 5
_JUMPING = ("cosine", "type-c")
"""Pulses whose acceleration jumps at their ends."""
_GAMMAS = (1.2, 1.6, 2.4, 4.0)
_PHASES = (0.0, 0.25 * math.pi, 0.5 * math.pi, 0.75 * math.pi)


@dataclass(frozen=True, slots=True)
class PulseFit:
    """A pulse fitted to a record.

    Parameters
    ----------
    kind : str
        As in a case.
    motion : Pulse
        The pulse, with a_p, T_p and start of the record's own time.
    on : str
        What was fitted, ``"velocity"`` or ``"acceleration"``.
    explained : float
        Share of the sum of squares of that, 0 to 1.
    """

    kind: str
    motion: Pulse
    on: On
    explained: float

    @property
    def a_p(self) -> float:
        """Amplitude (m/s^2)."""
        return self.motion.scales().a_g

    @property
    def length(self) -> float:
        """Length scale L_e = a_p / omega_p^2 (m)."""
        return self.motion.scales().length

    @property
    def T_p(self) -> float:  # noqa: N802 - the paper's symbol
        """Period (s)."""
        return self.motion.scales().period


def fit_pulse(
    record: Record, kinds: Sequence[str] = tuple(PULSES), on: On = "velocity"
) -> list[PulseFit]:
    """Fit pulses to a record.

    Parameters
    ----------
    record : Record
        The record, scaled and turned as it is.
    kinds : sequence of str
        Keys of `PULSES`.
    on : str
        What is fitted, ``"velocity"`` or ``"acceleration"``.

    Returns
    -------
    list of PulseFit
        One a kind, the best first.

    Raises
    ------
    InputError
        For a kind that there is not, or a record too short for any pulse.
    """
    unknown = [kind for kind in kinds if kind not in PULSES]
    if unknown or not kinds:
        found = ", ".join(unknown) or "none"
        raise InputError(f"pulse: found {found}; accepted: {', '.join(PULSES)}")
    fits = [_fit(_Target.of(record, on), kind) for kind in kinds]
    return sorted(fits, key=lambda fit: -fit.explained)


@dataclass(frozen=True)
class _Target:
    """What is fitted: times t (s) and values y, both of shape (n,)."""

    record: Record
    on: On
    t: Floats
    y: Floats

    @classmethod
    def of(cls, record: Record, on: On) -> _Target:
        t = record.times
        # The acceleration at the last sample is zero: what comes after the record.
        return cls(record, on, t, record.values if on == "acceleration" else record.velocity(t))

    def shape(self, motion: Pulse, t: Floats) -> Floats:
        """Values of a pulse, shape of `t`."""
        return motion.acceleration(t) if self.on == "acceleration" else motion.velocity(t)

    def sampled(self, motion: Pulse) -> tuple[slice, Floats]:
        """Which samples a pulse reaches, and its values there."""
        low = int(np.searchsorted(self.t, _begin(motion)))
        high = int(np.searchsorted(self.t, motion.end, side="right"))
        return slice(low, high), self.shape(motion, self.t[low:high])


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A pulse before its amplitude is known."""

    period: float
    start: float
    shape: tuple[float, ...]
    explained: float


def _fit(target: _Target, kind: str) -> PulseFit:
    """The best pulse of one kind."""
    candidates = sorted(_grid(target, kind), key=lambda c: -c.explained)[:_REFINED]
    if not candidates:
        raise InputError(
            f"pulse: the record of {target.t[-1] - target.t[0]:g} s is too short for a {kind} pulse"
        )
    motions = [_refined(target, kind, candidate) for candidate in candidates]
    fits = [PulseFit(kind, motion, target.on, _explained(target, motion)) for motion in motions]
    return max(fits, key=lambda fit: fit.explained)


def _pulse(kind: str, amplitude: float, period: float, start: float, *shape: float) -> Pulse:
    """A pulse of either sign; `shape` is gamma and phase where it has them."""
    numbers = dict(zip(("gamma", "phase"), shape, strict=False))
    return PULSES[kind](
        amplitude=abs(amplitude), period=period, reverse=amplitude < 0.0, start=start, **numbers
    )


def _begin(motion: Pulse) -> float:
    """Time before which a pulse is zero, to rounding for a wavelet (s)."""
    if isinstance(motion, Ricker | AntisymmetricRicker):
        return 2.0 * motion.middle - motion.end
    return motion.start


def _grid(target: _Target, kind: str) -> Iterator[_Candidate]:
    """For every period (and gamma and phase) the start that explains most."""
    from scipy.fft import irfft, next_fast_len, rfft

    dt = target.record.time_step
    shapes = list(product(_GAMMAS, _PHASES)) if kind == "mavroeidis-papageorgiou" else [()]
    square = float(target.y @ target.y)
    shortest = max(SHORTEST, _SAMPLES_A_PERIOD * dt)
    count = math.ceil(math.log(max(LONGEST / shortest, _RATIO)) / math.log(_RATIO))
    # No pulse tried is longer than the record, so twice its length keeps the ends apart.
    size = next_fast_len(2 * target.y.size, real=True)
    transform = rfft(target.y, size)
    for period, shape in product(shortest * _RATIO ** np.arange(count), shapes):
        unit = _pulse(kind, 1.0, float(period), 0.0, *shape)
        length = math.ceil(unit.end / dt) + 1
        if length > target.y.size:
            break
        w = target.shape(unit, dt * np.arange(length, dtype=np.float64))
        overlaps = target.y.size - length + 1
        products = irfft(transform * np.conj(rfft(w, size)), size)[:overlaps]
        best = int(np.argmax(np.abs(products)))
        explained = float(products[best]) ** 2 / (square * float(w @ w))
        yield _Candidate(float(period), float(target.t[best]), shape, explained)


def _refined(target: _Target, kind: str, candidate: _Candidate) -> Pulse:
    """The pulse at the minimum near a candidate; a_p follows from the rest."""
    from scipy.optimize import least_squares, minimize

    size = math.sqrt(float(target.y @ target.y))

    def scaled(numbers: Floats) -> tuple[float, slice, Floats]:
        """The best amplitude, and the pulse of amplitude 1 where it is not zero."""
        log_period, *others = (float(number) for number in numbers)
        inside, w = target.sampled(_pulse(kind, 1.0, math.exp(log_period), *others))
        square = float(w @ w)
        return (float(target.y[inside] @ w) / square if square > 0.0 else 0.0), inside, w

    def residual(numbers: Floats) -> Floats:
        amplitude, inside, w = scaled(numbers)
        rest = target.y / size
        rest[inside] -= amplitude / size * w
        return rest

    first = np.array([math.log(candidate.period), candidate.start, *candidate.shape])
    # A neighbour of the grid in T_p, and half a period in time, hold the minimum.
    reach = np.array([2.0 * math.log(_RATIO), 0.5 * candidate.period, 10.0, math.pi])[: first.size]
    low, high = first - reach, first + reach
    if candidate.shape:
        low[2] = 1.0 + 1e-3
    if kind in _JUMPING and target.on == "acceleration":
        # A sample goes in or out where an end of the pulse passes it: no gradient shows that.
        simplex = first + np.vstack([np.zeros(first.size), 0.02 * np.diag(reach)])
        options = {"initial_simplex": simplex, "xatol": 1e-6, "fatol": 1e-12}
        near = minimize(
            lambda x: float(np.sum(residual(x) ** 2)), first, method="Nelder-Mead", options=options
        )
        first = np.clip(near.x, low, high)
    found = least_squares(
        residual, first, bounds=(low, high), xtol=1e-12, ftol=1e-12, gtol=1e-12, x_scale=reach
    )
    amplitude, _, _ = scaled(found.x)
    return _pulse(kind, amplitude or 1e-300, math.exp(found.x[0]), *map(float, found.x[1:]))


def _explained(target: _Target, motion: Pulse) -> float:
    """Share of the sum of squares that a pulse explains."""
    inside, w = target.sampled(motion)
    rest = target.y.copy()
    rest[inside] -= w
    return 1.0 - float(rest @ rest) / float(target.y @ target.y)
