"""What lies between rows, against closed forms, SciPy, the ledger, and what solvers locate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound import simulate
from eventpound.errors import AccuracyWarning
from eventpound.motion import Cosine, Record
from eventpound.quantities import between
from eventpound.quantities.between import AGREEMENT
from eventpound.response import Response
from eventpound.scene import (
    BARRIER,
    GROUND,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from tests.solvers.scenes import pounding_pair

# Rows are doubled until nothing changes by more; an error of order four is then a fifteenth.
SETTLED = AGREEMENT
RNG = np.random.default_rng(3)
SHAKEN = Record(RNG.normal(0.0, 2.0, 150), 0.02)


@pytest.fixture(scope="module", params=["pulse", "record"])
def pounding(request: pytest.FixtureRequest) -> Response:
    scene = pounding_pair()
    if request.param == "record":
        scene = replace(scene, motion=SHAKEN)
    return simulate(scene, rtol=1e-10, duration=5.0, energy=True)


def test_work_is_that_of_the_ledger(pounding: Response) -> None:
    between, ledger = pounding._between(), pounding.energy
    assert ledger is not None
    work = sum(between.work_on_z(int(s)) for s in between.model.hysteretic)
    assert work == pytest.approx(ledger.hysteretic, rel=SETTLED)
    viscous = sum(
        pounding.quantity(f"dashpots.{name}.dissipated_energy") or 0.0
        for name in ("ground-a", "a-b")
    )
    assert viscous == pytest.approx(ledger.viscous, rel=SETTLED)


def test_shear_of_all_is_the_located_one(pounding: Response) -> None:
    found, located = pounding._between().shear(np.arange(2)), pounding.recording.base_shear
    scale = float(np.max(np.abs([located.maximum, located.minimum])))
    assert found.maximum[0] == pytest.approx(located.maximum[0], abs=SETTLED * scale)
    assert found.minimum[0] == pytest.approx(located.minimum[0], abs=SETTLED * scale)
    # The time of a smooth extreme is known to the root of its value.
    assert found.time_of_maximum[0] == pytest.approx(located.time_of_maximum[0], abs=1e-3)


def test_gaps_are_the_located_ones(pounding: Response) -> None:
    for i, name in enumerate(("left", "joint", "right")):
        found = pounding._between().gap(i)
        assert found.minimum[0] == pytest.approx(pounding.recording.smallest_gap[i], abs=1e-9)
        assert pounding.quantity(f"contacts.{name}.largest_gap") == found.maximum[0]
    # Against a barrier the largest opening is where the body is farthest from it.
    peaks = pounding.recording.displacement
    largest = pounding.quantity("contacts.left.largest_gap")
    assert largest == pytest.approx(0.06 + peaks.maximum[0], abs=SETTLED)


def test_free_vibration_in_closed_form() -> None:
    # u = 0.1 cos(w t), w = 3 rad/s beside a body that swings back with 5 rad/s.
    scene = Scene(
        (Body("a", 2.0, 0.1), Body("b", 1.0, -0.2)),
        (
            Spring("a", (GROUND, "a"), Linear(2.0 * 9.0)),
            Spring("b", (GROUND, "b"), Linear(25.0)),
        ),
        contacts=(Contact("far", "a", "b", 1.0, 0.5),),
    )
    response = simulate(scene, rtol=1e-11, duration=4.0)
    assert response.quantity("velocity.a.abs_max") == pytest.approx(0.3, rel=SETTLED)
    # One of the equal peaks, half a period apart.
    time = response.quantity("velocity.b.t_abs_max") or 0.0
    assert time % (np.pi / 5.0) == pytest.approx(np.pi / 10.0, abs=1e-4)
    t = np.linspace(0.0, 4.0, 4_000_001)
    gap = 1.0 - 0.2 * np.cos(5.0 * t) - 0.1 * np.cos(3.0 * t)
    found = response.quantity("contacts.far.largest_gap")
    # Samples a microsecond apart err by w^2 h^2 / 8.
    assert found == pytest.approx(gap.max(), abs=1e-9)
    assert response.quantity("springs.a.abs_max_force") == pytest.approx(1.8, rel=1e-9)


def test_shears_of_separate_structures_are_those_of_each_alone() -> None:
    law = BoucWen.from_yield("4 kN/m", "80 N", 0.05)
    whole = Scene(
        (Body("a", 100.0), Body("b", 80.0), Body("c", 50.0)),
        (
            Spring("first", (GROUND, "a"), law),
            Spring("second", ("a", "b"), Linear(3000.0)),
            Spring("own", ("c", GROUND), law),
        ),
        (Dashpot.from_ratio((GROUND, "a"), "5 %", 4000.0, 100.0),),
        motion=Cosine(2.0, 1.1),
    )
    both = simulate(whole, rtol=1e-10)
    pair = replace(whole, bodies=whole.bodies[:2], springs=whole.springs[:2])
    alone = replace(whole, bodies=whole.bodies[2:], springs=whole.springs[2:], dashpots=())
    for name, scene in (("a", pair), ("c", alone)):
        one = simulate(scene, rtol=1e-10, duration=both.task.end).recording.base_shear
        for word, value in (("max", one.maximum[0]), ("min", one.minimum[0])):
            found = both.quantity(f"structures.{name}.{word}_base_shear")
            # Shears of a hundred newtons, known to 1e-10 of the motion and to AGREEMENT.
            assert found == pytest.approx(value, abs=100.0 * SETTLED)


def test_hysteresis_against_scipy() -> None:
    k, q, u_y, n = 20.0, 4.0, 0.03, 6.0
    scene = Scene((Body("a", 1.2, 0.0, 0.9),), (Spring("s", (GROUND, "a"), BoucWen(k, q, u_y, n)),))

    def rate(_: float, y: np.ndarray) -> list[float]:
        u, v, z, _work = y
        z_rate = (v - 0.5 * abs(v) * z * abs(z) ** (n - 1) - 0.5 * v * abs(z) ** n) / u_y
        return [v, -(k * u + q * z) / 1.2, z_rate, q * z * v]

    run = solve_ivp(rate, (0.0, 3.0), [0.0, 0.9, 0.0, 0.0], "DOP853", rtol=1e-11, atol=1e-13)
    # SciPy's own dense output, sampled: 3e5 samples err by h^2 F''/8, 1e-9 of F.
    fine = solve_ivp(
        rate,
        (0.0, 3.0),
        [0.0, 0.9, 0.0, 0.0],
        "DOP853",
        rtol=1e-11,
        atol=1e-13,
        t_eval=np.linspace(0.0, 3.0, 300_001),
    ).y
    response = simulate(scene, rtol=1e-11, duration=3.0)
    force = k * fine[0] + q * fine[2]
    for word, value in (("max", force.max()), ("min", force.min())):
        assert response.quantity(f"springs.s.{word}_force") == pytest.approx(value, rel=1e-7)
    work, z = run.y[3, -1], run.y[2, -1]
    dissipated = work - 0.5 * q * u_y * z**2
    assert response.quantity("springs.s.dissipated_energy") == pytest.approx(dissipated, rel=1e-7)
    assert response.quantity("velocity.a.min") == pytest.approx(fine[1].min(), rel=1e-7)


def test_estimated_force_is_that_of_an_elastic_contact() -> None:
    # A mass that meets a spring k with speed v compresses it with v sqrt(k m).
    scene = Scene((Body("a", 3.0, 0.0, 2.0),), contacts=(Contact("stop", "a", BARRIER, 0.5, 1.0),))
    response = simulate(scene, duration=0.6)
    response = replace(response, stated=replace(response.stated, contact_stiffness=7e5))
    assert response.quantity("contacts.stop.estimated_force") == pytest.approx(
        2.0 * np.sqrt(7e5 * 3.0), rel=1e-12
    )
    bodies = (Body("a", 3.0, 0.0, 2.0), Body("b", 1.5))
    contacts = (Contact("joint", "a", "b", 0.5, 1.0),)
    pair = simulate(replace(scene, bodies=bodies, contacts=contacts), duration=0.6)
    pair = replace(pair, stated=replace(pair.stated, contact_stiffness=7e5))
    assert pair.quantity("contacts.joint.estimated_force") == pytest.approx(
        2.0 * np.sqrt(7e5 * 1.0), rel=1e-12
    )


def test_the_motion_without_contact_is_a_run_of_its_own(pounding: Response) -> None:
    scene = replace(pounding.scene, contacts=())
    apart = simulate(scene, rtol=1e-10, duration=5.0, energy=True)
    assert pounding.quantity("free.peaks.a.abs_max") == apart.peaks.loc["a", "abs_max"]
    gain = pounding.peaks.loc["b", "abs_max"] / apart.peaks.loc["b", "abs_max"]
    assert pounding.quantity("amplification.b") == pytest.approx(gain, rel=1e-15)


def test_a_warning_names_what_has_not_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(between, "AGREEMENT", 0.0)
    response = simulate(pounding_pair(), "fast", 1e-6, duration=0.5)
    said = r"(velocity of [ab]|base shear|work in \w+).* to some \de-\d+ of their size.* rtol helps"
    with pytest.warns(AccuracyWarning, match=said):
        response.quantity("contacts.joint.largest_gap")
    monkeypatch.setattr(between, "MOST_ROWS", 1)
    response = simulate(pounding_pair(), "fast", 1e-6, duration=0.5)
    with pytest.warns(AccuracyWarning, match="could not be checked .*shorter duration"):
        response.quantity("contacts.joint.largest_gap")
