"""The times at which a stepper stops: equal steps on each smooth piece of the ground motion.

A step never crosses the beginning or end of a pulse, where the acceleration may
jump. Under a record a step not longer than the sampling interval divides it, so
that every sample is met.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from eventpound.motion.base import Family, Piece
from eventpound.motion.forcing import next_sample

SAME = 1e-9
"""Part of a step that is no step of its own."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Equal steps of length `step` (s) from `start` (s), so many of them, on one piece."""

    start: float
    step: float
    steps: int
    piece: Piece


def stretches(pieces: list[Piece], start: float, end: float, longest: float) -> Iterator[Stretch]:
    """Cut a run into stretches of equal steps.

    Parameters
    ----------
    pieces : list of Piece
        The ground motion.
    start, end : float
        The run (s).
    longest : float
        Length that no step exceeds (s).

    Yields
    ------
    Stretch
        In order, without holes.
    """
    t = start
    for piece in pieces:
        stop = min(piece.end, end)
        if stop <= t:
            continue
        if piece.family is Family.SAMPLES and longest <= piece.coefficients[1] * (1.0 + SAME):
            yield from _between_samples(piece, t, stop, longest)
        else:
            yield _equal(piece, t, stop, longest)
        t = stop


def _equal(piece: Piece, start: float, stop: float, longest: float) -> Stretch:
    count = max(1, math.ceil((stop - start) / longest * (1.0 - SAME)))
    return Stretch(start, (stop - start) / count, count, piece)


def _between_samples(piece: Piece, start: float, stop: float, longest: float) -> Iterator[Stretch]:
    """Up to the first sample, from there in parts of the sampling interval, and what is left."""
    dt = float(piece.coefficients[1])
    first = next_sample(piece.coefficients, start, stop)
    on_sample = abs(first - dt - start) <= SAME * dt
    if not on_sample:
        yield _equal(piece, start, first, longest)
        start = first
    intervals = math.floor((stop - start) / dt * (1.0 + SAME))
    if intervals > 0:
        parts = math.ceil(dt / longest * (1.0 - SAME))
        yield Stretch(start, dt / parts, parts * intervals, piece)
        start += intervals * dt
    if stop - start > SAME * dt:
        yield _equal(piece, start, stop, longest)
