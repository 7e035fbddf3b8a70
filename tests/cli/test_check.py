"""`check` says what was understood, and refuses what `run` refuses, in the same words."""

import json
import math
import re

import pytest

from eventpound.case.solver_options import OWN_SOLVERS
from eventpound.cli import main
from eventpound.errors import ComputationError
from eventpound.solvers import available, solver_named
from eventpound.solvers.base import Task
from tests.models import CASES

CASE = """
[excitation]
kind = "cosine"
amplitude = "0.4 g"
period = "0.8 s"

[[body]]
name = "slab"
mass = "400 t"

[[body]]
name = "floor"
mass = "850 t"

[[spring]]
between = ["ground", "slab"]
name = "isolators"
law = "bouc-wen"
post_yield_period = "2.5 s"
of_mass = ["slab", "floor"]
strength = "900 kN"
yield_displacement = "1 cm"

[[spring]]
between = ["slab", "floor"]
law = "linear"
stiffness = "1e6 kN/m"

[solver]
name = "cvode"
"""


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def said(words: list[str], code: int, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    capsys.readouterr()
    assert main(words) == code
    out, err = capsys.readouterr()
    return out, err


def test_both_periods_of_a_spring_and_of_the_scene(case, capsys):
    out, err = said(["check", str(case)], 0, capsys)
    assert err == ""
    # K_s = 1.25e6 (2 pi / 2.5)^2 = 7.8957e6 N/m, K0 = K_s + Q/u_y = 9.7896e7 N/m.
    head, row = (line.split() for line in out.splitlines() if line.startswith(("spring ", "isol")))
    values = dict(zip(("K0", "K_s", "F_y", "Q", "u_y"), row[5:10], strict=True))
    assert values == {"K0": "97896", "K_s": "7895.7", "F_y": "978.96", "Q": "900", "u_y": "10"}
    # The mass on the isolators is both, and its weight 12 258 kN.
    assert row[-4:] == ["1250", "0.079861", "0.70999", "2.5"]
    assert head[-4:] == ["initial", "(s)", "T", "post-yield", "(s)"][-4:]
    first, later = (_longest(k) for k in (9.7896e7, 7.8957e6))
    mode = next(line.split() for line in out.splitlines() if line.startswith("1 "))
    assert float(mode[1]) == pytest.approx(first, rel=1e-4)
    assert float(mode[4]) == pytest.approx(later, rel=1e-4)


def test_json_is_in_si(case, capsys):
    out, _ = said(["check", str(case), "--json"], 0, capsys)
    found = json.loads(out)
    isolators = found["springs"][0]
    assert isolators["mass"] == 1.25e6
    assert isolators["T_post_yield"] == pytest.approx(2.5, rel=1e-12)
    assert isolators["F_y"] == pytest.approx(isolators["K0"] * 0.01, rel=1e-12)
    assert isolators["F_y/W"] == pytest.approx(isolators["F_y"] / (1.25e6 * 9.80665), rel=1e-12)
    assert found["motion"]["a_g/g"] == pytest.approx(0.4, rel=1e-12)
    assert found["motion"]["L_e"] == pytest.approx(0.4 * 9.80665 * (0.8 / 2 / math.pi) ** 2)
    assert sum(mode["share"] for mode in found["structures"][0]["initial"]) == pytest.approx(1.0)


def _longest(k: float) -> float:
    """Longest period (s) of the two masses on an isolator, by the quadratic for omega^2."""
    storey, slab, floor = 1e9, 4e5, 8.5e5
    b = (k + storey) / slab + storey / floor
    square = (
        2.0 * k * storey / (slab * floor) / (b + math.sqrt(b * b - 4.0 * k * storey / slab / floor))
    )
    return 2.0 * math.pi / math.sqrt(square)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"cvode"', '"cvodes"', "[solver]: solver = 'cvodes' is not known; accepted: cvode, ida"),
        ('"cvode"', '"cvode"\nrtol = 1e-20', "[solver]: rtol: found 1e-20; accepted: a number fr"),
        ('"cvode"', '"cvode"\nrtol = 0.1', "rtol: found 0.1; accepted: a number from 1e-14 to 0.0"),
        ('"cvode"', '"cvode"\ntheta = 1', "[solver]: theta is not a setting of cvode; accepted: "),
        ('"cvode"', '"ida"\ntimestep = 1', "[solver]: timestep is not a setting of ida"),
        ('"cvode"', '"moreau"\ntime_stop = 1', "is not a setting of moreau, did you mean 'time_s"),
        ('"cvode"', '"cvode"\nmethod = "x"', "[solver]: method = 'x'; accepted: Adams or BDF"),
        ('"cvode"', '"cvode"\ncoordinates = 1', "coordinates = 1; accepted: moving or relative"),
        ('"cvode"', '"moreau"\ntheta = 7', "[solver]: theta = 7; accepted: a number from 0.5 to"),
        ('"cvode"', '"moreau"\ntime_step = 0', "time_step = 0.0; accepted: a positive time"),
        ('"cvode"', '"penalty"\ntime_step = 1\nsteps_per_period = 9', "accepted: one of them"),
    ],
)
def test_check_and_run_refuse_the_same(case, capsys, old, new, message):
    (case / "case.toml").write_text(CASE.replace(old, new))
    _, of_check = said(["check", str(case)], 2, capsys)
    assert len(of_check.splitlines()) == 1
    assert message in of_check
    assert str(case / "case.toml") in of_check
    assert said(["run", str(case)], 2, capsys) == ("", of_check)
    assert [path.name for path in case.iterdir()] == ["case.toml"]


