"""Bouc-Wen springs that degrade: beside SciPy, in closed form, in random scenes."""

import math
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import airy

from eventpound import InputError, MavroeidisPapageorgiou, NoMotion, Response, simulate
from eventpound.case import read_case
from eventpound.scene import GROUND, Body, BoucWen, Contact, DegradingBoucWen, Linear, Scene, Spring
from tests.solvers.random_scenes import random_scene

PLAIN = BoucWen("2 MN/m", "500 kN", "1 cm", exponent=2.0)
WORN = DegradingBoucWen(**asdict(PLAIN), strength_degradation=0.1, stiffness_degradation=0.05)
POUNDING = Scene(
    (Body("deck", 1.0e6), Body("span", 6.0e5)),
    (
        Spring("pier", (GROUND, "deck"), WORN),
        Spring("far", (GROUND, "span"), replace(WORN, strength=1.5e6, exponent=1.0)),
        Spring("joint", ("deck", "span"), Linear(1.0e6)),
    ),
    contacts=(Contact("gap", "deck", "span", 0.001, 0.6),),
    motion=MavroeidisPapageorgiou(6.0, 0.9, gamma=5.0),
)
SOLVERS = [
    *(
        (solver, {"events": events})
        for solver in ("cvode", "ida")
        for events in ("own", "sundials")
    ),
    ("fast", {}),
]
RTOL = 1e-11


def run(scene: Scene, end: float, solver: str = "cvode", rtol: float = RTOL, **more) -> Response:
    return simulate(scene, solver=solver, duration=end, rtol=rtol, energy=True, **more)


class Program:
    """A scene of such springs and linear ones in SciPy, equations as Baber and Wen print them."""

    def __init__(self, scene: Scene) -> None:
        self.scene, names = scene, [body.name for body in scene.bodies]
        self.n, self.mass = len(names), np.array([body.mass for body in scene.bodies])
        self.rows = np.array([
            [(name == s.between[1]) * 1.0 - (name == s.between[0]) for name in names]
            for s in scene.springs
        ])  # fmt: skip
        self.worn = [i for i, s in enumerate(scene.springs) if isinstance(s.law, DegradingBoucWen)]
        self.impacts: list[float] = []

    def rate(self, t: float, y: np.ndarray, way: np.ndarray) -> np.ndarray:
        n, h = self.n, len(self.worn)
        x, x_rate = self.rows @ y[:n], self.rows @ y[n : 2 * n]
        force = np.array([s.law.stiffness for s in self.scene.springs]) * x
        rates = np.zeros(2 * h)
        for k, i in enumerate(self.worn):
            law, z, energy = self.scene.springs[i].law, y[2 * n + k], y[2 * n + h + k]
            force[i] += law.strength * z
            nu, eta = 1 + law.strength_degradation * energy, 1 + law.stiffness_degradation * energy
            speed = way[k] * x_rate[i]
            held = law.gamma * speed * z * abs(z) ** (law.exponent - 1.0)
            held += law.beta * x_rate[i] * abs(z) ** law.exponent
            rates[k] = (x_rate[i] - nu * held) / (eta * law.yield_displacement)
            rates[h + k] = z * x_rate[i] / law.yield_displacement
        ground = float(self.scene.motion.acceleration(np.array(t)))
        pull = -self.rows.T @ force / self.mass - ground
        return np.concatenate((y[n : 2 * n], pull, rates))

    def solved(self, end: float) -> np.ndarray:
        n, h = self.n, len(self.worn)
        (contact,), mass = self.scene.contacts, self.mass
        gap = np.array([-1.0, 1.0])
        stops = sorted({p.end for p in self.scene.motion.pieces() if 0.0 < p.end < end} | {end})
        y, t = np.zeros(2 * n + 2 * h), 0.0
        way = np.sign(self.rows[self.worn] @ self.rate(1e-9, y, np.ones(h))[n : 2 * n])

        def rate(t: float, y: np.ndarray) -> np.ndarray:
            return self.rate(t, y, way)

        def turns(k: int) -> Callable[[float, np.ndarray], float]:
            return lambda t, y: float(way[k] * (self.rows[self.worn[k]] @ y[n : 2 * n]))

        while t < end:
            events = [lambda t, y: contact.gap + gap @ y[:n] + 1e-14]
            events += [turns(k) for k in range(h)]
            for function in events:
                function.terminal, function.direction = True, -1.0
            stop = next(s for s in stops if s > t)
            exact = {"rtol": 1e-13, "atol": 1e-15, "max_step": end / 500}
            found = solve_ivp(rate, (t, stop), y, "DOP853", events=events, **exact)
            t, y = float(found.t[-1]), found.y[:, -1]
            if found.t_events[0].size:
                impulse = -(1.0 + contact.restitution) * (gap @ y[n : 2 * n]) / (1.0 / mass).sum()
                y[n : 2 * n] += impulse * gap / mass
                self.impacts.append(t)
                way = np.sign(self.rows[self.worn] @ y[n : 2 * n])
            for k in range(h):
                if found.t_events[1 + k].size:
                    way[k] = -way[k]
        return y


