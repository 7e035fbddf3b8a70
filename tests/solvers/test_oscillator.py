"""The scalar kernel of a single body against the kernel of any number of bodies.

The general one takes every run that asks for the energy ledger.
"""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.mechanics.model import assemble
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.record import Record
from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Extremes, Recording, Task
from eventpound.solvers.fast.constants import links_of
from eventpound.solvers.fast.single.body import oscillator_of
from tests.solvers.accuracy import allowed

END = 12.0
PULSE = Sine(1.0, 2.0 * np.pi, reverse=True)
GROUNDED = (GROUND, "a")
RIGHT = Contact("right", "a", BARRIER, 0.2, 0.6)
LEFT = Contact("left", BARRIER, "a", 0.3, 0.4)


def scene(law, *contacts, motion=PULSE, damping=0.0, body=None, ends=GROUNDED) -> Scene:
    dashpots = (Dashpot(GROUNDED, damping),) if damping else ()
    springs = (Spring("s", ends, law),) if law else ()
    return Scene((body or Body("a", 1.3),), springs, dashpots, contacts, motion)


def record() -> Record:
    t = 0.02 * np.arange(500)
    return Record(np.sin(2.3 * t) * np.sin(7.1 * t + 1.0) * np.exp(-(((t - 4.0) / 3.0) ** 2)), 0.02)


def bouc_wen(exponent=20.0, beta=0.5, gamma=0.5, initial_z=0.0, stiffness=0.4) -> BoucWen:
    return BoucWen(stiffness, 0.4, 0.05, exponent, beta, gamma, initial_z)


SCENES = {
    "elastic": scene(Linear(3.0), RIGHT),
    "elastic between barriers": scene(Linear(3.0), RIGHT, LEFT),
    "elastic and damped": scene(Linear(3.0), RIGHT, damping=0.3),
    "no spring": scene(None, RIGHT, LEFT, motion=Cosine(1.0, 2.0 * np.pi)),
    "elastoplastic": scene(bouc_wen(stiffness=0.0), RIGHT),
    "bilinear": scene(bouc_wen(), RIGHT, LEFT),
    "bilinear and damped": scene(bouc_wen(), RIGHT, damping=0.2),
    "turned spring": scene(bouc_wen(2.0, 0.6, 0.4), RIGHT, ends=("a", GROUND)),
    "n = 1": scene(bouc_wen(1.0), RIGHT),
    "n = 2, unloading curved": scene(bouc_wen(2.0, 0.1, 0.9), RIGHT),
    "n = 20, unloading curved": scene(bouc_wen(20.0, 0.8, 0.2), RIGHT, LEFT),
    "initial z": scene(bouc_wen(initial_z=-0.7), RIGHT, body=Body("a", 1.3, 0.1, -0.4)),
    "no strength": scene(BoucWen(3.0, 0.0, 0.05), RIGHT),
    "Ricker": scene(bouc_wen(), RIGHT, motion=Ricker(1.5, 2.0, center=3.0)),
    "record": scene(bouc_wen(), RIGHT, motion=record()),
    "record, elastic and damped": scene(Linear(9.0), RIGHT, LEFT, motion=record(), damping=0.2),
    "record, damped": scene(bouc_wen(), Contact("r", "a", BARRIER, 0.05, 0.5), motion=record()),
    "no contact": scene(bouc_wen(), motion=record()),
    "comes to rest": scene(Linear(3.0), Contact("r", "a", BARRIER, 0.02, 0.3)),
}


def both(of: Scene, rtol: float) -> tuple[Recording, Recording]:
    times = np.linspace(0.0, END, 61)
    fast = solver_named("fast")
    runs = (Task(of, 0.0, END, rtol, output_times=times, energy=e) for e in (False, True))
    single, general = (fast.solve(task) for task in runs)
    return single, general


def widest(extremes: Extremes) -> np.ndarray:
    return np.concatenate((extremes.maximum, extremes.minimum))


def assert_same_extremes(single: Extremes, general: Extremes, error: float) -> None:
    np.testing.assert_allclose(widest(single), widest(general), rtol=0.0, atol=error)


def test_which_runs_it_serves() -> None:
    for of in SCENES.values():
        model = assemble(of)
        assert oscillator_of(model, 1.0, links_of(model), energy=False).alone
        assert not oscillator_of(model, 1.0, links_of(model), energy=True).alone


@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", SCENES)
def test_same_motion(name: str, rtol: float) -> None:
    single, general = both(SCENES[name], rtol)
    size = np.abs(widest(general.displacement)).max()
    pull = np.abs(widest(general.acceleration)).max()
    speed = np.abs(general.history.v).max()
    error = allowed(1.0, rtol)
    np.testing.assert_allclose(single.u, general.u, rtol=0.0, atol=error * size)
    np.testing.assert_allclose(single.v, general.v, rtol=0.0, atol=error * speed)
    np.testing.assert_allclose(single.z, general.z, rtol=0.0, atol=10.0 * error)
    assert_same_extremes(single.displacement, general.displacement, error * size)
    assert_same_extremes(single.elongation, general.elongation, error * size)
    if single.resting_time.sum() == 0.0:
        # At rest the acceleration is the ground's, known at the ends of steps only.
        assert_same_extremes(single.acceleration, general.acceleration, 10.0 * error * pull)
    assert_same_extremes(single.base_shear, general.base_shear, 13.0 * error * pull)
    np.testing.assert_allclose(single.smallest_gap, general.smallest_gap, rtol=0, atol=error * size)


@pytest.mark.parametrize("name", SCENES)
def test_same_events_and_history(name: str) -> None:
    rtol = 1e-10
    single, general = both(SCENES[name], rtol)
    loud = [
        [e for e in run.events if e.kind.value != "impact" or e.gap_velocity_before < -1e-3]
        for run in (single, general)
    ]
    assert [(e.kind, e.contact) for e in loud[0]] == [(e.kind, e.contact) for e in loud[1]]
    times = [[e.t for e in events] for events in loud]
    np.testing.assert_allclose(*times, rtol=0.0, atol=allowed(END, rtol))
    outputs = np.linspace(0.0, END, 61)[1:-1]
    places = [np.searchsorted(run.history.t, outputs) for run in (single, general)]
    for column in ("u", "z", "force", "gap"):
        one, other = (
            getattr(run.history, column)[at]
            for run, at in zip((single, general), places, strict=True)
        )
        size = np.abs(other).max(initial=0.0)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=10.0 * allowed(size, rtol))
