"""What only close rows tell, against closed forms, SciPy, the ledger, and what solvers locate."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound import AccuracyWarning, Cosine, Record, simulate
from eventpound.quantities import between, rows
from eventpound.quantities.between import SETTLED
from eventpound.quantities.rows import AGREEMENT
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.contact_law import Element
from tests.solvers.scenes import pounding_pair, with_springs

RNG = np.random.default_rng(3)
SHAKEN = Record(RNG.normal(0.0, 2.0, 150), 0.02)


@pytest.fixture(scope="module", params=["pulse", "record"])
def pounding(request):
    scene = pounding_pair()
    if request.param == "record":
        scene = replace(scene, motion=SHAKEN)
    return simulate(scene, rtol=1e-10, duration=5.0, energy=True)


def test_work_is_that_of_the_ledger(pounding):
    ledger = pounding.energy
    stored = 0.5 * np.array([4.0 * 0.03, 6.0 * 0.02]) @ (pounding.recording.z**2 - [0.0, 0.1**2])
    frames = [pounding.quantity(f"springs.frame {x}.dissipated_energy") or 0.0 for x in "ab"]
    assert sum(frames) + stored == pytest.approx(ledger.hysteretic, rel=AGREEMENT)
    names = ("ground-a", "a-b")
    viscous = [pounding.quantity(f"dashpots.{name}.dissipated_energy") or 0.0 for name in names]
    assert sum(viscous) == pytest.approx(ledger.viscous, rel=AGREEMENT)


def test_shear_of_all_is_the_located_one(pounding):
    # A cable of no stiffness makes one structure of both decks, which is the whole scene.
    found = pounding._motion_between.extremes("structures.a.*_base_shear")
    located = pounding.recording.base_shear
    scale = float(np.max(np.abs([located.maximum, located.minimum])))
    assert found.maximum[0] == pytest.approx(located.maximum[0], abs=2.0 * SETTLED * scale)
    assert found.minimum[0] == pytest.approx(located.minimum[0], abs=2.0 * SETTLED * scale)
    # The time of a smooth extreme is known to the root of its value.
    assert found.time_of_maximum[0] == pytest.approx(located.time_of_maximum[0], abs=1e-4)


def struck_pair() -> tuple[Scene, dict[str, float]]:
    """Two oscillators that strike each other, and extremes by SciPy alone."""
    m, k, c, gap, restitution = (2.0, 3.0), (50.0, 200.0), (0.4, 0.9), 0.05, 0.6
    scene = Scene(
        (Body("a", m[0], -0.3), Body("b", m[1], 0.1)),
        tuple(Spring(x, (GROUND, x), Linear(k[i])) for i, x in enumerate("ab")),
        tuple(Dashpot((GROUND, x), c[i]) for i, x in enumerate("ab")),
        (Contact("joint", "a", "b", gap, restitution),),
    )

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[2:], (-np.array(k) * y[:2] - np.array(c) * y[2:]) / m])

    def watch(value, direction=0.0):
        value.terminal, value.direction = direction < 0.0, direction
        return value

    slopes = [
        watch(lambda t, y: y[3] - y[2]),
        watch(lambda t, y: rate(t, y)[2]),
        watch(lambda t, y: -k[1] * y[3] - c[1] * rate(t, y)[3]),
    ]
    closing = watch(lambda t, y: gap + y[1] - y[0], -1.0)
    t, y, seen, watched = 0.0, np.array([-0.3, 0.1, 0.0, 0.0]), [], [closing, *slopes]
    while t < 4.0:
        run = solve_ivp(rate, (t, 4.0), y, "DOP853", events=watched, rtol=1e-12, atol=1e-14)
        seen += [np.atleast_2d(run.y[:, 0]), *(np.reshape(e, (-1, 4)) for e in run.y_events)]
        t, y = run.t[-1], run.y[:, -1]
        if t < 4.0:
            impulse = (1.0 + restitution) * (y[2] - y[3]) / (1.0 / m[0] + 1.0 / m[1])
            y = y + np.array([0.0, 0.0, -impulse / m[0], impulse / m[1]])
            assert impulse > 0.0
    states = np.concatenate([*seen, y[None]])
    shear = -k[1] * states[:, 1] - c[1] * states[:, 3]
    return scene, {
        "contacts.joint.largest_gap": (gap + states[:, 1] - states[:, 0]).max(),
        "velocity.a.max": states[:, 2].max(),
        "velocity.a.min": states[:, 2].min(),
        "structures.b.max_base_shear": -shear.min(),
        "structures.b.min_base_shear": -shear.max(),
    }


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_openings_velocities_and_shears_against_scipy(solver):
    scene, expected = struck_pair()
    response = simulate(scene, solver, 1e-11, duration=4.0)
    assert response.impacts > 2
    for name, value in expected.items():
        assert response.quantity(name) == pytest.approx(value, rel=2.0 * SETTLED)


@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_openings_of_fixed_steps_are_the_largest_of_a_step(solver):
    scene, expected = struck_pair()
    if solver == "penalty":
        scene = with_springs(scene, Element.KELVIN_VOIGT, 1e5)
    step = {"time_step": 1e-3}
    response = simulate(scene, solver, settings=step, duration=4.0, output_step=1e-3)
    found = response.summary["contacts.joint.largest_gap"]
    assert found == pytest.approx(response.recording.history.gap.max(), rel=1e-12)
    assert found == pytest.approx(expected["contacts.joint.largest_gap"], rel=0.05)


def test_free_vibration_in_closed_form():
    # u = 0.1 cos(w t), w = 3 rad/s beside a body that swings back with 5 rad/s.
    scene = Scene(
        (Body("a", 2.0, 0.1), Body("b", 1.0, -0.2)),
        (Spring("a", (GROUND, "a"), Linear(2.0 * 9.0)), Spring("b", (GROUND, "b"), Linear(25.0))),
        contacts=(Contact("far", "a", "b", 1.0, 0.5),),
    )
    response = simulate(scene, rtol=1e-11, duration=4.0)
    assert response.quantity("velocity.a.abs_max") == pytest.approx(0.3, rel=2.0 * SETTLED)
    # One of the equal peaks, half a period apart.
    time = response.quantity("velocity.b.t_abs_max") or 0.0
    assert time % (np.pi / 5.0) == pytest.approx(np.pi / 10.0, abs=1e-4)
    t = np.linspace(0.0, 4.0, 4_000_001)
    gap = 1.0 - 0.2 * np.cos(5.0 * t) - 0.1 * np.cos(3.0 * t)
    found = response.quantity("contacts.far.largest_gap")
    # Samples a microsecond apart err by w^2 h^2 / 8.
    assert found == pytest.approx(gap.max(), abs=1e-9)
    assert response.quantity("springs.a.abs_max_force") == pytest.approx(1.8, rel=1e-9)


def test_shears_of_separate_structures_are_those_of_each_alone():
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
            # Shears of a hundred newtons, known to 1e-10 of the motion and to SETTLED.
            assert found == pytest.approx(value, abs=100.0 * 2.0 * SETTLED)


def test_hysteresis_against_scipy():
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
        assert response.quantity(f"springs.s.{word}_force") == pytest.approx(value, rel=2e-9)
    work, z = run.y[3, -1], run.y[2, -1]
    dissipated = work - 0.5 * q * u_y * z**2
    assert response.quantity("springs.s.dissipated_energy") == pytest.approx(dissipated, rel=1e-7)
    assert response.quantity("velocity.a.min") == pytest.approx(fine[1].min(), rel=2e-9)


def test_estimated_force_is_that_of_an_elastic_contact():
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


def test_the_motion_without_contact_is_a_run_of_its_own(pounding):
    scene = replace(pounding.scene, contacts=())
    apart = simulate(scene, rtol=1e-10, duration=5.0, energy=True)
    assert pounding.quantity("free.peaks.a.abs_max") == apart.peaks.loc["a", "abs_max"]
    gain = pounding.peaks.loc["b", "abs_max"] / apart.peaks.loc["b", "abs_max"]
    assert pounding.quantity("amplification.b") == pytest.approx(gain, rel=1e-15)


def test_a_warning_names_what_was_asked_and_what_helps(monkeypatch):
    monkeypatch.setattr(between, "_ROUNDS", 1)
    response = simulate(pounding_pair(), "fast", 1e-6, duration=0.5)
    said = r"^velocity.a.\*: known to some \d.\d\de-\d+ of its size, not to 1e-06; a smaller rtol "
    with pytest.warns(AccuracyWarning, match=said) as warned:
        response.quantity("velocity.a.max")
    assert [each.filename for each in warned] == [__file__]
    with pytest.warns(AccuracyWarning, match="some 1.40e-09 of its size, not to 1e-09"):
        rows.warn_unsettled("velocity.a.*", 1.4e-9, 1e-9)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows.warn_unsettled("velocity.a.*", 1.004e-9, 1e-9)
    assert response.quantity("contacts.joint.largest_gap")
    monkeypatch.setattr(rows, "MOST_ROWS", 1)
    response = simulate(pounding_pair(), "fast", 1e-6, duration=0.5)
    for name, called in (
        ("springs.frame a.max_force", r"springs.frame a.\*_force"),
        ("dashpots.a-b.dissipated_energy", "dashpots.a-b.dissipated_energy"),
    ):
        with pytest.warns(AccuracyWarning, match=f"^{called}: not checked: .* shorter duration"):
            response.quantity(name)
