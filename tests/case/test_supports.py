"""Supports and forces in a case: read, understood again, and refused in one message."""

import math
from pathlib import Path

import numpy as np
import pytest

from eventpound.case import Case, read_case
from eventpound.case.supports import read_force
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion import Cosine, Record
from eventpound.motion.constant import Constant, PhasedSine
from eventpound.scene import Body, Contact, Dashpot, Linear, Scene, Support
from eventpound.scene.check import check_scene

Table = dict[str, object]
PULSE: Table = {"kind": "sine", "amplitude": 1.0, "period": 1.0}
PIER: Table = {"name": "pier", "delay": "0.12 s"}
BODIES: list[Table] = [{"name": "a", "mass": 2.0}, {"name": "b", "mass": 3.0}]


def case_with(directory: Path = Path(), **tables: object) -> Case:
    document: Table = {"excitation": PULSE, "body": BODIES, "support": [PIER], **tables}
    return read_case(document, directory / "case.toml")


def problems(directory: Path = Path(), **tables: object) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        case_with(directory, **tables)
    return tuple(caught.value.problems)


def test_a_support_is_an_end():
    case = case_with(
        spring=[{"between": ["pier", "a"], "law": "linear", "period": 2.0}],
        dashpot=[{"between": ["a", "pier"], "ratio": "5 %"}],
        contact=[{"between": ["b", "pier"], "gap": 0.1, "restitution": 0.5}],
    )
    (pier,) = case.scene.supports
    assert (pier.name, pier.delay, pier.motion) == ("pier", 0.12, None)
    k = 2.0 * (2.0 * math.pi / 2.0) ** 2
    (spring,) = case.scene.springs
    assert spring.name == "pier-a"
    assert spring.law == Linear(k)
    c = 2.0 * 0.05 * math.sqrt(2.0 * k)
    (dashpot,) = case.scene.dashpots
    assert dashpot == Dashpot(("a", "pier"), dashpot.coefficient)
    assert dashpot.coefficient == pytest.approx(c, rel=1e-14)
    again = read_case(case.understood, Path("case.toml"))
    assert again.scene == case.scene


def test_rayleigh_damping_from_a_support():
    case = case_with(
        spring=[{"between": ["pier", "a"], "law": "linear", "stiffness": 8.0}],
        rayleigh=[
            {"bodies": ["a"], "support": "pier", "mass_coefficient": 0.3,
             "stiffness_coefficient": 0.1},
        ],
    )  # fmt: skip
    mass, stiffness = case.scene.dashpots
    assert (mass.between, mass.coefficient) == (("pier", "a"), 0.3 * 2.0)
    assert (stiffness.between, stiffness.coefficient) == (("pier", "a"), 0.1 * 8.0)


def test_a_motion_of_its_own():
    own = {"kind": "cosine", "amplitude": "0.2 g", "period": 0.5, "start": 0.1}
    case = case_with(support=[{"name": "pier", "excitation": own}])
    (pier,) = case.scene.supports
    assert pier.motion == Cosine(0.2 * 9.80665, 0.5, start=0.1)
    # Four periods after the last motion.
    assert case.run.duration == pytest.approx(1.0 + 4.0)
    assert read_case(case.understood, Path("case.toml")).scene == case.scene


def test_forces(tmp_path):
    (tmp_path / "push.csv").write_text("t, p\n0.5, 1.0\n0.6, 3.0\n0.7, -2.0\n")
    case = case_with(
        tmp_path,
        force=[
            {"bodies": ["a", "b"], "value": "-9.81 m/s^2"},
            {"body": "a", "value": "2 kN"},
            {"body": "b", "kind": "half-sine", "amplitude": 3.0, "period": 0.4, "phase": "90 deg"},
            {"body": "b", "file": "push.csv", "reverse": True},
        ],
    )
    weight, also, constant, pulse, record = case.scene.forces
    assert [f.body for f in case.scene.forces] == ["a", "b", "a", "b", "b"]
    assert weight.history == also.history == Constant(-9.81)
    assert (weight.per_mass, constant.per_mass) == (True, False)
    assert constant.history == Constant(2000.0)
    assert pulse.history == PhasedSine(3.0, 0.4, phase=math.pi / 2.0, cycles=0.5)
    assert np.array_equal(record.history.values, [-1.0, -3.0, 2.0])
    assert record.history.start == 0.5
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.understood == case.understood


