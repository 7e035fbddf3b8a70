"""Loads and displacements of supports in compiled code."""

import numpy as np
import pytest

from eventpound.mechanics.reduced import forcing_of
from eventpound.motion import AntisymmetricRicker, Cosine, GroundMotion, NoMotion, Ricker, Sine
from eventpound.motion.base import Family
from eventpound.motion.delayed import Delayed, travelled
from eventpound.motion.forcing import ground_acceleration, ground_taylor
from eventpound.motion.loaded import Load, LoadedMotion
from eventpound.motion.loads import add_body_loads, load_taylor, load_value, support_motion
from tests.motion.test_loaded import RECORD, SIGNALS, loaded

pytestmark = pytest.mark.usefixtures("interpreted")


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
