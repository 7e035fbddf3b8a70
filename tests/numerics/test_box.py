"""Least forces in bounds, beside every corner, edge and face tried, and Gauss's function in full.

Problems are of joints between bodies, whose masses reach a ratio of 1e9, and where forces are not
unique: joints between the same two, along cycles, to supports, at points, with bounds that are
equal, infinite or of a few digits, so that some are exactly reached.
"""

from fractions import Fraction
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import linprog, lsq_linear

from eventpound.numerics.box import BoxJoints, least_in_box

SMALL = 1e-4
NONE = Fraction(0)
ROUNDING = 1e-13
"""Part of its terms by which a rate, and of its own by which a value, may miss."""


class _Box(NamedTuple):
    """k joints between n bodies, W (n, k), a (m, n), low, high, start (k,)."""

    W: np.ndarray
    mass: np.ndarray
    a: np.ndarray
    low: np.ndarray
    high: np.ndarray
    start: np.ndarray

    def least(self) -> tuple[np.ndarray, bool]:
        """What is tested."""
        none = np.zeros(self.mass.size)
        x, found = least_in_box(
            BoxJoints(self.W.T.copy(), self.mass, self.a, none, self.low, self.high, self.start)
        )
        return x, bool(found)


def _box(mass: list[float], ends: np.ndarray, a: np.ndarray, bound: np.ndarray) -> _Box:
    """With bounds of both signs, or from zero on where one is infinite; it starts at the lower."""
    W = np.zeros((len(mass), ends.shape[1]))
    for i, (left, right) in enumerate(ends.T):
        W[[left] if left >= 0 else [], i] -= 1.0
        W[[right] if right >= 0 else [], i] += 1.0
    low = np.where(np.isinf(bound), 0.0, -bound)
    return _Box(W, np.array(mass), np.atleast_2d(a), low, bound, low.copy())


def _some(rng: np.random.Generator, *, digits: bool) -> _Box:
    n, k = int(rng.integers(1, 7)), int(rng.integers(1, 13))
    held = 0 if n == 1 else int(rng.integers(0, min(3, n)))
    wide = 0.0 if digits else float(rng.choice([0.0, 1.0, 4.5]))
    bodies = np.arange(-1, n)
    ends = np.array([rng.choice(bodies, 2, replace=False) for _ in range(k)])
    ends[(ends < held).all(axis=1), 0] = held
    ends[ends[:, 0] == ends[:, 1], 1] = -1
    ends[: int(rng.integers(1, k + 1))] = ends[0]
    mass = rng.integers(1, 4, n) * 1.0 if digits else 10.0 ** rng.uniform(-wide, wide, n)
    mass[:held] = np.inf
    bound = rng.integers(0, 4, k) * 1.0 if digits else 10.0 ** rng.uniform(-wide, wide, k)
    bound[rng.random(k) < rng.choice([0.0, 0.3, 0.8])] = np.inf
    a = rng.integers(-1, 2, n) if rng.random() < 0.5 else rng.normal(size=n)
    return _box(list(mass), ends.T.copy(), a * 10.0 ** rng.uniform(-wide, wide), bound)


def _at_points(rng: np.random.Generator, box: _Box) -> _Box:
    """Half of the joints with ends at points between two bodies each."""
    W, n = box.W.copy(), box.mass.size
    for i in np.flatnonzero(rng.random(W.shape[1]) < (0.5 if n > 1 else 0.0)):
        for sign in (-1.0, 1.0):
            own, part = W[:, i] == sign, rng.choice([0.5, 0.25, 1.0 / 3.0, 1.0 / 6.0, 0.9])
            W[own, i] = 0.0
            W[rng.choice(n, 2, replace=False), i] += sign * np.array([part, 1.0 - part])
    # What is between supports alone no force moves.
    still = (W[np.isfinite(box.mass)] == 0.0).all(axis=0)
    return box._replace(W=np.where(still, box.W, W))


def _has_none(box: _Box) -> bool:
    """Whether Gauss's function falls for ever: along a cycle whose forces have no bound."""
    free = np.isfinite(box.mass)
    one = np.isinf(box.high) * 1.0
    along = linprog(
        box.W.T @ np.where(free, 0.0, box.a[0]),
        A_eq=box.W[free],
        b_eq=np.zeros(int(free.sum())),
        bounds=np.column_stack((0.0 * one, one)),
    )
    return bool(along.fun < -1e-12)


def _could_fall(box: _Box, x: np.ndarray) -> tuple[float, float]:
    """By how much Gauss's function could be less at most, without rounding; and its rounding.

    A convex function is above its tangent, whose least value in the box is at a corner.
    """
    W, a, terms = [[Fraction(w) for w in row] for row in box.W], [], []
    for b, row in enumerate(W):
        move = sum((w * (Fraction(x[i]) - Fraction(box.start[i])) for i, w in enumerate(row)), NONE)
        sizes = float(np.abs(box.W[b]) @ (np.abs(x) + np.abs(box.start)))
        free = np.isfinite(box.mass[b])
        a.append(Fraction(box.a[0, b]) + (move / Fraction(box.mass[b]) if free else 0))
        terms.append(abs(box.a[0, b]) + (sizes / box.mass[b] if free else 0.0))
    fall, allowed = NONE, 0.0
    for i in range(x.size):
        w = sum((row[i] * part for row, part in zip(W, a, strict=True)), NONE)
        level = ROUNDING * float(np.abs(box.W[:, i]) @ terms)
        corner = box.low[i] if w > 0 else box.high[i]
        if np.isinf(corner):
            assert abs(w) <= level
            continue
        fall += w * (Fraction(x[i]) - Fraction(corner))
        allowed += level * abs(x[i] - corner)
    return float(fall), allowed


