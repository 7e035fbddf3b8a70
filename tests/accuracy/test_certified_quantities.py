import numpy as np
import pytest

from eventpound.accuracy.certified_quantities import ambiguities, limits_of
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task


def _recorded(scene: Scene, end: float):
    times = np.linspace(0.0, end, 1001)
    return solver_named("fast").solve(Task(scene, 0.0, end, 1e-12, output_times=times))


def test_limits_add_up_along_a_row():
    scene = Scene(
        tuple(Body(name, 1.0) for name in "abc"),
        contacts=(
            Contact("ab", "a", "b", 0.1, 0.5),
            Contact("bc", "b", "c", 0.2, 0.5),
            Contact("wall", "c", BARRIER, 0.05, 0.5),
        ),
    )
    right, left = limits_of(scene, 1.0), limits_of(scene, -1.0)
    assert right.reach == pytest.approx([0.35, 0.25, 0.05], rel=1e-15)
    assert right.chain == ([0, 1, 2], [1, 2], [2])
    assert np.all(np.isinf(left.reach))


def test_equal_peaks_of_a_free_vibration_make_the_time_uncertain():
    """u = cos t has its maximum at 0, 2π and 4π, its minimum at π and 3π."""
    scene = Scene((Body("b", 1.0, 1.0),), (Spring("s", (GROUND, "b"), Linear(1.0)),))
    run = _recorded(scene, 14.0)
    apart = ambiguities(scene, run.history, run.displacement, np.full((2, 1), 1e-12), 1.0)
    high, low = run.displacement.time_of_maximum[0], run.displacement.time_of_minimum[0]
    assert apart[0, 0] == pytest.approx(max(high, 4.0 * np.pi - high), abs=1e-9)
    assert apart[1, 0] == pytest.approx(max(low - np.pi, 3.0 * np.pi - low), abs=1e-9)


def test_damped_peaks_do_not_compete():
    from eventpound.scene import Dashpot

    scene = Scene(
        (Body("b", 1.0, 1.0),),
        (Spring("s", (GROUND, "b"), Linear(1.0)),),
        (Dashpot((GROUND, "b"), 0.1),),
    )
    run = _recorded(scene, 14.0)
    apart = ambiguities(scene, run.history, run.displacement, np.full((2, 1), 1e-6), 1.0)
    assert apart.tolist() == [[0.0], [0.0]]


def test_only_the_first_touch_of_a_barrier_counts():
    """A ball with ε = 1 between springless walls touches both again and again."""
    scene = Scene(
        (Body("b", 1.0, 0.0, 1.0),),
        contacts=(
            Contact("right", "b", BARRIER, 1.0, 1.0),
            Contact("left", BARRIER, "b", 1.0, 1.0),
        ),
    )
    run = _recorded(scene, 9.5)
    assert len(run.events) == 5
    apart = ambiguities(scene, run.history, run.displacement, np.full((2, 1), 1e-9), 1.0)
    assert apart.tolist() == [[0.0], [0.0]]