@cache
def printed_equations() -> tuple[np.ndarray, list[float]]:
    """Where the program ends, and its impacts."""
    program = Program(POUNDING)
    return program.solved(6.0), program.impacts


@pytest.mark.parametrize(("solver", "settings"), SOLVERS)
def test_motion_is_that_of_the_printed_equations(solver, settings):
    y, impacts = printed_equations()
    response = run(POUNDING, 6.0, solver, settings=settings)
    found = response.recording
    assert len(impacts) == response.impacts >= 4
    # Errors of single steps add up over thousands of them.
    scale = np.concatenate((np.full(2, 0.1), np.full(2, 1.0), np.ones(2), y[6:]))
    parts = (np.concatenate((found.u, found.v, found.z)) - y) / scale
    assert np.abs(parts).max() < 1e-9
    assert [e.t for e in found.events] == pytest.approx(impacts, abs=1e-9)


def test_a_law_that_does_not_degrade_moves_as_bouc_wen_does():
    new = replace(WORN, strength_degradation=0.0, stiffness_degradation=0.0)
    pair = [
        replace(POUNDING, springs=(replace(POUNDING.springs[0], law=law), *POUNDING.springs[2:]))
        for law in (new, PLAIN)
    ]
    worn, plain = (run(scene, 2.0).recording for scene in pair)
    np.testing.assert_allclose(worn.u, plain.u, atol=1e-10)
    np.testing.assert_allclose(worn.z[0], plain.z[0], atol=1e-10)


def yielded(xi: float, delta: float, energy: float) -> tuple[float, float]:
    """Both z and epsilon after a travel of xi u_y from z = 0, for n = 1, beta = gamma, eta = 1.

    With ``z = epsilon'`` and ``epsilon = (2/delta) (log y)'`` the law is ``y'' + y' = (delta/2)
    (xi + c) y``, which is Airy's equation of ``y e^(xi/2)``.
    """
    c, root = energy + 0.5 * delta * energy**2, (0.5 * delta) ** (1.0 / 3.0)

    def both(at: float) -> np.ndarray:
        a, a_1, b, b_1 = airy(root * (at + c + 0.5 / delta))
        return np.array([[a, b], [root * a_1, root * b_1]])

    w, w_1 = both(xi) @ np.linalg.solve(both(0.0), [1.0, 0.5 + 0.5 * delta * energy])
    energy = 2.0 / delta * (w_1 / w - 0.5)
    return xi + c - energy - 0.5 * delta * energy**2, energy


def thrown(solver: str, **degradation: float) -> tuple[Response, float, float]:
    """A body thrown against a spring that stops it and throws it back: u_y, x_max, x at the end."""
    law = DegradingBoucWen(0.0, 1.0, 1.0, 1.0, **degradation)
    scene = Scene((Body("b", 1.0, velocity=2.0),), (Spring("s", (GROUND, "b"), law),))
    response = run(replace(scene, motion=NoMotion()), 6.0, solver, output_step=1e-4)
    # Turned once, and yielding the other way.
    assert response.final["b"]["v"] < 0.0
    assert response.final["s"]["z"] < -0.1
    return response, float(response.peaks.loc["b", "max"]), response.final["b"]["u"]


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_strength_falls_along_a_loop_in_closed_form(solver):
    delta = 0.6
    response, top, x = thrown(solver, strength_degradation=delta)
    z, energy = yielded(top, delta, 0.0)
    # Back to z = 0 along the line of slope 1, then yielding the other way.
    z, energy = yielded(top - z - x, delta, energy - 0.5 * z**2)
    assert response.final["s"] == pytest.approx({"z": -z, "epsilon": energy}, rel=1e-9)
    left = 1.0 / (1.0 + delta * energy)
    assert response.quantity("springs.s.strength_lost") == pytest.approx(1.0 - left)
    assert response.quantity("springs.s.stiffness_lost") == 0.0


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_stiffness_falls_along_a_loop_in_closed_form(solver):
    # Yielding, d eta/dz = delta eta z/(1 - z); unloading, delta eta z.
    delta, start = 0.4, 0.5
    response, *_ = thrown(solver, stiffness_degradation=delta, initial_loss=start)
    eta, size = 1.0 + delta * start, -response.final["s"]["z"]
    # Flat where it turns: the closest row is off by the square of the distance.
    z = float(response.history["z.s"].max())
    eta *= (math.exp(-z) / (1.0 - z)) ** delta * math.exp(-0.5 * delta * z**2)
    lost = (eta - 1.0) / delta
    eta *= (math.exp(-size) / (1.0 - size)) ** delta
    assert 1.0 + delta * response.final["s"]["epsilon"] == pytest.approx(eta, rel=1e-7)
    assert response.quantity("springs.s.stiffness_lost") == pytest.approx(1.0 - 1.0 / eta, rel=1e-7)
    # What z holds at the end is given back along eta z' = x'.
    lost_now = (eta * math.exp(-0.5 * delta * size**2) - 1.0) / delta
    assert lost_now > lost > start
    found = response.quantity("springs.s.dissipated_energy")
    assert found == pytest.approx(lost_now - start, rel=1e-7)


