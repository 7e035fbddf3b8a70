"""Motions that come after a long rest: the response is that of the motion at once, only later."""

import numpy as np
import pytest

from eventpound.motion import AntisymmetricRicker, GroundMotion, NoMotion, Record, Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Force,
    Linear,
    Scene,
    Spring,
    Support,
)
from eventpound.scene.spring import Law
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from tests.solvers.ways import WAYS, directly_and_by

K = 6e6
LAWS = (Linear(K), BoucWen(0.05 * K, 0.95 * K * 0.02, 0.02), BilinearElastic(K, 0.5 * K))
PULSES = (Ricker, AntisymmetricRicker)
CENTER, END = 1.5, 4.0


def shaking(rest: float, before: float = 0.0) -> Record:
    """Four seconds of shaking, behind a rest (s) with a little noise in it (m/s²)."""
    t = 0.01 * np.arange(400)
    noise = before * np.sin(np.arange(round(rest / 0.01)))
    return Record(np.append(noise, 5.0 * np.sin(11.0 * t) * np.exp(-((t - 2.0) ** 2))), 0.01)


def deck(law: Law, motion: GroundMotion, moved: str) -> Scene:
    """A deck beside an abutment, shaken by the ground, by its support, or pushed."""
    foot, supports, forces = GROUND, (), ()
    ground = motion if moved == "ground" else NoMotion()
    if moved == "support":
        foot, supports = "rock", (Support("rock", motion=motion),)
    if moved == "force":
        forces = (Force("deck", motion, per_mass=True),)
    return Scene(
        (Body("deck", 1e5),),
        (Spring("pier", (foot, "deck"), law),),
        (Dashpot((foot, "deck"), 1e5),),
        (Contact("joint", "deck", BARRIER, 0.01, 0.5),),
        ground,
        supports,
        forces,
    )


def run(scene: Scene, end: float, solver: str, rtol: float) -> Recording:
    return solver_named(solver).solve(Task(scene, 0.0, end, rtol))


def differ(one: Recording, other: Recording) -> float:
    """Largest difference of peaks and of impacts, as part of the largest displacement."""
    assert len(one.events) == len(other.events)
    both = [np.append(r.displacement.minimum, r.displacement.maximum) for r in (one, other)]
    assert np.abs(both[0]).max() > 0.01
    return float(np.abs(both[0] - both[1]).max() / np.abs(both[0]).max())


@pytest.mark.parametrize("moved", ["ground", "support", "force"])
@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_a_pulse_long_after_the_start_is_met(solver, law, moved):
    for pulse in PULSES:
        at_once = run(deck(law, pulse(5.0, 0.5, center=CENTER), moved), END, solver, 1e-9)
        for rest, rtol in ((2.0, 1e-4), (40.0, 1e-6), (2.5, 1e-8), (10.0, 1e-10)):
            motion = pulse(5.0, 0.5, center=CENTER + rest)
            late = run(deck(law, motion, moved), rest + END, solver, rtol)
            assert differ(at_once, late) <= 100.0 * max(rtol, 1e-9)


@pytest.mark.parametrize("moved", ["ground", "support", "force"])
@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_a_record_behind_a_rest_is_met(solver, law, moved):
    at_once = run(deck(law, shaking(0.0), moved), END, solver, 1e-9)
    for rest, noise, rtol in ((10.0, 0.0, 1e-4), (30.0, 0.0, 1e-6), (30.0, 1e-7, 1e-4)):
        late = run(deck(law, shaking(rest, noise), moved), rest + END, solver, rtol)
        assert differ(at_once, late) <= 300.0 * rtol


@pytest.mark.parametrize("solver", ["cvode", "ida"])
@pytest.mark.parametrize("way", WAYS)
def test_other_ways_into_sundials_meet_it(solver, way, monkeypatch):
    scene = deck(LAWS[1], Ricker(5.0, 0.5, center=CENTER + 10.0), "ground")
    direct, other = directly_and_by(way, Task(scene, 0.0, 10.0 + END, 1e-6), solver, monkeypatch)
    assert differ(direct, other) <= 1e-4
    assert direct.displacement.minimum < -0.01
