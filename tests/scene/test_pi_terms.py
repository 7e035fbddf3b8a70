"""Π-terms against numbers worked out by hand, and there and back."""

import math
from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eventpound.errors import InputError
from eventpound.motion.base import Scales
from eventpound.motion.free import NoMotion
from eventpound.scene import Body, BoucWen, Contact, Linear, Scene, Spring, Support
from eventpound.scene.parameters import number_places, with_values
from eventpound.scene.pi_columns import numbers_with_terms
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.scene.pi_terms import number_of_terms, of_all, pi_terms
from eventpound.units import registry


@dataclass(frozen=True)
class Scaled(NoMotion):
    """A motion of which only the scales matter."""

    a_g: float = 4.0
    omega_g: float = 10.0

    def scales(self):
        return Scales(self.a_g, self.omega_g)


def pair(motion=None):
    # L_e = 4 / 10^2 = 0.04 m
    return Scene(
        bodies=(Body("a", 1000.0), Body("b", 4000.0)),
        springs=(
            Spring("sa", ("ground", "a"), BoucWen(25_000.0, 800.0, 0.01)),
            Spring("sb", ("b", "ground"), Linear(400_000.0)),
            Spring("link", ("a", "b"), Linear(77.0)),
        ),
        contacts=(Contact("joint", "a", "b", 0.02, 0.7),),
        motion=Scaled() if motion is None else motion,
    )


def with_pi_terms(scene, terms):
    places = number_places(scene)
    numbers = numbers_with_terms(scene, terms)
    return with_values(scene, {places[key]: float(value) for key, value in numbers.items()})


def test_terms_of_a_pair():
    assert pi_terms(pair()) == pytest.approx(
        {
            "omega_s": 5.0 / 10.0,  # sqrt(25000 / 1000) over omega_g
            "uy": 0.01 / 0.04,
            "Q": 800.0 / (1000.0 * 4.0),
            "m.b": 0.25,
            "omega_s.b": 5.0 / 10.0,  # sqrt(400000 / 4000) = 10
            "delta": 0.5,
            "epsilon": 0.7,
        },
        rel=1e-15,
    )


def test_a_mass_whose_inertia_is_no_double():
    body, spring = Body("a", 5e-324), Spring("s", ("ground", "a"), BoucWen(2.0, 1e-9, 1e-11))
    assert pi_terms(Scene((body,), (spring,), motion=Scaled(a_g=1e-9)))["Q"] == math.inf


def test_other_oscillator_looked_at():
    terms = pi_terms(pair(), "b")
    assert terms["omega_s"] == pytest.approx(1.0, rel=1e-15)
    assert terms["m.a"] == pytest.approx(4.0, rel=1e-15)
    assert terms["omega_s.a"] == pytest.approx(2.0, rel=1e-15)
    assert terms["Q.a"] == pytest.approx(0.2, rel=1e-15)
    assert "uy" not in terms


def test_free_motion_has_only_scaleless_terms():
    assert set(pi_terms(pair(NoMotion()))) == {"m.b", "omega_s.b", "epsilon"}


def test_perfectly_plastic_oscillator():
    scene = Scene(
        (Body("a", 2.0),), (Spring("s", ("ground", "a"), BoucWen(0.0, 1.0, 0.1)),), motion=Scaled()
    )
    assert set(pi_terms(scene)) == {"omega_s", "uy", "Q"}
    assert pi_terms(scene)["omega_s"] == 0.0
    bilinear = with_pi_terms(scene, {"omega_s": 0.3})
    assert bilinear.springs[0].law.stiffness == pytest.approx(2.0 * 3.0**2, rel=1e-14)


def test_several_contacts_are_named():
    scene = replace(
        pair(), contacts=(Contact("l", "barrier", "a", 0.1, 0.5), Contact("r", "a", "b", 0.2, 0.6))
    )
    terms = pi_terms(scene)
    assert [terms[k] for k in ("delta.l", "epsilon.l", "delta.r", "epsilon.r")] == pytest.approx(
        [2.5, 0.5, 5.0, 0.6], rel=1e-15
    )


@given(length=st.floats(0.01, 100), time=st.floats(0.01, 100), mass=st.floats(0.01, 100))
def test_scaled_scene_has_the_same_terms(length, time, mass):
    """Buckingham: a change of units of length, time and mass changes no Π-term."""
    here = pair()
    law = here.springs[0].law
    scaled = replace(
        here,
        bodies=tuple(replace(b, mass=b.mass * mass) for b in here.bodies),
        springs=(
            replace(
                here.springs[0],
                law=replace(
                    law,
                    stiffness=law.stiffness * mass / time**2,
                    strength=law.strength * mass * length / time**2,
                    yield_displacement=law.yield_displacement * length,
                ),
            ),
            replace(here.springs[1], law=Linear(400_000.0 * mass / time**2)),
        ),
        contacts=(replace(here.contacts[0], gap=0.02 * length),),
        motion=Scaled(4.0 * length / time**2, 10.0 / time),
    )
    # Each term is some ten roundings away from its twin.
    assert pi_terms(scaled) == pytest.approx(pi_terms(here), rel=1e-14)


positive = st.floats(0.05, 20)


