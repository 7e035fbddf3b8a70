"""The descriptor form of a mode against full matrices, its Jacobian against differences."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.mechanics.descriptor import Descriptor, descriptor_form
from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    constraint_errors,
    jacobian,
    residual,
    solve_contact_forces,
    to_moving_frame,
)
from eventpound.mechanics.descriptor_observation import observe_descriptor
from eventpound.mechanics.ground_frame import NO_FRAME, frame_motion
from eventpound.mechanics.observables import Observed, blank_observed
from eventpound.motion.forcing import ground_acceleration
from tests.mechanics.dense import rates
from tests.mechanics.scenes import LEDGER, Instant, assert_contacts, random_instant

# A dozen terms of order ten and a saddle-point matrix of condition below 1e4.
TOLERANCE = 1e-11
FRAME = np.array([[-1.0, 9.0], [1.5, -0.5], [0.3, 0.2], [0.7, 0.1]])
"""A frame that moves on one straight line of acceleration."""


def _descriptor(at: Instant) -> Descriptor:
    x = at.model.elongations(at.u)
    laws = at.model.elastic
    branch = np.where(laws.compression != laws.extension, np.where(x < laws.offset, -1, 1), 0)
    return descriptor_form(at.model, at.clusters, branch, ledger=LEDGER, ledger_weight=0.3)


def _consistent(at: Instant, d: Descriptor) -> tuple[np.ndarray, np.ndarray, Observed]:
    """Unknowns and rates that satisfy the equations at the start of the segment."""
    y, rate, observed = np.zeros(d.size), np.zeros(d.size), blank_observed(*at.model.counts)
    y[: 2 * at.u.size + at.z.size] = np.concatenate((at.u, at.v, at.z))
    problem = DescriptorProblem(d, at.forcing, NO_FRAME)
    solve_contact_forces(0.0, y, problem)
    observe_descriptor(0.0, y, problem, rate, observed)
    return y, rate, observed


@pytest.mark.parametrize("squeezed", [False, True])
def test_observed_values(squeezed: bool) -> None:
    rng = np.random.default_rng(31)
    for _ in range(40):
        at = random_instant(rng, squeezed=squeezed)
        d = _descriptor(at)
        _, rate, observed = _consistent(at, d)
        ground = ground_acceleration(at.forcing, at.forcing.start)
        expected = rates(at.scene, at.resting, ground, at.u, at.v, at.z)
        np.testing.assert_allclose(observed.a, expected.acceleration, atol=TOLERANCE)
        np.testing.assert_allclose(
            observed.acceleration[0], expected.acceleration + ground, atol=TOLERANCE
        )
        np.testing.assert_allclose(observed.z[1], expected.z_rate, atol=TOLERANCE)
        np.testing.assert_allclose(rate[d.ledger :], expected.ledger, atol=TOLERANCE)
        assert_contacts(observed, at, expected, squeezed)


@pytest.mark.parametrize("squeezed", [False, True])
def test_observed_rates_by_central_differences(squeezed: bool) -> None:
    # Along the exact tangent, a second difference errs by h² y'' / 6 of values of order
    # ten and rates up to 20/s: 1e-10 · 20³ · 10; rounding 1e-15 · 10 / h.
    rng, h = np.random.default_rng(32), 1e-5
    for _ in range(30):
        at = random_instant(rng, squeezed=squeezed)
        d = _descriptor(at)
        y, rate, observed = _consistent(at, d)
        sides = []
        for tau in (-h, h):
            moved, other = y + tau * rate, blank_observed(*at.model.counts)
            # Positions need the second order: their own rates are differenced too.
            moved[: at.u.size] += 0.5 * tau**2 * observed.a
            problem = DescriptorProblem(d, at.forcing, NO_FRAME)
            solve_contact_forces(tau, moved, problem)
            observe_descriptor(tau, moved, problem, np.zeros(d.size), other)
            sides.append(other)
        for name in ("force", "acceleration", "contact_force", "z", "shear"):
            low, high, slope = (getattr(s, name) for s in (*sides, observed))
            if name == "acceleration" and at.clusters.count == 0:
                continue
            difference = (high[0] - low[0]) / (2.0 * h)
            np.testing.assert_allclose(difference, slope[1], rtol=1e-6, atol=1e-5, err_msg=name)


@pytest.mark.parametrize("squeezed", [False, True])
@pytest.mark.parametrize("frame", [NO_FRAME, FRAME], ids=["relative", "moving"])
def test_the_residual_vanishes_on_the_motion(squeezed: bool, frame: np.ndarray) -> None:
    rng = np.random.default_rng(33)
    for _ in range(30):
        at = random_instant(rng, squeezed=squeezed)
        d = _descriptor(at)
        y, rate, _ = _consistent(at, d)
        count, t = at.u.size, at.forcing.start
        problem = DescriptorProblem(d, at.forcing, frame)
        to_moving_frame(problem, 0.0, 1.0, y)
        if frame.size:
            _, s_rate, s_second = frame_motion(frame, t)
            rate[:count] += d.framed * s_rate
            rate[count : 2 * count] += d.framed * s_second
        out = np.full(d.size, np.nan)
        residual(0.0, y, rate, out, problem)
        np.testing.assert_allclose(out, 0.0, atol=TOLERANCE)


@pytest.mark.parametrize("frame", [NO_FRAME, FRAME], ids=["relative", "moving"])
def test_jacobian_by_central_differences(frame: np.ndarray) -> None:
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
        problem = DescriptorProblem(d, at.forcing, frame)
        jacobian(0.0, y, cj, J, problem)
        for i in range(d.size):
            step = np.zeros(d.size)
            step[i] = h
            residual(0.0, y + step, rate + cj * step, sides[1], problem)
            residual(0.0, y - step, rate - cj * step, sides[0], problem)
            np.testing.assert_allclose(
                J[:, i], (sides[1] - sides[0]) / (2.0 * h), rtol=1e-5, atol=1e-4
            )


def test_the_gaps_determine_the_dependent_bodies() -> None:
    """Their columns of W have an inverse, of entries 0, 1 and -1 since gaps form trees."""
    rng = np.random.default_rng(35)
    for squeezed in (False, True):
        for _ in range(100):
            at = random_instant(rng, squeezed=squeezed)
            d = _descriptor(at)
            assert np.unique(d.dependent).size == d.opening.size
            if d.opening.size:
                assert abs(np.linalg.det(d.W[:, d.dependent])) == pytest.approx(1.0, abs=1e-12)


def test_constraint_errors() -> None:
    at = random_instant(np.random.default_rng(37), squeezed=True)
    d = _descriptor(at)
    y = np.zeros(d.size)
    count = at.u.size
    y[: 2 * count] = np.concatenate((at.u, at.v))
    assert max(constraint_errors(d, y)) < 1e-15
    y[0] += 1e-3
    y[count] -= 2e-3
    assert constraint_errors(d, y) == pytest.approx((1e-3, 2e-3), rel=1e-12)


def test_sizes() -> None:
    at = random_instant(np.random.default_rng(38))
    d = _descriptor(at)
    assert d.size == 2 * at.u.size + at.z.size + len(at.resting) + LEDGER
