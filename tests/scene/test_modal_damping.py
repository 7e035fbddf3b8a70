"""Modal damping against complex eigenvalues, the root of a matrix, a closed form, and SciPy."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eig, eigh, sqrtm

from eventpound import InputError, Sine, load_case, modal_damping, simulate
from eventpound.case import read_case
from eventpound.scene import (
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.scene.at_rest import stiffness_of
from eventpound.scene.check import scene_problems
from eventpound.scene.modes import modes_of
from eventpound.scene.parameters import number_places
from eventpound.scene.periods import joined
from eventpound.study.checked_numbers import variants_to_check

EPS = np.finfo(float).eps
Frame = tuple[tuple[Body, ...], tuple[Spring, ...]]


def frame(count: int) -> Frame:
    """A frame of storeys that yield, of random numbers."""
    rng = np.random.default_rng(count)
    ends = [GROUND, *(f"f{i}" for i in range(count))]
    bodies = [Body(name, m) for name, m in zip(ends[1:], rng.uniform(1e5, 4e5, count), strict=True)]
    laws = [BoucWen.from_yield(k, 1e6, 0.1) for k in rng.uniform(5e7, 2e8, count)]
    springs = [Spring(f"s{i}", (ends[i], ends[i + 1]), law) for i, law in enumerate(laws)]
    return tuple(bodies), tuple(springs)


def matrices(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, C, K of a scene, K initial."""
    names = [body.name for body in scene.bodies]
    damping = joined(names, [(d.direction, d.coefficient) for d in scene.dashpots])
    stiffness = joined(names, [(s.direction, stiffness_of(s)) for s in scene.springs])
    return np.diag([body.mass for body in scene.bodies]), damping, stiffness


def ratios_of(scene: Scene) -> np.ndarray:
    """Of the eigenvalues of the state matrix, -Re/|.|, the slowest first."""
    mass, damping, stiffness = matrices(scene)
    inverse, zero = np.linalg.inv(mass), np.zeros_like(mass)
    state = np.block([[zero, np.eye(len(mass))], [-inverse @ stiffness, -inverse @ damping]])
    values = eig(state, right=False)
    values = np.array(sorted(values[values.imag > 0.0], key=abs))
    return np.asarray(-values.real / abs(values))


@pytest.mark.parametrize("count", [1, 2, 5, 20])
@pytest.mark.parametrize("given", ["5 %", [0.05, 0.02], [0.0, 0.05, 0.01, 0.1]])
def test_every_mode_has_the_ratio_that_was_asked(count, given):
    bodies, springs = frame(count)
    listed = [0.05] if isinstance(given, str) else given[:count]
    wanted = [*listed, *listed[-1:] * count][:count]
    scene = Scene(
        bodies, springs, modal_damping(bodies, springs, given if isinstance(given, str) else listed)
    )
    # A part of the largest eigenvalue: rounding of the smallest is as large.
    assert ratios_of(scene) == pytest.approx(wanted, abs=1e3 * count * EPS)
    names = [body.name for body in bodies]
    assert modes_of(scene, names).damping == pytest.approx(wanted, abs=1e2 * count * EPS)
    assert scene_problems(scene) == []


@pytest.mark.parametrize("count", [2, 3, 8])
def test_one_ratio_is_a_root_of_the_stiffness_and_no_dashpot_is_negative(count):
    bodies, springs = frame(count)
    # Braces over several storeys, and some to the ground.
    rng = np.random.default_rng(9)
    for first, second in rng.integers(0, count, (count, 2)):
        ends = (GROUND if first == second else f"f{first}", f"f{second}")
        springs += (Spring(f"brace{len(springs)}", ends, Linear(rng.uniform(1e6, 1e8))),)
    scene = Scene(bodies, springs, modal_damping(bodies, springs, 0.03))
    mass, damping, stiffness = matrices(scene)
    root = 2.0 * 0.03 * mass @ sqrtm(np.linalg.solve(mass, stiffness))
    np.testing.assert_allclose(damping, root, atol=1e-12 * root.max())
    assert len(scene.dashpots) == count * (count + 1) // 2
    assert min(dashpot.coefficient for dashpot in scene.dashpots) > 0.0


def test_floors_on_a_slab_are_damped_relative_to_it():
    bodies, springs = frame(4)
    isolators = Spring("isolators", springs[0].between, Linear(8e6))
    springs = (isolators, *springs[1:])
    dashpots = modal_damping(bodies[1:], springs, "2 %", base="f0")
    assert {end for d in dashpots for end in d.between} == {"f0", "f1", "f2", "f3"}
    fixed = [replace(s, between=(GROUND, "f1")) if s.name == "s1" else s for s in springs[1:]]
    on_ground = modal_damping(bodies[1:], fixed, "2 %")
    assert [d.coefficient for d in dashpots] == [d.coefficient for d in on_ground]
    # The isolated mode hardly works the storeys; on the ground it would have more than 10 %.
    assert ratios_of(Scene(bodies, springs, dashpots))[0] < 1e-3


