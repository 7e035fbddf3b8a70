"""Buckingham's theorem finds the terms of the founding paper, and their values."""

import math
from dataclasses import replace

import pytest

from eventpound.errors import InputError
from eventpound.motion import Cosine, NoMotion
from eventpound.scene import Body, Scene
from eventpound.scene.buckingham import PEAK, Variable, pi_products, variables_of
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.scene.pi_terms import number_of_terms, pi_terms

MOTION = Cosine(3.9, 0.8)
OSCILLATOR = {"uy": 0.2, "Q": 0.3, "delta": 0.5, "epsilon": 0.7}
SEVERAL = OSCILLATOR | {"omega_s": 0.5, "omega_s.i": 2.0, "m.i": 0.5}


def test_terms_of_equation_6():
    scene = PiStructure(Kind.ELASTOPLASTIC, ("0", "barrier")).scene(MOTION, OSCILLATOR, 1000.0)
    products = pi_products(variables_of(scene))
    assert {name: product.exponents for name, product in products.items()} == {
        PEAK: {PEAK: 1, "omega_g": 2, "a_g": -1},
        "uy": {"uy": 1, "omega_g": 2, "a_g": -1},
        "Q": {"Q": 1, "m": -1, "a_g": -1},
        "omega_s": {"omega_s": 1, "omega_g": -1},
        "delta": {"delta": 1, "omega_g": 2, "a_g": -1},
    }
    assert products[PEAK].value is None


@pytest.mark.parametrize(("row", "count"), [(("0", "1"), 10), (("1", "0", "2"), 14)])
def test_number_of_terms_of_several_oscillators(row, count):
    """4n + 2 terms govern n bilinear oscillators (section 5); epsilon is one of them."""
    scene = PiStructure(Kind.BILINEAR, row).scene(MOTION, SEVERAL, 1000.0)
    products = pi_products(variables_of(scene))
    gaps = len(row) - 1
    # The paper has one gap for all contacts.
    assert len(products) - (gaps - 1) + 1 == count
    assert number_of_terms(scene) == count


def test_five_terms_govern_an_elastoplastic_oscillator_beside_a_barrier():
    """Section 3: seven variables, two dimensions; one more with a post-yield stiffness."""
    scene = PiStructure(Kind.ELASTOPLASTIC, ("0", "barrier")).scene(MOTION, OSCILLATOR, 1000.0)
    assert number_of_terms(scene) == 5
    (spring,) = scene.springs
    bilinear = replace(spring, law=replace(spring.law, stiffness=1.0))
    assert number_of_terms(replace(scene, springs=(bilinear,))) == 6


def test_values_are_the_terms_by_hand():
    scene = PiStructure(Kind.BILINEAR, ("1", "0", "2")).scene(MOTION, SEVERAL, 1000.0)
    terms, products = pi_terms(scene), pi_products(variables_of(scene))
    value = {name: product.value for name, product in products.items() if name != PEAK}
    for name in ("omega_s", "uy", "uy.1", "uy.2", "Q", "delta.1-0", "delta.0-2"):
        assert value[name] == pytest.approx(terms[name], rel=1e-13)
    for i in (1, 2):
        # Eq. 16 names ratios to oscillator 0 the other way round, and Q_i / (m_i a_g).
        assert 1.0 / value[f"m.{i}"] == pytest.approx(terms[f"m.{i}"], rel=1e-13)
        assert value["omega_s"] / value[f"omega_s.{i}"] == pytest.approx(
            terms[f"omega_s.{i}"], rel=1e-13
        )
        assert value[f"Q.{i}"] / value[f"m.{i}"] == pytest.approx(terms[f"Q.{i}"], rel=1e-13)


def test_variables_without_the_dimension_of_the_repeating_ones():
    wrong = {"a_g": Variable("m/s^2", 1.0), "omega_g": Variable("1/s", 1.0)}
    with pytest.raises(InputError, match="dimensionless"):
        pi_products(
            wrong
            | {"m": Variable("kg", 1.0), "p": Variable("1/s", math.pi)}
            | {"charge": Variable("A s", 1.0), "current": Variable("A", 1.0)}
        )


def test_free_motion_has_no_scales():
    with pytest.raises(InputError, match="no scales"):
        variables_of(Scene((Body("a", 1.0),), motion=NoMotion()))
