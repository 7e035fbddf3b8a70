"""Equations of motion of a mode against full matrices written anew."""

import numpy as np
import pytest

from eventpound.mechanics.model import assemble
from eventpound.mechanics.reduced import bandwidth, motion_rate, state_vector
from eventpound.motion.forcing import ground_acceleration
from eventpound.scene import GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from tests.mechanics.dense import rates
from tests.mechanics.scenes import (
    LEDGER,
    Instant,
    clusters_of,
    random_instant,
    reduced,
    sine_forcing,
)

# A dozen terms of order ten and a saddle-point matrix of condition below 1e4.
TOLERANCE = 1e-11


def _ground(at: Instant) -> float:
    return ground_acceleration(at.forcing, at.forcing.start)


@pytest.mark.parametrize("squeezed", [False, True])
def test_random_scenes(squeezed):
    rng = np.random.default_rng(21)
    for _ in range(60):
        at = random_instant(rng, squeezed=squeezed)
        expected = rates(at.scene, at.resting, _ground(at), at.u, at.v, at.z)
        rate = np.empty(at.system.size)
        motion_rate(0.0, at.y, rate, at.system, at.forcing)
        for body, c in enumerate(at.clusters.of_body):
            if c < 0:
                assert abs(expected.acceleration[body]) < TOLERANCE
                continue
            assert rate[at.system.iq[c]] == pytest.approx(at.v[body], abs=1e-15)
            assert rate[at.system.iv[c]] == pytest.approx(
                expected.acceleration[body], abs=TOLERANCE
            )
        for h, place in enumerate(at.system.z_of):
            if place >= 0:
                assert rate[place] == pytest.approx(expected.z_rate[h], abs=TOLERANCE)
            else:
                assert expected.z_rate[h] == 0.0
        np.testing.assert_allclose(
            rate[at.system.ledger :], expected.ledger, rtol=0.0, atol=TOLERANCE
        )


@pytest.mark.parametrize("squeezed", [False, True])
def test_state_vector_of_random_scenes(squeezed):
    rng = np.random.default_rng(22)
    for _ in range(60):
        at = random_instant(rng, squeezed=squeezed)
        works = rng.normal(size=LEDGER)
        y = state_vector(at.clusters, at.system, at.model.mass, at.u, at.v, at.z, works)
        # The bodies of a cluster agree, so that their mean is any of them.
        np.testing.assert_allclose(
            y[: at.system.ledger], at.y[: at.system.ledger], rtol=0.0, atol=1e-14
        )
        np.testing.assert_array_equal(y[at.system.ledger :], works)


def test_time_counts_from_the_start_of_the_segment():
    at = random_instant(np.random.default_rng(5))
    later = at.forcing._replace(start=at.forcing.start + 0.7)
    one, other = np.empty(at.system.size), np.empty(at.system.size)
    motion_rate(0.7, at.y, one, at.system, at.forcing)
    motion_rate(0.0, at.y, other, at.system, later)
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-14)


def test_only_what_the_scene_has():
    """An elastic body carries no z, a scene without ledger none, a rigid link nothing."""
    body = (Body("a", 1.0), Body("b", 2.0))
    elastic = assemble(Scene(body[:1], (Spring("s", (GROUND, "a"), Linear(1.0)),)))
    both = assemble(
        Scene(
            body,
            (Spring("s", ("a", "b"), BoucWen(1.0, 1.0, 1.0)),),
            (),
            (Contact("c", "a", "b", 0.0, 0.5),),
        )
    )

    def size(model: object, resting: list[int], ledger: bool) -> int:
        zeros = np.zeros(model.links)
        return reduced(model, clusters_of(model, resting), zeros, zeros, ledger=ledger).size

    assert size(elastic, [], False) == 2
    assert size(elastic, [], True) == 2 + LEDGER
    assert size(both, [], False) == 5
    assert size(both, [0], False) == 2


def test_jacobian_of_a_row_is_banded():
    # Neighbours joined by Bouc–Wen springs: q, v, z stand in blocks of three.
    names = [f"b{i}" for i in range(30)]
    scene = Scene(
        tuple(Body(n, 1.0) for n in names),
        tuple(Spring(f"s{i}", (names[i], names[i + 1]), BoucWen(1.0, 1.0, 1.0)) for i in range(29)),
    )
    model = assemble(scene)
    system = reduced(model, clusters_of(model, []), np.ones(29), np.zeros(29), ledger=False)
    rng = np.random.default_rng(6)
    y = rng.uniform(0.1, 0.5, system.size)
    forcing = sine_forcing(0.0)
    base, moved = np.empty(system.size), np.empty(system.size)
    motion_rate(0.0, y, base, system, forcing)
    reach = 0
    for i in range(system.size):
        shifted = y.copy()
        shifted[i] += 1e-6
        motion_rate(0.0, shifted, moved, system, forcing)
        changed = np.flatnonzero(moved != base)
        reach = max(reach, int(np.abs(changed - i).max(initial=0)))
    assert reach <= bandwidth(system) <= 5
