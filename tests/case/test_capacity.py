"""Capacities as a case gives them: in any unit of their quantities, and no other."""

from pathlib import Path

import pytest

from eventpound.case.loading import read_case
from eventpound.errors import InputError
from eventpound.quantities.lookup import asked

FILE = Path("case.toml")
CASE = {
    "excitation": {"kind": "none"},
    "body": [{"name": "deck", "mass": 1.0}],
    "spring": [{"between": ["ground", "deck"], "law": "linear", "stiffness": 1.0}],
    "run": {"duration": 1.0},
}


def stated_of(name, value):
    case = read_case(CASE | {"capacity": {name: value}}, FILE)
    return case, case.run.stated


@pytest.mark.parametrize(
    ("name", "value", "si"),
    [
        ("acceleration.deck.abs_max", "0.5 g", 0.5 * 9.80665),
        ("velocity.deck.abs_max", "12 cm/s", 0.12),
        ("peaks.deck.abs_max", "2 in", 0.0508),
        ("base_shear.abs_max", "3 kip", 3.0 * 4448.2216152605),
        ("acceleration.deck.abs_max", 3.0, 3.0),
    ],
)
def test_a_capacity_has_any_unit_of_its_quantity(name, value, si):
    case, stated = stated_of(name, value)
    assert dict(stated.capacities)[name] == pytest.approx(si, rel=1e-15)
    assert name in asked([(case.scene, stated)])
    assert read_case(case.understood, FILE).run.stated == stated


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("acceleration.deck.abs_max", "5 cm", "found a unit of length; accepted: an acceleration"),
        ("peaks.deck.abs_max", "5 kN", "found a unit of force; accepted: a length"),
        ("impacts", "5 g", "found a unit of acceleration; accepted: a plain number"),
        ("base_shear.abs_max", "5 J", "found a unit of energy; accepted: a force"),
    ],
)
def test_a_unit_of_something_else_is_refused(name, value, said):
    case, stated = stated_of(name, value)
    with pytest.raises(InputError, match=said) as error:
        asked([(case.scene, stated)])
    assert f"capacity: {name}: " in str(error.value)


@pytest.mark.parametrize("value", ["5 quux", "-5 g", 0, "much"])
def test_what_is_no_capacity_is_refused_with_its_name(value):
    with pytest.raises(InputError, match=r"case\.toml: \[capacity\]: acceleration\.deck\.abs_max"):
        stated_of("acceleration.deck.abs_max", value)
