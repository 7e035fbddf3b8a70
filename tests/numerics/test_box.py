"""The least of a quadratic function in a box, beside every corner, edge and face tried."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from eventpound.numerics.box import least_in_box

SMALL = 1e-4


def _problem(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """More unknowns than G has rank; numbers of a few digits, so that some are exactly equal."""
    k, rank = int(rng.integers(1, 5)), int(rng.integers(1, 4))
    D = rng.integers(-2, 3, (k, rank)) * 1.0
    D[~D.any(axis=1), 0] = 1.0
    q = np.column_stack((D @ rng.integers(-3, 4, rank), rng.integers(-1, 2, (k, 2)))) * 1.0
    high = np.where(rng.random(k) < 0.5, np.inf, rng.integers(1, 4, k))
    low = np.where(np.isinf(high), 0.0, -high)
    return D @ D.T, q, low, high


def _every_way(G: np.ndarray, q: np.ndarray, low: np.ndarray, high: np.ndarray) -> list[np.ndarray]:
    """Where the gradient points out of the box, of the x that each choice of bounds leaves."""
    found = []
    for sides in product((-1, 0, 1), repeat=q.size):
        side = np.array(sides)
        x = np.where(side < 0, low, np.where(side > 0, high, 0.0))
        free = side == 0
        if not np.isfinite(x).all():
            continue
        if free.any():
            F = G[np.ix_(free, free)]
            x[free] = np.linalg.lstsq(F, -(q + G @ x)[free], 1e-9)[0]
        w = G @ x + q
        inside = ((x >= low - 1e-11) & (x <= high + 1e-11)).all()
        if inside and (np.abs(w[free]) < 1e-11).all() and (side[~free] * w[~free] <= 1e-11).all():
            found.append(x)
    return found


def test_limit_is_that_of_small_changes_tried_in_every_way() -> None:
    rng = np.random.default_rng(5)
    seen = none = 0
    for _ in range(150):
        G, q, low, high = _problem(rng)
        start = np.where(np.isinf(high), 0.0, low)
        x, found = least_in_box(G, q, low, high, start)
        small = _every_way(G, q @ np.array([1.0, SMALL, SMALL**2]), low, high)
        if not found:
            none += 1
            assert not small
            continue
        seen += 1
        # Which of several is free; that it is the limit of one is not.
        assert min(np.abs(x - other).max() for other in small) < 100.0 * SMALL
        w = G @ x + q[:, 0]
        inside = (x > low) & (x < high)
        np.testing.assert_allclose(w[inside], 0.0, atol=1e-12)
    assert seen > 100
    assert none > 3


def test_joints_beside_each_other_end_nothing_by_rounding() -> None:
    # Forces that a joint does not change at all are moved by rounding, and some rounding is large
    # beside that.
    rng = np.random.default_rng(6)
    for _ in range(300):
        bodies = int(rng.integers(2, 6))
        W = np.zeros((2 * bodies, bodies))
        for row in W:
            one, other = rng.choice(bodies + 1, 2, replace=False)
            ends = np.array([one, other])
            row[ends[ends < bodies]] = np.array([-1.0, 1.0])[ends < bodies]
        G = W / rng.uniform(0.1, 3.0, bodies) @ W.T
        q = W @ rng.normal(size=bodies)
        high = np.where(rng.random(q.size) < 0.3, np.inf, rng.uniform(0.01, 1.0, q.size))
        low = np.where(np.isinf(high), 0.0, -high)
        x, found = least_in_box(G, q[:, None], low, high, low.copy())
        assert found
        w = G @ x + q
        assert (w[x < high] > -1e-11).all()
        assert (w[x > low] < 1e-11).all()


def test_a_number_that_nothing_moves_stays_at_its_start() -> None:
    G, low, high = np.ones((2, 2)), np.full(2, -1.0), np.ones(2)
    x, found = least_in_box(G, np.zeros((2, 1)), low, high, np.array([1.0, -1.0]))
    assert found
    assert x == pytest.approx([1.0, -1.0])


def test_rounding_of_unknowns_that_vanish_does_not_decide() -> None:
    # Two contacts and three sliders, which may all let go; next, two supports part.
    mass = np.array([1.2692422401767902, 1.5612784402796849, 1.7015906954878348])
    W = np.array([[1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0, -1, 1]])
    bound = np.array([0.0, 0.0, 0.29824614543211375, 4.986009876809242, 0.4319888918413696])
    high = np.where(bound > 0.0, bound, np.inf)
    q = np.column_stack((np.zeros(5), [1.5, 0.0, -1.5, 0.0, 0.0]))
    x, found = least_in_box(W / mass @ W.T, q, -bound, high, -bound)
    assert found
    np.testing.assert_allclose(x @ W, 0.0, rtol=0.0, atol=1e-14)
    # What the first slider is pulled by tells of its slip.
    assert x[2] == bound[2]
