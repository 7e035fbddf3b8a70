"""Short series of several bodies under a record: ends, bounds, and the roots that end them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound.mechanics.link_law import BETA, GAMMA
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import only_root
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.solvers.fast.expansion import LOCAL_SHARE, defect_error
from eventpound.solvers.fast.links import DOWN, UP
from eventpound.solvers.fast.sampled.bounds import pair_goes_one_way
from eventpound.solvers.fast.sampled.forces import accelerations
from eventpound.solvers.fast.sampled.series import propose_by_series
from tests.solvers.stepping import Stepper, stepper_of

pytestmark = pytest.mark.usefixtures("interpreted")

GROUND_NOW, SLOPE = 0.4, -6.0
"""Ground acceleration at the start of the step (m/s²) and its slope (m/s³)."""
YIELDING = (0.1, 0.2)
"""Yield displacements of the two frames (m)."""


def scene(u: float, v: float) -> Scene:
    """Two frames that yield, joined by a cable; they start on their way up the curve."""
    springs = (
        Spring("left", (GROUND, "a"), BoucWen(4.0, 1.2, YIELDING[0], 20.0)),
        Spring("right", (GROUND, "b"), BoucWen(3.0, 1.5, YIELDING[1], 20.0, 0.7, 0.3)),
        Spring("cable", ("a", "b"), Linear(0.8)),
    )
    dashpots = (Dashpot((GROUND, "a"), 0.3), Dashpot(("a", "b"), 0.15))
    contacts = (Contact("joint", "a", "b", 5.0, 0.7), Contact("end", "b", BARRIER, 5.0, 0.5))
    bodies = (Body("a", 1.0, u, v), Body("b", 2.2, 0.01, 0.05))
    motion = Record(np.sin(np.linspace(0.0, 9.0, 101)), 0.02)
    return Scene(bodies, springs, dashpots, contacts, motion)


def stepper(u: float, v: float, z: float, rtol: float = 1e-10) -> Stepper:
    """At rest in no contact, the first frame at z, about to step."""
    at = stepper_of(scene(u, v), np.array([z, 0.02]), rtol)
    bodies = at.series.tables.bodies
    bodies.pulled[:] = bodies.acceleration - GROUND_NOW
    return at


def integrated(at: Stepper, z: float, h: float) -> Floats:
    """u, v and z of the scene after h (s) by DOP853, the hysteresis in rate form."""
    mass = at.model.mass
    beta, gamma = at.model.law.memory[at.model.hysteretic][:, [BETA, GAMMA]].T

    def rates(t: float, y: Floats) -> Floats:
        u, v, zs = y[:2], y[2:4], y[4:]
        x, rate = np.array([u[0], u[1], u[1] - u[0]]), np.array([v[0], v[1], v[1] - v[0]])
        forces = np.array([4.0, 3.0, 0.8]) * x
        forces[:2] += np.array([1.2, 1.5]) * zs
        damped = np.array([0.3 * v[0], 0.0, 0.15 * rate[2]])
        total = forces + damped
        pull = np.array([-total[0] + total[2], -total[1] - total[2]])
        a = pull / mass - GROUND_NOW - SLOPE * t
        size = np.abs(zs) ** 20
        flow = 1.0 - size * (beta + gamma * np.sign(rate[:2] * zs))
        return np.concatenate([v, a, rate[:2] * flow / YIELDING])

    first = np.concatenate([at.state.u, at.state.v, [z, 0.02]])
    found = solve_ivp(rates, (0.0, h), first, method="DOP853", rtol=3e-14, atol=1e-16)
    last: Floats = found.y[:, -1]
    return last


@pytest.mark.parametrize("z", [0.0, 0.6, 0.9])
@pytest.mark.parametrize("h", [0.002, 0.02])
def test_a_step_is_that_of_the_equations_of_motion(z: float, h: float) -> None:
    at = stepper(0.05, 0.3, z)
    assert (at.state.part[0] == UP) == (z > 0.5)
    order, length = propose_by_series(2, at.table, h, SLOPE, at.run)
    assert 8 <= order <= at.plan.limits.order
    other = integrated(at, z, length)
    bodies, limits = at.series.tables.bodies, at.plan.limits
    of_u = LOCAL_SHARE * (limits.atol_u + limits.rtol * np.abs(at.state.u))
    of_v = LOCAL_SHARE * (limits.atol_v + limits.rtol * np.abs(at.state.v))
    assert np.all(np.abs(bodies.next_u - other[:2]) <= of_u)
    assert np.all(np.abs(bodies.next_v - other[2:4]) <= of_v)
    along, ends = at.series.tables.along, at.model.link_ends
    for a, (first, second) in enumerate(ends):
        for row, u in ((along.next_x, bodies.next_u), (along.next_x_rate, bodies.next_v)):
            row[a] = (u[second] if second >= 0 else 0.0) - (u[first] if first >= 0 else 0.0)
    where = along.next_x, bodies.next_u, bodies.next_v
    accelerations(2, at.table, *where, bodies.next_acceleration, at.run)
    curved = at.state.part >= DOWN
    np.testing.assert_allclose(at.series.z[curved, 0], other[4:][curved], rtol=0.0, atol=1e-9)
    g = GROUND_NOW + SLOPE * length
    assert defect_error(length, order, g, bodies.next_acceleration, at.series) <= 1.0


def test_a_step_that_the_series_cannot_reach_is_shortened() -> None:
    """At the knee |z|^20 leaves a radius of some u_y/20, a fifth of what is asked for."""
    at = stepper(0.05, 0.5, 0.95)
    order, length = propose_by_series(2, at.table, 0.05, SLOPE, at.run)
    assert order == at.plan.limits.order
    assert 0.05 * 0.05 < length < 0.05
    other = integrated(at, 0.95, length)
    np.testing.assert_allclose(at.series.tables.bodies.next_u, other[:2], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("seed", range(20))
def test_bounds_hold_at_every_instant_of_a_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = stepper(rng.uniform(-0.1, 0.1), rng.uniform(-0.02, 0.02), rng.uniform(-0.95, 0.95))
    order, h = propose_by_series(2, at.table, 0.04, SLOPE, at.run)
    assert order > 0
    tau = np.linspace(0.0, h, 401)[:, None]
    k = np.arange(2, order + 1)
    bodies, X = at.series.tables.bodies, at.series.X
    rates = []
    for b in range(2):
        x = X[b, 2 : order + 1]
        relative = (k * (k - 1) * x * tau ** (k - 2)).sum(1)
        bend = ((k - 3) * (k - 2) * (k - 1) * k * x * tau ** np.maximum(k - 4, 0))[:, 2:].sum(1)
        line = np.interp(tau[:, 0], [0.0, h], [at.state.u[b], bodies.next_u[b]])
        u = at.state.u[b] + at.state.v[b] * tau[:, 0] + (x * tau**k).sum(1)
        rates.append(at.state.v[b] + (k * x * tau ** (k - 1)).sum(1))
        more = 1.0 + 1e-12
        assert np.abs(relative).max() <= bodies.fastest[b] * more
        assert np.abs(u - line).max() <= bodies.sag[b] * more + 1e-17
        assert np.abs(bend).max() * h * h / 8.0 <= bodies.bend[b] * more
    for first, second in ((-1, 0), (-1, 1), (0, 1)):
        rate = rates[second] - (rates[first] if first >= 0 else 0.0)
        one_way = pair_goes_one_way(h, first, second, rate[0], rate[-1], at.plan, at.series.tables)
        assert not one_way or (rate > 0.0).all() or (rate < 0.0).all()


@pytest.mark.parametrize("seed", range(30))
def test_the_root_of_a_falling_polynomial(seed: int) -> None:
    """Made from its root: ``(r - x) (1 + q(x))`` with q above zero."""
    rng = np.random.default_rng(seed)
    root = rng.uniform(0.01, 0.99)
    others = np.concatenate([[1.0], rng.uniform(0.0, 1.0, 9) / np.arange(1.0, 10.0) ** 2])
    c = np.convolve(others, [root, -1.0])
    found = only_root(c, c.size, 1.0)
    # The value is known to rounding of the terms, the root to that over the slope.
    slope = np.polyval(others[::-1], root)
    assert abs(found - root) <= 4e-16 * np.abs(c * root ** np.arange(c.size)).sum() / slope
