"""One- and two-column text: what is read, what is asked for, what is refused."""

from pathlib import Path

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record


def write(path: Path, text: str) -> Path:
    path.write_bytes(text.encode("utf-8"))
    return path


def test_one_column_with_units_and_time_step(tmp_path):
    data = read_record(
        write(tmp_path / "a.txt", "0.1\r\n-.2\r\n3e-1\r\n\r\n"), units="gal", time_step=0.02
    )
    np.testing.assert_allclose(data.acceleration, [0.001, -0.002, 0.003], rtol=1e-15)
    assert (data.format, data.time_step, data.units) == ("columns", 0.02, "gal")


@pytest.mark.parametrize(
    "text",
    [
        "0.00 0.1\n0.02 0.2\n0.04 -0.3\n",
        "0\t0.1\n0.02\t0.2\n0.04\t-0.3",
        "\ufeff# a comment\r\n# t (s), a\r\n0.0,0.1\r\n0.02,0.2\r\n0.04,-0.3\r\n",
        "time; acc\n5.00; 0.1\n5.02; 0.2\n5.04; -0.3\n",
        "% x\n 0.0000000e+000 1.0E-01\n 2.0000000e-002 2.0E-01\n 4.0000000e-002-3.0E-01\n",
    ],
)
def test_two_columns_in_many_dresses(tmp_path, text):
    data = read_record(write(tmp_path / "a.csv", text), units="m/s2")
    np.testing.assert_array_equal(data.acceleration, [0.1, 0.2, -0.3])
    assert data.time_step == 0.02


def test_components_side_by_side(tmp_path):
    path = write(tmp_path / "a.txt", "t EW NS\n0.0 1 4\n0.1 2 5\n0.2 3 -6\n")
    data = read_record(path, units="m/s2", component="n-s")
    np.testing.assert_array_equal(data.acceleration, [4.0, 5.0, -6.0])
    assert (data.component, data.time_step) == ("NS", 0.1)
    np.testing.assert_array_equal(
        read_record(path, units="m/s2", component="#1").acceleration, [1.0, 2.0, 3.0]
    )


def test_columns_without_times(tmp_path):
    path = write(tmp_path / "a.txt", "4 -1 7\n6 -2 8\n5 3 -6\n")
    data = read_record(path, units="m/s2", component="#2", time_step=0.1)
    np.testing.assert_array_equal(data.acceleration, [-1.0, -2.0, 3.0])
    with pytest.raises(InputError, match="does not state its time step"):
        read_record(path, units="m/s2", component="#2")


def test_a_number_before_the_unit(tmp_path):
    data = read_record(write(tmp_path / "a.txt", "0.1\n0.2\n"), units="1e-1 g", time_step=0.1)
    np.testing.assert_allclose(data.acceleration, [0.0980665, 0.196133], rtol=1e-15)


def test_passed_over_lines_are_noted(tmp_path):
    text = "# who\ntime,acc\n0.0,0.1\n0.1,0.2\n"
    data = read_record(write(tmp_path / "a.csv", text), units="g")
    assert data.notes == ("2 lines before the numbers passed over",)


@pytest.mark.parametrize("dt", [0.005, 0.0025, 0.00244, 1.0 / 128.0, 0.01])
def test_time_step_of_times_rounded_in_printing(tmp_path, dt):
    rows = "".join(f"{i * dt:.4f} {(-1) ** i * 0.5:.3f}\n" for i in range(2000))
    data = read_record(write(tmp_path / "a.txt", rows), units="m/s2")
    # Two thousand steps fix dt to half of 1e-4 s in their sum and dt/1000.
    assert data.time_step == pytest.approx(dt, abs=(0.51e-4 + 1e-3 * dt) / 1999)


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        ("0.1\n0.2\n", {}, r"its units and its time step; give units = .* and time_step"),
        ("0.1\n0.2\n", {"units": "g"}, "does not state its time step; give time_step"),
        ("0.1\n0.2\n", {"time_step": 0.01}, "does not state its units; give units"),
        ("0 0.1\n0.1 0.2\n", {}, "does not state its units; give units"),
        ("0.1\n0.2\n", {"units": "furlong", "time_step": 0.1}, "'furlong'.*accepted: g, m/s2"),
        ("0.1\n0.2\n", {"units": "g", "time_step": -0.1}, "time_step = -0.1"),
        ("0.1\nNaN\n0.2\n", {"units": "g", "time_step": 0.1}, "line 2: found 'NaN'"),
        ("NaN\n0.1\n0.2\n", {"units": "g", "time_step": 0.1}, "line 1: found 'NaN'"),
        ("0.1\n0.2\nend\n", {"units": "g", "time_step": 0.1}, "line 3: found 'end'"),
        ("0.1\n", {"units": "g", "time_step": 0.1}, "1 samples found"),
        ("0.0\n0.0\n", {"units": "g", "time_step": 0.1}, "every sample is zero"),
        ("1\n0.01\n0.02\n", {"units": "g", "time_step": 0.1}, "line 1: the first number, 1,"),
        ("0 1 2\n1 2 3\n", {"units": "g"}, r"2 components \(#1, #2\); say which"),
        ("3 1 2\n1 2 3\n", {"units": "g"}, "line 1: 3 numbers on a line, the first of which is no"),
        ("3 1 2\n1 2\n", {"units": "g", "component": "#1"}, "line 2: 2 numbers; 3 expected"),
        ("0 0.1\n1 0.2\n2\n", {"units": "g"}, "line 3: 1 numbers; 2 expected, as on line 1"),
        ("0 0.1\n1 0.2\n2.5 0.1\n3 0\n4 0\n", {"units": "g"}, "line 3: .*1.5 s, expected 1 s"),
        ("0 0.1\n1 0.2\n1 0.1\n2 0\n3 0\n", {"units": "g"}, "line 3: the time step is not even"),
        ("0.3 0.1\n0.2 0.2\n0.1 0.1\n", {"units": "g"}, "first does not increase"),
        ("0 0.1\n0.1 0.2\n", {"units": "g", "time_step": 0.2}, "0.2 s was given.*of 0.1 s"),
        ("0,00;0,1\n0,01;0,2\n", {"units": "g"}, "line 1: .*decimal comma"),
        ("0,1\n0,2\n", {"units": "g", "time_step": 0.1}, "line 1: .*decimal comma"),
        ("0,01 0,5\n0,02 0,6\n", {"units": "g"}, "line 1: .*decimal comma"),
    ],
)
def test_refusals(tmp_path, text, arguments, message):
    with pytest.raises(InputError, match=message):
        read_record(write(tmp_path / "a.txt", text), **arguments)