@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("t,p\n", "no line of numbers"),
        ("0,1\n1,2\n3,1\n", "line 3: the time step is not even: found 2 s, expected 1 s"),
        ("0,1\n0,2\n", "does not increase"),
        ("0,1\n1,x\n", "line 2"),
        ("0,1,2\n1,1,2\n", "accepted"),
        ("0,1\n1,inf\n", "finite"),
    ],
)
def test_files_of_forces_that_are_none(tmp_path, text, holds):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(InputError, match=holds):
        read_force(tmp_path / "p.csv")


BETWEEN = {"law": "linear", "stiffness": 1.0}
BROKEN: list[tuple[str, Table, tuple[str, ...]]] = [
    ("named like a body", {"support": [{"name": "a", "delay": 0.1}]},
     ("[[support]] 1 (a): name: found 'a'", "no body")),
    ("named ground", {"support": [{"name": "ground", "delay": 0.1}]},
     ("[[support]] 1 (ground): name", "barrier")),
    ("twice", {"support": [PIER, PIER]}, ("[[support]] 2 (pier): name", "of its own")),
    ("delay and excitation", {"support": [{**PIER, "excitation": PULSE}]},
     ("[[support]] 1 (pier): delay: found beside excitation",)),
    ("neither", {"support": [{"name": "pier"}]}, ("[[support]] 1 (pier): delay: missing",)),
    ("negative delay", {"support": [{"name": "pier", "delay": -0.1}]},
     ("[[support]] 1 (pier): delay: found -0.1", "not negative")),
    ("a suite of its own",
     {"support": [{"name": "pier", "excitation": {"kind": "record", "suite": "*.AT2"}}]},
     ("[[support]] 1 (pier): excitation.suite", "suite in [excitation]")),
    ("no such file",
     {"support": [{"name": "pier", "excitation": {"kind": "record", "file": "none.AT2"}}]},
     ("[[support]] 1 (pier)", "none.AT2", "no file")),
    ("two fixed ends", {"spring": [{"between": ["ground", "pier"], **BETWEEN}]},
     ("[[spring]] 1: between: found ['ground', 'pier']", "a body")),
    ("an unknown end", {"spring": [{"between": ["a", "peer"], **BETWEEN}]},
     ("[[spring]] 1: between", "ground, pier")),
    ("an unknown key", {"support": [{**PIER, "dalay": 1}]},
     ("[[support]] 1 (pier): dalay: unknown key, did you mean 'delay'?",)),
    ("penetrated by a support",
     {"run": {"start_time": 0.9}, "contact":
      [{"between": ["a", "pier"], "gap": 0.0, "restitution": 0.5}]},
     ("[[contact]] 1: gap", "penetrated")),
    ("a force on nothing", {"force": [{"body": "c", "value": 1.0}]},
     ("[[force]] 1: body: found 'c'", "a, b")),
    ("a force of no kind", {"force": [{"body": "a"}]},
     ("[[force]] 1: value: found none of value, file, kind",)),
    ("two kinds of force", {"force": [{"body": "a", "value": 1.0, "kind": "sine"}]},
     ("[[force]] 1: value: found value and kind",)),
    ("a force in metres", {"force": [{"body": "a", "value": "3 m"}]},
     ("[[force]] 1: value: found '3 m'", "-9.81 m/s^2")),
    ("a force without a period", {"force": [{"body": "a", "kind": "sine", "amplitude": 1.0}]},
     ("[[force]] 1: period: missing",)),
    ("a force file that is not there", {"force": [{"body": "a", "file": "p.csv"}]},
     ("[[force]] 1: file", "no file")),
    ("Rayleigh damping from nowhere",
     {"rayleigh": [{"bodies": ["a"], "support": "peer", "mass_coefficient": 0.1}]},
     ("[[rayleigh]] 1: support: found 'peer'", "pier")),
]  # fmt: skip


@pytest.mark.parametrize(("tables", "holds"), [x[1:] for x in BROKEN], ids=[x[0] for x in BROKEN])
def test_one_message(tables, holds):
    (problem,) = problems(**tables)
    for part in holds:
        assert part in problem


