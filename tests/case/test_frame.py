"""Frames read from files in every form, and joints of buildings from their heights."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eventpound import Case, Contact, Linear, Point, frame, load_case, modal_damping, rayleigh
from eventpound.case import read_case
from eventpound.cli import main
from eventpound.scene.modes import modes_of

PULSE = '[excitation]\nkind = "sine"\namplitude = "0.3 g"\nperiod = "0.5 s"\n'
K = np.array([[126e6, -69e6, 12e6], [-69e6, 104e6, -51e6], [12e6, -51e6, 41e6]])
M = np.array([45e3, 45e3, 40e3])
C = 0.4 * np.diag(M) + 0.003 * K
FRAME = """
[[frame]]
name = "T"
stiffness = "K.csv"
mass = "M.csv"
"""


def case_of(folder: Path, text: str) -> Case:
    (folder / "case.toml").write_text(PULSE + text)
    return load_case(folder)


def lines(rows: np.ndarray, part: str = ",") -> str:
    return "".join(part.join(map(repr, row)) + "\n" for row in np.atleast_2d(rows).tolist())


NAMED = "floor,a,b,c\n" + "".join(f"{n},{lines(row)}" for n, row in zip("abc", K, strict=True))


def files(folder: Path) -> None:
    (folder / "K.csv").write_text(lines(K))
    (folder / "M.csv").write_text(lines(M))
    (folder / "C.csv").write_text(lines(C))


def test_a_case_has_the_frame_that_python_makes(tmp_path):
    files(tmp_path)
    case = case_of(tmp_path, FRAME + 'damping = "C.csv"\n')
    parts = frame("T", K, M, C)
    assert case.scene.bodies == parts.bodies
    assert case.scene.springs == parts.springs
    assert case.scene.dashpots == parts.dashpots
    again = read_case(case.understood, tmp_path / "again.toml")
    assert (again.scene.springs, again.scene.dashpots) == (parts.springs, parts.dashpots)


def test_units_and_names_are_those_of_the_case(tmp_path):
    # The masses stand in another order than the rows; numbers without a unit are in the units.
    rows = "".join(f"{n},{lines(row)}" for n, row in zip("abc", K / 1e3, strict=True))
    (tmp_path / "K.csv").write_text(f"-,a,b,c\n{rows}")
    (tmp_path / "M.csv").write_text("c,40\na,45\nb,45\n")
    units = 'units = { stiffness = "kN/m", mass = "t" }\n'
    case = case_of(tmp_path, FRAME + units)
    assert [(body.name, body.mass) for body in case.scene.bodies] == [
        (name, pytest.approx(mass)) for name, mass in zip("abc", M, strict=True)
    ]
    assert sum(s.law.stiffness for s in case.scene.springs if s.between[0] == "ground") == (
        pytest.approx(K.sum(), rel=1e-12)
    )
    inline = case_of(
        tmp_path,
        FRAME.replace('"M.csv"', '[45, "45000 kg", 40]') + 'names = ["a", "b", "c"]\n' + units,
    )
    assert inline.scene.springs == case.scene.springs
    assert [body.mass for body in inline.scene.bodies] == pytest.approx(M, rel=1e-15)


@pytest.mark.parametrize("how", ["rayleigh", "modal"])
def test_a_ratio_is_that_of_its_modes(how, tmp_path):
    files(tmp_path)
    scene = case_of(tmp_path, FRAME + f'ratio = 0.04\ndamping = "{how}"\n').scene
    names = ["T1", "T2", "T3"]
    damping = modes_of(scene, names).damping
    assert damping[: 2 if how == "rayleigh" else 3] == pytest.approx(0.04, rel=1e-9)
    parts = frame("T", K, M)
    made = (
        rayleigh(parts.bodies, parts.springs, 0.04, modes=(1, 2))
        if how == "rayleigh"
        else modal_damping(parts.bodies, parts.springs, 0.04)
    )
    assert scene.dashpots == made


SLAB = """
[[body]]
name = "slab"
mass = "90 t"
[[spring]]
name = "bearing"
between = ["ground", "slab"]
law = "slider"
friction = 0.05
normal_force = "1.0 W"
of_mass = ["slab", "A1", "A2"]
radius = 2.0
[[building]]
name = "A"
on = "slab"
storeys = 2
mass = "50 t"
stiffness = "90 MN/m"
height = 3.0
ratio = "3 %"
"""


def test_a_building_stands_on_a_slab(tmp_path):
    scene = case_of(tmp_path, SLAB).scene
    assert [(s.name, s.between) for s in scene.springs] == [
        ("bearing", ("ground", "slab")),
        ("storey-A1", ("slab", "A1")),
        ("storey-A2", ("A1", "A2")),
    ]
    assert scene.springs[0].law.normal_force == pytest.approx(190e3 * 9.80665)
    # Its ratio is modal, of the modes that it has on a slab that stands still; no dashpot of it
    # is between a floor and the ground.
    assert all("ground" not in dashpot.between for dashpot in scene.dashpots)
    fixed = case_of(
        tmp_path,
        SLAB.partition("[[building]]")[2].join(["[[building]]", ""]).replace('on = "slab"\n', "")
        + 'damping = "modal"\n',
    ).scene
    assert [d.coefficient for d in scene.dashpots] == [d.coefficient for d in fixed.dashpots]


BUILDINGS = """
[[building]]
name = "A"
storeys = 3
mass = "50 t"
stiffness = "90 MN/m"
height = 3.0
[[building]]
name = "B"
storeys = 2
mass = "50 t"
stiffness = "90 MN/m"
height = [4.0, 2.0]
"""
JOINT = '[[contact]]\nbetween_buildings = ["A", "B"]\ngap = "2 cm"\nrestitution = 0.5\n'


def contact(name: str, left: Any, right: Any) -> Contact:
    return Contact(name, left, right, 0.02, 0.5)


def test_contacts_of_two_buildings_follow_from_their_heights(tmp_path):
    # A has floors at 3, 6 and 9 m, B at 4 and 6: the third of A is above B.
    at_3, at_4 = {"ground": 0.25, "B1": 0.75}, {"A1": 1.0 - 1.0 / 3.0, "A2": 1.0 / 3.0}
    assert case_of(tmp_path, BUILDINGS + JOINT).scene.contacts == (
        contact("A1-ground+B1", "A1", Point(at_3)),
        contact("A1+A2-B1", Point(at_4), "B1"),
        contact("A2-B2", "A2", "B2"),
    )
    roof = case_of(tmp_path, BUILDINGS + JOINT + 'at = "roof"\ncapacity = { gap = 0.1 }\n')
    assert roof.scene.contacts == (contact("A2-B2", "A2", "B2"),)
    assert roof.run.stated.capacities == (("contacts.A2-B2.separation_needed", 0.1),)
    lower = BUILDINGS.replace("[4.0, 2.0]", "2.0")
    roof = case_of(tmp_path, lower + JOINT + 'at = "roof"\n')
    assert roof.scene.contacts == (contact("A1+A2-B2", Point(at_4), "B2"),)


def test_a_frame_with_levels_is_a_building(tmp_path):
    files(tmp_path)
    text = BUILDINGS + FRAME + "levels = [4, 8, 12]\n" + JOINT.replace('["A", "B"]', '["T", "B"]')
    assert case_of(tmp_path, text).scene.contacts == (
        contact("T1-B1", "T1", "B1"),
        contact("T1+T2-B2", Point({"T1": 0.5, "T2": 0.5}), "B2"),
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.replace("M.csv", "N.csv"), "(T): mass: file: found 'N.csv', but there is no"),
        (lambda t: t + "damping = 3\n", "(T): damping: found 3; accepted: a file (.csv, .npy"),
        (lambda t: t + 'damping = "C.csv"\nratio = 0.05\n', "ratio: found 0.05; accepted: none"),
        (lambda t: t + 'damping = "modal"\n', "(T): ratio: missing; accepted: the ratio of its"),
        (lambda t: t + 'units = { mass = "kN" }\n', "(T): units.mass: found '1 kN'"),
        (lambda t: t + 'units = { force = "kN" }\n', "(T): units.force: unknown key"),
        (lambda t: t + 'names = ["a", "b"]\n', "(T): names: found 2 for 3 rows of stiffness"),
        (lambda t: t + "levels = [3, 2, 4]\n", "(T): levels: found 3, 2, 4; accepted: 3 heights"),
        (lambda t: t + "levels = 3\n", "(T): levels: found 3; accepted: a list of heights"),
        (lambda t: t + 'on = "raft"\n', "between: found ['raft', 'T1']; accepted: two different"),
        (lambda t: t + "height = 3\n", "(T): height: unknown key"),
        (lambda t: BUILDINGS + JOINT.replace('"B"', '"D"'), "accepted: two buildings with heights"),
        (lambda t: BUILDINGS + JOINT + 'at = "foot"\n', "at: found 'foot'"),
        (lambda t: BUILDINGS + JOINT + 'name = "j"\n', "name: found 'j'; accepted: none beside"),
        (
            lambda t: SLAB.replace('ratio = "3 %"', 'ratio = 0.03\ndamping = "rayleigh"'),
            "damping: found 'rayleigh'; accepted: one of modal",
        ),
    ],
    ids=range(15),
)
def test_what_is_wrong_is_told(change, said, tmp_path, capsys):
    files(tmp_path)
    (tmp_path / "case.toml").write_text(PULSE + change(FRAME))
    assert main(["check", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "results").exists()


def test_a_table_of_inputs_has_the_frame_in_a_row(tmp_path, capsys):
    files(tmp_path)
    case_of(tmp_path, FRAME)
    assert main(["check", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "frame  couplings  to what it stands on" in out
    assert "T1-T2" not in out
    assert "T1 and damping: frame T\n" in out


def test_springs_are_linear_and_marked(tmp_path):
    files(tmp_path)
    scene = case_of(tmp_path, FRAME).scene
    assert all(isinstance(spring.law, Linear) and spring.frame == "T" for spring in scene.springs)
