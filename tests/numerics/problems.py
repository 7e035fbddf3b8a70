"""Random complementarity problems of impact and rest, and what a solution must satisfy."""

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.contact_problem import Joints
from eventpound.numerics.arrays import Floats, Ints

EPS = float(np.finfo(np.float64).eps)
ROUNDING = 1024.0 * EPS
"""The solvers stop where no entry of w lies below 512 roundings of the terms it is
summed from; as much again is left for the sums of the test."""


NO_POINTS = np.zeros((0, 0))
"""Weights, and compliance, of a scene without points."""


def joints(left: Ints, right: Ints, mass: Floats) -> Joints:
    """Contacts between masses that do not follow each other."""
    return Joints(left, right, 1.0 / mass, NO_POINTS)


@dataclass(frozen=True)
class Contacts:
    """k contacts between N masses; -1 is a barrier."""

    left: Ints
    right: Ints
    mass: Floats

    @property
    def joints(self) -> Joints:
        """The same, for the contact problem."""
        return joints(self.left, self.right, self.mass)

    @property
    def W(self) -> Floats:
        """Gradients of the gaps, shape (N, k)."""
        W = np.zeros((self.mass.size + 1, self.left.size))
        for j, (a, b) in enumerate(zip(self.left, self.right, strict=True)):
            W[a, j] -= 1.0
            W[b, j] += 1.0
        return W[:-1]

    @property
    def factor(self) -> Floats:
        """``A = M^(-1/2) W``, so that ``G = Aᵀ A``."""
        return self.W / np.sqrt(self.mass)[:, None]

    @property
    def G(self) -> Floats:
        """Delassus matrix, summed entry by entry so that its zeros are exact."""
        W = self.W
        return np.ascontiguousarray(np.einsum("bi,b,bj->ij", W, 1.0 / self.mass, W))


def masses(rng: np.random.Generator, count: int, decades: float) -> Floats:
    """Masses spread evenly over the logarithm of +-`decades`."""
    return 10.0 ** rng.uniform(-decades, decades, count)


def row(rng: np.random.Generator, bodies: int, decades: float, barriers: str) -> Contacts:
    """Contacts of neighbours from left to right; barriers: "none", "left", "right", "both"."""
    left, right = list(range(bodies - 1)), list(range(1, bodies))
    if barriers in ("left", "both"):
        left, right = [-1, *left], [0, *right]
    if barriers in ("right", "both"):
        left, right = [*left, bodies - 1], [*right, -1]
    return Contacts(
        np.array(left, np.int64), np.array(right, np.int64), masses(rng, bodies, decades)
    )


def graph(rng: np.random.Generator, decades: float) -> Contacts:
    """Contacts between any two bodies or a body and a barrier, repeated ones among them."""
    bodies = int(rng.integers(1, 7))
    pairs = []
    while len(pairs) < rng.integers(1, 11):
        a, b = rng.integers(-1, bodies, 2)
        if a != b:
            pairs.append((a, b))
    left, right = np.array(pairs, np.int64).T
    return Contacts(left.copy(), right.copy(), masses(rng, bodies, decades))


def rounding(G: Floats, x: Floats, q: Floats) -> Floats:
    """Rounding level of each entry of ``G x + q``, measured on a unit diagonal."""
    root = np.sqrt(np.diag(G))
    terms = (np.abs(G) @ np.abs(x) + np.abs(q)) / root
    return np.asarray(ROUNDING * terms.max(initial=0.0) * root)


def violation(G: Floats, q: Floats, x: Floats) -> float:
    """How far x is from solving, in units of `rounding`: at most 1 for a solution."""
    w, level = G @ x + q, rounding(G, x, q)
    level = np.where(level > 0.0, level, 1.0)
    active = np.where(x > 0.0, np.abs(w), np.maximum(-w, 0.0))
    return float(np.max(active / level, initial=0.0)) if (x >= 0.0).all() else np.inf


def assert_solved(G: Floats, q: Floats, x: Floats, w: Floats, solved: bool) -> None:
    """The conditions of optimality hold."""
    assert solved
    assert violation(G, q, x) <= 1.0
    assert (w >= 0.0).all()
    assert not (x * w).any()
    assert (np.abs(G @ x + q - w) <= rounding(G, x, q)).all()
