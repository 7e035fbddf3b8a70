"""A ground motion with loads on bodies beside it, its pieces united.

The numbers of a piece are laid out as `eventpound.motion.loads` reads them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from eventpound.motion.base import QUIET, Family, GroundMotion, Piece, Scales
from eventpound.motion.delayed import travelled
from eventpound.motion.record import integrals
from eventpound.numerics.arrays import Floats
from eventpound.tolerances import RISEN

FIRST_ROW, ROW_WIDTH = 3, 10
"""Where the rows of a LOADED piece begin in its coefficients, and numbers in each."""
_WIDTHS = np.arange(-QUIET, QUIET, 0.125)
"""Where a Gaussian is looked at, from its center in its own time."""


@dataclass(frozen=True)
class Load:
    """A force on one body that is known beforehand, or the motion of a support.

    Parameters
    ----------
    body : int
        Its number.
    signal : GroundMotion
        The force, or what `factor` makes one of; the motion of a support in space.
    factor : float
        What the signal is multiplied by: 1 for a force in N.
    driven : bool
        Whether it is the motion of a support.
    """

    body: int
    signal: GroundMotion
    factor: float = 1.0
    driven: bool = False


@dataclass(frozen=True, eq=False)
class LoadedMotion:
    """A ground motion and loads on bodies.

    Parameters
    ----------
    ground : GroundMotion
        The motion of the ground.
    loads : tuple of Load
        What acts beside it, in the order of the bodies: the motions of supports first.
    first_link : int
        The link of the model that carries the first load.
    own : Scales, optional
        Scales of the whole, of whatever moves it most.
    push : float
        Largest acceleration that a force alone gives a body (m/s^2).
    """

    ground: GroundMotion
    loads: tuple[Load, ...]
    first_link: int
    own: Scales | None
    push: float

    @property
    def supports(self) -> int:
        """How many of the bodies, the first ones, are supports."""
        return sum(load.driven for load in self.loads)

    @property
    def kind(self) -> str:
        """The word a case names the ground motion by."""
        return self.ground.kind

    @property
    def end(self) -> float:
        """Time after which all signals stay zero (s)."""
        return max(self.ground.end, *(load.signal.end for load in self.loads))

    def acceleration(self, t: Floats) -> Floats:
        """Ground acceleration, shape of `t` (m/s^2)."""
        return self.ground.acceleration(t)

    def velocity(self, t: Floats) -> Floats:
        """Ground velocity, shape of `t` (m/s)."""
        return self.ground.velocity(t)

    def displacement(self, t: Floats) -> Floats:
        """Ground displacement, shape of `t` (m)."""
        return self.ground.displacement(t)

    def scales(self) -> Scales | None:
        """Of whatever moves the scene most."""
        return self.own

    def pieces(self) -> list[Piece]:
        """Stretches on which every signal is smooth, of the family LOADED.

        And at whose ends supports begin to move apart, on which a body may have rested until then.
        """
        signals = [self.ground.pieces(), *(load.signal.pieces() for load in self.loads)]
        ends = {piece.end for pieces in signals for piece in pieces}
        ends |= _partings(self._moved, RISEN * max(self.own.a_g if self.own else 0.0, self.push))
        return [
            self._together(start, end, [next(p for p in each if p.end > start) for each in signals])
            for start, end in pairwise([-np.inf, *sorted(ends)])
        ]

    @property
    def _moved(self) -> list[GroundMotion]:
        """The motions of ground and supports."""
        return [self.ground, *(load.signal for load in self.loads if load.driven)]

    def _together(self, start: float, end: float, parts: Sequence[Piece]) -> Piece:
        """One stretch, of a piece of every signal."""
        from eventpound.motion.travel import signal_travel

        rows = np.zeros((len(parts), ROW_WIDTH))
        low, first = FIRST_ROW + rows.size, 0
        samples = [_with_sums(part) for part in parts]
        for row, part, own in zip(rows, parts, samples, strict=True):
            high = low + part.coefficients.size
            row[:6] = int(part.family), low, high, first, first + part.samples.size, 1.0
            low, first = high, first + own.size
        for row, load in zip(rows[1:], self.loads, strict=True):
            row[5:8] = load.factor, load.body, load.driven
        known = next((t for t in (start, end) if np.isfinite(t)), 0.0)
        for row, motion, part, own in zip(rows, self._moved, parts, samples, strict=False):
            own_travel = signal_travel(int(part.family), part.coefficients, own, known)
            row[8:] = np.subtract(travelled(motion, np.array(known)), own_travel)
        header = np.array([len(self.loads), self.first_link, known])
        numbers = [header, rows.ravel(), *(part.coefficients for part in parts)]
        return Piece(start, end, Family.LOADED, np.concatenate(numbers), np.concatenate(samples))


def _partings(moved: Sequence[GroundMotion], level: float) -> set[float]:
    """Times after zero (s) at which motions that were the same begin to differ by a level (m/s²).

    Of records that is a sample.
    """
    times: list[Floats] = []
    for piece in (piece for motion in moved for piece in motion.pieces()):
        if piece.family is Family.SAMPLES:
            start, dt = piece.coefficients[:2]
            times.append(start + np.arange(piece.samples.size) * dt)
        elif piece.family is Family.GAUSSIAN and piece.coefficients[1] > 0.0:
            center, decay = piece.coefficients[:2]
            times.append(center + _WIDTHS / np.sqrt(decay))
    if len(moved) == 1 or not times:
        return set()
    t, found = np.unique(np.concatenate(times)), set[float]()
    for one, other in combinations([motion.acceleration(t) for motion in moved], 2):
        same = np.abs(one - other) <= level
        # At a single sample two records may be the same by chance.
        parting = same[:-2] & same[1:-1] & ~same[2:] & (t[1:-1] > 0.0)
        found.update(t[1:-1][parting].tolist())
    return found


def _with_sums(piece: Piece) -> Floats:
    """The samples of a piece, if it has any, and behind them their integrals."""
    if piece.samples.size == 0:
        return piece.samples
    return np.concatenate((piece.samples, *integrals(piece.samples, float(piece.coefficients[1]))))
