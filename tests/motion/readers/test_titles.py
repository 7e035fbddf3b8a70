"""What stands beside samples: titles and their units, clocks, counts, steps, numbers of rows."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record

N = 60
A = 0.001 * np.cumsum(np.random.default_rng(1).normal(size=N))
OTHER = A[::-1]
T = [0.01 * i for i in range(N)]


def rows(form: str, *columns: Iterable[Any]) -> str:
    return "".join(form.format(*row) + "\n" for row in zip(*columns, strict=True))


def along(width: int, before: str = "", after: str = "") -> str:
    """Lines of several samples, with what stands before and after them, of line n or sample i."""
    lines = [A[i : i + width] for i in range(0, N, width)]
    return "".join(
        before.format(n=n + 1, i=width * n + 1)
        + " ".join(f"{x:.6f}" for x in line)
        + after.format(n=n + 1)
        + "\n"
        for n, line in enumerate(lines)
    )


ONE = rows("{:.6e}", A)
SHORT = rows("{:.5g}", A)
FIXED = rows("{:.6f}", A)
TWO = rows("{:.2f} {:.6f}", T, A)
MS = range(0, 10 * N, 10)
CLOCK = [f"16:10:{9 + t:05.2f}" for t in T]
MIDNIGHT = [f"{'23:59:59' if i < 50 else '00:00:00'}.{(50 + i) % 100:02d}" for i in range(N)]
G, GIVEN = {"units": "g"}, {"units": "g", "time_step": 0.01}
COMPONENT_L = {"units": "g", "component": "L"}


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        # A step, a count, or both before the samples.
        ("0.01\n" + ONE, GIVEN),
        ("0.01\n" + SHORT, GIVEN),
        ("0.010000\n" + FIXED, GIVEN),
        ("60 0.01\n" + ONE, G),
        ("60 0.01\n" + ONE, GIVEN),
        ("0.01, 60\n" + ONE, G),
        ("60\n0.01\n" + ONE, G),
        ("60\n" + ONE, GIVEN),
        ("60 0.01\n" + along(6), G),
        ("60\n0.01\n" + along(8), G),
        ("0.01\n" + along(6), GIVEN),
        ("El Centro\n60 0.01\n" + ONE, G),
        ("60 0.01\n" + TWO, G),
        # Numbers of rows and samples.
        (along(6, after=" {n}"), GIVEN),
        (along(8, after=" {n}"), GIVEN),
        (along(8, "{n} "), GIVEN),
        (along(6, "{i} "), GIVEN),
        (rows("{} {:.6f}", range(N), A), GIVEN),
        (rows("{} {:.6f}", range(N), A), GIVEN | {"as_needed": True}),
        ("sample,acc\n" + rows("{},{:.6f}", range(N), A), GIVEN),
        (rows("{} {:.2f} {:.6f}", range(N), T, A), G),
        (rows("{:.2f} {:.6f} {}", T, A, range(1, N + 1)), G),
        (rows("{:.6f} {}", A, range(1, N + 1)), GIVEN),
        # Titles.
        ("time_ms,acc\n" + rows("{},{:.6f}", MS, A), G),
        ("TIME_MS,ACC\n" + rows("{},{:.6f}", MS, A), G),
        ("t [ms]\ta [g]\n" + rows("{}\t{:.6f}", MS, A), {}),
        ("Time (sec)  Acc (g)\n" + TWO, {}),
        ("t (min), a (g)\n" + rows("{:.6f}, {:.6f}", [t / 60 for t in T], A), {}),
        ("# time acc\n# [ms] [g]\n" + rows("{} {:.6f}", MS, A), {}),
        ("Acc (g),Time (s)\n" + rows("{:.6f},{:.2f}", A, T), {}),
        ('"Time (s)","Acc, NS (g)"\n' + rows("{:.2f},{:.6f}", T, A), {}),
        ("t a v d\n" + rows("{:.2f} {:.6f} {:.4f} {:.4f}", T, A, OTHER, OTHER), G),
        (
            "Time (s),Vel (cm/s),Disp (cm),Acc (g)\n"
            + rows("{:.2f},{:.4f},{:.4f},{:.6f}", T, OTHER, OTHER, A),
            {},
        ),
        (
            "Time (s)\tAcc EW (g)\tAcc NS (g)\n" + rows("{:.2f}\t{:.6f}\t{:.6f}", T, OTHER, A),
            {"component": "Acc NS"},
        ),
        ("Acc (g)\n" + FIXED, {"time_step": 0.01}),
        ("t,Acc (%g)\n" + rows("{:.2f},{:.6f}", T, 100.0 * A), {}),
        ("t,acc (m/(s^2))\n" + rows("{:.2f},{:.6f}", T, 9.80665 * A), {}),
        ("t/s,a/g\n" + rows("{:.2f},{:.6f}", T, A), {}),
        ("t,V,L,T\n" + rows("{:.2f},{:.6f},{:.6f},{:.6f}", T, OTHER, A, OTHER), COMPONENT_L),
        ("Time (s),Acc (g),\n" + rows("{:.2f},{:.6f},", T, A), {}),
        (TWO + "\x1a", G),
        # Words before the samples.
        ("# dt = 0.01 s\n# UNITS: g\n" + FIXED, {}),
        ("# Sampling rate: 100 Hz\n" + FIXED, G),
        ("DT (ms) = 10\n" + along(6), G),
        ("% 100 sps\n% ACC IN UNITS OF G\n" + along(6), {}),
        ("# PGA = 300 gal, PGV = 12 cm/s\n# dt 0.01\n" + FIXED, G),
        ("# resampled from dt = 0.005 s\n# dt = 0.01 s\n" + FIXED, GIVEN),
        ("# dt = 0.01\n" + TWO, G),
        ("Motion, units: g\n60 0.01\n" + ONE, {}),
        # Clocks.
        (rows("{} {:.6f}", CLOCK, A), G),
        (rows("2024/01/01 {},{:.6f}", CLOCK, A), G),
        (rows("2024-01-01T{}Z\t{:.6f}", CLOCK, A), G),
        (rows("2024-01-01 {} +0900,{:.6f}", CLOCK, A), G),
        ("Date Time Acc_g\n" + rows("2024-01-01 {} {:.6f}", CLOCK, A), {}),
        (rows("{}\t{:.6f}", MIDNIGHT, A), G),
        (rows("2024-01-{:02d} {}\t{:.6f}", [1] * 50 + [2] * 10, MIDNIGHT, A), G),
        ("Time,RelTime(s),Acc(g)\n" + rows("{},{:.2f},{:.6f}", CLOCK, T, A), {}),
    ],
)
def test_read_as_what_it_is(tmp_path, text, arguments):
    path = tmp_path / "a.txt"
    path.write_text(text)
    data = read_record(path, **arguments)
    np.testing.assert_allclose(data.acceleration, 9.80665 * A, atol=1e-5)
    assert data.time_step == 0.01


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        ("0.01\n" + ONE, G, "line 1: found '0.01', .*give time_step = \"0.01 s\""),
        ("0.01\n" + ONE, {"units": "g", "time_step": 0.005}, "line 1: found '0.01'.*0.005 s"),
        ("0.01\n" + SHORT, {"units": "g", "time_step": 0.005}, "line 1: found '0.01'.*0.005 s"),
        ("60 0.01\n" + ONE, {"units": "g", "time_step": 0.02}, "0.02 s was given.* of 0.01 s"),
        ("61 0.01\n" + ONE, GIVEN, "60 numbers found .* line 1 states samples = 61"),
        ("0.01\n" + along(6), G, "line 1: found '0.01', unlike the 60 numbers after it"),
        ("60 0.02\n" + TWO, G, "line 1: a time step of 0.02 s is stated, column 1 .* 0.01 s"),
        (rows("{} {:.6f}", range(N), A), G, "line 1: the first column counts"),
        ("Sample,a\n" + rows("{},{:.6f}", range(N), A), G, "does not state its time step"),
        (
            "t [ms]\ta (cm/s2)\n" + rows("{}\t{:.6f}", MS, A),
            G,
            "line 1: units = 'g' were given, but the file states 'cm/s2'",
        ),
        ("Acc (gal)\n" + FIXED, GIVEN, "'g' were given, but the file states 'gal'"),
        # Words before the samples.
        ("# dt = 0.02\n" + FIXED, GIVEN, "line 1: time_step = 0.01 s was given.* of 0.02 s"),
        ("# dt = 0.02\n" + TWO, G, "line 1: a time step of 0.02 s is stated"),
        ("# Sampling rate: 50 Hz\n" + along(6), GIVEN, "line 1: time_step = 0.01 s was given"),
        ("# dt = 0.02\n60 0.01\n" + along(6), G, "line 1: states 0.02 s, line 2 0.01 s"),
        ("# Acceleration in cm/s2\n# EW\n" + FIXED, GIVEN, "line 1: units = 'g' were given"),
        ("acc (cm/s2)\n60 0.01\n" + ONE, G, "line 1: units = 'g' were given"),
        ("VELOCITY IN CM/S\n" + along(6), GIVEN, "line 1: states 'CM/S', the unit of a velocity"),
        ("# NPTS = 61\n" + FIXED, GIVEN, "60 samples found .* line 1 states NPTS = 61"),
        ("# NPTS = 61\n" + along(6), GIVEN, "60 samples found .* line 1 states NPTS = 61"),
        # A head that agrees with nothing, and decimal commas beside points.
        ("60 0.01 9.81\n" + ONE, GIVEN, "line 1: found '60 0.01 9.81', unlike the 60 numbers"),
        ("60 0.01 9.81\n" + TWO, GIVEN, "line 1: found '60 0.01 9.81', unlike the 120 numbers"),
        ("60 0\n" + ONE, G, "line 1: found '60 0', .* it agrees not with their number: give what"),
        (rows("{:.2f}\t{}", T, [f"{x:.6f}".replace(".", ",") for x in A]), G, "decimal commas"),
        ("acc_milli-g\n" + FIXED, {"time_step": 0.01}, "does not state its units"),
        ("t,Velocity (cm/s)\n" + rows("{:.2f},{:.6f}", T, A), G, "'Velocity .*' is a velocity"),
        ("time,DISP\n" + rows("{:.2f},{:.6f}", T, A), G, "'DISP' is a displacement"),
        ("Velocity (cm/s)\n" + FIXED, GIVEN, "line 1: 'Velocity .*' is a velocity"),
        (
            "t a v\n" + rows("{:.2f} {:.6f} {:.4f}", T, A, OTHER),
            {"units": "g", "component": "v"},
            "component = 'v' is not one of its components: #1 a",
        ),
        (rows("2024-01-01 {}\t{:.6f}", MIDNIGHT, A), G, "line 51: .* found -86400 s"),
        (
            "Time,RelTime(s),Acc(g)\n" + rows("{},{:.2f},{:.6f}", CLOCK, [2 * t for t in T], A),
            {},
            "a time step of 0.01 s is stated, column 2 has one of 0.02 s",
        ),
    ],
)
def test_refused(tmp_path, text, arguments, message):
    path = tmp_path / "a.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_record(path, **arguments)
