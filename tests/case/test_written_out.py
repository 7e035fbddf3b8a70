"""Buildings written out, forces as parts of a weight, and cases to begin with."""

from pathlib import Path

import numpy as np
import pytest

from eventpound import InputError, load_case, simulate
from eventpound.case import read_case, write_template
from eventpound.case.template import SCENES
from eventpound.cli import main
from eventpound.scene import GROUND, Body, BoucWen, Linear, Spring
from eventpound.scene.modes import modes_of
from eventpound.units import STANDARD_GRAVITY

PULSE = '[excitation]\nkind = "sine"\namplitude = "0.3 g"\nperiod = "0.5 s"\n'
FRAME = """
[[building]]
name = "A"
storeys = 3
mass = ["200 t", "180 t", "100 t"]
stiffness = "300 MN/m"
"""


def case_of(folder: Path, text: str):
    (folder / "case.toml").write_text(PULSE + text)
    return load_case(folder)


def test_a_building_is_its_bodies_and_springs(tmp_path):
    scene = case_of(tmp_path, FRAME + 'height = [4, "3.2 m", 3.2]\n').scene
    assert scene.bodies == tuple(
        Body(name, mass, structure="A") for name, mass in (("A1", 2e5), ("A2", 1.8e5), ("A3", 1e5))
    )
    ends = [GROUND, "A1", "A2", "A3"]
    assert scene.springs == tuple(
        Spring(f"storey-{ends[i + 1]}", (ends[i], ends[i + 1]), Linear(3e8), height)
        for i, height in enumerate((4.0, 3.2, 3.2))
    )
    assert scene.dashpots == ()


def test_a_part_of_the_weight_is_of_what_the_storey_carries(tmp_path):
    scene = case_of(tmp_path, FRAME + 'yield_force = ["0.2 W", "0.3 W", "500 kN"]\n').scene
    expected = [0.2 * 480e3 * STANDARD_GRAVITY, 0.3 * 280e3 * STANDARD_GRAVITY, 5e5]
    for spring, force in zip(scene.springs, expected, strict=True):
        law = BoucWen.from_yield(3e8, force, 0.05)
        assert spring.law.strength == pytest.approx(law.strength, rel=1e-14)
        assert spring.law.yield_displacement == pytest.approx(law.yield_displacement, rel=1e-14)


def test_its_damping_is_the_ratio_at_two_modes(tmp_path):
    scene = case_of(tmp_path, FRAME + 'ratio = "4 %"\nmodes = [1, 3]\n').scene
    damping = modes_of(scene, ["A1", "A2", "A3"]).damping
    assert damping[[0, 2]] == pytest.approx(0.04, rel=1e-12)
    one = FRAME.replace("storeys = 3", "storeys = 1").replace(
        '["200 t", "180 t", "100 t"]', '"200 t"'
    )
    single = case_of(tmp_path, one + "ratio = 0.05\n").scene
    assert modes_of(single, ["A1"]).damping == pytest.approx([0.05], rel=1e-12)


def test_buildings_stand_beside_bodies_and_are_understood(tmp_path):
    more = '[[body]]\nname = "wall"\nmass = 1e5\n[[contact]]\nbetween = ["A3", "wall"]\n'
    case = case_of(tmp_path, FRAME + more + "gap = 0.1\nrestitution = 0.5\n")
    assert [body.name for body in case.scene.bodies] == ["wall", "A1", "A2", "A3"]
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.scene == case.scene


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("storeys = 3", "storeys = 0", "[[building]] 1 (A): storeys: found 0; accepted: a whole"),
        ("storeys = 3\n", "", "storeys: missing; accepted: a whole number from 1 to 500"),
        ("storeys = 3", "storeys = 4", "mass: found ['200 t', '180 t', '100 t']; accepted: one"),
        ('"300 MN/m"', '"300 MN"', "stiffness: found '300 MN': 'MN' is no unit of stiffness"),
        ('"300 MN/m"', "0", "stiffness: found 0; accepted: positive values"),
        ('stiffness = "300 MN/m"', "", "stiffness: missing; accepted: a stiffness"),
        ("storeys = 3", "storeys = 3\nstorey = 2", "storey: unknown key, did you mean 'storeys'?"),
    ],
)
def test_what_is_wrong_is_said_of_the_building(tmp_path, old, new, said):
    with pytest.raises(InputError) as caught:
        case_of(tmp_path, FRAME.replace(old, new))
    assert str(caught.value).startswith(f"{tmp_path / 'case.toml'}: [[building]] 1 (A): ")
    assert said in str(caught.value)


SPRING = """
[[body]]
name = "deck"
mass = "100 t"
[[body]]
name = "top"
mass = "50 t"
[[spring]]
between = ["ground", "deck"]
law = "bouc-wen"
initial_stiffness = "90 MN/m"
hardening = 0.1
yield_force = "0.15 W"
"""


def test_a_spring_by_a_part_of_the_weight(tmp_path):
    for more, mass in (("", 1e5), ('of_mass = ["deck", "top"]\n', 1.5e5)):
        law = case_of(tmp_path, SPRING + more).scene.springs[0].law
        force = (law.stiffness + law.strength / law.yield_displacement) * law.yield_displacement
        assert force == pytest.approx(0.15 * mass * STANDARD_GRAVITY, rel=1e-14)
    between = SPRING.replace('["ground", "deck"]', '["deck", "top"]')
    with pytest.raises(InputError, match="a force, or of_mass beside it, whose weight W is"):
        case_of(tmp_path, between)


@pytest.mark.parametrize("scene", SCENES)
def test_cases_to_begin_with_run_without_a_doubt(scene, tmp_path):
    case = load_case(write_template(tmp_path / scene, scene))
    assert case.warnings == ()
    assert simulate(case, rtol=1e-6).impacts > 0


def test_a_case_to_begin_with_under_a_record(tmp_path, capsys):
    record = tmp_path / 'a "record".AT2'
    values = " ".join(f"{v:.6E}" for v in np.random.default_rng(0).normal(0.0, 0.1, 500))
    record.write_text(
        f"PEER\nEvent\nACCELERATION IN UNITS OF G\nNPTS= 500, DT= .0200 SEC\n{values}"
    )
    words = ["new", str(tmp_path / "case"), "--bridge", "--record", str(record)]
    assert main(words) == 0
    case = load_case(tmp_path / "case")
    assert case.scene.motion.kind == "record"
    assert len(case.scene.bodies) == 3
    assert main(["new", str(tmp_path / "x"), "--record", str(tmp_path / "none.AT2")]) == 2
    assert "none.AT2: no such file" in capsys.readouterr().err
