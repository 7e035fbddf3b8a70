"""Sliders beside published examples: Siconos' friction oscillator, Den Hartog's and Shaw's."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from eventpound import Harmonic, NoMotion, simulate
from eventpound.numerics.arrays import Floats
from eventpound.scene import GROUND, Body, Dashpot, Scene, Slider, Spring
from eventpound.solvers.base import Recording

SOLVERS = ["cvode", "ida", "fast"]
RTOL = 1e-10
# siconos-tutorials (2024), mechanics/FrictionOscillator: time, place and speed from its .ref file.
SICONOS = (
    (1.0, 11.38901295126014, -6.617952262720126),
    (10.0, -7.256299752295587, 0.8801721180254144),
    (20.0, 1.241125196600963, -0.2072515377774506),
    (25.0, 0.6820441351954105, 0.0),
)


def siconos(h: float, end: float) -> Floats:
    """Its scheme by hand: x'' + x = r, -r in sgn x', the midpoint rule, friction at the end."""
    A = np.array([[0.0, 1.0], [-1.0, 0.0]])
    W = np.linalg.inv(np.eye(2) - 0.5 * h * A)
    forward, push = W @ (np.eye(2) + 0.5 * h * A), W @ np.array([0.0, h])
    rows = [np.array([12.0, 6.0])]
    for _ in range(round(end / h)):
        free = forward @ rows[-1]
        rows.append(free + push * np.clip(-free[1] / push[1], -1.0, 1.0))
    return np.array(rows)


def forced(friction: float, beta: float, ratio: float, periods: int, solver: str) -> Recording:
    """x'' + 2 xi x' + x + f sgn x' = sin(beta t), up to a sign."""
    spring = Spring("friction", (GROUND, "mass"), Slider(friction, 1.0, 1.0))
    dashpots = (Dashpot((GROUND, "mass"), 2.0 * ratio),) if ratio else ()
    period = 2.0 * math.pi / beta
    scene = Scene((Body("mass", 1.0),), (spring,), dashpots, motion=Harmonic(1.0, period))
    return simulate(scene, solver=solver, duration=periods * period, rtol=RTOL).recording


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_oscillator_of_siconos_stops_where_it_does(solver):
    rows = siconos(0.01, 25.0)
    for t, *expected in SICONOS:
        np.testing.assert_allclose(rows[round(t / 0.01)], expected, rtol=0.0, atol=1e-12)
    spring = Spring("friction", (GROUND, "mass"), Slider(1.0, 1.0, 1.0))
    scene = Scene((Body("mass", 1.0, 12.0, 6.0),), (spring,), motion=NoMotion())
    found = simulate(scene, solver=solver, duration=25.0, rtol=RTOL, output_step=0.01).recording
    # Peaks fall by 2: sqrt(13^2 + 6^2) - 1 - 2 n, and from 1.32 it slides to the same side.
    assert found.u[0] == pytest.approx(15.0 - math.sqrt(205.0), abs=1e-7)
    # A stop comes up to a step late there: of first order, to our motion.
    times, first = np.unique(found.history.t, return_index=True)
    errors = []
    for h in (0.01, 0.001):
        rows = siconos(h, 25.0)
        theirs = np.interp(times, h * np.arange(len(rows)), rows[:, 0])
        errors.append(np.abs(theirs - found.history.u[first, 0]).max())
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.2)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("beta", [0.8, 1.3, 2.0])
def test_oscillator_stops_where_friction_is_above_the_boundary_of_den_hartog(beta, solver):
    # At a turn of x0 = sqrt(V^2 - f^2 U^2) the pull is x0/V: it turns back where
    # x0 - x0/V > f, that is beta^2 x0 > f.
    V = 1.0 / (1.0 - beta**2)
    U = math.sin(math.pi / beta) / (beta * (1.0 + math.cos(math.pi / beta)))
    boundary = abs(V) / math.sqrt(U**2 + beta**-4)
    stops = []
    for part in (0.97, 1.03):
        history = forced(part * boundary, beta, 0.0, 30, solver).history
        late = history.t > history.t[-1] - 4.0 * math.pi / beta
        stops.append(bool((np.abs(history.z[late]) < 0.99).any()))
    assert stops == [False, True]


def amplitude_of_shaw(beta: float, ratio: float, friction: float) -> float:
    """Of the steady motion without stops: half a cycle takes a maximum to its opposite."""
    A = np.array([[0.0, 1.0], [-1.0, -2.0 * ratio]])
    half = expm(A * math.pi / beta)
    # What friction alone, +f over the half cycle and -f over the next, gives at the maximum.
    rest = np.array([friction, 0.0])
    x, v = np.linalg.solve(np.eye(2) + half, (half - np.eye(2)) @ rest)
    forced = 1.0 / complex(1.0 - beta**2, 2.0 * ratio * beta)
    # The forced motion makes the speed there zero.
    return float(x + math.sqrt(abs(forced) ** 2 - (v / beta) ** 2))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("beta", "ratio", "friction"), [(0.7, 0.1, 0.3), (1.3, 0.05, 0.3), (2.0, 0.2, 0.2)]
)
def test_oscillator_with_a_dashpot_has_the_steady_amplitude_of_shaw(beta, ratio, friction, solver):
    # J. Sound Vib. 108 (1986) 305-325: dry friction and viscous damping.
    found = forced(friction, beta, ratio, 40, solver)
    history = found.history
    late = history.t > history.t[-1] - 2.0 * math.pi / beta
    expected = amplitude_of_shaw(beta, ratio, friction)
    # What is left of the start: less than e^(-2 pi xi 40 / beta).
    assert np.abs(history.u[late]).max() == pytest.approx(expected, rel=1e-6)
