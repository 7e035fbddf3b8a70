"""A single body that swings freely: closed forms of its turns, rows and borders."""

from itertools import pairwise

import numpy as np
import pytest

from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task

OMEGA, MASS, REACH = 3.0, 1.7, 0.2
END = 40.0


def solved(*contacts: Contact, law=None, rows: int = 2, body: Body | None = None) -> Recording:
    spring = Spring("s", (GROUND, "a"), law or Linear(MASS * OMEGA**2))
    scene = Scene((body or Body("a", MASS, -REACH),), (spring,), (), contacts)
    times = np.linspace(0.0, END, rows)
    return solver_named("fast").solve(Task(scene, 0.0, END, 1e-6, output_times=times))


def test_from_turn_to_turn_to_rounding():
    found = solved(Contact("r", "a", BARRIER, 1.1 * REACH, 0.5), rows=997)
    # One step from turn to turn, whatever the tolerance: rounding is all that adds up.
    assert found.work.steps == np.ceil(OMEGA * END / np.pi)
    wanted = -REACH * np.cos(OMEGA * found.history.t)
    np.testing.assert_allclose(found.history.u[:, 0], wanted, rtol=0.0, atol=1e-13)
    assert found.displacement.maximum[0] == pytest.approx(REACH, rel=1e-15)
    assert found.displacement.minimum[0] == pytest.approx(-REACH, rel=1e-15)
    assert found.displacement.time_of_maximum[0] == pytest.approx(np.pi / OMEGA, rel=1e-15)
    assert found.smallest_gap[0] == pytest.approx(0.1 * REACH, rel=1e-14)
    # Cut where the run ends, in the midst of a swing.
    assert found.v[0] == pytest.approx(REACH * OMEGA * np.sin(OMEGA * END), rel=1e-11)


def test_a_barrier_within_reach_is_met():
    gap, eps = 0.9 * REACH, 0.6
    found = solved(Contact("r", "a", BARRIER, gap, eps))
    # u = -R cos ω t comes up to the gap.
    t = np.arccos(-gap / REACH) / OMEGA
    speed = OMEGA * np.sqrt(REACH**2 - gap**2)
    assert found.events[0].t == pytest.approx(t, rel=1e-6)
    assert found.events[0].gap_velocity_before == pytest.approx(-speed, rel=1e-5)
    # It comes back as u = g cos ω τ - ε (v/ω) sin ω τ, which reaches further than the gap.
    again = (2.0 * np.pi - 2.0 * np.arctan2(eps * speed / OMEGA, gap)) / OMEGA
    assert found.events[1].t - t == pytest.approx(again, rel=1e-6)


@pytest.mark.parametrize(("size", "yields"), [(0.3, False), (3.0, True)])
def test_a_yielding_spring_swings_freely_only_where_it_is_straight(size, yields):
    u_y = 0.1
    law = BoucWen(4.0, 1.5, u_y, 20.0, initial_z=min(size, 0.9))
    found = solved(law=law, body=Body("a", 1.0, size * u_y))
    assert bool(found.displacement.minimum[0] > -size * u_y * (1.0 - 1e-3)) is yields
    omega = np.sqrt(4.0 + 1.5 / u_y)
    if not yields:
        assert found.u[0] == pytest.approx(size * u_y * np.cos(omega * END), abs=1e-6 * u_y)
        assert found.work.steps == pytest.approx(omega * END / np.pi, abs=1.0)


def test_small_bounces_keep_their_relative_accuracy():
    # A spring that is short by d presses the body onto the barrier; it bounces ever lower,
    # and a flight at the speed v takes 2 atan(v / (ω d)) / ω.
    eps, d, gap = 0.5, 0.3, 0.2
    law = BilinearElastic(MASS * OMEGA**2, MASS * OMEGA**2, gap + d)
    contact = Contact("right", "a", BARRIER, gap, eps)
    found = solved(contact, law=law, body=Body("a", MASS, 0.0))
    impacts = [e for e in found.events if e.kind.value == "impact"]
    assert len(impacts) > 20
    for one, other in pairwise(impacts[:20]):
        flight = 2.0 * np.arctan(one.gap_velocity_after / (OMEGA * d)) / OMEGA
        assert other.t - one.t == pytest.approx(flight, rel=1e-9, abs=1e-14)
        assert other.gap_velocity_before == pytest.approx(-one.gap_velocity_after, rel=1e-9)
