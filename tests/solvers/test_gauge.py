"""Distances, of a gauge without stiffness too: their extremes are located by every solver."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.scene import BARRIER, GROUND, Body, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.solvers.random_scenes import driven_scene, random_scene, resting_scene

END = 10.0
FREE = Scene(
    (Body("a", 1.0, 0.1), Body("b", 2.0, -0.05)),
    (Spring("left", (GROUND, "a"), Linear(4.0)), Spring("right", (GROUND, "b"), Linear(16.82))),
)
GAUGED = replace(FREE, springs=(*FREE.springs, Spring("gauge", ("a", "b"), Linear(0.0))))


@pytest.mark.parametrize("solver", ["fast", "cvode", "ida"])
def test_it_measures_and_pulls_nothing(solver):
    """Two oscillators of 2 and 2.9 rad/s by themselves: their distance is known."""
    t = np.linspace(0.0, END, 400_001)
    apart = -0.05 * np.cos(2.9 * t) - 0.1 * np.cos(2.0 * t)
    run = solver_named(solver).solve(Task(GAUGED, 0.0, END, 1e-9))
    assert run.elongation.maximum[2] == pytest.approx(apart.max(), abs=1e-8)
    assert run.elongation.minimum[2] == pytest.approx(apart.min(), abs=1e-8)
    assert run.elongation.time_of_maximum[2] == pytest.approx(t[apart.argmax()], abs=1e-4)
    last = np.array([0.1 * np.cos(2.0 * END), -0.05 * np.cos(2.9 * END)])
    np.testing.assert_allclose(run.u, last, rtol=0.0, atol=1e-8)


def _cubic_extremes(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> tuple[float, float]:
    """Extremes of the cubics through values and rates of rows, those of one instant apart."""
    low, high = np.flatnonzero(np.diff(t) > 0.0), np.flatnonzero(np.diff(t) > 0.0) + 1
    h = t[high] - t[low]
    c_1, rise = h * v[low], x[high] - x[low]
    c_2, c_3 = 3.0 * rise - h * (2.0 * v[low] + v[high]), h * (v[low] + v[high]) - 2.0 * rise
    with np.errstate(invalid="ignore", divide="ignore"):
        q = -(c_2 + np.copysign(np.sqrt(c_2**2 - 3.0 * c_3 * c_1), c_2))
        turns = np.array([q / (3.0 * c_3), c_1 / q])
    turns = np.where((turns > 0.0) & (turns < 1.0), turns, 0.0)
    inside = x[low] + turns * (c_1 + turns * (c_2 + turns * c_3))
    return max(x.max(), inside.max()), min(x.min(), inside.min())


@pytest.mark.parametrize("solver", ["fast", "cvode", "ida"])
@pytest.mark.parametrize("make", [random_scene, driven_scene, resting_scene])
@pytest.mark.parametrize("seed", [91000, 91003])
def test_extremes_are_those_of_close_rows(solver, make, seed):
    """Openings and elongations; rows h apart and their rates err by h⁴/384 of the fourth rate."""
    scene, end = make(seed)
    times = np.linspace(0.0, end, 40_001)
    run = solver_named(solver).solve(Task(scene, 0.0, end, 1e-9, output_times=times))
    rows, still = run.history, np.zeros(run.history.t.size)
    moves = {GROUND: (still, still), BARRIER: (still, still)}
    moves |= {x.name: (rows.u[:, i], rows.v[:, i]) for i, x in enumerate(scene.bodies)}
    if run.supports is not None:
        known = zip(scene.supports, run.supports.s.T, run.supports.sv.T, strict=True)
        moves |= {support.name: (s, sv) for support, s, sv in known}
    near = 1e-9 * np.abs(rows.u).max()
    for i, spring in enumerate(scene.springs):
        (u, v), (u_2, v_2) = (moves[end] for end in spring.between)
        high, low = _cubic_extremes(rows.t, u_2 - u, v_2 - v)
        assert run.elongation.maximum[i] == pytest.approx(high, rel=0.0, abs=near)
        assert run.elongation.minimum[i] == pytest.approx(low, rel=0.0, abs=near)
    for j, contact in enumerate(scene.contacts):
        rate = moves[str(contact.right)][1] - moves[str(contact.left)][1]
        high, _ = _cubic_extremes(rows.t, rows.gap[:, j], rate)
        assert run.largest_gap[j] == pytest.approx(high, rel=0.0, abs=near)
