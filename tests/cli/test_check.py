"""`check` says what was understood, and refuses what `run` refuses, in the same words."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from eventpound.case.options import OWN_SOLVERS
from eventpound.cli import main
from eventpound.solvers import available

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
def case(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def said(words: list[str], code: int, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    capsys.readouterr()
    assert main(words) == code
    out, err = capsys.readouterr()
    return out, err


def test_both_periods_of_a_spring_and_of_the_scene(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, err = said(["check", str(case)], 0, capsys)
    assert err == ""
    # K_s = 1.25e6 (2 pi / 2.5)^2 = 7.8957e6 N/m, K0 = K_s + Q/u_y = 9.7896e7 N/m.
    assert "isolators: bouc-wen, K0 = 9.7896e+07 N/m, K_s = 7.8957e+06 N/m" in out
    assert "period of 1.25e+06 kg on it: 0.71 s initial, 2.5 s post-yield" in out
    first, later = (_longest(k) for k in (9.7896e7, 7.8957e6))
    assert (
        f"period    {first:.4g} s, the longest of the scene without contact, {later:.4g} s" in out
    )


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
        ('"cvode"', '"penalty"\ncontact = "hunt"', "contact = 'hunt'; accepted: linear, kelvin-"),
        ('"cvode"', '"penalty"\ncontact_stiffness = 0', "accepted: a positive stiffness (N/m)"),
        ('"cvode"', '"penalty"\ntime_step = 1\nsteps_per_period = 9', "accepted: one of them"),
    ],
)
def test_check_and_run_refuse_the_same(
    case: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, message: str
) -> None:
    (case / "case.toml").write_text(CASE.replace(old, new))
    _, of_check = said(["check", str(case)], 2, capsys)
    assert len(of_check.splitlines()) == 1
    assert message in of_check
    assert str(case / "case.toml") in of_check
    assert said(["run", str(case)], 2, capsys) == ("", of_check)
    assert [path.name for path in case.iterdir()] == ["case.toml"]


def test_a_warning_is_given_once_a_command(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ratio = '[[dashpot]]\nbetween = ["ground", "slab"]\nratio = 5\nrefers_to = "2.5 s"\n[solver]'
    (case / "case.toml").write_text(CASE.replace("[solver]", ratio))
    _, err = said(["check", str(case)], 0, capsys)
    assert err.count("warning: ") == 1
    assert "[[dashpot]] 1: ratio = 5 is 500 % of critical damping" in err


def test_pi_terms_are_not_doubted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        '[excitation]\nkind = "cosine"\namplitude = 1e5\nperiod = 1e-6\n'
        '[pi]\nstructure = "elastic"\nomega_s = 0.5\ndelta = 0.1\nepsilon = 0.6\nperiods = 5\n'
    )
    (tmp_path / "case.toml").write_text(text)
    assert said(["check", str(tmp_path)], 0, capsys)[1] == ""


def test_own_solvers_are_those_that_need_nothing_else() -> None:
    assert set(OWN_SOLVERS) == set(available()) - {"opensees"}
