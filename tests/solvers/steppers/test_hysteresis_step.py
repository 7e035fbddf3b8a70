"""z over a step: against the law's own inverse, its order, its bound, its derivative."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound.mechanics.link_law import z_bound
from eventpound.scene import BoucWen
from eventpound.solvers.timestepping.equations import z_after
from tests.mechanics.dense import literal_z_rate, memory_of

pytestmark = pytest.mark.usefixtures("interpreted")

LAWS = [(20.0, 0.5, 0.5), (2.0, 0.3, 0.7), (1.0, 0.5, 0.5), (5.0, -0.1, 0.6), (3.0, 0.8, 0.1)]


def _steps(z: float, change: float, steps: int, law: tuple[float, float, float]) -> np.ndarray:
    """Z at eight equal parts of a change made in so many steps."""
    memory, path = memory_of(*law, 0.1), []
    for i in range(1, steps + 1):
        z = z_after(0, memory, z, change / steps, z_bound(memory)[0])[0]
        if i % (steps // 8) == 0:
            path.append(z)
    return np.array(path)


def _exact(z: float, change: float, law: tuple[float, float, float]) -> np.ndarray:
    """Eq. 3 as printed, integrated along the elongation."""
    n, beta, gamma = law
    printed = BoucWen(0.0, 1.0, 0.1, n, beta, gamma)
    sign = np.sign(change)
    solution = solve_ivp(
        lambda _, y: [literal_z_rate(printed, sign, y[0])],
        (0.0, abs(change)),
        [z],
        rtol=1e-12,
        atol=1e-13,
        method="DOP853",
        max_step=0.01,
        t_eval=abs(change) * np.arange(1, 9) / 8,
    )
    return solution.y[0]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("z", "change"), [(0.0, 0.08), (0.4, 0.3), (0.7, -0.25), (-0.2, 0.13)])
def test_order_two_along_the_elongation(law, z, change):
    wanted = _exact(z, change, law)
    counts = np.array([160, 320, 640, 1280])
    errors = [np.abs(_steps(z, change, m, law) - wanted).max() for m in counts]
    # At the bound, or where the law is a straight line, there may be nothing to converge.
    if max(errors) > 1e-8:
        order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
        # The one step across z = 0, where the rate has a kink, errs now more, now less.
        assert 1.8 < order < 2.6


@pytest.mark.parametrize("law", LAWS)
def test_a_long_step_ends_at_the_bound(law):
    # L-stable: where the bound is b and the length l = |Δx|/u_y is great, the two stages leave
    # γ l g = -√2 (b - z), so z exceeds b by √2 b²/(γ n l) with γ = 0.293.
    n, memory = law[0], memory_of(*law, 0.1)
    (bound,) = z_bound(memory)
    for length in (1e2, 1e4):
        z, z_x = z_after(0, memory, 0.0, 0.1 * length, bound)
        assert abs(z - bound) < 5.0 * bound**2 / (n * length)
        assert abs(z_x) * 0.1 * length < 1.0
        assert z_after(0, memory, 0.0, -0.1 * length, bound)[0] == -z


@pytest.mark.parametrize("law", LAWS)
def test_derivative_is_that_of_the_step(law):
    n, memory = law[0], memory_of(*law, 0.1)
    (bound,) = z_bound(memory)
    rng = np.random.default_rng(5)
    for _ in range(200):
        z, change = rng.uniform(-bound, bound), rng.choice([-1, 1]) * 10.0 ** rng.uniform(-3, 0)
        small = 1e-6 * abs(change)
        ends = [z_after(0, memory, z, change + s, bound)[0] for s in (-small, small)]
        slope = z_after(0, memory, z, change, bound)[1]
        # Central differences: rounding over the interval, and its square times a third derivative,
        # which is of order (n/u_y)³; a kink at z = 0 within the interval is rare enough to skip.
        allowed = 4e-16 / small + (n / 0.1) ** 3 * small**2 + 1e-7 / 0.1
        assert (ends[1] - ends[0]) / (2.0 * small) == pytest.approx(slope, abs=10 * allowed)


def test_no_step_changes_nothing():
    assert z_after(0, memory_of(20.0, 0.5, 0.5, 0.1), 0.3, 0.0, 1.0)[0] == 0.3
