"""IDA: contact forces as unknowns, constraints kept, equations that are none of CVODE's."""

import ast
import gc
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eventpound
from eventpound.errors import ComputationError
from eventpound.mechanics.model import assemble
from eventpound.scene import GROUND, Body, Contact, Dashpot, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.scales import scene_scales, tolerances
from eventpound.solvers.events.step_check import CLEAR, MARKED, Examination
from eventpound.solvers.sundials import library as sundials
from tests.benchmarks.agreement import judge
from tests.properties.transforms import scaled
from tests.reference.problems import load
from tests.solvers.accuracy import RTOL, allowed
from tests.solvers.random_scenes import random_scene
from tests.solvers.scenes import pounding_pair, run

if sundials.ida_library() is None:
    pytest.skip("the SUNDIALS library is out of reach here", allow_module_level=True)

from eventpound.solvers.sundials.compiled_ida import DirectIda
from eventpound.solvers.sundials.descriptor_modes import DescriptorModes
from eventpound.solvers.sundials.memory import IdaMemory

ROOT = Path(eventpound.__file__).parent
OWN = tuple(ROOT.glob("mechanics/descriptor*.py"))


def _thrown(m_a: float = 2.0, m_b: float = 0.7, damping: float = 0.0) -> Scene:
    """a on a spring, b lying before it; both at u = -0.3, without speed."""
    bodies = (Body("a", m_a, -0.3), Body("b", m_b, -0.3))
    spring = Spring("k", (GROUND, "a"), Linear((m_a + m_b) * 4.0))
    dashpots = (Dashpot((GROUND, "b"), damping),) if damping else ()
    return Scene(bodies, (spring,), dashpots, (Contact("joint", "a", "b", 0.0, 0.5),))


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, RTOL, 1e-12])
def test_force_and_release_of_a_thrown_body(rtol):
    # Together u = -0.3 cos 2t, and λ = m_b u'' = 0.7 · 1.2 cos 2t until t = π/4; then b
    # flies at 0.6 m/s and a swings on alone, ω_a² = 4 · 2.7/2.
    response = response_of(_thrown(), "ida", rtol, duration=1.5, output_step=0.05)
    recording = response.recording
    release = math.pi / 4.0
    assert [e.kind for e in recording.events] == [EventKind.REST, EventKind.DETACHMENT]
    assert recording.events[1].t == pytest.approx(release, abs=allowed(1.0, rtol))
    h = recording.history
    held = (h.t > 0.0) & (h.t < release)
    np.testing.assert_allclose(
        h.contact_force[held, 0], 0.84 * np.cos(2.0 * h.t[held]), atol=allowed(0.84, rtol)
    )
    assert recording.max_force[0] == pytest.approx(0.84, rel=allowed(1.0, rtol))
    omega = math.sqrt(4.0 * 2.7 / 2.0)
    late = 1.5 - release
    assert recording.u[1] == pytest.approx(0.6 * late, abs=allowed(0.3, rtol))
    assert recording.u[0] == pytest.approx(
        0.6 / omega * math.sin(omega * late), abs=allowed(0.3, rtol)
    )


@pytest.mark.parametrize("rtol", [1e-6, 1e-13])
@pytest.mark.parametrize("name", ["B03", "B12", "C03", "D23", "E01"])
def test_no_drift(name, rtol):
    """The gaps and their rates are equations, solved to rounding whatever the tolerance."""
    recording = run(load()[name].scene, rtol, 6.0, solver="ida")
    assert recording.resting_time.max() > 0.1
    # A few roundings of displacements some times L.
    assert recording.drift.gap < 1e-14
    assert recording.drift.gap_rate < 1e-14


def _ida(scene: Scene, end: float, rtol: float) -> tuple[Task, DirectIda]:
    task = Task(scene, 0.0, end, rtol, output_times=np.linspace(0.0, end, 101))
    model = assemble(scene)
    scales = scene_scales(scene, model, end)
    library = sundials.ida_library()
    modes = DescriptorModes(model, scales, tolerances(task, scales), rtol, ledger=False)
    return task, DirectIda(library, modes)