def test_springs_slack_at_rest_and_others_are_left_out():
    bodies, springs = frame(3)
    more = (
        Spring("stop", ("f2", GROUND), BilinearElastic(1e9, 0.0, -0.1)),
        Spring("link", ("f2", "tower"), Linear(1e8)),
    )
    assert modal_damping(bodies, springs + more, 0.05) == modal_damping(bodies, springs, 0.05)


def test_what_nothing_holds_gets_no_dashpots_to_the_ground():
    bodies, springs = frame(4)
    dashpots = modal_damping(bodies, springs[1:], 0.05)
    assert all(GROUND not in dashpot.between for dashpot in dashpots)
    assert len(dashpots) == 6


@pytest.mark.parametrize(
    ("ratio", "names", "said"),
    [
        (-0.01, "f0 f1 f2", "ratio: found -0.01; accepted: one that is not negative"),
        ([0.05] * 4, "f0 f1 f2", "a list of at most 3, one a mode"),
        ([], "f0 f1 f2", "ratio: found ()"),
        (0.05, "f0 f2", "bodies: found 2; accepted: up to 100, which springs"),
    ],
)
def test_what_cannot_be_damped_by_modes(ratio, names, said):
    bodies, springs = frame(3)
    group = [body for body in bodies if body.name in names.split()]
    with pytest.raises(InputError) as error:
        modal_damping(group, springs, ratio)
    assert said in str(error.value)


def unlike_ratios() -> Scene:
    """An elastic frame whose dashpots are negative in part."""
    bodies, springs = frame(4)
    springs = tuple(replace(s, law=Linear(stiffness_of(s))) for s in springs)
    dashpots = modal_damping(bodies, springs, [0.05, 0.02, 0.0, 0.01])
    assert min(dashpot.coefficient for dashpot in dashpots) < 0.0
    return Scene(bodies, springs, dashpots)


@pytest.mark.parametrize(
    ("solver", "error"),
    [("cvode", 1e-8), ("ida", 1e-8), ("fast", 1e-8), ("moreau", 1e-2), ("penalty", 1e-2)],
)
def test_free_vibration_decays_mode_by_mode(solver, error):
    still = unlike_ratios()
    start = np.random.default_rng(7).uniform(-0.05, 0.05, 4)
    bodies = [replace(b, displacement=u) for b, u in zip(still.bodies, start, strict=True)]
    scene, end = replace(still, bodies=tuple(bodies)), 2.0
    mass, _, stiffness = matrices(scene)
    squares, shapes = eigh(stiffness, mass)
    omega, xi = np.sqrt(squares), np.array([0.05, 0.02, 0.0, 0.01])
    damped = omega * np.sqrt(1.0 - xi**2)
    decay = np.exp(-xi * omega * end)
    q = decay * (np.cos(damped * end) + xi * omega / damped * np.sin(damped * end))
    expected = shapes @ (q * (shapes.T @ mass @ start))
    settings = {"time_step": 2e-4} if solver in ("moreau", "penalty") else {}
    tolerance = {} if settings else {"rtol": 1e-10}
    response = simulate(scene, solver, duration=end, settings=settings, **tolerance)
    found = [response.final[body.name]["u"] for body in scene.bodies]
    assert found == pytest.approx(expected, abs=error * np.abs(start).max())


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_impacts_of_a_frame_with_negative_dashpots_are_those_of_scipy(solver):
    gap, period, end, restitution = 0.04, 0.7, 2.0, 0.9
    contact = Contact("wall", "f3", "barrier", gap=gap, restitution=restitution)
    scene = replace(unlike_ratios(), contacts=(contact,), motion=Sine(3.0, period))
    mass, damping, stiffness = matrices(scene)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        ground = 3.0 * np.sin(2.0 * np.pi / period * t) if shaken else 0.0
        return np.r_[y[4:], -np.linalg.solve(mass, stiffness @ y[:4] + damping @ y[4:]) - ground]

    def closed(t: float, y: np.ndarray) -> float:
        return float(gap - y[3])

    closed.terminal, closed.direction = True, -1
    t, y, impacts, shaken = 0.0, np.zeros(8), [], True
    while t < end:
        shaken = t < period
        span = (t, period if shaken else end)
        part = solve_ivp(
            rate, span, y, "DOP853", events=closed, rtol=1e-11, atol=1e-13, max_step=0.01
        )
        t, y = part.t[-1], part.y[:, -1]
        if part.status == 1:
            impacts.append(t)
            y[3], y[7] = gap, -restitution * y[7]
            assert len(impacts) < 50
    response = simulate(scene, solver, rtol=1e-10, duration=end)
    struck = response.events[response.events.kind == "impact"]
    assert len(impacts) > 1
    assert struck.t.tolist() == pytest.approx(impacts, abs=1e-7)
    found = [response.final[body.name]["u"] for body in scene.bodies]
    assert found == pytest.approx(y[:4], abs=1e-8)


