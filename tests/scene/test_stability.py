"""P-Delta and negative stiffnesses: closed form of a shear building, SciPy, statics, refusals."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from eventpound import Cosine, InputError, load_case, simulate, simulate_many
from eventpound.cli import main
from eventpound.mechanics.model import assemble
from eventpound.results.input_tables import input_lines
from eventpound.results.inputs import inputs_of
from eventpound.scene import BilinearElastic, Body, BoucWen, Force, Linear, Scene, Spring
from eventpound.scene.check import check_scene, scene_problems
from eventpound.scene.modes import modes_of
from eventpound.scene.plausibility import doubts
from eventpound.scene.statics import in_equilibrium

MASS, HEIGHT, N = 4e5, 3.2, 4
PULSE = Cosine(amplitude=3.0, period=0.6)
STIFFNESS = [3e8, 2.5e8, 2e8, 1.5e8]
WEIGHT = [6e7, 4.5e7, 3e7, 1.5e7]


def storeys(
    stiffness: Sequence[float], weight: Sequence[float | None], law: type = Linear
) -> Scene:
    """A shear building; with another law than a linear one each storey yields."""
    ends = ["ground", *(f"A{i}" for i in range(1, len(stiffness) + 1))]
    laws = [
        Linear(k) if law is Linear else BoucWen.from_yield(k, 0.005 * k, 0.05) for k in stiffness
    ]
    return Scene(
        tuple(Body(end, MASS) for end in ends[1:]),
        tuple(
            Spring(f"storey {i}", (ends[i - 1], ends[i]), laws[i - 1], HEIGHT, weight[i - 1])
            for i in range(1, len(ends))
        ),
        motion=PULSE,
    )


def matrix(stiffness: Sequence[float], weight: Sequence[float]) -> np.ndarray:
    """K of a shear building by its definition: forces that unit displacements need."""
    net = np.append(np.array(stiffness) - np.array(weight) / HEIGHT, 0.0)
    return np.diag(net[:-1] + net[1:]) - np.diag(net[1:-1], 1) - np.diag(net[1:-1], -1)


def names(scene: Scene) -> list[str]:
    return [body.name for body in scene.bodies]


@pytest.mark.parametrize("theta", [0.0, 0.1, 0.6])
def test_frequencies_are_those_of_the_closed_form(theta):
    # Equal storeys: omega_j = 2 sqrt((k - P/h)/m) sin((2 j - 1) pi / (4 n + 2)).
    k = 2e8
    scene = storeys([k] * N, [theta * k * HEIGHT or None] * N)
    j = np.arange(1, N + 1)
    omega = 2.0 * math.sqrt(k * (1.0 - theta) / MASS) * np.sin((2 * j - 1) * np.pi / (4 * N + 2))
    assert modes_of(scene, names(scene)).period == pytest.approx(2.0 * np.pi / omega, rel=1e-12)


def test_frequencies_of_unequal_storeys_are_those_of_scipy():
    scene = storeys(STIFFNESS, WEIGHT)
    squares = eigh(matrix(STIFFNESS, WEIGHT), MASS * np.eye(N), eigvals_only=True)
    period = modes_of(scene, names(scene)).period
    assert period == pytest.approx(2.0 * np.pi / np.sqrt(squares), rel=1e-12)


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_the_motion_is_that_of_another_integrator(solver):
    scene, K = storeys(STIFFNESS, WEIGHT), matrix(STIFFNESS, WEIGHT) / MASS

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        a = 3.0 * math.cos(2.0 * math.pi / 0.6 * t) if t < 0.6 else 0.0
        return np.append(y[N:], -K @ y[:N] - a)

    y = np.zeros(2 * N)
    for span in ((0.0, 0.6 - 1e-15), (0.6, 2.0)):
        y = solve_ivp(rate, span, y, "DOP853", rtol=1e-13, atol=1e-16).y[:, -1]
    response = simulate(scene, solver, rtol=1e-11, duration=2.0)
    assert response.recording.u == pytest.approx(y[:N], abs=1e-9 * np.abs(y[:N]).max())


def test_forces_of_storeys_balance_the_floors():
    # What a storey puts on its ends is its shear: the force of inertia of all above it.
    for law in (Linear, BoucWen):
        scene = storeys(STIFFNESS, [0.2 * w for w in WEIGHT], law)
        history = simulate(scene, "fast", duration=2.0).history
        shear = np.zeros(len(history))
        for i in range(N, 0, -1):
            shear = shear - MASS * history[f"a.A{i}"]
            size = np.abs(shear).max()
            assert history[f"force.storey {i}"].to_numpy() == pytest.approx(
                shear.to_numpy(), abs=1e-9 * size
            )


def test_a_weight_too_large_is_refused_with_its_storey():
    for i in range(N):
        weight = list(WEIGHT)
        weight[i] = 0.999 * STIFFNESS[i] * HEIGHT
        check_scene(storeys(STIFFNESS, weight))
        weight[i] = 1.001 * STIFFNESS[i] * HEIGHT
        (problem,) = scene_problems(storeys(STIFFNESS, weight))
        assert (problem.kind, problem.name, problem.key) == ("spring", f"storey {i + 1}", "weight")
        assert f"(below k h = {STIFFNESS[i] * HEIGHT:.6g} N)" in problem.accepted


@pytest.mark.parametrize("part", [0.99, 1.01])
def test_a_negative_spring_is_taken_where_the_others_hold_it(part):
    # From the ground to the roof, all storeys in series resist it.
    whole = 1.0 / sum(1.0 / k for k in STIFFNESS)
    scene = storeys(STIFFNESS, [None] * N)
    leaning = Spring("leaning", ("ground", f"A{N}"), Linear(-part * whole))
    scene = replace(scene, springs=(*scene.springs, leaning))
    problems = scene_problems(scene)
    assert [(p.name, p.key) for p in problems] == [("leaning", "stiffness")] * (part > 1.0)
    K = matrix(STIFFNESS, [0.0] * N)
    K[-1, -1] -= part * whole
    squares = np.linalg.eigvalsh(K / MASS)
    assert (squares[0] > 0.0) == (part < 1.0)
    if part < 1.0:
        period = modes_of(scene, names(scene)).period
        assert period == pytest.approx(2.0 * np.pi / np.sqrt(squares), rel=1e-10)


def test_extremes_of_a_negative_force_are_the_right_way_round():
    scene = storeys(STIFFNESS, [None] * N)
    scene = replace(scene, springs=(*scene.springs, Spring("x", ("ground", "A4"), Linear(-1e7))))
    response = simulate(scene, "fast", duration=2.0)
    u = response.peaks.loc["A4"]
    assert response.summary["springs.x.max_force"] == -1e7 * u["min"]
    assert response.summary["springs.x.min_force"] == -1e7 * u["max"]
    assert response.summary["springs.x.t_max_force"] == u["t_min"]


def test_the_stability_coefficient_is_that_of_the_codes():
    # theta = P D/(V h), of linear storeys P/(k h); else V on the bilinear backbone, whose knee
    # an exponent of 20 rounds off by less than 2^(-1/20) - 1 of F_y; the formula has the corner.
    linear = simulate(storeys(STIFFNESS, WEIGHT), "fast", duration=2.0)
    yields = simulate(storeys(STIFFNESS, [0.2 * w for w in WEIGHT], BoucWen), "fast", duration=2.0)
    for i, (k, weight) in enumerate(zip(STIFFNESS, WEIGHT, strict=True), 1):
        key = f"springs.storey {i}.stability_coefficient"
        assert linear.summary[key] == pytest.approx(weight / (k * HEIGHT), rel=1e-12)
        drift = yields.summary[f"springs.storey {i}.abs_max_elongation"]
        resists = min(k * drift, 0.05 * k * drift + 0.95 * 0.005 * k)
        expected = 0.2 * weight * drift / (resists * HEIGHT)
        assert yields.summary[key] == pytest.approx(expected, rel=1e-12)
    assert any(yields.summary[f"springs.storey {i}.ductility"] > 1.0 for i in range(1, N + 1))


@pytest.mark.parametrize("law", [Linear, BoucWen])
def test_many_weights_are_runs_one_by_one(law):
    scene = storeys(STIFFNESS, [0.2 * w for w in WEIGHT], law)
    columns = {
        "spring.storey 2.weight": np.array([1e5, 2e7, 6e7]),
        "spring.storey 2.stiffness": np.array([2e8, 1.9e8, 1.8e8]),
    }
    many = simulate_many(scene, columns, duration=2.0, rtol=1e-10)
    for n, (weight, k) in enumerate(zip(*columns.values(), strict=True)):
        spring = scene.springs[1]
        one = replace(spring, weight=weight, law=replace(spring.law, stiffness=k))
        springs = (scene.springs[0], one, *scene.springs[2:])
        peaks = simulate(replace(scene, springs=springs), "fast", rtol=1e-10, duration=2.0).peaks
        assert many.table["peaks.A4.abs_max"][n] == pytest.approx(
            peaks.loc["A4", "abs_max"], rel=1e-9
        )
    columns["spring.storey 2.weight"][1] = 1e9 if law is Linear else 9e9
    with pytest.raises(InputError, match="stands at rest"):
        simulate_many(scene, columns, duration=2.0)


@pytest.mark.parametrize("hardening", [0.05, 0.0])
def test_one_body_that_leans_on_after_yield(hardening):
    # Under 8 % of its stiffness in P-Delta it has a negative one after yield, and comes to rest
    # aside. With `fast` in closed form where that is not so, so against another solver.
    law = BoucWen.from_yield(2e8, 1e6, hardening)
    spring = Spring("column", ("ground", "A"), law, HEIGHT, 0.08 * 2e8 * HEIGHT)
    scene = Scene((Body("A", MASS),), (spring,), motion=PULSE)
    fast, cvode = (
        simulate(scene, solver, rtol=1e-11, duration=3.0) for solver in ("fast", "cvode")
    )
    assert fast.recording.u == pytest.approx(cvode.recording.u, rel=1e-8)
    assert fast.summary["springs.column.ductility"] > 3.0
    assert assemble(scene).elastic.extension[0] == pytest.approx((hardening - 0.08) * 2e8)
    assert any("leans on" in doubt for doubt in doubts(scene))


def test_a_start_in_equilibrium_is_that_of_the_softened_matrix():
    scene = storeys(STIFFNESS, WEIGHT)
    scene = replace(scene, forces=(Force("A4", 2e6),))
    u = np.linalg.solve(matrix(STIFFNESS, WEIGHT), [0.0, 0.0, 0.0, 2e6])
    found = [body.displacement for body in in_equilibrium(scene).bodies]
    assert found == pytest.approx(u, rel=1e-9)
    yields = storeys(STIFFNESS, WEIGHT, BoucWen)
    with pytest.raises(InputError, match="negative stiffnesses \\('storey 1'"):
        in_equilibrium(replace(yields, forces=(Force("A4", 1e3),)))


CASE = """
[excitation]
kind = "cosine"
amplitude = "3 m/s^2"
period = 0.6
[[building]]
name = "A"
storeys = 2
mass = "400 t"
stiffness = "200 MN/m"
height = 3.2
weight = ["1.5 W", "900 kN"]
ratio = "5 %"
"""


def test_a_case_says_weights(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    weights = [spring.weight for spring in case.scene.springs]
    assert weights == pytest.approx([1.5 * 8e5 * 9.80665, 9e5], rel=1e-15)
    assert [s["weight"] for s in case.understood["spring"]] == weights
    # The ratio holds at the periods that the structure has with P-Delta.
    found = inputs_of(case)
    assert [m["damping"] for m in found["structures"][0]["initial"]] == pytest.approx([0.05] * 2)
    assert found["springs"][1]["theta"] == pytest.approx(9e5 / (2e8 * 3.2))
    assert "storey-A1" in dict(input_lines(found))["at rest"]
    assert main(["run", str(tmp_path), "--export", str(tmp_path / "out")]) == 0
    scene = json.loads((tmp_path / "out" / "scene.json").read_text())
    assert "weight" in scene["conventions"]
    assert scene["springs"][0]["weight"] == weights[0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("height = 3.2\n", ""), "[[building]] 1 (A): height: missing; accepted: the heights of"),
        (('"900 kN"', '"900 MN"'), "[[spring]] 2 (storey-A2): weight: found 900000000.0; accepted"),
        (('"900 kN"', '"900 t"'), "has a mass for a force"),
        (('"900 kN"', "-1.0"), "[[building]] 1 (A): weight: found ['1.5 W', -1.0]; accepted: pos"),
    ],
    ids=["no-height", "unstable", "mass", "negative"],
)
def test_wrong_weights_are_refused(tmp_path, change, said, capsys):
    (tmp_path / "case.toml").write_text(CASE.replace(*change))
    assert main(["check", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err


def test_a_weight_goes_with_laws_of_storeys_only():
    scene = storeys([3e8], [None])
    stop = Spring("stop", ("ground", "A1"), BilinearElastic(1e8, 0.0, -0.1), HEIGHT, 1e5)
    scene = replace(scene, springs=(*scene.springs, stop))
    assert [(p.name, p.key) for p in scene_problems(scene)] == [("stop", "weight")]
    bare = replace(scene.springs[0], height=None, weight=1e5)
    assert [p.key for p in scene_problems(replace(scene, springs=(bare,)))] == ["height"]
