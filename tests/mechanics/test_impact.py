"""Newton's impact law: identities on random chains, closed forms on simple ones."""

from dataclasses import dataclass

import numpy as np
import pytest

from eventpound.mechanics.impact import impact_law, inverse_mass, newton, push_apart
from eventpound.numerics.compiled import by_python
from tests.numerics.problems import Contacts, graph, joints, row

EPS = np.finfo(float).eps


@dataclass(frozen=True)
class Impact:
    """An impact problem and what the law makes of it."""

    contacts: Contacts
    restitution: np.ndarray
    closed: np.ndarray
    before: np.ndarray
    v_before: np.ndarray
    after: np.ndarray
    v_after: np.ndarray
    impulse: np.ndarray
    involved: np.ndarray
    energy_lost: float

    @property
    def speed(self) -> float:
        """Largest speed of a body before or after."""
        return float(max(np.abs(self.v_before).max(), np.abs(self.v_after).max()))


def impact(
    contacts: Contacts, restitution: np.ndarray, closed: np.ndarray, v: np.ndarray
) -> Impact:
    """Apply the law to velocities v, gap rates as exact as they can be."""
    rate = np.asarray(contacts.W.T @ v)
    v_after, after = v.copy(), rate.copy()
    impulse, involved, lost, solved = impact_law(
        contacts.joints, contacts.mass, restitution, closed, after, v_after
    )
    assert solved
    return Impact(contacts, restitution, closed, rate, v, after, v_after, impulse, involved, lost)


def test_a_support_is_moved_by_nothing():
    """It is as a barrier that has a velocity, to which the bodies on its sides are nothing."""
    mass, left, right = np.array([np.inf, 2.0, 3.0]), np.array([1, 0]), np.array([0, 2])
    v, restitution = np.array([0.5, 2.0, -1.0]), np.array([0.6, 0.2])
    rate = np.array([v[0] - v[1], v[2] - v[0]])
    expected = -(1.0 + restitution) * rate * mass[1:]
    impulse, _, _, solved = impact_law(
        joints(left, right, mass), mass, restitution, rate <= 0.0, rate, v
    )
    assert solved
    np.testing.assert_allclose(impulse, expected, rtol=4.0 * EPS)
    np.testing.assert_allclose(v, [0.5, 0.5 - 0.6 * 1.5, 0.5 + 0.2 * 1.5], atol=8.0 * EPS)
    assert v[0] == 0.5


def _random_impacts(count: int) -> list[Impact]:
    """Rows with and without barriers and graphs, with resting and separating contacts."""
    rng = np.random.default_rng(91)
    found = []
    while len(found) < count:
        if rng.random() < 0.7:
            barriers = str(rng.choice(["none", "left", "right", "both"]))
            contacts = row(rng, int(rng.integers(2, 9)), 1.0, barriers)
        else:
            contacts = graph(rng, 1.0)
        # Few distinct speeds, so that neighbours often move alike: γ⁻ = 0.
        v = rng.choice(rng.normal(size=3), contacts.mass.size)
        closed = rng.random(contacts.left.size) < 0.8
        if not ((contacts.W.T @ v)[closed] < 0.0).any():
            continue
        restitution = rng.choice([0.0, 1.0, rng.random()], contacts.left.size)
        found.append(impact(contacts, restitution, closed, v))
    return found


@pytest.fixture(scope="module")
def impacts():
    with by_python():
        return _random_impacts(300)


def _noise(i: Impact) -> float:
    """Rounding of a gap rate: speeds of a condition of 100 masses, in 512 roundings."""
    return 2048.0 * EPS * i.speed * np.sqrt(i.contacts.mass.max() / i.contacts.mass.min())


def test_momentum_of_every_body(impacts):
    # M (v⁺ - v⁻) = W Λ to rounding, hence the whole momentum where no barrier is touched.
    for i in impacts:
        mass, W = i.contacts.mass, i.contacts.W
        momentum = mass * (i.v_after - i.v_before)
        size = mass * (np.abs(i.v_after) + np.abs(i.v_before)) + np.abs(W) @ i.impulse
        assert (np.abs(momentum - W @ i.impulse) <= 8 * EPS * size).all()
        touched = i.impulse > 0.0
        walls = (i.contacts.left < 0) | (i.contacts.right < 0)
        if not (touched & walls).any():
            # Each body rounds its own velocity once for each of its contacts.
            assert abs(momentum.sum()) <= 16 * EPS * size.sum()


