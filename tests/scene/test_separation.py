"""Gaps that avoid contact, and codes' distances: against SciPy, bisection and closed forms."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from eventpound import Cosine, Response, simulate, simulate_many
from eventpound.quantities.lookup import names_of
from eventpound.scene import BARRIER, GROUND, Body, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.separation import correlation_of, is_between_structures

END, PULSE, RESTITUTION, WALL = 3.0, Cosine(4.0, 0.6), 0.6, 0.02
MASS, STIFFNESS, DRAG = np.array([1.0, 2.0]), np.array([40.0, 150.0]), np.array([0.5, 1.2])
NAMES = ("a", "b")


def row(joint: float = 0.03, wall: float = WALL) -> Scene:
    """Two oscillators side by side, and a wall to the right of the second."""
    return Scene(
        bodies=tuple(Body(n, m) for n, m in zip(NAMES, MASS.tolist(), strict=True)),
        springs=tuple(
            Spring(f"frame {n}", (GROUND, n), Linear(k))
            for n, k in zip(NAMES, STIFFNESS.tolist(), strict=True)
        ),
        dashpots=tuple(Dashpot((GROUND, n), c) for n, c in zip(NAMES, DRAG.tolist(), strict=True)),
        contacts=(
            Contact("joint", "a", "b", joint, 0.4),
            Contact("wall", "b", BARRIER, wall, RESTITUTION),
        ),
        motion=PULSE,
    )


def approach(wall: float) -> float:
    """Largest u_a - u_b where a and b never meet, b striking the wall: SciPy's integrator."""

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        ground = PULSE.amplitude * math.cos(2.0 * math.pi * t / PULSE.period) * (t < PULSE.period)
        u, v = y[:2], y[2:]
        return np.concatenate((v, -ground - (STIFFNESS * u + DRAG * v) / MASS))

    def closes(_: float, y: np.ndarray) -> float:
        return wall - float(y[1])

    closes.terminal, closes.direction = True, -1.0
    y, largest = np.zeros(4), 0.0
    for begin, end in pairwise((0.0, PULSE.period, END)):
        t = begin
        while t < end:
            # The pulse ends with a jump: up to there it is that of its inside.
            last = end - 1e-12 if begin == 0.0 else end
            part = solve_ivp(
                rate,
                (t, last),
                y,
                "DOP853",
                events=closes,
                rtol=1e-12,
                atol=1e-14,
                dense_output=True,
            )
            seen = part.sol(np.arange(t, part.t[-1], 2e-5))
            largest = max(largest, float((seen[0] - seen[1]).max()))
            y, t = part.y[:, -1].copy(), float(part.t[-1])
            if part.status == 1:
                y[1], y[3] = wall, -RESTITUTION * y[3]
            else:
                break
    return largest


def gap(response: Response, name: str) -> float:
    value = response.quantity(f"contacts.joint.{name}")
    assert value is not None
    return value


def test_a_gap_that_avoids_this_contact_is_that_of_scipy():
    response = simulate(row(), rtol=1e-11, duration=END)
    # A maximum between rows 2e-5 s apart is missed by less than a h^2/8 of 50 m/s^2.
    assert gap(response, "avoiding_gap_alone") == pytest.approx(approach(WALL), abs=3e-9)
    assert gap(response, "avoiding_gap") == pytest.approx(approach(math.inf), abs=3e-9)
    # The wall changes the motion by far more than either is off.
    assert abs(gap(response, "avoiding_gap_alone") - gap(response, "avoiding_gap")) > 0.01


@pytest.mark.parametrize("wall", [0.01, 0.03])
def test_a_gap_that_avoids_this_contact_is_that_of_a_bisection(wall):
    low, high = 0.0, 1.0
    while high - low > 1e-8:
        tried = np.linspace(low, high, 34)[1:-1]
        many = simulate_many(row(wall=wall), {"contact.joint.gap": tried}, rtol=1e-11, duration=END)
        touching = many.impacts[:, 0] > 0
        # Every gap below the least one is struck, none above.
        count = np.count_nonzero(touching)
        assert touching[:count].all()
        low, high = [low, *tried][count], [*tried, high][count]
    found = gap(simulate(row(wall=wall), "fast", 1e-11, duration=END), "avoiding_gap_alone")
    assert low - 1e-9 <= found <= high + 1e-9


