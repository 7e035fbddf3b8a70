"""What must not change an answer: units, the side one looks from, the order of a list."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from eventpound.scene import GROUND, Body, BoucWen, Linear, Scene, Spring
from eventpound.solvers.base import Event, EventKind, Recording
from tests.properties.restored import restored
from tests.properties.transforms import from_state, mirrored, reordered, same, scaled
from tests.solvers.accuracy import RTOL, allowed
from tests.solvers.scenes import pounding_pair, run

SCENE = pounding_pair()
LENGTH, SPEED = 0.1, 1.0
"""Scales of displacement (m) and velocity (m/s); those of time and z are one."""


def _impacts(events: tuple[Event, ...]) -> list[Event]:
    return [e for e in events if e.kind is EventKind.IMPACT]


def _compare(recording: Recording, whole: Recording, accuracy: float) -> None:
    """Compare with the whole run, in its terms."""

    def close(ours: object, expected: object, scale: float) -> None:
        np.testing.assert_allclose(ours, expected, rtol=0.0, atol=accuracy * scale)

    close(recording.u, whole.u, LENGTH)
    close(recording.v, whole.v, SPEED)
    close(recording.z, whole.z, 1.0)
    assert [(e.kind, e.contact) for e in recording.events] == [
        (e.kind, e.contact) for e in whole.events
    ]
    close([e.t for e in recording.events], [e.t for e in whole.events], 1.0)
    ours, expected = _impacts(recording.events), _impacts(whole.events)
    close([e.gap_velocity_before for e in ours], [e.gap_velocity_before for e in expected], SPEED)


@lru_cache
def _whole(solver: str) -> Recording:
    """The run that others are compared with."""
    return run(SCENE, RTOL, solver=solver, energy=True)


def test_the_scene_is_worth_the_name(solver: str) -> None:
    """It pounds at every contact, yields, and pulls its cable tight."""
    whole = _whole(solver)
    assert {e.contact for e in _impacts(whole.events)} == {0, 1, 2}
    assert whole.elongation.maximum[0] > 0.03
    assert whole.elongation.maximum[2] > 0.015


@pytest.mark.parametrize(
    ("length", "time", "mass"), [(0.0137, 3.3, 1e5), (1e3, 1e-3, 1e-4), (0.3, 0.7, 1.0)]
)
def test_scaling(solver: str, length: float, time: float, mass: float) -> None:
    # The default tolerances scale along, so what is left is rounding, and where it tips a
    # decision of the step control, a part of the tolerance.
    rtol = 1e-12
    one = run(SCENE, rtol, solver=solver)
    scene, view = scaled(SCENE, length, time, mass)
    other = restored(run(scene, rtol, 6.0 * time, solver=solver), view)
    _compare(other, one, allowed(1.0))
    # Π_um = u_peak ω_g²/a_g: both lengths scale alike.
    for which in ("maximum", "minimum"):
        ours, expected = getattr(other.displacement, which), getattr(one.displacement, which)
        np.testing.assert_allclose(ours, expected, rtol=1e-10)
    np.testing.assert_allclose(other.u, one.u, rtol=0.0, atol=1e-10 * LENGTH)


def test_mirror(solver: str) -> None:
    scene, view = mirrored(SCENE)
    _compare(restored(run(scene, RTOL, solver=solver), view), _whole(solver), allowed(1.0))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_order_of_the_lists(solver: str, seed: int) -> None:
    scene, view = reordered(SCENE, np.random.default_rng(seed))
    _compare(restored(run(scene, RTOL, solver=solver), view), _whole(solver), allowed(1.0))


def test_a_body_far_away_changes_nothing(solver: str) -> None:
    scene = replace(
        SCENE,
        bodies=(*SCENE.bodies, Body("far", 5.0, 0.02, 0.1)),
        springs=(*SCENE.springs, Spring("frame far", (GROUND, "far"), Linear(77.0))),
    )
    other = restored(run(scene, RTOL, solver=solver), same(SCENE))
    _compare(other, _whole(solver), allowed(1.0))


@pytest.mark.parametrize("split", [0.9, 1.7, 3.3])
def test_a_run_in_two_parts(solver: str, split: float) -> None:
    first = run(SCENE, RTOL, split, solver=solver)
    second = run(from_state(SCENE, first.u, first.v, first.z, 0.0), RTOL, 6.0, split, solver=solver)
    both = replace(second, events=(*first.events, *second.events))
    _compare(both, _whole(solver), allowed(1.0))


@pytest.mark.parametrize("rtol", [1e-5, 1e-7, 1e-9])
def test_a_looser_tolerance(solver: str, rtol: float) -> None:
    _compare(run(SCENE, rtol, solver=solver), _whole(solver), allowed(1.0, rtol))


def test_energy_ledger(solver: str) -> None:
    whole = _whole(solver)
    assert whole.energy is not None
    energy = whole.energy
    assert abs(energy.closure) < allowed(1.0)
    mass = np.array([b.mass for b in SCENE.bodies])
    assert energy.kinetic == pytest.approx(0.5 * mass @ whole.v**2, rel=1e-12)
    assert energy.impact == pytest.approx(sum(e.energy_lost for e in whole.events), rel=1e-12)
    assert min(energy.viscous, energy.hysteretic, energy.impact) > 0.0


def test_momentum_between_free_bodies(solver: str) -> None:
    # Springs and contacts between bodies only: the momentum stays, impact by impact.
    scene = Scene(
        (Body("a", 1.0, 0.0, 2.0), Body("b", 0.2, 0.3, 0.0), Body("c", 4.0, 0.7, -1.0)),
        (Spring("s", ("a", "c"), Linear(3.0)), Spring("h", ("b", "c"), BoucWen(0.1, 0.5, 0.1))),
        (),
        tuple(
            replace(c, left=a, right=b)
            for c, (a, b) in zip(SCENE.contacts[:2], (("a", "b"), ("b", "c")), strict=True)
        ),
    )
    recording = run(scene, RTOL, 4.0, solver=solver, energy=True)
    assert len(_impacts(recording.events)) > 3
    mass = np.array([1.0, 0.2, 4.0])
    # Multistep methods keep linear invariants to rounding, a sum over the steps.
    assert mass @ recording.v == pytest.approx(-2.0, abs=1e-13 * recording.work.steps)
    assert recording.energy is not None
    assert abs(recording.energy.closure) < allowed(1.0)