@pytest.mark.parametrize("name", ["thrown", "damped", "B03", "C03", "E01"])
def test_the_force_is_an_unknown_of_ida(name):
    """At the end of every step λ of IDA's vector is what the loop finds without it."""
    rtol = 1e-9
    scenes = {"thrown": (_thrown(), 0.7), "damped": (_thrown(damping=0.4), 0.7)}
    scene, end = scenes.get(name) or (load()[name].scene, load()[name].end)
    task, ida = _ida(scene, end, rtol)
    errors, stepping = [], ida.advance

    def advance(tau: float, first: int, excess: float, bounds: Bounds, e: Examination) -> object:
        done = stepping(tau, first, excess, bounds._replace(most=1), e)
        d, memory = ida._own.descriptor, ida._memory
        if d.opening.size and done.verdict in (CLEAR, MARKED):
            mine = memory.unknowns[2 * d.mass.size + d.hysteretic :]
            force = e.observations[1 - done.first].contact_force[0, d.resting]
            pushed = d.all_gaps[d.resting].T @ force
            errors.append(np.abs(d.W.T @ mine - pushed).max())
        return done

    ida.advance = advance
    EventLoop(task, ida).run()
    assert len(errors) > 50
    # Newton's iteration stops at a third of a step's tolerance, itself a part of rtol.
    assert max(errors) < rtol * ida.scales.force


def test_energy_closes():
    response = response_of(pounding_pair(), "ida", 1e-9, duration=6.0, energy=True)
    assert abs(response.energy.closure) < allowed(1.0, 1e-9)


@pytest.mark.parametrize("seed", [0, 5, 8, 24, 72, 423])
def test_random_scenes(seed):
    verdict = judge(seed, "ida")
    assert verdict.word in ("agree", "agree when tight", "ill-conditioned"), verdict


def test_nothing_is_taken_from_the_reduced_equations():
    """Of the modules with CVODE's right-hand side, only types, and which body is a support."""
    types = {
        "eventpound.mechanics.reduced": {"Forcing"},
        "eventpound.mechanics.observables": set(),
        "eventpound.mechanics.series": set(),
        "eventpound.mechanics.clusters": {"Clusters"},
    }
    assert len(OWN) == 2
    for path in OWN:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module in types:
                assert {a.name for a in node.names} <= types[node.module], path.name


def test_a_failure_keeps_what_was_computed():
    task, ida = _ida(_thrown(), 1.5, 1e-6)
    loop = EventLoop(task, ida)

    def spoil(t: float) -> None:
        if t > 1.0:
            ida._own.descriptor.stiffness[:] = np.nan

    loop.event_run.task = replace(task, progress=spoil)
    with pytest.raises(ComputationError, match="IDA could not continue") as caught:
        loop.run()
    assert 1.0 <= caught.value.recording.history.t[-1] < 1.5


def test_objects_are_freed():
    task, ida = _ida(_thrown(), 0.7, 1e-6)
    EventLoop(task, ida).run()
    finalizer = next(iter(ida._memories.values()))._finalizer
    assert finalizer.alive
    del ida, task
    gc.collect()
    assert not finalizer.alive


def test_what_cannot_be_set_up_is_an_error():
    library = sundials.ida_library()
    with pytest.raises(MemoryError, match="flag -22"):
        IdaMemory(library, -1.0, np.ones(2), np.zeros(2, bool), 1, 1, 1)


def test_units_in_which_energies_are_large_numbers_take_the_same_steps():
    # A row of the ledger must not be the pivot of a velocity: Newton's iteration then ends in
    # the rounding of an energy, here of some 1e25, and steps shrink to 1e-8 T.
    scene, end = random_scene(72140)
    other, view = scaled(scene, 2.0**16, 2.0**-18, 2.0**16)
    first = solver_named("ida").solve(Task(scene, 0.0, 0.3 * end, 1e-9, energy=True))
    calls = 0

    def progress(t: float) -> None:
        nonlocal calls
        calls += 1
        if calls > first.work.steps:
            raise ComputationError("far more steps than in the first units", t)

    task = Task(other, 0.0, 0.3 * end * view.time, 1e-9, energy=True, progress=progress)
    recording = solver_named("ida").solve(task)
    assert recording.work.steps == pytest.approx(first.work.steps, rel=0.1)
    np.testing.assert_allclose(recording.u, first.u * view.length, rtol=1e-6)
