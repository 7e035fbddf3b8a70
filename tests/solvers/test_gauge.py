"""A spring of no stiffness: a gauge between two bodies, whose extremes every solver locates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task

END = 10.0
FREE = Scene(
    (Body("a", 1.0, 0.1), Body("b", 2.0, -0.05)),
    (Spring("left", (GROUND, "a"), Linear(4.0)), Spring("right", (GROUND, "b"), Linear(16.82))),
)
GAUGED = replace(FREE, springs=(*FREE.springs, Spring("gauge", ("a", "b"), Linear(0.0))))


@pytest.mark.parametrize("solver", ["fast", "cvode", "ida"])
def test_it_measures_and_pulls_nothing(solver: str) -> None:
    """Two oscillators of 2 and 2.9 rad/s by themselves: their distance is known."""
    t = np.linspace(0.0, END, 400_001)
    apart = -0.05 * np.cos(2.9 * t) - 0.1 * np.cos(2.0 * t)
    run = solver_named(solver).solve(Task(GAUGED, 0.0, END, 1e-9))
    assert run.elongation.maximum[2] == pytest.approx(apart.max(), abs=1e-8)
    assert run.elongation.minimum[2] == pytest.approx(apart.min(), abs=1e-8)
    assert run.elongation.time_of_maximum[2] == pytest.approx(t[apart.argmax()], abs=1e-4)
    last = np.array([0.1 * np.cos(2.0 * END), -0.05 * np.cos(2.9 * END)])
    np.testing.assert_allclose(run.u, last, rtol=0.0, atol=1e-8)
