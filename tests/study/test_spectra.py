"""Spectra in dimensions, made of Π-terms, against runs made in dimensions."""

import math

import numpy as np
import pytest

from eventpound.cli import main
from eventpound.motion.base import Scales
from eventpound.simulation import response_of
from eventpound.study.engine import Batch
from eventpound.study.running import run_study
from eventpound.study.spectra import dimensional_name, dimensional_spectrum
from eventpound.study.table import read_table

BILINEAR = """
[excitation]
kind = "cosine"
{excitation}
[pi]
structure = "bilinear"
Q = 0.2
uy = 0.1
epsilon = 0.7
periods = 6
[study]
quantities = ["pi_um", "free.pi_um", "peaks.0.abs_max"]
[[study.axis]]
key = "pi.delta"
values = [0.1, 0.5]
[[study.axis]]
key = "pi.omega_s"
from = 0.2
to = 2.0
count = 12
"""
FIGURE = '[figure]\ny = "pi_um"\ncurves = "pi.delta"\ngrey = "free.pi_um"\n'
SCALES = Scales(0.4 * 9.80665, 2.0 * math.pi / 0.8)


@pytest.fixture
def table_of(make_study):
    """Maker of the table of a study."""

    def make(text, name):
        case = make_study(text, name)
        run_study(case.study, case.directory / "results", Batch())
        return read_table(case.directory / "results")

    return make


def test_similarity_gives_the_spectrum_of_another_pulse(table_of):
    unit = table_of(BILINEAR.format(excitation=""), "unit")
    pulse = table_of(BILINEAR.format(excitation='amplitude = "0.4 g"\nperiod = "0.8 s"'), "pulse")
    spectrum = dimensional_spectrum(unit, SCALES)
    # Both are within a hundred times rtol 1e-9 of the truth.
    np.testing.assert_allclose(spectrum["u_max"], pulse["peaks.0.abs_max"], rtol=2e-7)
    np.testing.assert_allclose(
        spectrum["free.u_max"], pulse["free.pi_um"] * SCALES.length, rtol=2e-7
    )


def test_a_point_of_the_spectrum_by_hand(table_of):
    spectrum = dimensional_spectrum(table_of(BILINEAR.format(excitation=""), "unit"), SCALES)
    length = 0.4 * 9.80665 / (2.0 * math.pi / 0.8) ** 2
    assert spectrum["delta"].unique() == pytest.approx([0.1 * length, 0.5 * length], rel=1e-15)
    # Pi_omega_s = 0.2 is five periods of the pulse.
    assert spectrum["T_s"][0] == pytest.approx(5 * 0.8, rel=1e-15)
    assert "peaks.0.abs_max" in spectrum


@pytest.mark.parametrize(
    ("column", "name"),
    [
        ("pi_um", "u_max"),
        ("pi_um.1", "u_max.1"),
        ("free.pi_um", "free.u_max"),
        ("pi.uy.i", "u_y.i"),
        ("pi.omega_s.i", "pi.omega_s.i"),
        ("pi.m.1", "pi.m.1"),
        ("pi.epsilon", "pi.epsilon"),
        ("impacts", "impacts"),
        ("excitation.kind", "excitation.kind"),
    ],
)
def test_names(column, name):
    assert dimensional_name(column) == name


def test_command(make_study, capsys):
    case = make_study(BILINEAR.format(excitation="") + FIGURE)
    words = ["study", "spectrum", str(case.directory), "--amplitude"]
    arguments = [*words, "0.4 g", "--period", "0.8"]
    assert main(arguments) == 2
    assert "no table of this case" in capsys.readouterr().err
    assert main(["study", str(case.directory), "--no-figures"]) == 0
    assert main(arguments) == 0
    assert (case.directory / "results" / "spectrum-study.png").stat().st_size > 10_000
    assert main([*words, "0.4 s", "--period", "0.8"]) == 2
    assert "--amplitude: found '0.4 s'" in capsys.readouterr().err
    assert main([*words, "0.4 g", "--period", "-1"]) == 2
    assert "--period: found '-1'" in capsys.readouterr().err


def test_its_first_point_is_a_run(table_of, make_study):
    table = table_of(BILINEAR.format(excitation=""), "unit")
    base = make_study(BILINEAR.format(excitation=""), "unit").study.bases[0]
    run = response_of(base.case, "fast", 1e-9)
    assert table["pi_um"][0] == float(run.peaks.loc["0", "abs_max"])
