"""What is observed of a state against full matrices, and its rates against differences."""

import numpy as np
import pytest

from eventpound.mechanics.observables import Observed, blank_observed, observe
from eventpound.mechanics.reduced import motion_rate
from eventpound.mechanics.series import evaluate_series, motion_series
from eventpound.motion.forcing import ground_acceleration
from tests.mechanics.dense import rates
from tests.mechanics.scenes import Instant, assert_contacts, random_instant


def _observe(at: Instant, tau: float, y: np.ndarray) -> Observed:
    rate = np.empty(y.size)
    motion_rate(tau, y, rate, at.system, at.forcing)
    out = blank_observed(*at.model.counts)
    observe(tau, y, rate, at.system, at.bodies, at.forcing, out)
    return out


@pytest.mark.parametrize("squeezed", [False, True])
def test_values(squeezed):
    rng = np.random.default_rng(71)
    for _ in range(40):
        at = random_instant(rng, squeezed=squeezed)
        observed = _observe(at, 0.0, at.y)
        ground = ground_acceleration(at.forcing, at.forcing.start)
        expected = rates(at.scene, at.resting, ground, at.u, at.v, at.z)
        np.testing.assert_allclose(observed.u, at.u, atol=1e-14)
        np.testing.assert_allclose(observed.v, at.v, atol=1e-14)
        np.testing.assert_allclose(observed.z[0], at.z, atol=1e-15)
        np.testing.assert_allclose(
            observed.acceleration[0], expected.acceleration + ground, atol=1e-11
        )
        force = assert_contacts(observed, at, expected, squeezed)
        assert not observed.gap[:, at.resting].any()
        # The ground takes what the bodies and their inertia do not: Newton's third law.
        barrier = sum(
            force[j] * ((c.left == "barrier") * 1.0 - (c.right == "barrier") * 1.0)
            for j, c in enumerate(at.scene.contacts)
        )
        mass = np.array([b.mass for b in at.scene.bodies])
        inertia = mass @ (expected.acceleration + ground)
        assert inertia == pytest.approx(barrier - observed.shear[0], abs=1e-10)


def _rows_with_rates(observed: Observed) -> np.ndarray:
    """Every quantity that is observed together with its rate, values then rates."""
    pairs = (observed.z, observed.force, observed.acceleration, observed.contact_force)
    rows = [
        np.concatenate([pair[i] for pair in pairs] + [[observed.shear[i], observed.ground[i]]])
        for i in (0, 1)
    ]
    for chain in (observed.gap, observed.elongation):
        rows = [
            np.concatenate((rows[0], chain[0], chain[1])),
            np.concatenate((rows[1], chain[1], chain[2])),
        ]
    rows = [
        np.concatenate((rows[0], observed.u, observed.v)),
        np.concatenate((rows[1], observed.v, observed.a)),
    ]
    return np.array(rows)


@pytest.mark.parametrize("squeezed", [False, True])
def test_rates_by_central_differences(squeezed):
    # Five points: error h⁴ f⁽⁵⁾/30. Rates up to 20/s (n = 20, near the bound) make
    # f⁽⁵⁾ ≤ 20⁵ of values of order ten: 1e-16 · 3e6 · 10/30 = 1e-10, and rounding
    # 1e-15 · 10/h = 1e-10.
    rng = np.random.default_rng(72)
    h = 1e-4
    checked = 0
    while checked < 10:
        at = random_instant(rng, squeezed=squeezed)
        speeds = at.model.elongations(at.v)[at.model.hysteretic]
        moving = at.system.z_of >= 0
        if (np.abs(speeds[moving]) < 0.1).any() or (np.abs(at.z[moving]) < 0.05).any():
            continue
        Y = motion_series(0.0, at.y, at.system, at.forcing, 12, 0.0)
        values = {
            m: _rows_with_rates(_observe(at, m * h, evaluate_series(Y, m * h)[0]))[0]
            for m in (-2, -1, 1, 2)
        }
        difference = (8.0 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12.0 * h)
        rate = _rows_with_rates(_observe(at, 0.0, at.y))[1]
        np.testing.assert_allclose(rate, difference, rtol=0.0, atol=1e-8)
        checked += 1