def test_an_elastic_way_out_and_back_loses_nothing():
    law = replace(WORN, stiffness_degradation=0.7, initial_loss=3.0)
    for z in (0.0, 0.4, -1.0):
        begun = replace(law, initial_z=z)
        assert begun.dissipated(0.0, z, begun.second_at) == pytest.approx(0.0, abs=1e-9)
    # Without degradation of stiffness z holds z^2/2.
    law = replace(law, stiffness_degradation=0.0, initial_z=0.6)
    assert law.second_at == pytest.approx(3.0 + 0.18)
    law = replace(law, stiffness_degradation=0.7)
    a = 0.5 * 0.7 * 0.6**2
    assert law.second_at == pytest.approx(3.0 * math.exp(a) + math.expm1(a) / 0.7, rel=1e-14)


def test_epsilon_of_a_case_starts_at_its_loss_and_what_its_z_holds():
    spring = {"between": ["ground", "b"], "name": "s", "law": "degrading-bouc-wen"}
    spring |= {"stiffness": 0.0, "strength": 1e3, "yield_displacement": 0.01, "exponent": 2}
    for loss in (0.0, 2.0):
        given = spring | {"initial_z": 0.5, "strength_degradation": 0.3, "initial_loss": loss}
        case = read_case(
            {
                "excitation": {"kind": "none"},
                "body": [{"name": "b", "mass": 1000.0}],
                "spring": [given],
                "run": {"duration": 1e-6},
            },
            Path("case.toml"),
        )
        final = simulate(case, error_estimate=False).final["s"]
        assert final["epsilon"] == pytest.approx(loss + 0.125, abs=1e-9)


def worn(scene: Scene, seed: int) -> Scene:
    """The scene with degradation of every Bouc-Wen spring that may have it."""
    rng, springs = np.random.default_rng(seed), []
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, BoucWen) and abs(law.beta) <= law.gamma:
            nu, eta, lost = (float(rng.choice([0.0, 0.01, 0.1, 1.0])) for _ in range(3))
            law = DegradingBoucWen(
                **asdict(law), strength_degradation=nu, stiffness_degradation=eta, initial_loss=lost
            )
        springs.append(replace(spring, law=law))
    return replace(scene, springs=tuple(springs))


@pytest.mark.parametrize(
    "seed",
    [*range(1, 11), *(pytest.param(seed, marks=pytest.mark.sweep) for seed in range(11, 25))],
)
def test_random_scenes_move_alike_and_keep_energy(seed):
    scene, end = random_scene(seed)
    scene = worn(scene, seed)
    first, *others = (run(scene, end, solver, 1e-9) for solver in ("cvode", "ida", "fast"))
    size = np.abs(first.recording.history.u).max()
    for other in others:
        np.testing.assert_allclose(first.recording.u, other.recording.u, atol=1e-6 * size)
    for response in (first, *others):
        assert abs(response.energy.closure) < 1e-6
        bounds = [s.law.bound for s in scene.springs if isinstance(s.law, BoucWen)]
        z = np.abs(response.recording.history.z[:, : len(bounds)])
        assert np.all(z <= np.array(bounds) * (1.0 + 1e-6))


def test_its_energy_is_the_hysteretic_work():
    response = run(POUNDING, 4.0)
    parts = [
        spring.law.strength * spring.law.yield_displacement * response.final[spring.name]["epsilon"]
        for spring in POUNDING.springs[:2]
    ]
    assert response.energy.hysteretic == pytest.approx(sum(parts), rel=1e-12)
    lost = [response.quantity(f"springs.{name}.dissipated_energy") for name in ("pier", "far")]
    assert all(0.0 < own < of for own, of in zip(lost, parts, strict=True))


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_damage_goes_on_in_an_aftershock(solver):
    thrown = Body("deck", 1.0e6, velocity=3.0)
    scene = replace(POUNDING, motion=NoMotion(), bodies=(thrown, POUNDING.bodies[1]))
    whole, first = run(scene, 4.0, solver), run(scene, 2.5, solver)
    second = run(scene, 1.5, solver, start=first.final)
    assert second.scene.springs[0].law.initial_loss > 1.0
    np.testing.assert_allclose(second.recording.u, whole.recording.u, atol=1e-9)
    np.testing.assert_allclose(second.recording.z, whole.recording.z, rtol=1e-8)


def test_numbers_that_would_heal_it_are_refused():
    for key, value in (("beta", 0.6), ("strength_degradation", -0.1), ("initial_loss", -1.0)):
        law = replace(WORN, **{key: value})
        with pytest.raises(InputError, match=key):
            simulate(replace(POUNDING, springs=(Spring("pier", (GROUND, "deck"), law),)))
