"""Duties that every ground motion has: kinematics, pieces, compiled evaluation, scales."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from eventpound.mechanics.reduced import forcing_of
from eventpound.motion import (
    AntisymmetricRicker,
    Cosine,
    Family,
    GroundMotion,
    Harmonic,
    MavroeidisPapageorgiou,
    NoMotion,
    Record,
    Ricker,
    Sine,
    TypeC,
)
from eventpound.motion.forcing import ground_acceleration

MOTIONS: dict[str, GroundMotion] = {
    "none": NoMotion(),
    "sine": Sine(2.0, 0.8),
    "sine reversed, late": Sine(2.0, 0.8, reverse=True, start=0.37),
    "cosine": Cosine(3.0, 1.1, start=-0.2),
    "type-c1": TypeC(2.5, 0.6),
    "type-c3 reversed": TypeC(2.5, 0.6, reverse=True, start=0.1, cycles=3),
    "ricker": Ricker(1.5, 0.9),
    "ricker cut in its middle": Ricker(1.5, 0.9, start=0.5, center=0.6),
    "antisymmetric ricker": AntisymmetricRicker(1.5, 0.9, reverse=True, start=0.2),
    "mavroeidis": MavroeidisPapageorgiou(4.0, 0.7, start=0.15),
    "mavroeidis general": MavroeidisPapageorgiou(4.0, 0.7, gamma=1.37, phase=0.9),
    "harmonic": Harmonic(2.0, 0.5, cycles=2.3, start=0.2),
    "endless harmonic": Harmonic(2.0, 0.5),
    "record": Record(np.array([0.4, -1.0, 2.0, 0.3, -0.6]), 0.25, start=0.3, scale=1.7),
}
EACH = pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS.keys())


def _breaks(motion: GroundMotion, a: float, b: float) -> list[float]:
    """Places between a and b where the acceleration or its slope may jump."""
    breaks = [piece.start for piece in motion.pieces()]
    if isinstance(motion, Record):
        breaks += [motion.start + i * motion.time_step for i in range(motion.samples.size)]
    return sorted({x for x in breaks if a < x < b})


def _begin(motion: GroundMotion) -> float:
    return getattr(motion, "start", 0.0)


@EACH
def test_it_is_a_ground_motion(motion):
    assert isinstance(motion, GroundMotion)


@EACH
@pytest.mark.parametrize("after", [0.05, 0.6, 1.3, 4.0])
def test_velocity_and_displacement_are_the_integrals(motion, after):
    start = _begin(motion)
    t = start + after
    points = [start, *_breaks(motion, start, t), t]
    velocity = displacement = 0.0
    for a, b in pairwise(points):
        velocity += quad(lambda x: float(motion.acceleration(np.array(x))), a, b, epsabs=1e-11)[0]
        # Cauchy's formula for a repeated integral: an integral of a alone.
        displacement += quad(
            lambda x: (t - x) * float(motion.acceleration(np.array(x))), a, b, epsabs=1e-11
        )[0]
    assert motion.velocity(np.array([t]))[0] == pytest.approx(velocity, abs=1e-10)
    assert motion.displacement(np.array([t]))[0] == pytest.approx(displacement, abs=1e-10)


@EACH
def test_the_ground_starts_at_rest(motion):
    start = np.array([_begin(motion)])
    assert motion.velocity(start)[0] == 0.0
    assert motion.displacement(start)[0] == 0.0
    if motion.pieces()[0].family is Family.ZERO:
        before = start - np.array([1.0, 0.1])
        assert not np.any(motion.acceleration(before))
        assert not np.any(motion.velocity(before))
        assert not np.any(motion.displacement(before))


@EACH
def test_pieces_follow_one_another_without_holes(motion):
    pieces = motion.pieces()
    assert pieces[0].start == -math.inf
    assert pieces[-1].end == math.inf
    for piece, following in pairwise(pieces):
        assert piece.start < piece.end == following.start


@EACH
def test_the_compiled_pieces_are_the_motion(motion):
    times = np.linspace(_begin(motion) - 0.5, _begin(motion) + 4.0, 613)
    times = np.append(times, [p.start for p in motion.pieces() if math.isfinite(p.start)])
    expected = motion.acceleration(times)
    for t, a in zip(times, expected, strict=True):
        piece = next(p for p in motion.pieces() if p.start <= t < p.end)
        computed = ground_acceleration(forcing_of(piece, 0.0), t)
        # Both evaluate the same formula; a few roundings of a few terms of size a_g.
        assert computed == pytest.approx(a, abs=1e-14 * 4.0)


@EACH
def test_nothing_happens_after_the_end(motion):
    if math.isfinite(motion.end):
        late = motion.end + np.array([0.0, 0.1, 3.0])
        scales = motion.scales()
        allowed = 0.0 if scales is None else 1e-15 * scales.a_g
        assert np.max(np.abs(motion.acceleration(late))) <= allowed


@EACH
def test_the_amplitude_is_the_peak_and_reverse_changes_the_sign_only(motion):
    scales = motion.scales()
    if scales is None:
        return
    times = np.linspace(_begin(motion) - 1.0, _begin(motion) + 5.0, 60_001)
    peak = np.max(np.abs(motion.acceleration(times)))
    assert peak <= scales.a_g * (1.0 + 1e-14)
    # The grid misses a peak of curvature (2 pi / T)^2 a_g by less than
    # (2 pi / 0.5 * 5e-5)^2 / 2 = 2e-7 a_g; a corner of the record by 5e-5 of its slope.
    assert peak >= scales.a_g * (1.0 - 1e-4)


@pytest.mark.parametrize(
    "kind", [Sine, Cosine, TypeC, Ricker, AntisymmetricRicker, MavroeidisPapageorgiou, Harmonic]
)
def test_a_reversed_motion_is_the_mirror_image(kind):
    times = np.linspace(-0.5, 3.0, 501)
    ahead, back = kind(2.0, 0.7, start=0.1), kind(2.0, 0.7, start=0.1, reverse=True)
    for quantity in ("acceleration", "velocity", "displacement"):
        np.testing.assert_array_equal(
            getattr(ahead, quantity)(times), -getattr(back, quantity)(times)
        )
    assert ahead.scales() == back.scales()
    assert ahead.scales().omega_g == pytest.approx(2.0 * math.pi / 0.7, rel=1e-15)
    assert ahead.scales().length == pytest.approx(2.0 / (2.0 * math.pi / 0.7) ** 2, rel=1e-14)
