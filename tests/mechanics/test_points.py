"""Constraints of contacts at points: projection, forces and impacts beside dense algebra."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from eventpound.contact.points import impact_over
from eventpound.mechanics.impact import impact_law
from eventpound.mechanics.points import independent, projection_of, unique_forces_of
from eventpound.numerics.compiled import in_python

EPS = np.finfo(float).eps


@pytest.mark.parametrize("seed", range(20))
def test_the_projection_is_gauss_least_constraint(seed: int) -> None:
    """Of all accelerations that keep the gaps, those nearest to the free ones by mass."""
    rng = np.random.default_rng(seed)
    count, rows = 7, int(rng.integers(1, 5))
    mass = 10.0 ** rng.uniform(-3.0, 3.0, count)
    W = rng.uniform(-1.0, 1.0, (rows, count)) * (rng.random((rows, count)) < 0.6)
    W = W[W.any(axis=1)]
    P = projection_of(W, mass)
    free = rng.normal(size=count)
    # Least (a - free)' M (a - free) with W a = 0, by its own optimality conditions.
    zero = np.zeros((W.shape[0], W.shape[0]))
    system = np.block([[np.diag(mass), -W.T], [W, zero]])
    best = np.linalg.lstsq(system, np.append(mass * free, np.zeros(W.shape[0])), rcond=None)[0]
    # The condition of that system, and no more, parts them.
    np.testing.assert_allclose(P @ free, best[:count], atol=1e-9 * np.abs(free).max())
    np.testing.assert_allclose(W @ P @ free, 0.0, atol=1e-11 * np.abs(free).max() * 1e3)
    idle = ~W.any(axis=0)
    np.testing.assert_array_equal((P @ free)[idle], free[idle])


def test_what_a_support_carries_moves_the_others() -> None:
    """Two decks on a beam between a pier, which is held, and a free body: as beside much mass."""
    W = np.array([[0.5, -1.0, 0.0, 0.5], [0.25, 0.0, -1.0, 0.75]])
    mass = np.array([np.inf, 2.0, 3.0, 5.0])
    P = projection_of(W, mass)
    np.testing.assert_array_equal(P[0], [1.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(W @ P, 0.0, atol=4.0 * EPS)
    # A finite mass errs by its part of the others, and by rounding of its square root.
    np.testing.assert_allclose(P, projection_of(W, np.where(mass < np.inf, mass, 1e12)), atol=1e-11)


def test_rows_that_others_make_up_are_left_out() -> None:
    W = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, -1.0]])
    first = np.array([False, True, True])
    chosen = independent(W, np.array([1.0, 1e-6, 1e6]), first)
    np.testing.assert_array_equal(chosen, [False, True, True])


def test_which_forces_are_unique() -> None:
    """Three contacts between two bodies and one beside them."""
    W = np.array([[1.0, -1.0, 0.0], [1.0, -0.5, 0.0], [0.5, -1.0, 0.0], [0.0, 0.3, 1.0]])
    np.testing.assert_array_equal(unique_forces_of(W), [False, False, False, True])
    assert unique_forces_of(W[[0, 1, 3]]).all()


@pytest.mark.parametrize("seed", range(30))
def test_between_bodies_it_is_the_impact_law(seed: int) -> None:
    """Columns of W with two entries: the law over links, whose matrix falls into parts."""
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(2, 7))
    mass = 10.0 ** rng.uniform(-2.0, 2.0, bodies)
    left, right = np.arange(-1, bodies), np.append(np.arange(bodies), -1)
    rows = np.zeros((left.size, bodies + 1))
    rows[np.arange(left.size), right] += 1.0
    rows[np.arange(left.size), left] -= 1.0
    rows = rows[:, :bodies]
    closed = rng.random(left.size) < 0.8
    v = rng.normal(size=bodies)
    rate, restitution = rows @ v, rng.choice([0.0, 0.5, 1.0], left.size)
    if not (closed & (rate < 0.0)).any():
        closed[np.argmin(rate)] = True
    other_v, other_rate = v.copy(), rate.copy()
    at = SimpleNamespace(mass=mass, gap_rate=rate, v=v)
    own_impulse, own_involved, own_lost, own_solved = impact_over(rows, restitution, closed, at)
    law = in_python(impact_law)
    impulse, involved, lost, solved = law(
        mass, left, right, restitution, closed, other_rate, other_v
    )
    assert own_solved
    assert solved
    np.testing.assert_array_equal(own_involved, involved)
    # Condition of the matrix: the ratio of the masses, 1e4, times some units of rounding.
    near = 1e6 * EPS
    np.testing.assert_allclose(own_impulse, impulse, rtol=near, atol=near * impulse.max())
    np.testing.assert_allclose(v, other_v, rtol=near, atol=near)
    np.testing.assert_allclose(rate, other_rate, rtol=near, atol=near)
    assert own_lost == pytest.approx(lost, rel=1e-9, abs=1e-12)
