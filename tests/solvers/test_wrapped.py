"""CVODE and IDA through scikit-sundae alone, as where the library's symbols are out of reach."""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.mechanics.model import assemble
from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers import ida, solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.sundials import library
from eventpound.solvers.sundials.wrapped import WrappedCvode, WrappedIda
from tests.reference.comparison import compare
from tests.reference.problems import load
from tests.solvers.accuracy import allowed
from tests.solvers.scenes import pounding_pair


@pytest.fixture
def out_of_reach(monkeypatch):
    monkeypatch.setattr(library, "library", lambda: None)
    monkeypatch.setattr(library, "ida_library", lambda: None)


def _chosen(task: Task) -> object:
    model = assemble(task.scene)
    return ida.integrator(task, model, scene_scales(task.scene, model, task.end))


def test_both_are_chosen_there(out_of_reach):
    assert isinstance(integrator(1e-6, "Adams"), WrappedCvode)
    assert isinstance(_chosen(Task(pounding_pair(), 0.0, 1.0, 1e-6)), WrappedIda)


@pytest.mark.parametrize(
    ("name", "rtol", "accuracy", "solver"),
    [
        ("D23", 1e-8, 1e-6, "cvode"),
        ("B12", 1e-6, 1e-4, "ida"),
        *(
            pytest.param(*run, marks=pytest.mark.sweep)
            for run in (
                ("B12", 1e-6, 1e-4, "cvode"),
                ("D23", 1e-8, 1e-6, "ida"),
                ("E01", 1e-9, 1e-7, "cvode"),
                ("E01", 1e-9, 1e-7, "ida"),
            )
        ),
    ],
)
def test_solved_problem(out_of_reach, name, rtol, accuracy, solver):
    problem = load()[name]
    response = response_of(problem.scene, solver, rtol, duration=problem.end)
    assert compare(problem, response, accuracy).failures == []


def _both(monkeypatch: pytest.MonkeyPatch, task: Task) -> tuple[Recording, Recording]:
    if library.ida_library() is None:
        pytest.skip("the SUNDIALS library is out of reach here")
    ours = solver_named("ida").solve(task)
    monkeypatch.setattr(library, "ida_library", lambda: None)
    return ours, solver_named("ida").solve(task)


def test_ida_gives_the_same_both_ways(monkeypatch):
    """Rests, a record's history, energy and drift: the same to what the tolerance leaves."""
    rtol, end = 1e-8, 6.0
    task = Task(
        pounding_pair(), 0.0, end, rtol, output_times=np.linspace(0.0, end, 37), energy=True
    )
    ours, theirs = _both(monkeypatch, task)
    assert [(e.kind, e.contact) for e in ours.events] == [
        (e.kind, e.contact) for e in theirs.events
    ]
    times = [[e.t for e in one.events] for one in (ours, theirs)]
    np.testing.assert_allclose(*times, atol=allowed(end, rtol))
    scale = np.abs(ours.history.u).max()
    np.testing.assert_allclose(ours.history.u, theirs.history.u, atol=allowed(scale, rtol))
    assert ours.energy is not None
    assert theirs.energy.closure == pytest.approx(0.0, abs=allowed(1.0, rtol))
    assert theirs.work.steps == pytest.approx(ours.work.steps, rel=0.3)


def test_drift_of_ida_is_a_part_of_the_tolerance(out_of_reach):
    """What is seen of a state is closed; what IDA itself leaves open is reported."""
    problem = load()["B03"]
    for rtol in (1e-6, 1e-9):
        recording = solver_named("ida").solve(Task(problem.scene, 0.0, 6.0, rtol))
        assert recording.resting_time.max() > 0.1
        assert 0.0 < max(recording.drift.gap, recording.drift.gap_rate) < rtol


def test_a_failure_of_ida_keeps_what_was_computed(out_of_reach):
    scene = Scene((Body("m", 1.0, 1e-3),), (Spring("k", (GROUND, "m"), Linear(1.0)),))
    task = Task(scene, 0.0, 10.0, 1e-6, output_times=np.linspace(0.0, 10.0, 101))
    chosen = _chosen(task)
    assert isinstance(chosen, WrappedIda)

    def spoil(t: float) -> None:
        if t > 5.0:
            chosen._own.descriptor.stiffness[:] = np.nan

    with pytest.raises(ComputationError, match="IDA could not continue") as caught:
        EventLoop(replace(task, progress=spoil), chosen).run()
    recording = caught.value.recording
    assert 5.0 <= recording.history.t[-1] <= recording.t < 10.0
    assert recording.u[0] == pytest.approx(1e-3 * math.cos(recording.t), abs=1e-7)


BOUNCE = """
import json
from eventpound.solvers.sundials import library
library.library = lambda: None
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
scene = Scene((Body("m", 1.0, 0.3),), (Spring("k", (GROUND, "m"), Linear(4.0)),), (),
              (Contact("wall", BARRIER, "m", 0.0, 0.5),))
times = {s: [e.t for e in response_of(scene, s, 1e-8, duration=3.0).recording.events]
         for s in ("cvode", "ida")}
import sys
loaded = [m for m in sys.modules if m.startswith("eventpound.solvers.sundials.")]
print(json.dumps([times, loaded]))
"""


def test_nothing_that_needs_the_symbols_is_loaded_there():
    """In a process of its own: what is linked to them would end it where they are missing."""
    done = subprocess.run(
        [sys.executable, "-c", BOUNCE], capture_output=True, text=True, check=True, timeout=600
    )
    times, loaded = json.loads(done.stdout)
    # u = 0.3 cos 2t meets the wall at π/4, then every half period.
    wanted = [math.pi / 4.0, 3.0 * math.pi / 4.0]
    for solver in ("cvode", "ida"):
        assert times[solver] == pytest.approx(wanted, abs=allowed(1.0, 1e-8))
    for name in ("compiled_cvode", "compiled_ida"):
        assert f"eventpound.solvers.sundials.{name}" not in loaded
