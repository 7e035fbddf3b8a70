"""Coordinates that follow others: motion, forces and impacts beside dense algebra of the bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import nnls

from eventpound.contact.impacts import put_as_one
from eventpound.mechanics.clusters import Clusters, ContactEnds, form_clusters
from eventpound.mechanics.contact_problem import Joints
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.impact import impact_law
from eventpound.mechanics.model import assemble
from eventpound.numerics.compiled import in_python
from eventpound.scene import Body, Contact, Scene
from tests.numerics.problems import NO_POINTS, joints

EPS = np.finfo(float).eps


class Drawn(NamedTuple):
    """Bodies and points, contacts that all are closed at the displacements `u` of the bodies."""

    mass: np.ndarray
    T: np.ndarray  # (coordinates, bodies)
    left: np.ndarray
    right: np.ndarray
    gap: np.ndarray
    resting: np.ndarray
    u: np.ndarray

    @property
    def weights(self) -> np.ndarray:
        """Of the points, as a model has them."""
        bodies = self.T.shape[1]
        return np.hstack((self.T[bodies:], np.zeros((self.T.shape[0] - bodies,) * 2)))

    @property
    def W(self) -> np.ndarray:
        """Directions of all gaps in the bodies, (K, bodies)."""
        T = np.vstack((self.T, np.zeros(self.T.shape[1])))
        return np.asarray(T[self.right] - T[self.left])

    def clusters(self, resting: np.ndarray) -> Clusters:
        """Those with these contacts at rest."""
        ends = self.left, self.right, self.gap
        between = ContactEnds(*ends, self.mass, self.weights, self.gap.size)
        return form_clusters(between, resting, resting)


def drawn(seed: int, decades: float) -> Drawn:
    """Three to six bodies, one to three points on two of them or on one and the ground."""
    rng = np.random.default_rng([seed, 4])
    bodies, points = int(rng.integers(3, 7)), int(rng.integers(1, 4))
    mass = np.append(10.0 ** rng.uniform(-decades, decades, bodies), np.zeros(points))
    T = np.vstack((np.eye(bodies), np.zeros((points, bodies))))
    left, right = np.empty((2, points + 3), np.int64)
    for d in range(points):
        below, above, other = rng.permutation(bodies)[:3]
        w = rng.uniform(0.05, 0.95)
        T[bodies + d, above] = w
        T[bodies + d, below] = 0.0 if rng.random() < 0.3 else 1.0 - w
        left[d], right[d] = rng.permutation([bodies + d, other])
    for j in range(points, points + 3):
        ends = rng.permutation(bodies)[:2]
        left[j], right[j] = ends if rng.random() < 0.7 else (ends[0], -1)
    u = rng.normal(size=bodies)
    place = np.append(T @ u, 0.0)
    gap = place[left] - place[right]
    return Drawn(mass, T, left, right, gap, rng.random(points + 3) < 0.6, u)


def independent(rows: np.ndarray) -> list[int]:
    """Rows that make up all others, the first ones first."""
    chosen: list[int] = []
    for j in range(rows.shape[0]):
        if np.linalg.matrix_rank(rows[[*chosen, j]], tol=1e-9) > len(chosen):
            chosen.append(j)
    return chosen


@pytest.mark.parametrize("decades", [0.0, 3.0])
@pytest.mark.parametrize("seed", range(40))
def test_motion_and_forces_are_those_of_the_constraints(seed: int, decades: float) -> None:
    """Of all accelerations that keep the gaps, those nearest to the free ones by mass (Gauss)."""
    scene = drawn(seed, decades)
    clusters, bodies = scene.clusters(scene.resting), scene.T.shape[1]
    rows, mass = scene.W[scene.resting], scene.mass[:bodies]
    carrying = np.flatnonzero(~clusters.redundant)
    np.testing.assert_array_equal(carrying, independent(rows))
    held, moving = rows[carrying], clusters.of_body >= 0
    group = np.zeros((clusters.count, scene.mass.size))
    group[clusters.of_body[moving], np.flatnonzero(moving)] = 1.0
    rng = np.random.default_rng(seed)
    force = rng.normal(size=scene.mass.size)
    a = group.T @ clusters.compliance @ group @ force
    onto = scene.T.T @ force
    K = np.block([[np.diag(mass), -held.T], [held, np.zeros((len(held),) * 2)]])
    # The condition of that system, scaled by its diagonal, and no more parts them.
    scale = np.append(1.0 / np.sqrt(mass), np.sqrt(mass.min()) * np.ones(len(held)))
    right = np.append(onto, np.zeros(len(held)))
    best = scale * np.linalg.solve(K * scale[:, None] * scale, scale * right)
    size = np.abs(onto / mass).max()
    np.testing.assert_allclose(a[:bodies], best[:bodies], atol=1e-10 * size)
    np.testing.assert_allclose(a, scene.T @ a[:bodies], atol=1e-12 * size)
    np.testing.assert_allclose(held @ a[:bodies], 0.0, atol=1e-12 * size)
    # The ground takes along: without forces accelerations are -1 a_g less what the contacts do.
    lifted = -(group.T @ clusters.carried)[:bodies]
    pulled = np.linalg.lstsq(held.T, mass * (lifted + 1.0), rcond=None)[0] if len(held) else []
    np.testing.assert_allclose(mass * (lifted + 1.0), held.T @ pulled, atol=1e-10 * mass.max())
    np.testing.assert_allclose(held @ lifted, 0.0, atol=1e-12)
    # Forces that put given ones on the bodies.
    wanted = rng.normal(size=len(held))
    back = clusters.force_map[:, :bodies] @ held.T @ wanted
    np.testing.assert_allclose(back[carrying], wanted, atol=1e-11)
    np.testing.assert_array_equal(back[clusters.redundant], 0.0)


@pytest.mark.parametrize("seed", range(40))
def test_it_is_put_where_it_moves_the_least(seed: int) -> None:
    scene = drawn(seed, 1.0)
    clusters, bodies = scene.clusters(scene.resting), scene.T.shape[1]
    rng, mass = np.random.default_rng(seed), scene.mass[:bodies]
    rows, gap = scene.W[scene.resting], scene.gap[scene.resting]
    start = scene.u + 0.1 * rng.normal(size=bodies)
    for places, opening in ((True, gap), (False, np.zeros(gap.size))):
        x = scene.T @ start
        in_python(put_as_one)(clusters, places, scene.mass, x)
        np.testing.assert_allclose(rows @ x[:bodies] + opening, 0.0, atol=1e-13)
        np.testing.assert_allclose(x, scene.T @ x[:bodies], atol=1e-13)
        root = np.sqrt(mass)
        least = np.linalg.lstsq(rows / root, -(rows @ start + opening), rcond=1e-9)[0] / root
        np.testing.assert_allclose(x[:bodies] - start, least, atol=1e-12)


@pytest.mark.parametrize("seed", range(60))
def test_which_are_unique_and_which_are_locked(seed: int) -> None:
    """By the null space, and by least squares without negative unknowns (Lawson and Hanson)."""
    scene = drawn(seed, 0.0)
    clusters, rows = scene.clusters(scene.resting), scene.W[scene.resting]
    balance = np.eye(rows.shape[0]) - rows @ np.linalg.pinv(rows, rcond=1e-9)
    np.testing.assert_array_equal(clusters.unique, np.abs(np.diagonal(balance)) < 1e-9)
    for j in range(rows.shape[0]):
        others = np.delete(rows, j, axis=0)
        left = nnls(others.T, -rows[j])[1] if others.size > 0 else np.inf
        assert clusters.locked[j] == (left < 1e-9), (seed, j)


def test_a_light_body_follows_a_heavy_one() -> None:
    """A body of 1e9 at rest on two of 1: what it does is known to the last digits."""
    T = np.vstack((np.eye(3), [0.0, 1.0 / 6.0, 5.0 / 6.0]))
    scene = Drawn(
        np.array([1e9, 1.0, 1.0, 0.0]),
        *(T, np.array([0]), np.array([3]), np.zeros(1), np.ones(1, bool), np.zeros(3)),
    )
    clusters = scene.clusters(scene.resting)
    assert clusters.count == 3
    a = clusters.compliance[clusters.of_body][:, clusters.of_body[1]]
    # λ = -w f / (w² + v² + 1e-9) on the first of 1 under the force 1, exact to first order in 1e-9.
    w, v, m = 1.0 / 6.0, 5.0 / 6.0, 1e-9
    pull = -w / (w * w + v * v + m)
    assert a[0] == pytest.approx(-pull * m, rel=1e-13)
    np.testing.assert_allclose(a[1:3], [1.0 + w * pull, v * pull], rtol=1e-13)


@pytest.mark.parametrize("seed", range(30))
def test_an_impact_is_the_law_over_dense_rows(seed: int) -> None:
    """``M (v⁺ - v⁻) = W Λ`` with ``0 <= γ⁺ + ε γ⁻ ⊥ Λ >= 0``, whose solution is one."""
    scene = drawn(seed, 1.0)
    bodies, rng = scene.T.shape[1], np.random.default_rng(seed)
    mass, count = scene.mass[:bodies], scene.left.size
    none = np.zeros(count, bool)
    compliance = scene.clusters(none).compliance
    restitution, closed = rng.choice([0.0, 0.5, 1.0], count), rng.random(count) < 0.8
    before = rng.normal(size=bodies)
    v, rate = scene.T @ before, scene.W @ before
    if not (closed & (rate < 0.0)).any():
        closed[np.argmin(rate)] = True
    first, law = rate.copy(), in_python(impact_law)
    ends = Joints(scene.left, scene.right, np.ones(scene.mass.size), compliance)
    impulse, involved, lost, solved = law(ends, scene.mass, restitution, closed, rate, v)
    assert solved
    np.testing.assert_array_equal(involved, closed & (first <= 0.0))
    assert (impulse >= 0.0).all()
    assert not impulse[~involved].any()
    size = np.abs(v).max()
    np.testing.assert_allclose(v[:bodies], before + scene.W.T @ impulse / mass, atol=1e-12 * size)
    np.testing.assert_allclose(v, scene.T @ v[:bodies], atol=1e-12 * size)
    np.testing.assert_allclose(rate, scene.W @ v[:bodies], atol=1e-11 * size)
    after = (rate + restitution * first)[involved]
    assert (after >= -1e-12 * size).all()
    np.testing.assert_allclose(after * impulse[involved], 0.0, atol=1e-11 * impulse.max() * size)
    kinetic = [0.5 * mass @ w**2 for w in (before, v[:bodies])]
    assert lost == pytest.approx(kinetic[0] - kinetic[1], abs=1e-11 * kinetic[0])


def test_points_of_whole_bodies_are_the_bodies() -> None:
    """The law of pairs, whose matrix falls into parts."""
    rng = np.random.default_rng(5)
    left, right = np.array([-1, 0, 1, 2]), np.array([0, 1, 2, -1])
    for _ in range(30):
        mass, v = rng.uniform(0.2, 3.0, 3), rng.normal(size=3)
        T = np.vstack((np.eye(3), np.eye(3)))
        moved = np.append(np.arange(3, 6), -1)
        scene = Drawn(
            np.append(mass, np.zeros(3)),
            *(T, left, moved[right], np.zeros(4), np.zeros(4, bool), np.zeros(3)),
        )
        rate, restitution = scene.W @ v, rng.choice([0.0, 0.5, 1.0], 4)
        closed = rate < 0.0
        if not closed.any():
            continue
        rates, both = (rate.copy(), rate.copy()), (v.copy(), T @ v)
        ends = Joints(left, moved[right], np.ones(6), scene.clusters(np.zeros(4, bool)).compliance)
        law = in_python(impact_law)
        pairs = law(joints(left, right, mass), mass, restitution, closed, rates[0], both[0])
        points = law(ends, scene.mass, restitution, closed, rates[1], both[1])
        np.testing.assert_allclose(points[0], pairs[0], atol=1e-13)
        np.testing.assert_allclose(both[1], np.tile(both[0], 2), atol=1e-13)
    between, none = ContactEnds(left, right, np.zeros(4), mass, NO_POINTS, 4), np.zeros(4, bool)
    assert form_clusters(between, none, none).compliance.size == 0


def test_points_start_where_later_steps_place_them_to_the_last_bit() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        u = rng.normal(size=12)
        bodies = [Body(f"b{i}", 1.0, displacement=each) for i, each in enumerate(u)]
        parts = rng.random(11)
        at = {f"b{i}": float(each) for i, each in enumerate(parts / parts.sum())}
        model = assemble(Scene(bodies, contacts=[Contact("c", at, "b11", 100.0, 0.5)]))
        again = model.u0.copy()
        in_python(place_points)(model.weights, again)
        np.testing.assert_array_equal(model.u0, again)