_SLIDER = """
[[spring]]
between = ["ground", "slab"]
name = "bearing"
law = "slider"
friction = 0.06
normal_force = "4000 kN"
"""
_DEGRADING = """
[[spring]]
between = ["slab", "floor"]
name = "pier"
law = "degrading-bouc-wen"
stiffness = "1e4 kN/m"
strength = "900 kN"
yield_displacement = "1 cm"
strength_degradation = 0.01
"""
_BACKFILL = """
[[spring]]
between = ["ground", "slab"]
name = "soil"
law = "backfill"
wall_height = "2 m"
wall_width = "10 m"
"""
_STOP = """
[[contact]]
between = ["barrier", "slab"]
name = "stop"
gap = "3 cm"
restitution = 0.5
"""
_KELVIN = _STOP + 'law = "kelvin-voigt"\nstiffness = 1e9\n'
_POINT = """
[[body]]
name = "column"
mass = "100 t"
[[contact]]
between = [{ slab = 0.5, floor = 0.5 }, "column"]
name = "point"
gap = "3 cm"
restitution = 0.5
"""
_SUPPORT = '[[support]]\nname = "pier2"\ndelay = 0.1\n'
_FORCE = '[[force]]\nbody = "slab"\nvalue = "1 kN"\n'
_SHORT = "time_step = 1e-13\n"
_ADDED = {
    "slider": _SLIDER,
    "degrading": _DEGRADING,
    "backfill": _BACKFILL,
    "stop": _STOP,
    "kelvin-voigt": _KELVIN,
    "hertz": _STOP.replace("restitution = 0.5", 'law = "hertz"\nstiffness = 1e9'),
    "point": _POINT,
    "support": _SUPPORT,
    "force": _FORCE,
    "slip": _SLIDER + '[run]\nevents = ["slip"]\n',
    "estimate": "[run]\nerror_estimate = true\n",
}


_LAW = "[solver]: {{}} does not know the laws of {}; accepted: {}\n"
_CANNOT = "[solver]: name: the solver '{{}}' cannot take {}; accepted: cvode, ida, fast"
REFUSAL = {
    "slider": _LAW.format("springs 'bearing' (slider)", "cvode, ida, fast"),
    "degrading": _LAW.format("springs 'pier' (degrading-bouc-wen)", "cvode, ida, fast"),
    "backfill": _LAW.format("springs 'soil' (backfill)", "cvode, ida, fast"),
    "kelvin-voigt": _LAW.format("contacts 'stop' (kelvin-voigt)", "cvode, penalty"),
    "hertz": _LAW.format("contacts 'stop' (hertz)", "cvode, penalty"),
    "point": "[solver]: {} does not take ends at a point between bodies (contact 'point')",
    "support": _CANNOT.format("supports"),
    "force": _CANNOT.format("forces") + ", moreau\n",
    "slip": "[solver]: {} does not list events of springs; accepted: cvode, ida, fast\n",
}


@pytest.mark.parametrize("added", [*_ADDED, "step"])
@pytest.mark.parametrize("solver", OWN_SOLVERS)
def test_check_refuses_what_run_refuses_of_every_solver(solver, added, case, capsys, monkeypatch):
    def solve(self: object, task: Task) -> None:
        raise ComputationError("began to run", task.start)

    monkeypatch.setattr(type(solver_named(solver)), "solve", solve)
    monkeypatch.setattr(type(solver_named(solver)), "ready", lambda *of: None, raising=False)
    text = CASE.replace("[solver]", _ADDED.get(added, "") + "[solver]")
    text = text.replace('"cvode"', f'"{solver}"') + (_SHORT if added == "step" else "")
    (case / "case.toml").write_text(text)
    checked = main(["check", str(case)])
    of_check = capsys.readouterr().err
    if checked == 0:
        assert main(["run", str(case)]) == 1
        assert "began to run" in capsys.readouterr().err
    else:
        assert checked == 2
        assert REFUSAL.get(added, "").format(solver) in of_check
        assert said(["run", str(case)], 2, capsys) == ("", of_check)
    unknown = {"slider", "degrading", "backfill", "slip", "support", "force", "point"}
    laws = {"kelvin-voigt", "hertz"}
    not_taken = {
        "cvode": {"step"},
        "ida": laws | {"step"},
        "fast": laws | {"step"},
        "moreau": unknown - {"force", "point"} | laws | {"step"},
        "penalty": unknown | {"step"},
    }
    assert (checked == 2) == (added in not_taken[solver])