@pytest.mark.parametrize("delay", [math.nan, -1.0])
def test_a_delay_that_is_none_is_the_only_problem(delay):
    """The gap beside it is not judged by where the support would stand."""
    record = Record(np.array([0.0, 1.0, 0.0]), 0.1)
    contacts = (Contact("joint", "pier", "a", 0.0, 0.5),)
    with pytest.raises(InputError, match="delay: found") as refused:
        check_scene(
            Scene(
                (Body("a", 1.0),),
                contacts=contacts,
                motion=record,
                supports=(Support("pier", delay),),
            )
        )
    assert len(refused.value.problems) == 1


def test_warnings():
    drifting = Record(np.full(11, 1.0), 0.1)
    case = case_with(
        support=[
            {"name": "late", "delay": 50.0},
            {"name": "off", "excitation": {"kind": "harmonic", "amplitude": 1.0, "period": 1.0,
                                           "cycles": 0.5}},
        ],
        run={"duration": 5.0},
    )  # fmt: skip
    late, off, *unused = case.warnings
    assert all("'late'" in doubt for doubt in unused)
    assert "late" in late
    assert "50 s" in late
    # Half a period leaves a_p T_p/π; a whole sine pulse leaves nothing.
    assert f"{1.0 / math.pi:.3g} m/s" in off
    assert "processing" in off
    assert drifting.velocity(np.array(1.0)) == pytest.approx(1.0)


def test_check_shows_them(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(
        '[excitation]\nkind = "sine"\namplitude = 1.0\nperiod = 1.0\n'
        '[[body]]\nname = "a"\nmass = 2.0\n'
        '[[support]]\nname = "pier"\ndelay = 0.25\n'
        '[[spring]]\nbetween = ["pier", "a"]\nlaw = "linear"\nstiffness = 20.0\n'
        '[[force]]\nbody = "a"\nvalue = "-9.81 m/s^2"\n'
    )
    assert main(["check", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "pier     sine" in out
    assert "0.25" in out
    assert "constant" in out
    assert "19.62" in out


def test_titles_of_forces_say_their_units(tmp_path):
    rows = "".join(f"{1000.0 * i / 512.0:.1f}\t{i % 7}\n" for i in range(100))
    (tmp_path / "p.txt").write_text("t [ms]\tF [kN]\n" + rows)
    start, step, force = read_force(tmp_path / "p.txt")
    assert (start, step) == (0.0, 1.0 / 512.0)
    assert force[:3].tolist() == [0.0, 1000.0, 2000.0]
    (tmp_path / "p.txt").write_text("t [ms]\ta [cm/s2]\n" + rows)
    with pytest.raises(InputError, match=r"'a \[cm/s2\]' is no force but an acceleration"):
        read_force(tmp_path / "p.txt")


@pytest.mark.parametrize(
    "title", ["t [s],Fx (kN)", "t,wind_kN", "Zeit,Kraft [kN]", "# force in kN", "# units: kN"]
)
def test_forces_of_any_name_have_their_unit(tmp_path, title):
    rows = "".join(f"{0.01 * i:.2f},{i % 7}\n" for i in range(100))
    (tmp_path / "p.txt").write_text(f"{title}\n{rows}")
    _, step, force = read_force(tmp_path / "p.txt")
    assert step == 0.01
    assert force[:3].tolist() == [0.0, 1000.0, 2000.0]


@pytest.mark.parametrize(
    ("before", "mark", "message"),
    [
        ("t,Moment [kNm]\n", ",", r"'Moment \[kNm\]' states no unit of a force"),
        ("100 0.02\n", " ", "line 1: a time step of 0.02 s is stated, column 1 has one of 0.01 s"),
        ("", "\t0,", "decimal commas"),
        ("PK\x03\x04", ",", "a zip archive .*; times and forces are needed"),
    ],
)
def test_forces_that_are_refused(tmp_path, before, mark, message):
    rows = "".join(f"{0.01 * i:.2f}{mark}{i % 7}\n" for i in range(100))
    (tmp_path / "p.txt").write_text(before + rows)
    with pytest.raises(InputError, match=message):
        read_force(tmp_path / "p.txt")
