"""Contacts, springs and dashpots at points between bodies: what is read, shown and refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from eventpound.case import Case, read_case
from eventpound.errors import InputError
from eventpound.motion.pulses import Sine
from eventpound.report.model_figure import model_figure
from eventpound.results.export import arrays_of
from eventpound.results.input_tables import input_tables
from eventpound.results.inputs import inputs_of
from eventpound.results.manifest import describe_scene
from eventpound.scene import (
    BARRIER,
    GROUND,
    Contact,
    ContactLaw,
    Dashpot,
    Linear,
    Point,
    Spring,
    Support,
)
from eventpound.scene.check import check_scene
from eventpound.scene.grounded import grounded
from eventpound.scene.modes import modes_of
from eventpound.scene.parameters import number_places
from eventpound.scene.periods import longest_period
from eventpound.scene.structures import structures_of
from eventpound.simulation import check_solver, response_of

UPPER = {"B1": 0.4, "B2": 0.6}


def case_with(left: object = "A", right: object = UPPER, **keys: object) -> Case:
    names = ("A", "B1", "B2")
    document: dict[str, object] = {
        "excitation": {"kind": "sine", "amplitude": 1.0, "period": 1.0},
        "body": [{"name": name, "mass": 2.0 + i} for i, name in enumerate(names)],
        "contact": [{"between": [left, right], "gap": "1 cm", "restitution": 0.5, **keys}],
        "run": {"duration": 1.0},
    }
    return read_case(document, Path("case.toml"))


def problems(left: object = "A", right: object = UPPER, **keys: object) -> str:
    with pytest.raises(InputError) as caught:
        case_with(left, right, **keys)
    return str(caught.value)


def test_it_is_read_and_written_back():
    case = case_with()
    assert case.scene.contacts == (Contact("A-B1+B2", "A", Point(UPPER), 0.01, 0.5),)
    assert case.scene.contacts[0] == Contact("A-B1+B2", "A", UPPER, "1 cm", 0.5)
    again = read_case(case.understood, Path("case.toml"))
    assert again.scene.contacts == case.scene.contacts
    at_ground = case_with({GROUND: "40 %", "A": 0.6}, BARRIER).scene.contacts[0]
    assert at_ground.direction == ((GROUND, -0.4), ("A", -0.6), (BARRIER, 1.0))


def test_thirds_count_as_a_whole():
    """A motion of all bodies together leaves the gap as it is, but for one rounding."""
    contact = case_with("A", {"B1": 0.3333333333, "B2": 0.6666666666}).scene.contacts[0]
    assert abs(sum(weight for _, weight in contact.direction)) <= 2.3e-16


@pytest.mark.parametrize(
    ("left", "right", "message"),
    [
        ("A", {"B1": 0.4, "B2": 0.5}, "accepted: weights of a point that are 1 in sum"),
        ("A", {"B1": -0.4, "B2": 1.4}, "accepted: positive weights"),
        ("A", {"B1": 0.4, "C9": 0.6}, "accepted: points between bodies and the ground"),
        ("Z", UPPER, "accepted: one of A, B1, B2, barrier, or a point"),
        ("B1", UPPER, "accepted: no body at both ends"),
        (BARRIER, {GROUND: 1.0}, "accepted: a body at one end at least"),
        ("A", {}, "weights of a point that are 1 in sum"),
        ("A", {"B1": "a lot", "B2": 0.6}, "between: Point: B1: found 'a lot'"),
        ("A", {"B1": True, "B2": 0.6}, "between: Point: B1: found True"),
        (3, UPPER, "accepted: the left and the right body"),
    ],
    ids=lambda value: str(value)[:24],
)
def test_refused(left, right, message):
    assert message in problems(left, right)


def test_laws_are_refused_and_supports_are_bodies():
    assert "accepted: newton alone" in problems(law="linear", stiffness=1e3, restitution=None)
    scene = case_with().scene
    between = Contact("c", "A", {"pier": 0.5, "B1": 0.5}, 0.01, 0.5)
    with pytest.raises(InputError, match="points between bodies and the ground: A, B1, B2, ground"):
        check_scene(replace(scene, contacts=(between,)))
    held = replace(scene, contacts=(between,), supports=(Support("pier", 0.5),))
    check_scene(held)
    (alone,) = grounded(held).contacts
    assert alone.right == Point((("ground", 0.5), ("B1", 0.5)))
    soft = Contact("c", "A", UPPER, 0.01, 0.5, ContactLaw("linear", 1e3))
    with pytest.raises(InputError, match="newton alone"):
        check_scene(replace(scene, contacts=(soft,)))


def test_penetration_is_that_of_the_point():
    scene = case_with().scene
    bodies = tuple(replace(b, displacement=-0.03 if b.name == "B1" else 0.0) for b in scene.bodies)
    with pytest.raises(InputError, match=r"it is -0\.002 m open"):
        check_scene(replace(scene, bodies=bodies))


def test_what_was_understood_shows_the_point():
    case = case_with()
    (row,) = inputs_of(case)["contacts"]
    assert row["between"] == ["A", UPPER]
    # 1/m = 1/2 + 0.4²/3 + 0.6²/4
    assert row["effective_mass"] == pytest.approx(1.0 / (0.5 + 0.16 / 3.0 + 0.09))
    cells = [cell for table in input_tables(inputs_of(case)) for r in table.rows for cell in r]
    assert "A - (0.4 B1 + 0.6 B2)" in cells
    assert describe_scene(case.scene)["contacts"][0]["right"] == UPPER
    np.testing.assert_array_equal(arrays_of(case.scene)["W"], [[-1.0], [0.4], [0.6]])


def test_other_solvers_say_who_can():
    case, solver = case_with(), "penalty"
    options = replace(case.solver, name=solver, settings={})
    with pytest.raises(InputError) as caught:
        check_solver(options, case.scene)
    message = str(caught.value)
    assert "'A-B1+B2'" in message
    assert message.endswith("accepted: cvode, ida, fast, moreau")
    with pytest.raises(InputError, match="at a point between bodies"):
        response_of(case, solver)


LINKED = {
    "spring": [
        {"between": ["ground", "A"], "law": "linear", "stiffness": 9.0},
        {"between": ["ground", "B1"], "law": "linear", "stiffness": 7.0},
        {"between": ["B1", "B2"], "law": "linear", "stiffness": 5.0},
        {"between": [{"ground": 0.3, "A": 0.7}, UPPER], "law": "linear", "stiffness": 4.0},
    ],
    "dashpot": [{"between": ["A", UPPER], "coefficient": 0.2}],
}
DIRECTIONS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 1.0], [-0.7, 0.4, 0.6]])
"""B of its springs, by hand."""


def linked(**more: object) -> Case:
    document = {
        "excitation": {"kind": "sine", "amplitude": 1.0, "period": 1.0},
        "body": [{"name": name, "mass": 2.0 + i} for i, name in enumerate(("A", "B1", "B2"))],
        "run": {"duration": 1.0},
    }
    return read_case(document | LINKED | more, Path("case.toml"))


def test_links_are_read_named_and_written_back() -> None:
    case = linked()
    spring, (dashpot,) = case.scene.springs[-1], case.scene.dashpots
    assert spring.between == (Point({GROUND: 0.3, "A": 0.7}), Point(UPPER))
    assert spring.name == "ground+A-B1+B2"
    assert spring.direction == ((GROUND, -0.3), ("A", -0.7), ("B1", 0.4), ("B2", 0.6))
    assert dashpot == Dashpot(("A", UPPER), 0.2)
    assert f"dashpot.{dashpot.label}.coefficient" == "dashpot.A-B1+B2.coefficient"
    assert "dashpot.A-B1+B2.coefficient" in number_places(case.scene)
    again = read_case(case.understood, Path("case.toml"))
    assert (again.scene.springs, again.scene.dashpots) == (case.scene.springs, (dashpot,))
    described = describe_scene(case.scene)
    assert described["dashpots"] == [{"between": ["A", UPPER], "coefficient": 0.2}]
    np.testing.assert_array_equal(np.transpose(arrays_of(case.scene)["B"]), DIRECTIONS)
    cells = [cell for table in input_tables(inputs_of(case)) for r in table.rows for cell in r]
    assert "(0.3 ground + 0.7 A) - (0.4 B1 + 0.6 B2)" in cells


def test_modes_and_damping_have_their_matrices() -> None:
    """Periods and ratios of ``B K Bᵀ`` and ``D C Dᵀ``; Rayleigh's C is a M + b K of these."""
    scene = linked().scene
    M, names = np.diag([2.0, 3.0, 4.0]), ["A", "B1", "B2"]
    K = (DIRECTIONS.T * [9.0, 7.0, 5.0, 4.0]) @ DIRECTIONS
    assert structures_of(scene) == [names]
    squares, shape = eigh(K, M)
    modes = modes_of(scene, names)
    np.testing.assert_allclose(modes.period, 2.0 * np.pi / np.sqrt(squares), rtol=1e-13)
    d = np.array([-1.0, 0.4, 0.6])
    ratio = 0.2 * (d @ shape) ** 2 / (2.0 * np.sqrt(squares))
    np.testing.assert_allclose(modes.damping, ratio, rtol=1e-12)
    assert longest_period(scene) == pytest.approx(modes.period[0], rel=1e-13)
    damped = linked(rayleigh=[{"bodies": names, "ratio": 0.05, "modes": [1, 2]}]).scene
    omega = np.sqrt(squares[:2])
    a, b = 0.1 * omega.prod() / omega.sum(), 0.1 / omega.sum()
    C = np.array(arrays_of(damped)["C"]) - 0.2 * np.outer(d, d)
    np.testing.assert_allclose(C, a * M + b * K, rtol=1e-12)
    modal = linked(modal_damping=[{"bodies": names, "ratio": 0.04}]).scene
    C = np.array(arrays_of(modal)["C"]) - 0.2 * np.outer(d, d)
    ratio = np.einsum("ij,ik,kj->j", shape, C, shape) / (2.0 * np.sqrt(squares))
    np.testing.assert_allclose(ratio, 0.04, rtol=1e-9)