def test_a_warning_is_given_once_a_command(case, capsys):
    ratio = '[[dashpot]]\nbetween = ["ground", "slab"]\nratio = 5\nrefers_to = "2.5 s"\n[solver]'
    (case / "case.toml").write_text(CASE.replace("[solver]", ratio))
    _, err = said(["check", str(case)], 0, capsys)
    assert err.count("warning: ") == 1
    assert "[[dashpot]] 1: ratio = 5 is 500 % of critical damping" in err


def test_pi_terms_are_not_doubted(tmp_path, capsys):
    text = (
        '[excitation]\nkind = "cosine"\namplitude = 1e5\nperiod = 1e-6\n'
        '[pi]\nstructure = "elastic"\nomega_s = 0.5\ndelta = 0.1\nepsilon = 0.6\nperiods = 5\n'
    )
    (tmp_path / "case.toml").write_text(text)
    assert said(["check", str(tmp_path)], 0, capsys)[1] == ""


def test_own_solvers_are_those_that_need_nothing_else():
    assert set(OWN_SOLVERS) == set(available()) - {"opensees"}


def test_a_dashpot_where_stiffness_times_mass_is_no_double(tmp_path, capsys):
    text = (
        '[excitation]\nkind = "none"\n[run]\nduration = 1.0\n[[body]]\nname = "b"\nmass = 1e-200\n'
        '[[spring]]\nbetween = ["ground", "b"]\nlaw = "linear"\nstiffness = 1e-200\n'
        '[[dashpot]]\nbetween = ["ground", "b"]\ncoefficient = 1e-201\n'
    )
    (tmp_path / "case.toml").write_text(text)
    out, _ = said(["check", str(tmp_path)], 0, capsys)
    # c / (2 sqrt(k m)) = 5 %
    assert re.search(r"1e-201 +5 +5", out)


def test_the_number_of_pi_terms_is_that_of_the_paper(capsys):
    for name, count in (("figure-04", 5), ("figure-07", 10), ("figure-08", 14)):
        out, _ = said(["check", str(CASES / name)], 0, capsys)
        assert f"Pi-terms  dimensionless numbers, {count} with the peak's" in out
    out, _ = said(["check", str(CASES / "pair")], 0, capsys)
    assert "Pi-terms  dimensionless numbers, 10 with the peak's: omega_s = " in out


def test_a_study_shows_the_scene_of_its_first_run(case, capsys):
    alone, _ = said(["check", str(case)], 0, capsys)
    axis = '[[study.axis]]\nkey = "spring.isolators.strength"\nvalues = ["900 kN", "2e3 kN"]\n'
    (case / "case.toml").write_text(CASE + axis)
    out, err = said(["check", str(case)], 0, capsys)
    assert err == ""
    of_scene = [line for line in alone.splitlines() if "T initial" in line or line[:2] == "1 "]
    assert len(of_scene) == 3
    assert set(of_scene) < set(out.splitlines())
    assert "shown     what the first run has: spring.isolators.strength = 900000" in out


def test_of_many_dashpots_a_few_are_listed(case, capsys):
    bodies = "".join(f'[[body]]\nname = "b{i}"\nmass = 1e5\n' for i in range(6))
    springs = "".join(
        f'[[spring]]\nbetween = ["{f"b{i - 1}" if i else "ground"}", "b{i}"]\nlaw = "linear"\n'
        "stiffness = 1e8\n"
        for i in range(6)
    )
    names = ", ".join(f'"b{i}"' for i in range(6))
    damped = f"[[modal_damping]]\nbodies = [{names}]\nratio = 0.05\n"
    (case / "case.toml").write_text(
        CASE.replace("[solver]", bodies + springs + damped + "[solver]")
    )
    out, _ = said(["check", str(case)], 0, capsys)
    # One to the ground for each body, one between every two.
    assert "and 9 more" in out


def test_records_alone_have_no_quantities(capsys):
    _, error = said(["check", str(CASES / "figure-01"), "--quantities"], 2, capsys)
    assert "the case has no bodies, and so no quantities" in error
