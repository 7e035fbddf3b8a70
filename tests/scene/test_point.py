"""Contacts at points between bodies: what is read, shown and refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eventpound.case import Case, read_case
from eventpound.errors import InputError
from eventpound.results.description import describe_scene
from eventpound.results.export import arrays_of
from eventpound.results.input_tables import input_tables
from eventpound.results.inputs import inputs_of
from eventpound.scene import BARRIER, GROUND, Contact, ContactLaw, Point, Support
from eventpound.scene.check import check_scene
from eventpound.scene.grounded import grounded
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
    assert describe_scene(case.scene)["contacts"][0]["right"] == UPPER  # type: ignore[index]
    np.testing.assert_array_equal(arrays_of(case.scene)["W"], [[-1.0], [0.4], [0.6]])


@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_other_solvers_say_who_can(solver):
    case = case_with()
    options = replace(case.solver, name=solver, settings={})
    with pytest.raises(InputError) as caught:
        check_solver(options, case.scene)
    message = str(caught.value)
    assert "'A-B1+B2'" in message
    assert message.endswith("accepted: cvode, ida, fast")
    with pytest.raises(InputError, match="at a point between bodies"):
        response_of(case, solver)
