"""Closings of one instant are solved together; where one ends is one rule for all integrators."""

import numpy as np
import pytest

from eventpound.scene import GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task

# The scene's own time is 1 s here.
TOGETHER, APART = (0.0, 5e-13), (2e-12, 5e-12)


def _pinched(later: float) -> Scene:
    """A body of 2 kg that two of 1 kg meet from both sides, the second `later` (s)."""
    gap, speed = np.sin(1.0), np.cos(1.0)
    return Scene(
        (Body("a", 1.0, velocity=1.0), Body("m", 2.0), Body("c", 1.0, velocity=-1.0)),
        tuple(Spring(name, (GROUND, name), Linear(1.0)) for name in "ac"),
        (),
        (Contact("am", "a", "m", gap, 1.0), Contact("mc", "m", "c", gap + later * speed, 1.0)),
    )


@pytest.mark.parametrize("solver", ["fast", "cvode", "ida"])
@pytest.mark.parametrize("later", [*TOGETHER, *APART])
def test_two_closings_are_one_impact_within_an_instant_only(solver, later):
    recording = solver_named(solver).solve(Task(_pinched(later), 0.0, 1.5, 1e-12))
    groups = [event.group for event in recording.events]
    if later in TOGETHER:
        # Both go back as they came, and the one between them stays.
        assert groups == [0, 0]
        assert recording.v == pytest.approx([-np.cos(0.5), 0.0, np.cos(0.5)], abs=1e-9)
    else:
        # One after the other, the last of them between bodies that have hardly parted.
        assert groups == [0, 1, 2]
        assert abs(recording.v[1]) == pytest.approx(10.0 / 27.0 * np.cos(1.0), rel=1e-9)