@pytest.mark.parametrize("points", [False, True])
@pytest.mark.parametrize("digits", [False, True])
def test_no_other_forces_are_less(*, digits, points):
    rng = np.random.default_rng(9)
    seen = none = 0
    for _ in range(400):
        box = _some(rng, digits=digits)
        box = _at_points(rng, box) if points else box
        x, found = box.least()
        assert ((x >= box.low) & (x <= box.high)).all()
        if not found:
            none += 1
            assert _has_none(box)
            continue
        fall, allowed = _could_fall(box, x)
        assert fall <= allowed
        free = np.isfinite(box.mass)
        # At points bvls may end elsewhere; that there is nothing less is shown above.
        if (box.low < box.high).all() and not (points or box.a[0, ~free].any()):
            seen += 1
            A = box.W[free] / np.sqrt(box.mass[free])[:, None]
            b = A @ box.start - np.sqrt(box.mass[free]) * box.a[0, free]
            other = lsq_linear(A, b, (box.low, box.high), method="bvls").x
            # Accelerations are unique, whatever the forces.
            size = np.linalg.norm(np.abs(A) @ np.abs(np.column_stack((x, other, box.start)))) + 1.0
            assert np.linalg.norm(A @ (x - other)) <= 1e-7 * size
            assert np.linalg.norm(A @ x - b) <= np.linalg.norm(A @ other - b) + 1e-12 * size
    assert points or seen > 50
    assert none > 3


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


def test_limit_is_that_of_small_changes_tried_in_every_way():
    rng = np.random.default_rng(5)
    seen = none = 0
    for _ in range(150):
        n, k = int(rng.integers(1, 4)), int(rng.integers(1, 5))
        ends = np.array([rng.choice(np.arange(-1, n), 2, replace=False) for _ in range(k)]).T
        bound = np.where(rng.random(k) < 0.5, np.inf, rng.integers(1, 4, k))
        # Beside what moves itself, what is between ground and supports.
        mass = np.where(np.arange(n) < rng.integers(0, n), np.inf, rng.integers(1, 4, n))
        a = rng.integers(-3, 4, (3, n)) * 1.0
        a[1:, np.isfinite(mass)] = 0.0
        box = _box(list(mass), ends, a, bound)
        x, found = box.least()
        inverse = np.where(np.isinf(mass), 0.0, 1.0 / mass)
        G = box.W.T @ (inverse[:, None] * box.W)
        q = box.W.T @ (a.T @ np.array([1.0, SMALL, SMALL**2])) - G @ box.start
        small = _every_way(G, q, box.low, box.high)
        if not found:
            none += 1
            assert not small
            continue
        seen += 1
        # Which of several is free; that it is the limit of one is not.
        assert min(np.abs(x - other).max() for other in small) < 100.0 * SMALL
    assert seen > 100
    assert none > 3


def test_a_force_that_nothing_moves_stays_at_its_start():
    box = _box([1.0], np.array([[0, 0], [-1, -1]]), np.zeros(1), np.ones(2))
    x, found = box._replace(start=np.array([1.0, -1.0])).least()
    assert found
    assert x == pytest.approx([1.0, -1.0])


def test_sliders_beside_bodies_of_very_unlike_masses_do_not_go_round_in_circles():
    # Of 63 000, 105 and 0.3 t; three sliders and the ground are a cycle.
    bound = np.array([600.0, 600000.0, 20000.0, 300000.0])
    ends = np.array([[-1, 0, 2, 1], [1, 1, -1, 2]])
    box = _box([6.3e7, 1.05e5, 300.0], ends, np.zeros(3), bound)
    a = box.W @ box.start / box.mass
    x, found = box._replace(a=a[None, :]).least()
    assert found
    # Nothing else pulls at the bodies: they stay where they are.
    np.testing.assert_allclose(box.W @ x / box.mass, 0.0, atol=ROUNDING * np.abs(a).max())


def test_rounding_of_unknowns_that_vanish_does_not_decide():
    # Two contacts and three sliders, which may all let go; next, two supports part.
    mass = [np.inf, np.inf, 1.2692442401767902, 1.5612784402796849, 1.7015906954878348]
    bound = np.array([np.inf, np.inf, 0.29824614543211375, 4.986009876809242, 0.4319888918413696])
    ends = np.array([[0, 3, 3, -1, 3], [2, 2, 1, 4, 4]])
    box = _box(mass, ends, np.zeros((2, 5)), bound)
    a = np.zeros((2, 5))
    a[0, 2:] = (box.W @ box.start)[2:] / box.mass[2:]
    a[1, :2] = -1.5, -1.5
    x, found = box._replace(a=a).least()
    assert found
    np.testing.assert_allclose((box.W @ x)[2:], 0.0, rtol=0.0, atol=1e-14)
    # What the first slider is pulled by tells of its slip.
    assert x[2] == bound[2]