def test_of_many_each_row_has_the_gap_of_its_own_scene():
    walls, joints = np.array([0.01, 0.01, 0.04]), np.array([0.01, 0.02, 0.02])
    names = [f"contacts.joint.{n}" for n in ("avoiding_gap", "avoiding_gap_alone", "cqc", "srss")]
    many = simulate_many(
        row(),
        {"contact.wall.gap": walls, "contact.joint.gap": joints, "body.a.mass": [1.0, 1.0, 1.5]},
        rtol=1e-9,
        duration=END,
        quantities=names,
    )
    # What the joint does is no matter where it cannot close.
    assert many.table[names[1]][0] == many.table[names[1]][1]
    for i in range(3):
        scene = row(joints[i], walls[i])
        heavy = replace(scene.bodies[0], mass=[1.0, 1.0, 1.5][i])
        one = simulate(replace(scene, bodies=(heavy, scene.bodies[1])), "fast", 1e-9, duration=END)
        for name in names:
            assert many.table[name][i] == pytest.approx(one.quantity(name), rel=1e-12)


def test_with_one_contact_both_meanings_are_one():
    scene = replace(row(), contacts=row().contacts[:1])
    response = simulate(scene, "fast", duration=END)
    assert gap(response, "avoiding_gap_alone") == gap(response, "avoiding_gap")


def test_corners_of_one_joint_open_together():
    joint, wall = row().contacts
    corners = replace(joint, name="other", gap=0.5 * joint.gap)
    found = [
        gap(simulate(replace(row(), contacts=contacts), "fast", duration=END), "avoiding_gap_alone")
        for contacts in ((joint, wall), (joint, corners, wall))
    ]
    assert found[0] == found[1] > joint.gap


def test_codes_combine_the_peaks_without_contact():
    response = simulate(row(), rtol=1e-11, duration=END)
    a, b = (response.without_contact.peaks["abs_max"][name] for name in NAMES)
    period, ratio = (
        2.0 * np.pi * np.sqrt(MASS / STIFFNESS),
        DRAG / (2.0 * np.sqrt(MASS * STIFFNESS)),
    )
    rho = correlation_of(period[0], ratio[0], period[1], ratio[1])
    assert gap(response, "absolute_sum") == pytest.approx(a + b, rel=1e-12)
    assert gap(response, "srss") == pytest.approx(math.sqrt(a**2 + b**2), rel=1e-12)
    assert gap(response, "cqc") == pytest.approx(math.sqrt(a**2 + b**2 - 2 * rho * a * b), rel=1e-9)
    # No motion can need more than the sum.
    assert gap(response, "avoiding_gap") <= gap(response, "absolute_sum")


@pytest.mark.parametrize(
    ("t_1", "x_1", "t_2", "x_2"),
    [(1.0, 0.05, 0.8, 0.05), (0.5, 0.02, 0.7, 0.1), (1, 0.05, 1, 0.05)],
)
def test_the_correlation_is_that_under_white_noise(t_1, x_1, t_2, x_2):
    def transfer(w: float, t: float, x: float) -> complex:
        p = 2.0 * math.pi / t
        return 1.0 / (p * p - w * w + 2j * x * p * w)

    def power(first: tuple[float, float], second: tuple[float, float]) -> float:
        peaks = [2.0 * math.pi / t for t in (t_1, t_2)]

        def both(w: float) -> float:
            return (transfer(w, *first) * transfer(w, *second).conjugate()).real

        inner = quad(both, 0.0, 200.0, points=peaks, limit=500)[0]
        return float(inner + quad(both, 200.0, math.inf)[0])

    one, two = (t_1, x_1), (t_2, x_2)
    expected = power(one, two) / math.sqrt(power(one, one) * power(two, two))
    assert correlation_of(*one, *two) == pytest.approx(expected, rel=1e-7)


def test_undamped_structures_of_one_period_move_as_one():
    assert correlation_of(0.7, 0.0, 0.7, 0.0) == 1.0
    assert correlation_of(0.7, 0.0, 0.9, 0.0) == 0.0


def test_codes_say_nothing_of_a_wall_and_of_one_structure():
    assert "contacts.wall.srss" not in names_of(row())
    joined = replace(row(), springs=(*row().springs, Spring("tie", ("a", "b"), Linear(5.0))))
    assert not is_between_structures(joined, 0)
    assert "contacts.joint.srss" in names_of(joined)
    assert "contacts.joint.cqc" not in names_of(joined)


def test_seat_used_and_residual_are_of_the_motion():
    response = simulate(row(), rtol=1e-10, duration=END, output_step=1e-4)
    rows, found = response.history, response.summary
    opening = (rows["u.b"] - rows["u.a"]).max()
    # Between rows a motion of accelerations below 400 m/s^2 grows by less than 5e-7 m.
    assert opening <= found["contacts.joint.seat_used"] <= opening + 5e-7
    left = rows["u.b"].iloc[-1]
    assert found["springs.frame b.residual_elongation"] == pytest.approx(left, rel=1e-12)
    each = [found[f"contacts.{name}.impacts_faster"] for name in ("joint", "wall")]
    assert found["impacts_faster"] == sum(each) > 0
