"""The descriptor form of a mode against full matrices, its Jacobian against differences."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from eventpound.mechanics.descriptor import Descriptor, descriptor_form
from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    constraint_errors,
    jacobian,
    to_moving_frame,
)
from eventpound.mechanics.ground_frame import NO_FRAME, frame_motion
from eventpound.mechanics.observables import bodies_motion
from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.compiled import by_python
from eventpound.solvers.sundials.descriptor_steps import full_residual, to_clusters
from tests.mechanics.dense import rates
from tests.mechanics.scenes import LEDGER, Instant, random_instant

# A dozen terms of order ten and a saddle-point matrix of condition below 1e4.
TOLERANCE = 1e-11
FRAME = np.array([[-1.0, 9.0], [1.5, -0.5], [0.3, 0.2], [0.7, 0.1]])
"""A frame that moves on one straight line of acceleration."""


def _descriptor(at: Instant) -> Descriptor:
    x = at.model.elongations(at.u)
    laws = at.model.elastic
    branch = np.where(laws.compression != laws.extension, np.where(x < laws.offset, -1, 1), 0)
    return descriptor_form(at.model, at.clusters, branch, ledger=LEDGER, ledger_weight=0.3)


def _on_the_motion(at: Instant, d: Descriptor) -> tuple[np.ndarray, np.ndarray]:
    """Unknowns and rates of full matrices at the start of the segment; λ changes at no rate."""
    ground = ground_acceleration(at.forcing, at.forcing.start)
    found = rates(at.scene, at.resting, ground, at.u, at.v, at.z)
    # Where forces are not unique, those of the independent contacts push the bodies alike.
    pushed = d.all_gaps[at.resting].T @ found.contact_force
    contact = np.linalg.lstsq(d.W.T, pushed, rcond=None)[0]
    np.testing.assert_allclose(d.W.T @ contact, pushed, atol=TOLERANCE)
    y = np.concatenate((at.u, at.v, at.z, contact, np.zeros(LEDGER)))
    still = np.zeros(contact.size)
    return y, np.concatenate((at.v, found.acceleration, found.z_rate, still, found.ledger))


def _all_rows(
    y: np.ndarray, rate: np.ndarray, out: np.ndarray, problem: DescriptorProblem, at: Instant
) -> None:
    """`full_residual` at the start of the segment."""
    mode: Any = SimpleNamespace(system=at.system, bodies=at.bodies)
    with by_python():
        full_residual(0.0, y, rate, out, problem, mode)


@pytest.mark.parametrize("squeezed", [False, True])
@pytest.mark.parametrize("frame", [NO_FRAME, FRAME], ids=["relative", "moving"])
def test_the_residual_vanishes_on_the_motion(squeezed, frame):
    rng = np.random.default_rng(33)
    for _ in range(30):
        at = random_instant(rng, squeezed=squeezed)
        d = _descriptor(at)
        y, rate = _on_the_motion(at, d)
        count, t = at.u.size, at.forcing.start
        problem = DescriptorProblem(d, at.forcing, frame, np.zeros(2))
        to_moving_frame(problem, 0.0, 1.0, y)
        if frame.size:
            _, s_rate, s_second = frame_motion(frame, t)
            rate[:count] += d.framed * s_rate
            rate[count : 2 * count] += d.framed * s_second
        out = np.full(d.size, np.nan)
        _all_rows(y, rate, out, problem, at)
        np.testing.assert_allclose(out, 0.0, atol=TOLERANCE)


@pytest.mark.parametrize("frame", [NO_FRAME, FRAME], ids=["relative", "moving"])
def test_jacobian_by_central_differences(frame):
    # Entries up to κ n |z|^(n-1) x'/u_y of order 1e2, third derivatives n² of that:
    # h² 4e4/6 = 1e-6 at h = 1e-5; rounding 1e-15 · 1e2/h = 1e-8.
    rng, cj, h = np.random.default_rng(34), 3.7, 1e-5
    for _ in range(15):
        at = random_instant(rng)
        d = _descriptor(at)
        y, rate = rng.normal(size=(2, d.size))
        # Away from x' = 0 and z = 0, where eq. 3 has kinks.
        y[2 * at.u.size : 2 * at.u.size + at.z.size] = at.z
        x_rate = d.B @ y[at.u.size : 2 * at.u.size]
        hysteretic = at.model.hysteretic
        if (np.abs(x_rate[hysteretic]) < 0.01).any() or (np.abs(at.z) < 0.01).any():
            continue
        J, sides = np.full((d.size, d.size), np.nan), np.empty((2, d.size))
        # The ledger is counted of bodies that move together as one.
        rows = d.ledger if d.opening.size else d.size
        problem = DescriptorProblem(d, at.forcing, frame, np.zeros(2))
        jacobian(0.0, y, cj, J, problem)
        for i in range(d.size):
            step = np.zeros(d.size)
            step[i] = h
            _all_rows(y + step, rate + cj * step, sides[1], problem, at)
            _all_rows(y - step, rate - cj * step, sides[0], problem, at)
            np.testing.assert_allclose(
                J[:rows, i], (sides[1] - sides[0])[:rows] / (2.0 * h), rtol=1e-5, atol=1e-4
            )


def test_the_gaps_determine_the_dependent_bodies():
    """Their columns of W have an inverse, of entries 0, 1 and -1 since gaps form trees."""
    rng = np.random.default_rng(35)
    for squeezed in (False, True):
        for _ in range(100):
            at = random_instant(rng, squeezed=squeezed)
            d = _descriptor(at)
            assert np.unique(d.dependent).size == d.opening.size
            if d.opening.size:
                assert abs(np.linalg.det(d.W[:, d.dependent])) == pytest.approx(1.0, abs=1e-12)


def test_the_loop_has_the_momentum_of_the_bodies_and_no_gaps():
    rng = np.random.default_rng(36)
    for squeezed in (False, True):
        at = random_instant(rng, squeezed=squeezed)
        d, state, u = _descriptor(at), np.empty(at.system.size), np.empty((2, at.u.size))
        y, _ = _on_the_motion(at, d)
        to_clusters(y, 1.0, at.system, at.bodies, state)
        np.testing.assert_allclose(state[: at.y.size - LEDGER], at.y[:-LEDGER], atol=1e-14)
        y[: 2 * at.u.size] += 1e-3 * rng.normal(size=2 * at.u.size)
        to_clusters(y, 1.0, at.system, at.bodies, state)
        bodies_motion(state, at.bodies, *u)
        assert np.abs(d.opening + d.W @ u[0]).max(initial=0.0) < 1e-14
        moves = at.clusters.of_body >= 0
        for part in (0, 1):
            own = y[part * at.u.size :][: at.u.size]
            assert d.mass[moves] @ (u[part] - own)[moves] == pytest.approx(0.0, abs=1e-13)


def test_constraint_errors():
    at = random_instant(np.random.default_rng(37), squeezed=True)
    d = _descriptor(at)
    y = np.zeros(d.size)
    count = at.u.size
    y[: 2 * count] = np.concatenate((at.u, at.v))
    assert max(constraint_errors(d, y)) < 1e-15
    y[0] += 1e-3
    y[count] -= 2e-3
    assert constraint_errors(d, y) == pytest.approx((1e-3, 2e-3), rel=1e-12)


def test_sizes():
    at = random_instant(np.random.default_rng(38))
    d = _descriptor(at)
    assert d.size == 2 * at.u.size + at.z.size + len(at.resting) + LEDGER
