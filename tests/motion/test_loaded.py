"""Pieces of a ground motion with loads: united at every breakpoint, each signal as it is alone."""

import numpy as np
import pytest

from eventpound.mechanics.reduced import forcing_of
from eventpound.motion import Family, GroundMotion, NoMotion, Record, Ricker, Sine
from eventpound.motion.constant import Constant, PhasedSine
from eventpound.motion.delayed import Delayed
from eventpound.motion.forcing import decay_time, next_corner, signal_value
from eventpound.motion.loaded import Load, LoadedMotion
from eventpound.motion.travel import signal_travel

pytestmark = pytest.mark.usefixtures("interpreted")

RECORD = Record(np.random.default_rng(1).normal(size=9), 0.13, start=0.31)
SIGNALS: tuple[GroundMotion, ...] = (
    Delayed(Sine(2.0, 0.7), 0.25),
    Constant(-3.0),
    Delayed(RECORD, 0.4),
    Ricker(1.5, 0.9),
    PhasedSine(2.0, 0.5, start=0.2, phase=0.7, cycles=0.5),
    NoMotion(),
)


def loaded(ground: GroundMotion) -> LoadedMotion:
    bodies = (0, 1, 1, 2, 3, 4)
    loads = tuple(
        Load(b, signal, factor=2.0**b, driven=b == 0)
        for b, signal in zip(bodies, SIGNALS, strict=True)
    )
    return LoadedMotion(ground, loads, 7, None, 0.0)


def ends_beside(ground: GroundMotion, moved: GroundMotion) -> list[float]:
    """Where pieces of ground and support end, of a scene whose largest acceleration is 1 m/s²."""
    motion = LoadedMotion(ground, (Load(0, moved, driven=True),), 7, None, 1.0)
    own = {piece.end for each in (ground, moved) for piece in each.pieces()}
    return sorted({piece.end for piece in motion.pieces()} - own)


def test_a_piece_ends_where_motions_that_were_the_same_part():
    one, other = np.array([[0, 1, 2, 1, 2, 3, 1, 2], [0, 1, 2, 1, 0, 3, 0, 1]]) / 10.0
    # They are the same once more, by chance.
    assert ends_beside(Record(one, 0.5), Record(other, 0.5)) == [1.5]
    assert ends_beside(Record(one, 0.5), Record(one, 0.5)) == []


@pytest.mark.parametrize("q", [0.0, 0.4])
def test_integrals_of_any_cubic_beside_a_gaussian(q):
    """Its own differences over h err by h²/12 of a derivative, and by rounding over h."""
    numbers, none, h = np.array([0.3, q, 0.7, -0.4, 0.9, 0.2]), np.empty(0), 1e-4
    for t in np.linspace(-2.0, 3.0, 11):
        at = [signal_travel(int(Family.GAUSSIAN), numbers, none, t + k * h) for k in (-1, 0, 1)]
        a = signal_value(int(Family.GAUSSIAN), numbers, none, t)
        assert (at[2][0] - at[0][0]) / (2.0 * h) == pytest.approx(at[1][1], abs=1e-7)
        assert (at[2][1] - at[0][1]) / (2.0 * h) == pytest.approx(a, abs=1e-7)


def test_corners_of_two_records():
    motion = loaded(RECORD)
    samples = {round(float(s + 0.13 * i), 12) for s in (0.31, 0.71) for i in range(9)}
    found, t = set(), 0.0
    for piece in motion.pieces():
        while t < min(piece.end, 2.0):
            t = next_corner(forcing_of(piece, 0.0), t, min(piece.end, 2.0))
            found.add(round(t, 12))
    assert samples <= found


def test_the_shortest_decay_counts():
    piece = loaded(Ricker(2.0, 0.6)).pieces()[0]
    alone = [m.pieces()[0] for m in (Ricker(2.0, 0.6), Ricker(1.5, 0.9))]
    times = [decay_time(forcing_of(p, 0.0), 0.1) for p in alone]
    assert decay_time(forcing_of(piece, 0.0), 0.1) == min(times)