def test_dashpots_that_drive_a_motion_are_refused():
    scene = unlike_ratios()
    driving = replace(scene, dashpots=(*scene.dashpots, Dashpot((GROUND, "f3"), -1e6)))
    (problem,) = scene_problems(driving)
    assert "a negative one only where all dashpots together never drive a motion" in str(problem)


def test_variants_of_negative_dashpots_are_checked_together():
    scene = unlike_ratios()
    driving = Dashpot((GROUND, "f0"), 1e6)
    scene = replace(scene, dashpots=(driving, Dashpot((GROUND, "f0"), 1e6)))
    places = [p for key, p in number_places(scene).items() if key.startswith("dashpot")]
    # Only the third variant has two that drive together.
    columns = np.array([[2e6, -1e6, -1e6, 2e6], [-1e6, 2e6, -0.5e6, -1e6]])
    rows = variants_to_check(scene, dict(zip(places, columns, strict=True)), 4)
    assert 2 in rows.tolist()


CASE = """
[excitation]
kind = "sine"
amplitude = "0.3 g"
period = "0.5 s"
[[building]]
name = "A"
storeys = 3
mass = ["200 t", "180 t", "100 t"]
stiffness = "300 MN/m"
yield_force = "0.3 W"
"""


def case_of(folder: Path, text: str):
    (folder / "case.toml").write_text(text)
    return load_case(folder)


def test_a_building_of_a_case_has_modal_damping(tmp_path):
    case = case_of(tmp_path, CASE + 'ratio = ["5 %", 0.03]\ndamping = "modal"\n')
    assert ratios_of(case.scene) == pytest.approx([0.05, 0.03, 0.03], abs=1e-12)
    assert read_case(case.understood, tmp_path / "case.toml").scene == case.scene
    table = '[[modal_damping]]\nbodies = ["A1", "A2", "A3"]\nratio = ["5 %", 0.03]\n'
    assert case_of(tmp_path, CASE + table).scene == case.scene


def test_a_group_stands_on_a_body_of_the_case(tmp_path):
    table = '[[modal_damping]]\nbodies = ["A2", "A3"]\nratio = "2 %"\nbase = "A1"\n'
    scene = case_of(tmp_path, CASE + table).scene
    assert [d.between for d in scene.dashpots] == [("A1", "A2"), ("A1", "A3"), ("A2", "A3")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('damping = "modal"\n', "[[building]] 1 (A): ratio: missing"),
        (
            'damping = "modal"\nratio = 0.05\nmodes = [1, 2]\n',
            "modes: found [1, 2]; accepted: none",
        ),
        ('damping = "modes"\nratio = 0.05\n', "damping: found 'modes'"),
        ('[[modal_damping]]\nbodies = ["A1"]\n', "[[modal_damping]] 1: ratio: missing"),
        ('[[modal_damping]]\nbodies = ["A1"]\nratio = -1\n', "ratio: found -1; accepted: a ratio"),
        ('[[modal_damping]]\nbodies = ["A1"]\nratio = [1, 1]\n', "a list of at most 1"),
        ('[[modal_damping]]\nbodies = ["A1"]\nratio = "x"\n', "ratio: found 'x'"),
        ('[[modal_damping]]\nbodies = ["A1"]\nratio = 0.1\nbase = "A1"\n', "one of ground, A2, A3"),
        ('[[modal_damping]]\nbodies = ["A1", "A3"]\nratio = 0.1\n', "bodies: found 2; accepted"),
        ('[[modal_damping]]\nbodies = ["A1"]\nratio = 0.1\nmodes = 1\n', "modes: unknown key"),
        (
            'ratio = 0.05\n[[modal_damping]]\nbodies = ["A1"]\nratio = 0.1\n',
            "[[modal_damping]] 1: bodies: found 'A1' again",
        ),
        (
            '[[modal_damping]]\nbodies = ["A1", "A2", "A3"]\nratio = 0.1\n'
            '[[rayleigh]]\nsprings = ["storey-A2"]\nstiffness_coefficient = 0.01\n',
            "damps spring 'storey-A2' again",
        ),
    ],
)
def test_what_is_wrong_is_said_first(text, said, tmp_path):
    with pytest.raises(InputError) as error:
        case_of(tmp_path, CASE + text)
    assert said in error.value.problems[0]
