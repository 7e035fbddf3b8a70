"""Scenes written in Π-terms: what they are told is what they have."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eventpound.errors import InputError
from eventpound.motion import Cosine, NoMotion
from eventpound.scene import Linear
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.scene.pi_terms import pi_terms

MOTION = Cosine(4.0, 2.0 * math.pi / 10.0)  # L_e = 4 / 10^2 = 0.04 m
TRIPLET = PiStructure(Kind.BILINEAR, ("2", "0", "1"))


def test_an_elastoplastic_oscillator_beside_a_barrier():
    structure = PiStructure(Kind.ELASTOPLASTIC, ("0", "barrier"))
    terms = {"uy": 0.25, "Q": 0.5, "delta": 0.5, "epsilon": 0.6}
    scene = structure.scene(MOTION, terms, mass=1000.0)
    assert scene.bodies[0].mass == 1000.0
    law = scene.springs[0].law
    assert (law.stiffness, law.exponent) == (0.0, 20.0)
    # u_y = 0.25 L_e, Q = 0.5 m a_g, delta = 0.5 L_e.
    assert law.yield_displacement == pytest.approx(0.01, rel=1e-15)
    assert law.strength == pytest.approx(2000.0, rel=1e-15)
    contact = scene.contacts[0]
    assert (contact.left, contact.right, contact.restitution) == ("0", "barrier", 0.6)
    assert contact.gap == pytest.approx(0.02, rel=1e-15)


def test_neighbours_are_like_the_one_looked_at():
    scene = TRIPLET.scene(
        MOTION,
        {"omega_s": 0.5, "uy": 0.1, "Q": 0.3, "omega_s.i": 2.0, "delta": 1.0, "epsilon": 0.5},
    )
    assert [body.name for body in scene.bodies] == ["0", "1", "2"]
    assert [(c.left, c.right) for c in scene.contacts] == [("2", "0"), ("0", "1")]
    first, *others = (spring.law for spring in scene.springs)
    for law in others:
        # omega_s,i = omega_s,0 / 2 on the same mass, the rest equal (section 5).
        assert law.stiffness == pytest.approx(first.stiffness / 4.0, rel=1e-14)
        assert law.strength == pytest.approx(first.strength, rel=1e-15)
        assert law.yield_displacement == pytest.approx(first.yield_displacement, rel=1e-15)


def test_a_term_of_one_goes_before_that_of_all():
    terms = {"omega_s": 0.5, "omega_s.i": 2.0, "omega_s.2": 4.0, "delta": 1.0, "epsilon": 0.5}
    scene = PiStructure(Kind.ELASTIC, ("2", "0", "1")).scene(MOTION, terms)
    stiffness = [spring.law.stiffness for spring in scene.springs]
    assert np.array(stiffness) / stiffness[0] == pytest.approx([1.0, 1 / 4, 1 / 16], rel=1e-14)
    assert isinstance(scene.springs[0].law, Linear)


positive = st.floats(0.05, 20.0)
KEYS = ("omega_s", "uy", "Q", *(f"{t}.{i}" for t in ("m", "omega_s", "uy", "Q") for i in (1, 2)))


@given(
    terms=st.fixed_dictionaries(dict.fromkeys(KEYS, positive)),
    delta=positive,
    epsilon=st.floats(0.0, 1.0),
    a_g=st.floats(0.01, 100.0),
    omega_g=st.floats(0.01, 100.0),
)
def test_there_and_back(terms, delta, epsilon, a_g, omega_g):
    """A scene has the terms it was made of, whatever the ground motion."""
    given_terms = terms | {"delta": delta, "epsilon": epsilon}
    scene = TRIPLET.scene(Cosine(a_g, 2.0 * math.pi / omega_g), given_terms, mass=7.0)
    found = pi_terms(scene)
    expected = terms | {f"delta.{c}": delta for c in ("2-0", "0-1")}
    expected |= {f"epsilon.{c}": epsilon for c in ("2-0", "0-1")}
    assert found == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(
    ("row", "terms", "words"),
    [
        (("0", "barrier"), {"uy": 0.1}, ["Q: missing", "delta: missing", "epsilon: missing"]),
        (("0",), {"uy": 0.1, "Q": 1.0, "omega_s": 1.0}, ["omega_s: this structure has no such"]),
        (("0",), {"uy": 0.1, "Q": 1.0, "delta": 1.0}, ["delta: this structure has no such"]),
    ],
)
def test_terms_that_do_not_fit_are_named(row, terms, words):
    with pytest.raises(InputError) as caught:
        PiStructure(Kind.ELASTOPLASTIC, row).scene(MOTION, terms)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("row", [(), ("barrier",), ("1",), ("0", "0"), ("0", "barrier", "1")])
def test_rows_that_are_none(row):
    with pytest.raises(InputError, match="row: found"):
        PiStructure(Kind.ELASTIC, row)


def test_free_motion_has_no_scales():
    with pytest.raises(InputError, match="no scales"):
        PiStructure(Kind.ELASTIC, ("0",)).scene(NoMotion(), {"omega_s": 1.0})
