"""Units at the border, against their definitions."""

import math
import subprocess
import sys

import pytest

from eventpound.errors import InputError
from eventpound.units import USUAL, Dimension, quantity


@pytest.mark.parametrize(
    ("value", "dimension", "expected"),
    [
        (3, Dimension.LENGTH, 3.0),
        (-0.25, Dimension.VELOCITY, -0.25),
        ("0.25", Dimension.LENGTH, 0.25),
        ("1.27 cm", Dimension.LENGTH, 0.0127),
        ("1in", Dimension.LENGTH, 0.0254),
        ("1301 t", Dimension.MASS, 1301e3),
        ("3440 kN", Dimension.FORCE, 3440e3),
        ("233443 kN/m", Dimension.STIFFNESS, 233443e3),
        ("1743 kN s/m", Dimension.DAMPING, 1743e3),
        ("1743 kN*s/m", Dimension.DAMPING, 1743e3),
        ("1743 kN·s/m", Dimension.DAMPING, 1743e3),
        ("0.4 g", Dimension.ACCELERATION, 0.4 * 9.80665),
        ("-0.4g", Dimension.ACCELERATION, -0.4 * 9.80665),
        ("300 gal", Dimension.ACCELERATION, 3.0),
        ("300 Gal", Dimension.ACCELERATION, 3.0),
        ("35 cm/s^2", Dimension.ACCELERATION, 0.35),
        ("35 cm/s**2", Dimension.ACCELERATION, 0.35),
        ("35 cm/s2", Dimension.ACCELERATION, 0.35),
        ("35 cm s-2", Dimension.ACCELERATION, 0.35),
        ("35 Gal", Dimension.ACCELERATION, 0.35),
        ("5 ms", Dimension.TIME, 0.005),
        ("2 rad/s", Dimension.ANGULAR_FREQUENCY, 2.0),
        ("30 rpm", Dimension.ANGULAR_FREQUENCY, math.pi),
        ("90 deg", Dimension.ANGLE, math.pi / 2),
        ("5 %", Dimension.NUMBER, 0.05),
        ("1.5e2 mm", Dimension.LENGTH, 0.15),
    ],
)
def test_value_in_si(value, dimension, expected):
    # One rounding of the factor, one of the product.
    assert quantity(value, dimension) == pytest.approx(expected, rel=4e-16)


def test_a_decimal_with_a_unit_is_the_nearest_double():
    assert quantity("1.27 cm", Dimension.LENGTH) == 0.0127
    assert quantity("0.3 kN", Dimension.FORCE) == 300.0


@pytest.mark.parametrize(
    ("dimension", "unit"), [(kind, unit) for kind, units in USUAL.items() for unit in units]
)
def test_usual_units_are_those_of_pint(dimension, unit):
    assert f"1*{unit}" not in USUAL[dimension]
    # pint makes a kip of several factors, each rounded.
    by_pint = quantity(f"0.3 1*{unit}", dimension)
    assert quantity(f"0.3 {unit}", dimension) == pytest.approx(by_pint, rel=4e-16)


def test_usual_units_do_not_start_pint():
    program = (
        "import sys\n"
        "from eventpound.units import Dimension, quantity\n"
        "assert quantity('1.27 cm', Dimension.LENGTH) == 0.0127 and 'pint' not in sys.modules\n"
        "assert quantity('1 ft', Dimension.LENGTH) > 0.3 and 'pint' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize(
    ("value", "dimension", "fragment"),
    [
        ("3 kg", Dimension.LENGTH, "'kg' is no unit of length"),
        ("0.4 g", Dimension.MASS, "standard gravity"),
        ("0.4 g", Dimension.NUMBER, "standard gravity"),
        ("4 kg", Dimension.ACCELERATION, "'kg' is no unit of acceleration"),
        ("2 Hz", Dimension.ANGULAR_FREQUENCY, "period"),
        ("2 kHz", Dimension.RATE, "rad/s"),
        ("2 ton", Dimension.MASS, "'t' for 1000 kg"),
        ("3 parsnips", Dimension.LENGTH, "unknown unit 'parsnips'"),
        ("3 m)(", Dimension.LENGTH, "unknown unit"),
        ("3 m + 2 m", Dimension.LENGTH, "unknown unit"),
        ("3 m**9999999", Dimension.LENGTH, "unknown unit"),
        ("m", Dimension.LENGTH, "found 'm'"),
        ("", Dimension.LENGTH, "found ''"),
        ("nan", Dimension.LENGTH, "found 'nan'"),
        ("1e308 km", Dimension.LENGTH, "not finite"),
        (math.inf, Dimension.LENGTH, "not finite"),
        (math.nan, Dimension.LENGTH, "not finite"),
        (True, Dimension.NUMBER, "found True"),
        (None, Dimension.NUMBER, "found None"),
        ([1.0], Dimension.LENGTH, "found [1.0]"),
        (10**400, Dimension.LENGTH, "not finite"),
    ],
)
def test_refused(value, dimension, fragment):
    with pytest.raises(InputError) as caught:
        quantity(value, dimension)
    message = str(caught.value)
    assert fragment in message
    assert repr(value) in message
    assert len(message.splitlines()) == 1


def test_every_example_is_accepted():
    for dimension in Dimension:
        example = dimension.value[2]
        assert example in dimension.accepted
        assert math.isfinite(quantity(example, dimension))


@pytest.mark.parametrize("unit", ["degC", "t", "kg/m"])
def test_a_unit_of_another_kind_is_refused(unit):
    with pytest.raises(InputError, match="is no unit of time"):
        quantity(f"5 {unit}", Dimension.TIME)


def test_a_mass_for_a_force_is_answered():
    for text, dimension in (("500 t", Dimension.FORCE), ("500 t/m", Dimension.STIFFNESS)):
        with pytest.raises(InputError, match="a mass for a force: write kN, or tf"):
            quantity(text, dimension)