def test_kinetic_energy_never_grows(impacts):
    for i in impacts:
        mass = i.contacts.mass
        before = 0.5 * mass @ i.v_before**2
        after = 0.5 * mass @ i.v_after**2
        slack = 32 * EPS * (before + after) + i.impulse.sum() * _noise(i)
        assert after <= before + slack
        assert i.energy_lost == pytest.approx(before - after, abs=slack)


def test_newtons_law_and_complementarity(impacts):
    for i in impacts:
        noise = _noise(i)
        np.testing.assert_array_equal(i.involved, i.closed & (i.before <= 0.0))
        assert (i.impulse >= 0.0).all()
        assert not i.impulse[~i.involved].any()
        excess = i.after + i.restitution * i.before
        assert (excess[i.involved] >= -noise).all()
        # γ⁺ = -ε γ⁻ where there is an impulse: the product Λ (γ⁺ + ε γ⁻) vanishes.
        pressed = i.impulse > 0.0
        assert (np.abs(excess[pressed]) <= 4 * EPS * np.abs(i.before[pressed])).all()
        # The gap rates are those of the bodies.
        assert (np.abs(i.after - i.contacts.W.T @ i.v_after) <= noise).all()


def test_involved_contacts_do_not_approach_any_more(impacts):
    for i in impacts:
        assert (i.after[i.involved] >= 0.0).all()


def _pair(m: tuple[float, float], eps: float, v: tuple[float, float]) -> Impact:
    contacts = Contacts(np.array([0]), np.array([1]), np.array(m))
    return impact(contacts, np.array([eps]), np.array([True]), np.array(v))