@given(
    terms=st.fixed_dictionaries(
        {},
        optional=dict.fromkeys(
            ("omega_s", "uy", "Q", "m.b", "omega_s.b", "delta", "epsilon"), positive
        ),
    )
)
def test_there_and_back(terms):
    """What is set is found again; what is not set keeps its value."""
    before = pi_terms(pair())
    after = pi_terms(with_pi_terms(pair(), terms))
    assert after == pytest.approx(before | terms, rel=1e-13)


def test_setting_keeps_what_no_term_describes():
    scene = with_pi_terms(pair(), {"m.b": 0.5})
    assert scene.bodies[1].mass == 2000.0
    assert scene.springs[2] == pair().springs[2]
    assert math.isclose(scene.springs[1].law.stiffness, 200_000.0, rel_tol=1e-14)


def test_without_scales_the_ratios_can_be_set():
    scene = with_pi_terms(pair(NoMotion()), {"omega_s.b": 1.0, "epsilon": 0.0})
    assert scene.springs[1].law.stiffness == pytest.approx(4000.0 * 25.0, rel=1e-14)
    assert scene.springs[0] == pair().springs[0]
    assert scene.contacts[0] == Contact("joint", "a", "b", 0.02, 0.0)


def test_unknown_terms_are_named_together():
    with pytest.raises(InputError) as caught:
        with_pi_terms(pair(), {"gap": 1.0, "uy.b": 1.0})
    assert len(caught.value.problems) == 2
    assert "'gap'" in caught.value.problems[0]
    assert "omega_s" in caught.value.problems[0]


def test_unknown_oscillator():
    with pytest.raises(InputError, match="bodies are a, b"):
        pi_terms(pair(), "c")


def on_piers(delays):
    scene = pair()
    return replace(
        scene,
        springs=tuple(
            replace(s, between=tuple("p0" if e == "ground" else e for e in s.between))
            for s in scene.springs
        ),
        supports=tuple(Support(f"p{i}", delay) for i, delay in enumerate(delays)),
    )


def test_terms_of_supports():
    terms = pi_terms(on_piers([0.3]))
    # Oscillators stand on a pier as they do on the ground.
    assert {k: v for k, v in terms.items() if k != "delay"} == pi_terms(pair())
    assert terms["delay"] == pytest.approx(0.3 * 10.0, rel=1e-15)
    several = on_piers([0.3, 0.1])
    assert pi_terms(several)["delay.p1"] == pytest.approx(1.0, rel=1e-15)
    assert "delay" not in pi_terms(several)
    own = replace(several, supports=(Support("p0", motion=Scaled()), several.supports[1]))
    assert pi_terms(own)["delay"] == pytest.approx(1.0, rel=1e-15)
    with pytest.raises(InputError, match=r"delay\.p0.*no such term"):
        with_pi_terms(own, {"delay.p0": 1.0})


def test_scenes_with_other_delays():
    scene = with_pi_terms(on_piers([0.3, 0.1]), {"delay.p1": 2.0, "delta": 0.25})
    assert [s.delay for s in scene.supports] == [0.3, 0.2]
    assert scene.contacts[0].gap == pytest.approx(0.01, rel=1e-15)
    assert of_all(scene, {"delay": 1.5}) == {"delay.p0": 1.5, "delay.p1": 1.5}
    assert pi_terms(scene)["delay.p1"] == pytest.approx(2.0, rel=1e-14)


OSCILLATOR = {"uy": 0.2, "Q": 0.3, "delta": 0.5, "epsilon": 0.7}
SEVERAL = OSCILLATOR | {"omega_s": 0.5, "omega_s.i": 2.0, "m.i": 0.5}


def dimensionless_products(oscillators):
    """How many Buckingham's theorem finds, by pint, for bilinear oscillators with one gap."""
    units = {"u_max": "m", "a_g": "m/s^2", "omega_g": "1/s", "delta": "m"}
    for i in range(oscillators):
        units |= {f"m{i}": "kg", f"omega_s{i}": "1/s", f"uy{i}": "m", f"Q{i}": "N"}
    return len(registry().pi_theorem({name: registry().Unit(unit) for name, unit in units.items()}))


@pytest.mark.parametrize(("row", "count"), [(("0", "1"), 10), (("1", "0", "2"), 14)])
def test_number_of_terms_of_several_oscillators(row, count):
    """4n + 2 terms govern n bilinear oscillators (section 5); epsilon is one of them."""
    scene = PiStructure(Kind.BILINEAR, row).scene(Scaled(), SEVERAL, 1000.0)
    assert number_of_terms(scene) == count == dimensionless_products(len(row)) + 1


def test_five_terms_govern_an_elastoplastic_oscillator_beside_a_barrier():
    """Section 3: seven variables, two dimensions; one more with a post-yield stiffness."""
    structure = PiStructure(Kind.ELASTOPLASTIC, ("0", "barrier"))
    scene = structure.scene(Scaled(), OSCILLATOR, 1000.0)
    assert number_of_terms(scene) == 5
    (spring,) = scene.springs
    bilinear = replace(spring, law=replace(spring.law, stiffness=1.0))
    assert number_of_terms(replace(scene, springs=(bilinear,))) == 6
