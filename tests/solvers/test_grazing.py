"""Gaps that just close, or just do not, between two steps.

The gap is set to the peak the same run has without the contact, made smaller
or larger by a part of itself: so tuned, the outcome does not hang on the
global error of the run, and must be right at every tolerance.
"""

import math
from dataclasses import replace

import pytest

from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Event, EventKind
from tests.solvers.scenes import run

PARTS = [1e-3, 1e-6, 1e-9]
TOLERANCES = [1e-6, 1e-12, *(pytest.param(r, marks=pytest.mark.sweep) for r in (1e-4, 1e-8, 1e-10))]
WALL = Contact("wall", "m", BARRIER, math.nan, 0.6)


def _free() -> Scene:
    """u = 0.3 sin(2 t): the peak comes between steps, whatever they are."""
    return Scene((Body("m", 1.0, 0.0, 0.6),), (Spring("k", (GROUND, "m"), Linear(4.0)),))


def _sine() -> Scene:
    return Scene(
        (Body("m", 1.0),), (Spring("k", (GROUND, "m"), Linear(9.0)),), motion=Sine(1.0, 1.7)
    )


def _yielding() -> Scene:
    law = BoucWen(2.0, 1.0, 0.02, 20.0)
    return Scene((Body("m", 1.0),), (Spring("k", (GROUND, "m"), law),), motion=Sine(3.0, 1.1))


def _after_an_impact() -> Scene:
    """The peak on the right follows a bounce on the left."""
    left = Contact("left", BARRIER, "m", 0.1, 0.8)
    spring = Spring("k", (GROUND, "m"), Linear(4.0))
    return Scene((Body("m", 1.0, 0.0, -0.6),), (spring,), (), (left,))


def _soon_after_an_impact() -> Scene:
    """Thrown up from the left against a stiff spring: the peak lies a few steps on."""
    left = Contact("left", BARRIER, "m", 0.0, 1.0)
    spring = Spring("k", (GROUND, "m"), Linear(900.0))
    return Scene((Body("m", 1.0, 0.0, -0.01),), (spring,), (), (left,))


SCENES = {
    "free": (_free(), 2.0),
    "sine": (_sine(), 2.5),
    "yielding": (_yielding(), 2.5),
    "after-an-impact": (_after_an_impact(), 2.5),
    "soon-after-an-impact": (_soon_after_an_impact(), 0.09),
}


def _impacts_on_the_wall(
    scene: Scene, gap: float, end: float, rtol: float, solver: str
) -> list[Event]:
    contacts = (*scene.contacts, replace(WALL, gap=gap))
    events = run(replace(scene, contacts=contacts), rtol, end, solver=solver).events
    return [e for e in events if e.contact == len(scene.contacts) and e.kind is EventKind.IMPACT]


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("rtol", TOLERANCES)
@pytest.mark.parametrize("name", SCENES)
def test_found_and_missed(solver, name, rtol, part):
    scene, end = SCENES[name]
    free = run(scene, rtol, end, solver=solver).displacement
    peak, time = float(free.maximum[0]), float(free.time_of_maximum[0])
    found = _impacts_on_the_wall(scene, peak * (1.0 - part), end, rtol, solver)
    assert found
    # u = peak (1 - ω² τ²/2): the gap closes sqrt(2 part)/ω before the peak, ω from 1 to 30.
    assert found[0].t < time
    assert found[0].t == pytest.approx(time, abs=3.0 * math.sqrt(2.0 * part))
    assert not _impacts_on_the_wall(scene, peak * (1.0 + part), end, rtol, solver)


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_speed_of_a_graze(solver, rtol, part):
    # Free oscillation: γ⁻ = -ω sqrt(A² - δ²). An error e of the amplitude makes it
    # sqrt(2 part ± 2 e), where the tuning takes away all of e but the interpolant's.
    scene, end = SCENES["free"]
    peak = float(run(scene, rtol, end, solver=solver).displacement.maximum[0])
    gap = peak * (1.0 - part)
    found = _impacts_on_the_wall(scene, gap, end, rtol, solver)
    expected = -2.0 * math.sqrt(peak**2 - gap**2)
    assert found[0].gap_velocity_before == pytest.approx(expected, rel=max(0.05, 3e3 * rtol))


def test_a_graze_within_two_bodies(solver):
    # Two oscillators that only just do not, or do, meet: gap 1 - (sin t + sin 1.5 t)/2 ....
    bodies = (Body("a", 1.0, 0.0, 0.5), Body("b", 2.0, 0.0, -0.75))
    springs = (
        Spring("k", (GROUND, "a"), Linear(1.0)),
        Spring("l", (GROUND, "b"), Linear(2.0 * 2.25)),
        Spring("probe", ("b", "a"), Linear(0.0)),
    )
    scene = Scene(bodies, springs)
    closest = float(run(scene, 1e-9, 4.0, solver=solver).elongation.maximum[2])
    for part in PARTS:
        for sign, count in ((-1.0, 1), (1.0, 0)):
            joint = Contact("joint", "a", "b", closest * (1.0 + sign * part), 0.9)
            events = run(replace(scene, contacts=(joint,)), 1e-9, 4.0, solver=solver).events
            assert (len(events) > 0) == bool(count)
