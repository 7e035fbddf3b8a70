"""Rows of bodies under a record beside CVODE: motion, events, peaks and rows are the same."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from eventpound import Record, simulate_many
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task

RTOL = 1e-10
FAR = 2e-6
"""How far peaks and rows may be off, beside the largest: dozens of impacts lie between."""
SHAPES = ((0.5, 0.5), (0.1, 0.9), (0.9, 0.1), (-0.2, 0.8))


def record(rng: np.random.Generator, period: float, dt: float, peak: float) -> Record:
    """Four sines at random, of three periods."""
    t = dt * np.arange(int(3.0 * period / dt) + 2)
    waves = (
        rng.normal() * np.sin(2.0 * np.pi * t * rng.uniform(0.5, 3.0) / period + rng.uniform(0, 6))
        for _ in range(4)
    )
    return Record(sum(waves), dt, pga=peak)


def row(seed: int, count: int, wide: float = 1.0) -> tuple[Scene, float]:
    """Bodies between barriers, linear or yielding, some of them damped; length of the run (s)."""
    rng = np.random.default_rng(seed)
    period, peak = rng.uniform(0.4, 2.0), rng.uniform(1.0, 5.0)
    length = peak * (period / (2.0 * np.pi)) ** 2
    bodies = tuple(
        Body(f"b{i}", 10.0 ** rng.uniform(-0.7, 0.7), rng.normal() * length * 0.2)
        for i in range(count)
    )
    springs, dashpots = [], []
    for i, body in enumerate(bodies):
        ends = (GROUND, body.name) if rng.random() < 0.7 else (body.name, GROUND)
        if rng.random() < 0.3:
            k = body.mass * peak / length * 10.0 ** rng.uniform(-1.0, 0.7)
            springs.append(Spring(f"s{i}", ends, Linear(k)))
        else:
            force, u_y = body.mass * peak * rng.uniform(0.1, 1.0), length * rng.uniform(0.05, 0.6)
            beta, gamma = SHAPES[rng.integers(len(SHAPES))]
            n = float(rng.choice((1.0, 2.0, 20.0)))
            law = BoucWen(0.1 * force / u_y, force, u_y, n, beta, gamma)
            springs.append(Spring(f"s{i}", ends, law))
        if rng.random() < 0.4:
            c = 0.1 * rng.random() * body.mass * np.sqrt(peak / length)
            dashpots.append(Dashpot(ends, c))
    u = {body.name: body.displacement for body in bodies} | {BARRIER: 0.0}
    contacts = tuple(
        Contact(
            f"c{i}",
            a,
            b,
            u[a] - u[b] + wide * length * rng.uniform(0.1, 1.0),
            rng.uniform(0.3, 1.0),
        )
        for i, (a, b) in enumerate(pairwise((BARRIER, *(body.name for body in bodies), BARRIER)))
    )
    motion = record(rng, period, period / 40.0, peak)
    return Scene(bodies, tuple(springs), tuple(dashpots), contacts, motion), 3.5 * period


def solved(scene: Scene, end: float, solver: str, rtol: float) -> Recording:
    times = np.linspace(0.0, end, 83)
    return solver_named(solver).solve(Task(scene, 0.0, end, rtol, output_times=times))


@pytest.mark.parametrize("seed", range(10))
def test_as_cvode(seed):
    scene, end = row(seed, 2 + seed % 6) if seed < 9 else row(seed, 20, 3.0)
    # In seed 6 bodies touch: cvode tells when to the square root of its tolerance, and is 6e-6 of
    # the motion off at 1e-11, 1e-7 at 1e-13, where fast is 5e-9 off at 1e-10.
    found, true = solved(scene, end, "fast", RTOL), solved(scene, end, "cvode", 1e-3 * RTOL)
    assert [e[1:4:2] for e in found.events] == [e[1:4:2] for e in true.events]
    assert true.events
    for name in ("displacement", "acceleration", "base_shear"):
        peaks, wanted = getattr(found, name), getattr(true, name)
        far = FAR * max(np.abs(wanted.maximum).max(), np.abs(wanted.minimum).max())
        np.testing.assert_allclose(peaks.maximum, wanted.maximum, rtol=0.0, atol=far)
        np.testing.assert_allclose(peaks.minimum, wanted.minimum, rtol=0.0, atol=far)
    far = FAR * np.abs(true.history.u).max()
    np.testing.assert_allclose(found.smallest_gap, true.smallest_gap, rtol=0.0, atol=far)
    np.testing.assert_allclose(found.largest_gap, true.largest_gap, rtol=0.0, atol=far)
    for name in ("t", "u", "v", "a", "z", "force", "gap", "contact_force"):
        rows, wanted = getattr(found.history, name), getattr(true.history, name)
        far = FAR * np.abs(wanted).max(initial=1e-300)
        np.testing.assert_allclose(rows, wanted, rtol=0.0, atol=far, err_msg=name)


def test_rows_do_not_change_the_motion():
    """Nor does being one of many, to the last bit."""
    scene, end = row(3, 5)
    with_rows = solved(scene, end, "fast", RTOL)
    without = solver_named("fast").solve(Task(scene, 0.0, end, RTOL, output_times=np.empty(0)))
    np.testing.assert_array_equal(with_rows.u, without.u)
    gap = f"contact.{scene.contacts[1].name}.gap"
    many = simulate_many(scene, {gap: [scene.contacts[1].gap] * 2}, rtol=RTOL, duration=end)
    for b, body in enumerate(scene.bodies):
        peaks = many.table[f"peaks.{body.name}.max"]
        assert (peaks == with_rows.displacement.maximum[b]).all()


def test_plastic_impacts():
    """Two bodies rest on each other, while others go on."""
    scene, end = row(5, 4)
    contacts = tuple(replace(contact, restitution=0.0) for contact in scene.contacts)
    scene = replace(scene, contacts=contacts)
    found, true = solved(scene, end, "fast", RTOL), solved(scene, end, "cvode", 0.1 * RTOL)
    kinds = [event.kind.name for event in true.events]
    assert "REST" in kinds
    assert [event.kind.name for event in found.events] == kinds
    np.testing.assert_allclose(found.u, true.u, rtol=0.0, atol=FAR * np.abs(true.history.u).max())
