"""A scene as OpenSees's elements, and what is refused; OpenSees itself is not needed."""

import math

import pytest

from eventpound.errors import InputError
from eventpound.mechanics.model import assemble
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
)
from eventpound.solvers.opensees.elements import contact_choice, contact_material, elements_of

BOUC_WEN = BoucWen(2.0, 3.0, 0.5, exponent=4.0, beta=0.3, gamma=0.7)


def _scene(**changes):
    parts = {
        "bodies": (Body("a", 2.0), Body("b", 6.0)),
        "springs": (
            Spring("s", (GROUND, "a"), BOUC_WEN),
            Spring("t", ("a", "b"), Linear(5.0)),
            Spring(
                "w", ("b", GROUND), Series((Linear(4.0), BilinearElastic(4.0, 0.0, 0.1)))
            ),
        ),
        "dashpots": (Dashpot((GROUND, "a"), 0.25), Dashpot((GROUND, "b"), 0.5)),
        "contacts": (Contact("c", "a", "b", 0.1, 0.5), Contact("d", "b", BARRIER, 0.2, 0.5)),
    }  # fmt: skip
    return Scene(**(parts | changes))


def _elements(scene, settings=None):
    choice = contact_choice(settings or {"contact_stiffness": 100.0})
    return elements_of(scene, assemble(scene), choice, 0.01)


def test_nodes_and_order():
    found = _elements(_scene())
    ends = [(element.first, element.second) for element in found]
    # Springs, the dashpots beside two of them, contacts; 1 is the ground.
    assert ends == [(1, 2), (2, 3), (3, 1), (1, 2), (3, 1), (2, 3), (3, 1)]
    assert [e.material[0] for e in found] == [
        "BoucWen", "Elastic", "ElasticMultiLinear", "Viscous", "Viscous",
        "ViscoelasticGap", "ViscoelasticGap",
    ]  # fmt: skip
    assert found[3].material == ("Viscous", 0.25, 1.0)


def test_bouc_wen_parameters():
    """F = k x + Q z in OpenSees's terms: a spring K_0 = k + Q/u_y, its z a length u_y z."""
    name, alpha, initial, n, gamma, beta, *rest = _elements(_scene())[0].material
    assert (name, n, rest) == ("BoucWen", 4.0, [1.0, 0.0, 0.0, 0.0])
    assert alpha * initial == pytest.approx(2.0)
    assert (1.0 - alpha) * initial * 0.5 == pytest.approx(3.0)
    assert gamma * 0.5**4 == pytest.approx(0.7)
    assert beta * 0.5**4 == pytest.approx(0.3)


def test_an_elastic_law_with_a_kink():
    """Slack above 0.1, 2 N/m (4 and 4 in series) below."""
    _, _, *numbers = _elements(_scene())[2].material
    strain, stress = numbers[:3], numbers[4:]
    assert numbers[3] == "-stress"
    assert strain[1] == 0.1
    assert stress[1] == stress[2] == 0.0
    assert stress[0] / (strain[0] - strain[1]) == pytest.approx(2.0)


def test_kelvin_voigt_has_the_damping_of_the_restitution():
    """A half-wave of m x'' + c x' + k x = 0 from x = 0 gives back exp(-π ζ / sqrt(1 - ζ²))."""
    choice = contact_choice({"contact_stiffness": 100.0})
    _, k, c, gap = contact_material(choice, 1.5, 0.5, 0.1, 0.01)
    zeta = c / (2.0 * math.sqrt(k * 1.5))
    assert math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)) == pytest.approx(0.5)
    assert (k, gap) == (100.0, -0.1)


def test_effective_masses_and_the_default_stiffness():
    """1.5 kg for 2 kg against 6 kg, 6 kg at the barrier; half a wave lasts 20 steps."""
    pair, barrier = _elements(_scene(), {"contact": "linear"})[-2:]
    for element, mass in ((pair, 1.5), (barrier, 6.0)):
        assert math.pi / math.sqrt(element.material[1] / mass) == pytest.approx(20 * 0.01)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"contact": "linear", "contact_stiffness": 9.0}, "ElasticPPGap"),
        ({"contact": "hertz", "contact_stiffness": 9.0}, "Hertzdamp"),
        ({"contact": "hertz-damp", "contact_stiffness": 9.0}, "Hertzdamp"),
        ({"contact": "jankowski", "contact_stiffness": 9.0}, "JankowskiImpact"),
        ({"contact": "impact", "contact_stiffness": 9.0, "indentation": 0.01}, "ImpactMaterial"),
    ],
)
def test_contact_materials(settings, name):
    material = _elements(_scene(), settings)[-2].material
    assert material[0] == name
    assert -0.1 in material


def test_impact_material_loses_what_restitution_loses():
    """A bilinear loop from 0 to d_m encloses (K_1 - K_2) d_y (d_m - d_y)."""
    choice = contact_choice({"contact": "impact", "contact_stiffness": 9.0, "indentation": 0.01})
    _, first, second, yields, _ = contact_material(choice, 1.0, 0.6, 0.1, 0.01)
    loop = (first - second) * -yields * (0.01 + yields)
    assert loop == pytest.approx(0.4 * 9.0 * 0.01**2.5 * (1.0 - 0.6**2))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"contact": "glue"}, "contact = 'glue'; accepted: linear, kelvin-voigt"),
        ({"contact": "hertz"}, "contact = 'hertz' needs contact_stiffness"),
        ({"contact": "impact", "contact_stiffness": 1.0}, "needs indentation"),
        ({"contact_stiffness": -1.0}, "contact_stiffness = -1.0; accepted: a positive number"),
        ({"contact_stiffness": "stiff"}, "contact_stiffness = 'stiff'"),
    ],
)
def test_settings_that_are_refused(settings, message):
    with pytest.raises(InputError, match=message.replace("(", r"\(")):
        contact_choice(settings)


@pytest.mark.parametrize(
    ("law", "bodies", "message"),
    [
        (BoucWen(1.0, 1.0, 0.5, initial_z=0.1), None, "starts from z = 0"),
        (BOUC_WEN, (Body("a", 1.0, 0.1),), "starts from no elongation"),
        (BoucWen(1.0, 1.0, 1e-16), None, "too large a number"),
    ],
)
def test_scenes_that_are_refused(law, bodies, message):
    scene = _scene(
        bodies=bodies or (Body("a", 1.0),), springs=(Spring("s", (GROUND, "a"), law),),
        dashpots=(), contacts=(),
    )  # fmt: skip
    with pytest.raises(InputError, match=f"solver = 'opensees': spring s: .*{message}"):
        _elements(scene)


def test_a_negative_dashpot_is_refused():
    scene = _scene(dashpots=(Dashpot((GROUND, "a"), 0.5), Dashpot(("a", "b"), -0.1)))
    with pytest.raises(InputError, match="dashpot a - b: its Viscous material is not negative"):
        _elements(scene)
