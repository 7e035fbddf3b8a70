"""CVODE called from compiled code and through scikit-sundae: the same steps, the same answers."""

import ctypes
import gc
from dataclasses import replace

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.sundials import library
from eventpound.solvers.sundials.memory import BANDED_FROM, CvodeMemory, MemoryLayout
from eventpound.solvers.sundials.wrapped import WrappedCvode
from tests.solvers.scenes import pounding_pair

if library.library() is None:
    pytest.skip("the SUNDIALS library is out of reach here", allow_module_level=True)

from eventpound.solvers.sundials import compiled_cvode


def _record_scene() -> Scene:
    """A yielding oscillator between barriers under 3 s of samples with no structure."""
    a = np.random.default_rng(7).normal(0.0, 3.0, 301)
    contacts = (Contact("left", BARRIER, "m", 0.05, 0.6), Contact("right", "m", BARRIER, 0.02, 0.6))
    spring = Spring("k", (GROUND, "m"), BoucWen(20.0, 4.0, 0.03, 5.0))
    return Scene((Body("m", 1.0),), (spring,), (), contacts, Record(a, 0.01))


def _row() -> Scene:
    """A row long enough for a banded Jacobian."""
    names = [f"m{i}" for i in range(BANDED_FROM // 2 + 1)]
    springs = [Spring("k0", (GROUND, names[0]), Linear(300.0))]
    springs += [
        Spring(f"k{i}", (names[i - 1], names[i]), Linear(300.0)) for i in range(1, len(names))
    ]
    bodies = tuple(Body(name, 1.0, 0.0, 0.1 if name == "m3" else 0.0) for name in names)
    return Scene(bodies, tuple(springs), (), (Contact("wall", names[-1], BARRIER, 1e-3, 0.5),))


TIMES = 300.0
"""Times rtol that two runs of one tolerance may differ by after the impacts of these scenes."""
SCENES = {
    "pair": (pounding_pair(), 6.0, 1e-7),
    "record": (_record_scene(), 3.0, 1e-7),
    "record-stopping-at-samples": (_record_scene(), 3.0, 1e-9),
    "row": (_row(), 3.0, 1e-6),
}


def _runs(task: Task, method: str) -> tuple[Recording, Recording]:
    found = library.library()
    ours = EventLoop(task, compiled_cvode.DirectCvode(found, task.rtol, method)).run()
    return ours, EventLoop(task, WrappedCvode(task.rtol, method)).run()


@pytest.mark.parametrize(
    ("name", "method"),
    [
        *((name, "BDF") for name in SCENES),
        *((name, "Adams") for name in SCENES if name != "row"),
        pytest.param("row", "Adams", marks=pytest.mark.sweep),
    ],
)
def test_both_ways_take_the_same_steps(name, method):
    scene, end, rtol = SCENES[name]
    task = Task(scene, 0.0, end, rtol, output_times=np.linspace(0.0, end, 37), energy=True)
    ours, theirs = _runs(task, method)
    assert ours.events
    # The wrapped one counts its Python calls, the direct one in its callback.
    assert ours.work.restarts == theirs.work.restarts
    # The same operations in the same order, but for events, which the wrapped one locates on a
    # polynomial through 13 values of CVODE's. Its rounding moves choices of step size after an
    # event, and so what follows by a part of the tolerance, multiplied by the impacts.
    for count in ("rhs", "jacobian", "steps"):
        mine, other = (getattr(one.work, count) for one in (ours, theirs))
        assert mine == pytest.approx(other, rel=5e-2, abs=2), count
    for mine, other in zip(ours.events, theirs.events, strict=True):
        assert mine.kind is other.kind
        assert mine.t == pytest.approx(other.t, rel=TIMES * rtol)
    # Up to the first event there is nothing but the same operations.
    assert ours.events[0].t == pytest.approx(theirs.events[0].t, rel=1e-12)
    atol = TIMES * rtol * np.abs(ours.history.u).max()
    np.testing.assert_allclose(ours.history.u, theirs.history.u, rtol=0.0, atol=atol)
    np.testing.assert_allclose(ours.history.z, theirs.history.z, rtol=0.0, atol=TIMES * rtol)
    np.testing.assert_allclose(ours.displacement.minimum, theirs.displacement.minimum, atol=atol)


def test_where_the_library_is_out_of_reach_scikit_sundae_steps(monkeypatch):
    assert isinstance(integrator(1e-6, "Adams"), compiled_cvode.DirectCvode)
    monkeypatch.setattr(library, "library", lambda: None)
    assert isinstance(integrator(1e-6, "Adams"), WrappedCvode)


@pytest.mark.parametrize("way", ["direct", "wrapped"])
def test_a_failure_keeps_what_was_computed(way):
    """CVODE gives up on equations that become numbers no more; the rows before it stay."""
    scene = Scene((Body("m", 1.0, 1e-3),), (Spring("k", (GROUND, "m"), Linear(1.0)),))
    task = Task(scene, 0.0, 10.0, 1e-6, output_times=np.linspace(0.0, 10.0, 101))
    chosen = (
        compiled_cvode.DirectCvode(library.library(), 1e-6, "Adams")
        if way == "direct"
        else WrappedCvode(1e-6, "Adams")
    )
    loop = EventLoop(task, chosen)

    def spoil(t: float) -> None:
        if t > 5.0:
            chosen._segment.system.stiffness[:] = np.nan

    loop.event_run.task = replace(task, progress=spoil)
    with pytest.raises(ComputationError, match="CVODE could not continue") as caught:
        loop.run()
    recording = caught.value.recording
    assert 5.0 <= recording.history.t[-1] <= recording.t < 10.0
    assert recording.work.steps > 10
    # What is called final is the end of the last step: u = u_0 cos t.
    assert recording.u[0] == pytest.approx(1e-3 * np.cos(recording.t), abs=1e-3 * 1e2 * 1e-6)
    assert recording.v[0] == pytest.approx(-1e-3 * np.sin(recording.t), abs=1e-3 * 1e2 * 1e-6)


def _never_called() -> int:
    """Address of a right-hand side that no object gets to call."""
    return ctypes.cast(ctypes.CFUNCTYPE(ctypes.c_int)(lambda: -1), ctypes.c_void_p).value or 0


def test_objects_are_freed():
    layout = MemoryLayout(1e-6, np.ones(3), 0)
    memory = CvodeMemory(library.library(), "Adams", layout, _never_called(), 0)
    finalizer = memory._finalizer
    assert finalizer.alive
    del memory
    gc.collect()
    assert not finalizer.alive


def test_what_cannot_be_set_up_is_an_error():
    with pytest.raises(MemoryError, match="flag -22"):
        CvodeMemory(
            library.library(), "Adams", MemoryLayout(-1.0, np.ones(3), 0), _never_called(), 0
        )


def test_a_step_to_the_end_of_a_record_has_a_length():
    """The end less 0.51 s, where the integrator begins, and plus it is another number."""
    oscillator = Scene(
        (Body("m", 1.0),),
        (Spring("k", (GROUND, "m"), Linear(30.0)),),
        motion=Record(np.sin(np.arange(252)), 0.01),
    )
    end = oscillator.motion.end
    assert 0.51 + (end - 0.51) < end
    task = Task(oscillator, 0.5, 3.0, 1e-9)
    cvode, fast = (solver_named(name).solve(task) for name in ("cvode", "fast"))
    np.testing.assert_allclose(cvode.u, fast.u, rtol=0, atol=1e-7)
