"""A few of the random scenes with stiff beside soft bodies: same events by every solver."""

from collections import Counter

import pytest

from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from tests.hard.stiff import RTOL, examine, stiff_scene


@pytest.mark.parametrize(
    "seed",
    [
        1,
        pytest.param(22, id="a closed contact passes on impacts softer than rounding"),
        pytest.param(51, id="forces that vanish together"),
        pytest.param(120, id="a vibration that dies away"),
        pytest.param(192, id="rests that get shorter and shorter"),
        pytest.param(348, id="an impulse passed on"),
        pytest.param(599, id="where a collapse is cut off"),
    ],
)
def test_same_events(seed):
    found = examine(seed, 60.0)
    assert found.word == "agrees", found.remark


@pytest.mark.parametrize("rtol", [1e-9, 5e-11, 3e-11, 2e-11, 1e-11])
def test_rounding_where_forces_vanish_makes_no_impacts(rtol):
    """Three bodies leave a barrier in touch; the stiff one of them opened and closed for ever."""
    scene, end = stiff_scene(51)
    events = solver_named("fast").solve(Task(scene, 0.0, end, rtol)).events
    kinds = Counter(event.kind for event in events if event.t > 0.9)
    assert kinds[EventKind.DETACHMENT] == 1
    assert len(events) == 111


def test_a_force_that_rounding_keeps_from_changing_vanishes():
    """A stiff body rests on one far from its place: Newton's steps to the zero crept along."""
    scene, _ = stiff_scene(990)
    recording = solver_named("ida").solve(Task(scene, 0.0, 0.3, RTOL))
    assert recording.t == 0.3
