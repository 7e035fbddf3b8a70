"""Contact elements as laws of a case: what is read, shown and refused."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from eventpound.case import Case, read_case
from eventpound.errors import InputError
from eventpound.results.inputs import inputs_of
from eventpound.scene import BARRIER, Contact, ContactLaw, Scene
from eventpound.scene.check import check_scene
from eventpound.scene.parameters import number_places, value_at, with_values

Table = dict[str, object]


def case_with(**keys: object) -> Case:
    document: Table = {
        "excitation": {"kind": "sine", "amplitude": 1.0, "period": 1.0},
        "body": [{"name": "a", "mass": 2.0}, {"name": "b", "mass": 3.0}],
        "contact": [{"between": ["a", "b"], "gap": "1 cm", **keys}],
    }
    return read_case(document, Path("case.toml"))


def problems(**keys: object) -> str:
    with pytest.raises(InputError) as caught:
        case_with(**keys)
    return str(caught.value)


@pytest.mark.parametrize(
    ("keys", "contact"),
    [
        ({"restitution": 0.5, "law": "newton"}, Contact("a-b", "a", "b", 0.01, 0.5)),
        (
            {"law": "linear", "stiffness": "10 kN/m"},
            Contact("a-b", "a", "b", 0.01, None, ContactLaw("linear", 1e4)),
        ),
        (
            {"law": "kelvin-voigt", "stiffness": 1e4, "damping": "5 %", "tension": False},
            Contact("a-b", "a", "b", 0.01, None, ContactLaw("kelvin-voigt", 1e4, 0.05, False)),
        ),
        (
            {"law": "jankowski", "stiffness": "2.75e6 kN/m^1.5", "restitution": 0.65},
            Contact("a-b", "a", "b", 0.01, 0.65, ContactLaw("jankowski", 2.75e9)),
        ),
        (
            {"law": "hertz-damp", "stiffness": 1e4, "restitution": 0.0},
            Contact("a-b", "a", "b", 0.01, 0.0, ContactLaw("hertz-damp", 1e4)),
        ),
    ],
    ids=lambda value: str(value.get("law")) if isinstance(value, dict) else "",
)
def test_read_and_understood(keys, contact):
    case = case_with(**keys)
    assert case.scene.contacts == (contact,)
    again = read_case(case.understood, Path("case.toml"))
    assert again.scene.contacts == case.scene.contacts


def test_constants_are_shown():
    (row,) = inputs_of(case_with(law="kelvin-voigt", stiffness=1e4, restitution=0.5))["contacts"]
    ratio = math.log(2.0) / math.hypot(math.pi, math.log(2.0))
    assert row["effective_mass"] == pytest.approx(1.2)
    assert row["damping"] == pytest.approx(ratio)
    assert row["c"] == pytest.approx(2.0 * ratio * math.sqrt(1e4 * 1.2))
    (row,) = inputs_of(case_with(law="hertz", stiffness=1e4))["contacts"]
    assert not {"damping", "restitution"} & set(row)
    (row,) = inputs_of(case_with(restitution=0.5))["contacts"]
    assert list(row) == ["name", "between", "gap", "restitution"]


@pytest.mark.parametrize(
    ("keys", "fragments"),
    [
        ({"law": "herz", "stiffness": 1.0}, ("found 'herz', did you mean 'hertz'?",)),
        ({"law": "linear"}, ("stiffness: missing",)),
        ({"law": "linear", "stiffness": 0.0}, ("stiffness: found 0.0", "> 0 (N/m)")),
        ({"law": "hertz", "stiffness": "1 kN/m"}, ("no unit of Hertz stiffness",)),
        (
            {"law": "linear", "stiffness": 1.0, "restitution": 0.5},
            ("restitution: found 0.5; accepted: none: linear loses no energy",),
        ),
        (
            {"law": "hertz", "stiffness": 1.0, "damping": 0.5},
            ("damping: found 0.5; accepted: none: hertz loses no energy",),
        ),
        ({"law": "hertz-damp", "stiffness": 1.0}, ("restitution: missing", "or damping")),
        (
            {"law": "hertz-damp", "stiffness": 1.0, "restitution": 0.5, "damping": 0.1},
            ("restitution: found 0.5", "one of restitution and damping (a), and not both"),
        ),
        ({"law": "jankowski", "stiffness": 1.0, "restitution": 0.0}, ("found 0.0", "divides")),
        ({"law": "jankowski", "stiffness": 1.0, "restitution": 1.5}, ("from 0 to 1",)),
        ({"law": "jankowski", "stiffness": 1.0, "damping": -0.5}, ("damping: found -0.5",)),
        (
            {"law": "hertz-damp", "stiffness": 1.0, "damping": 0.1, "tension": False},
            ("tension: found False; accepted: none: only kelvin-voigt",),
        ),
        ({"restitution": 0.5, "stiffness": 1.0}, ("stiffness: found 1.0", "law = linear")),
        ({"law": "newton"}, ("restitution: missing",)),
    ],
)
def test_refused(keys, fragments):
    said = problems(**keys)
    assert said.startswith("case.toml: [[contact]] 1: ")
    assert "\n" not in said
    for fragment in fragments:
        assert fragment in said


def test_a_contact_with_a_law_may_be_pressed_shut_at_the_start():
    scene = case_with(law="linear", stiffness=1.0, gap=-0.01).scene
    check_scene(scene)
    with pytest.raises(InputError, match="not penetrated"):
        check_scene(replace(scene, contacts=(replace(scene.contacts[0], restitution=1, law=None),)))


def test_numbers_by_their_keys():
    scene = case_with(law="kelvin-voigt", stiffness=1e4, restitution=0.5).scene
    places = number_places(scene)
    place = places["contact.a-b.stiffness"]
    assert value_at(scene, place) == 1e4
    (changed,) = with_values(scene, {place: 2e4}).contacts
    assert changed.law == ContactLaw("kelvin-voigt", 2e4)
    assert "contact.a-b.stiffness" not in number_places(case_with(restitution=0.5).scene)


def test_a_scene_built_in_python_is_checked():
    bodies = case_with(restitution=0.5).scene.bodies
    contact = Contact("wall", "a", BARRIER, 0.1, 0.5, ContactLaw("herz", 1.0))
    with pytest.raises(InputError, match="contact 1 \\(wall\\): law: found 'herz'"):
        check_scene(Scene(bodies, (), (), (contact,)))