@pytest.mark.parametrize("eps", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("ratio", [1e-6, 0.01, 1.0, 7.0, 1e6])
def test_two_bodies(eps, ratio):
    m, v = (ratio, 1.0), (2.0, -0.5)
    hit = _pair(m, eps, v)
    reduced = m[0] * m[1] / sum(m)
    impulse = reduced * (1.0 + eps) * 2.5
    assert hit.impulse[0] == pytest.approx(impulse, rel=8 * EPS)
    assert hit.v_after == pytest.approx([2.0 - impulse / m[0], -0.5 + impulse / m[1]], abs=16 * EPS)
    assert hit.after[0] == pytest.approx(eps * 2.5, rel=4 * EPS)
    assert hit.energy_lost == pytest.approx(0.5 * reduced * (1.0 - eps**2) * 2.5**2, abs=8 * EPS)


@pytest.mark.parametrize("side", ["left", "right"])
def test_body_against_a_wall(side):
    ends = ([0], [-1]) if side == "right" else ([-1], [0])
    contacts = Contacts(np.array(ends[0]), np.array(ends[1]), np.array([3.0]))
    speed = 0.7 if side == "right" else -0.7
    hit = impact(contacts, np.array([0.6]), np.array([True]), np.array([speed]))
    assert hit.v_after[0] == pytest.approx(-0.6 * speed, rel=4 * EPS)
    assert hit.impulse[0] == pytest.approx(3.0 * 1.6 * 0.7, rel=4 * EPS)
    assert hit.energy_lost == pytest.approx(0.5 * 3.0 * 0.49 * (1.0 - 0.36), rel=8 * EPS)


def _row_at_rest(bodies: int, eps: float) -> Impact:
    """The first body hits a resting row of equals at speed 1."""
    left = np.arange(bodies - 1)
    contacts = Contacts(left, left + 1, np.ones(bodies))
    v = np.zeros(bodies)
    v[0] = 1.0
    return impact(contacts, np.full(bodies - 1, eps), np.ones(bodies - 1, bool), v)


@pytest.mark.parametrize("bodies", [2, 3, 5, 40])
def test_row_of_equal_bodies(bodies):
    # As one problem the resting bodies stay together (γ⁺ = -ε·0) and only the first
    # contact opens, at ε: v_1 = (1 - (N-1) ε)/N, the others (1 + ε)/N. This is Moreau's
    # answer; the cradle's, where the last leaves alone, needs one impact after the other.
    eps = 0.8
    hit = _row_at_rest(bodies, eps)
    expected = np.full(bodies, (1.0 + eps) / bodies)
    expected[0] = (1.0 - (bodies - 1) * eps) / bodies
    np.testing.assert_allclose(hit.v_after, expected, rtol=0.0, atol=bodies**2 * EPS)
    # Exactly at rest, not nearly: they are one mass from now on.
    assert not hit.after[1:].any()


def test_cradle_one_impact_after_the_other():
    # With ε = 1 and gaps between them, equal bodies exchange their velocities.
    left = np.arange(4)
    contacts = Contacts(left, left + 1, np.full(5, 2.0))
    v = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    for j in range(4):
        closed = np.arange(4) == j
        v = impact(contacts, np.ones(4), closed, v).v_after
    np.testing.assert_allclose(v, [0.0, 0.0, 0.0, 0.0, 1.0], atol=8 * EPS)


@pytest.mark.parametrize("eps", [0.0, 0.7, 1.0])
def test_symmetric_collision(eps):
    # Two equal bodies run into a third from both sides: it stays, they return at ε.
    contacts = Contacts(np.array([0, 1]), np.array([1, 2]), np.array([1.5, 0.3, 1.5]))
    hit = impact(contacts, np.full(2, eps), np.ones(2, bool), np.array([1.0, 0.0, -1.0]))
    np.testing.assert_allclose(hit.v_after, [-eps, 0.0, eps], atol=8 * EPS)
    assert hit.impulse[0] == pytest.approx(hit.impulse[1], rel=4 * EPS)


def test_resting_group_rebounds_from_a_barrier_as_a_whole():
    contacts = Contacts(np.array([0, 1]), np.array([1, -1]), np.array([2.0, 1.0]))
    hit = impact(contacts, np.array([0.1, 0.5]), np.ones(2, bool), np.array([1.0, 1.0]))
    # γ⁻ = 0 between the bodies, 1 against the barrier: both return at ε = 0.5.
    np.testing.assert_allclose(hit.v_after, [-0.5, -0.5], atol=4 * EPS)
    assert hit.after[0] == 0.0


def test_separating_contacts_take_no_part():
    contacts = Contacts(np.array([0, 1]), np.array([1, 2]), np.ones(3))
    hit = impact(contacts, np.ones(2), np.ones(2, bool), np.array([1.0, 0.0, 0.5]))
    np.testing.assert_array_equal(hit.involved, [True, False])
    np.testing.assert_allclose(hit.v_after, [0.0, 1.0, 0.5], atol=4 * EPS)
    # What the first impact did to the second contact is told: it approaches now.
    assert hit.after[1] == pytest.approx(-0.5, abs=4 * EPS)


def test_a_single_contact_needs_no_problem():
    # A chain of four bodies and two barriers, one contact closed: the scalar law and the problem.
    rng = np.random.default_rng(11)
    left, right = np.array([-1, 0, 1, 2, 3]), np.array([0, 1, 2, 3, -1])
    for _ in range(100):
        mass, v = rng.uniform(0.1, 5.0, 4), rng.normal(size=4)
        rate = np.append(v, 0.0)[right] - np.append(v, 0.0)[left]
        j = int(rng.choice(np.flatnonzero(rate < 0.0))) if (rate < 0.0).any() else -1
        if j < 0:
            continue
        restitution, closed = rng.uniform(size=5), np.arange(5) == j
        u, g = v.copy(), rate.copy()
        impulse, _, lost, solved = impact_law(
            joints(left, right, mass), mass, restitution, closed, g, u
        )
        assert solved
        inverse = inverse_mass(left[j], right[j], mass)
        after, *one = newton(rate[j], restitution[j], inverse)
        push_apart(j, one[0], mass, left, right, rate, v)
        assert after == pytest.approx(rate[j], rel=1e-12)
        np.testing.assert_allclose(one, (impulse[j], lost), rtol=1e-12)
        np.testing.assert_allclose(v, u, rtol=0.0, atol=1e-13 * np.abs(u).max())
        np.testing.assert_allclose(rate, g, rtol=0.0, atol=1e-13 * np.abs(g).max())


def test_no_play_leaves_no_speed_of_rounding():
    # A body between two barriers that it touches meets one and parts from the other: with
    # ε = 0 it stands still, at both of them, and not at a speed of 1e-17.
    left, right = np.array([-1, 0]), np.array([0, -1])
    rng = np.random.default_rng(3)
    for _ in range(50):
        mass, v = 10.0 ** rng.uniform(-3.0, 3.0, 1), rng.normal(size=1)
        rate = np.array([v[0], -v[0]])
        _, _, lost, solved = impact_law(
            joints(left, right, mass),
            mass,
            np.array([0.0, 0.0]),
            np.array([True, True]),
            rate,
            v.copy(),
        )
        assert solved
        np.testing.assert_array_equal(rate, 0.0)
        assert lost == pytest.approx(0.5 * mass[0] * v[0] ** 2, rel=1e-14)