@pytest.mark.parametrize(
    ("between", "message"),
    [
        ([{"A": 0.5, "B1": 0.4}, "B2"], "accepted: weights of a point that are 1 in sum"),
        (["Z", UPPER], "accepted: one of A, B1, B2, ground, or a point"),
        (["B1", UPPER], "accepted: no body at both ends"),
        (["ground", {"ground": 1.0}], "accepted: a body at one end at least"),
        ([{"A": 0.5}], "accepted: two bodies, or a body and \"ground\"; or a point"),
        ([{"A": "much"}, "B1"], "between: Point: A: found 'much'"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["spring", "dashpot"])
def test_links_refused(kind: str, between: list[object], message: str) -> None:
    own = {"spring": {"law": "linear", "stiffness": 1.0}, "dashpot": {"coefficient": 1.0}}[kind]
    with pytest.raises(InputError) as caught:
        linked(**{kind: [{"between": between, **own}]})
    assert message in str(caught.value)


def test_a_frequency_of_a_spring_at_a_point_needs_its_mass() -> None:
    spring = {"between": ["ground", {"ground": 0.5, "A": 0.5}], "law": "linear", "frequency": 2.0}
    with pytest.raises(InputError, match="of_mass"):
        linked(spring=[spring])
    (found,) = linked(spring=[{**spring, "of_mass": ["A"]}], dashpot=[]).scene.springs
    assert found.law == Linear(2.0 * 2.0**2)


def test_what_is_on_a_support_is_its_shear_and_work() -> None:
    """The parts of a point go to its names; the energy of a run closes with them."""
    scene = linked().scene
    ends = {GROUND: 0.3, "pier": 0.2, "A": 0.5}
    springs = (*scene.springs[:3], Spring("tie", (ends, "B2"), Linear(4.0)))
    held = replace(
        scene,
        springs=springs,
        dashpots=(Dashpot((ends, "B2"), 0.2),),
        supports=(Support("pier", motion=Sine(0.5, 0.7)),),
    )
    check_scene(held)
    (alone,) = grounded(held).springs[3:]
    assert alone.direction[:2] == ((GROUND, -0.3), (GROUND, -0.2))
    run = response_of(held, rtol=1e-10, duration=2.0, energy=True)
    h, supports = run.recording.history, run.recording.supports
    assert abs(run.recording.energy.closure) < 1e-9
    x_rate = h.v[:, 2] - 0.5 * h.v[:, 0] - 0.2 * supports.sv[:, 0]
    np.testing.assert_allclose(supports.force[:, 0], 0.2 * (h.force[:, 3] + 0.2 * x_rate))
    shear = h.force[:, 0] + h.force[:, 1] + 0.3 * (h.force[:, 3] + 0.2 * x_rate)
    assert run.recording.base_shear.maximum[0] == pytest.approx(shear.max(), rel=1e-3)


def test_it_is_drawn() -> None:
    """Columns with the points on them, and a link from one to a wall."""
    scene = linked(
        dashpot=[
            {"between": ["A", UPPER], "coefficient": 0.2},
            {"between": ["ground", {"B1": 0.5, "B2": 0.5}], "coefficient": 0.2},
        ]
    ).scene
    axes = model_figure(scene).axes[0]
    points = [line for line in axes.get_lines() if line.get_marker() == "o"]
    assert len(points) == 4
