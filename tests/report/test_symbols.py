"""Every column that a study can draw is called what it is, with its unit."""

from functools import cache

import numpy as np
import pytest
from matplotlib.mathtext import MathTextParser

from eventpound.motion import AntisymmetricRicker, Harmonic, MavroeidisPapageorgiou, Record, TypeC
from eventpound.motion.base import GroundMotion
from eventpound.report.symbols import axis_label, display_unit, symbol, value_label
from eventpound.results.shown_units import Unit
from eventpound.scene import (
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
from eventpound.scene.parameters import dimension_of_number, number_places
from eventpound.study.plan import quantities_of
from eventpound.units import STANDARD_GRAVITY

MOTIONS: list[GroundMotion] = [
    Harmonic(1.0, 1.0, cycles=3.0),
    TypeC(1.0, 1.0),
    AntisymmetricRicker(1.0, 1.0),
    MavroeidisPapageorgiou(1.0, 1.0),
    Record(np.array([0.0, 1.0, 0.0]), 0.1),
]


# A key has the same label under every motion, and to parse one takes long.
parsed = cache(MathTextParser("path").parse)
NAME = "deck 1.5 _$^{%"


def scene(motion: GroundMotion) -> Scene:
    """All kinds of elements, one with dots and a dollar in its name."""
    stop = BilinearElastic(1.0, 2.0)
    return Scene(
        (Body("A5", 1.0), Body(NAME, 1.0)),
        (
            Spring("pier2", (GROUND, "A5"), BoucWen(1.0, 1.0, 1.0)),
            Spring("stop", ("A5", NAME), Series((Linear(1.0), stop))),
            Spring("bearing", (GROUND, NAME), stop),
        ),
        (Dashpot((GROUND, "A5"), 1.0), Dashpot((GROUND, "A5"), 1.0)),
        (Contact("floor5", "A5", NAME, 0.1, 0.5),),
        motion,
    )


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.kind)
def test_no_column_is_shown_as_its_key(motion):
    assert all(dimension_of_number(key) is not None for key in number_places(scene(motion)))
    for key in quantities_of(scene(motion)):
        label = axis_label(key)
        assert key not in label or key in ("impacts", "amplification")
        parsed(label)


@pytest.mark.parametrize(
    ("key", "label"),
    [
        ("peaks.A5.abs_max", "$u_{max}$ of A5 (m)"),
        ("peaks.A5.t_abs_max", "time of the peak displacement of A5 (s)"),
        ("base_shear.abs_max", "peak base shear (N)"),
        ("base_shear.min", "least base shear (N)"),
        ("acceleration.A5.abs_max", "peak absolute acceleration of A5 (m/s²)"),
        ("free.acceleration.A5.max", "greatest absolute acceleration of A5 without contact (m/s²)"),
        ("springs.pier2.abs_max_elongation", "peak elongation of pier2 (m)"),
        ("springs.pier2.ductility", "ductility of pier2"),
        ("contacts.floor5.smallest_gap", "smallest gap of floor5 (m)"),
        ("contact.floor5.gap", "gap of floor5 (m)"),
        ("spring.stop.parts.1.stiffness", "stiffness of stop, part 1 (N/m)"),
        ("dashpot.ground-A5.2.coefficient", "damping coefficient of ground-A5.2 (N s/m)"),
        ("final.A5.v", "final velocity of A5 (m/s)"),
        ("u_max.A5", "$u_{max}$ of A5 (m)"),
        ("free.u_max", "$u_{max}$ without contact (m)"),
        ("T_s", "$T_s$ (s)"),
        ("excitation.pga", "PGA (m/s²)"),
        ("amplification.A5", "peak with contact / without of A5"),
        ("free.pi_um", r"$\Pi_{um} = u_{max}\,\omega_g^2/a_g$"),
        ("excitation.file", "excitation.file"),
    ],
)
def test_labels(key, label):
    assert axis_label(key) == label


def test_values_in_a_legend():
    assert value_label("contact.floor5.gap", 0.0063591) == "gap of floor5 = 0.6359 cm"
    assert value_label("contact.floor5.restitution", 0.6) == r"$\epsilon$ of floor5 = 0.6"
    assert symbol("contact.floor5.gap") == "gap of floor5"
    assert value_label("pi.row", 2) == "pi.row = 2"


def test_units_that_are_easy_to_read():
    assert display_unit("excitation.psa", 4.0) == Unit("g", STANDARD_GRAVITY)
    assert display_unit("free.acceleration.A5.max", 4.0).name == "g"
    # A strength over a mass is an acceleration, but none of the ground or a floor.
    assert display_unit("Q/m", 4.0) == Unit("m/s²", 1.0)
    assert display_unit("contacts.floor5.smallest_gap", -0.02) == Unit("cm", 0.01)
    assert display_unit("base_shear.max", 2e6) == Unit("kN", 1e3)
    assert display_unit("spring.stop.parts.1.stiffness", 4e7) == Unit("MN/m", 1e6)
    assert display_unit("contacts.floor5.sum_impulse", 5e2) == Unit("N s", 1.0)
    assert display_unit("body.A5.mass", 5e5) == Unit("t", 1e3)
    assert axis_label("Sa_T1", display_unit("Sa_T1", 4.0)) == "$S_a(T_1)$ (g)"
    assert axis_label("PGV") == "PGV (m/s)"
    assert display_unit("impacts", 3.0) == Unit("", 1.0)
    assert axis_label("excitation.pga", Unit("g", STANDARD_GRAVITY)) == "PGA (g)"
