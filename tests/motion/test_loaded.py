"""Pieces of a ground motion with loads: united at every breakpoint, each signal as it is alone."""

import numpy as np
import pytest

from eventpound.mechanics.reduced import forcing_of
from eventpound.motion import (
    AntisymmetricRicker,
    Cosine,
    GroundMotion,
    NoMotion,
    Record,
    Ricker,
    Sine,
)
from eventpound.motion.base import Family
from eventpound.motion.constant import Constant, PhasedSine
from eventpound.motion.delayed import Delayed, travelled
from eventpound.motion.forcing import (
    decay_time,
    ground_acceleration,
    ground_taylor,
    next_corner,
    signal_value,
)
from eventpound.motion.loaded import Load, LoadedMotion
from eventpound.motion.loads import add_body_loads, load_taylor, load_value, support_motion
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


@pytest.mark.parametrize("ground", [Sine(1.0, 1.1), RECORD, NoMotion(), Ricker(2.0, 0.6)])
def test_every_signal_is_itself(ground):
    motion = loaded(ground)
    pieces = motion.pieces()
    assert [p.end for p in pieces[:-1]] == [p.start for p in pieces[1:]]
    assert (pieces[0].start, pieces[-1].end) == (-np.inf, np.inf)
    ends = {p.end for m in (ground, *SIGNALS) for p in m.pieces()}
    assert {p.end for p in pieces} == ends
    for piece in pieces:
        assert piece.family is Family.LOADED
        formula = forcing_of(piece, 0.0)
        low, high = max(piece.start, -1.0), min(piece.end, 3.0)
        # A time less a delay rounds: a border may lie on either side of itself.
        for t in np.linspace(low, high, 8)[1:-1]:
            at = np.array(t)
            a = ground_acceleration(formula, t)
            assert a == pytest.approx(float(ground.acceleration(at)), rel=1e-13, abs=1e-13)
            forces = np.zeros(5)
            for row, load in enumerate(motion.loads, 1):
                value = load.factor * float(load.signal.acceleration(at))
                assert load_value(row, formula, t) == pytest.approx(value, rel=1e-12, abs=1e-12)
                forces[load.body] += value
            found = np.zeros(5)
            add_body_loads(formula, t, found, found)
            assert np.allclose(found, forces, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("ground", [Sine(1.0, 1.1), RECORD, NoMotion(), Ricker(2.0, 0.6)])
def test_supports_are_where_their_motions_take_them(ground):
    moved: tuple[GroundMotion, ...] = (
        Sine(2.0, 0.7),
        Cosine(1.0, 0.9),
        Delayed(RECORD, 0.4),
        Ricker(1.5, 0.9),
        AntisymmetricRicker(2.0, 0.8),
        NoMotion(),
    )
    loads = tuple(Load(b, signal, driven=True) for b, signal in enumerate(moved))
    motion = LoadedMotion(ground, loads, 7, None, 0.0)
    for piece in motion.pieces():
        formula = forcing_of(piece, 0.0)
        for t in np.linspace(max(piece.start, -2.0), min(piece.end, 30.0), 9):
            still = travelled(ground, np.array(t))
            for row, signal in enumerate(moved, 1):
                own = travelled(signal, np.array(t))
                found = support_motion(row, formula, t)
                # Residual velocities of 0.3 m/s have gone 10 m.
                assert np.abs(np.subtract(found, np.subtract(own, still))).max() <= 2e-14


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


@pytest.mark.parametrize("kind", [Ricker, AntisymmetricRicker])
def test_a_piece_ends_where_a_tail_has_begun(kind):
    wavelet = kind(1.0, 0.5, center=5.0)
    for ground, moved in ((NoMotion(), wavelet), (wavelet, Delayed(wavelet, 0.2))):
        (end,) = ends_beside(ground, moved)
        apart = abs(float(ground.acceleration(np.array(end)) - moved.acceleration(np.array(end))))
        assert 1e-13 < apart <= 1e-11
    # As a run begins it is late for that.
    assert ends_beside(NoMotion(), kind(1.0, 0.5, center=0.5)) == []


@pytest.mark.parametrize("q", [0.0, 0.4])
def test_integrals_of_any_cubic_beside_a_gaussian(q):
    """Its own differences over h err by h²/12 of a derivative, and by rounding over h."""
    numbers, none, h = np.array([0.3, q, 0.7, -0.4, 0.9, 0.2]), np.empty(0), 1e-4
    for t in np.linspace(-2.0, 3.0, 11):
        at = [signal_travel(int(Family.GAUSSIAN), numbers, none, t + k * h) for k in (-1, 0, 1)]
        a = signal_value(int(Family.GAUSSIAN), numbers, none, t)
        assert (at[2][0] - at[0][0]) / (2.0 * h) == pytest.approx(at[1][1], abs=1e-7)
        assert (at[2][1] - at[0][1]) / (2.0 * h) == pytest.approx(a, abs=1e-7)


def test_series_of_a_load():
    motion = loaded(Sine(1.0, 1.1))
    t, h = 0.4, 1e-2
    formula = forcing_of(next(p for p in motion.pieces() if p.end > t), 0.0)
    out = np.zeros(14)
    for row in range(1, 1 + len(SIGNALS)):
        load_taylor(row, formula, t, 14, out)
        series = float(np.polynomial.polynomial.polyval(h, out))
        assert series == pytest.approx(load_value(row, formula, t + h), rel=1e-12, abs=1e-12)
    ground_taylor(formula, t, 14, out)
    value = ground_acceleration(formula, t + h)
    assert float(np.polynomial.polynomial.polyval(h, out)) == pytest.approx(value, rel=1e-13)


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


@pytest.mark.parametrize("motion", [Sine(2.0, 0.7), Cosine(1.0, 0.9), RECORD, Ricker(2.0, 0.8)])
def test_a_motion_later(motion):
    later = Delayed(motion, 0.3)
    t = np.linspace(-0.5, 3.0, 200)
    for name in ("acceleration", "velocity", "displacement"):
        assert np.array_equal(getattr(later, name)(t), getattr(motion, name)(t - 0.3))
    for piece, own in zip(later.pieces(), motion.pieces(), strict=True):
        assert piece.end == own.end + 0.3
    assert later.end == motion.end + 0.3


@pytest.mark.parametrize("delay", np.linspace(0.01, 1.3, 100))
def test_a_later_jump_is_where_its_piece_begins(delay):
    motion = Cosine(1.0, 0.9, start=0.1)
    later = Delayed(motion, delay)
    for piece, values in zip(later.pieces()[1:], ((0.0, 1.0), (1.0, 0.0)), strict=True):
        t = np.array([np.nextafter(piece.start, -np.inf), piece.start])
        np.testing.assert_allclose(later.acceleration(t), values, atol=1e-14)


def test_a_wavelet_has_begun_long_before():
    """Displacement from -inf: what `start` counts from is not where it was at rest."""
    ricker = Ricker(2.0, 0.8)
    t = np.linspace(-3.0, 4.0, 20001)
    d, v = travelled(ricker, t)
    step = t[1] - t[0]
    a = ricker.acceleration(t)
    summed = np.concatenate(([0.0], np.cumsum(0.5 * step * (a[1:] + a[:-1]))))
    assert np.abs(v - summed).max() < 1e-6
    assert abs(d[0]) < 1e-15
    assert np.abs(np.diff(d) / step - 0.5 * (v[1:] + v[:-1])).max() < 1e-6
