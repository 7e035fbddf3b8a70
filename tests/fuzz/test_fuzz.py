"""A sample of the long runs of ``python -m tests.fuzz``, and what they have found."""

import pytest

from eventpound.case import load_case
from eventpound.errors import InputError
from eventpound.motion.readers import read_components, read_record
from eventpound.study.reading import load_study
from tests.fuzz.targets import defects, written_records

CASE = """\
title = "found by damaging cases"
body = [{{ name = "{name}", mass = {mass} }}]
spring = [{{ between = ["ground", "{name}"], name = "piers", law = "linear", stiffness = 1e6 }}]
[excitation]
kind = "{kind}"
amplitude = 1.0
period = {period}
start = {start}
[run]
start_time = {start_time}
"""
SOUND = {
    "kind": "cosine", "period": 1.0, "start": 0.0, "name": "deck", "mass": 1e6, "start_time": 0.0
}  # fmt: skip


@pytest.mark.parametrize(("kind", "count"), [("cases", 120), ("records", 270)])
def test_damaged_files_are_read_or_refused(kind, count, tmp_path):
    found = [
        (number, outcome)
        for number, _, outcome in defects(kind, count, 7, tmp_path)
        if not isinstance(outcome, str)
    ]
    assert found == []


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"period": "1e308"}, "period"),  # an infinite duration
        ({"period": "5e-324"}, "period"),  # refused without a message
        ({"kind": "antisymmetric-ricker", "period": "1e-300"}, "period"),  # a division by zero
        ({"kind": "sine", "start": "1e308"}, "start"),  # coefficients that are NaN
        ({"kind": "mavroeidis-papageorgiou", "period": "1\ngamma = 1e6"}, "gamma"),  # a hang
        ({"kind": "type-c", "period": "1\ncycles = 1e308"}, "cycles"),  # an OverflowError
        ({"kind": "mavroeidis-papageorgiou", "period": "1\nphase = 1e18"}, "phase"),  # 1/0
        ({"start_time": "-1e307"}, "duration"),  # lost in rounding
        ({"name": "\\n"}, "name"),  # a message of two lines
        ({"mass": '"' + "x" * 100_000 + '"'}, "mass"),  # a message of 100 000 characters
    ],
)
def test_numbers_out_of_all_reason(changes, key, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(CASE.format(**(SOUND | changes)))
    with pytest.raises(InputError) as caught:
        load_case(file)
    assert any(key in problem for problem in caught.value.problems)
    for problem in caught.value.problems:
        assert problem.startswith(str(file))
        assert len(problem) < 1000
        assert "\n" not in problem


STUDY = """\
[excitation]
kind = "sine"
[pi]
structure = "elastic"
epsilon = 0.7
periods = {periods}
delta = 0.5
{part}
[study]
[[study.axis]]
key = "pi.omega_s"
from = 0.1
to = {to}
count = {count}
{part}
{part}
[figure]
name = "a"
x = "pi.omega_s"
y = "pi_um"
marks = {marks}
[intensity]
measure = "pi.omega_s"
demand = "pi_um"
records = "row"
fractiles = {fractiles}
[solver]
name = "moreau"
theta = {theta}
"""
SOUND_STUDY = {
    "periods": 10, "to": 2.0, "count": 3, "part": "", "marks": "[1.0]", "fractiles": "[50]",
    "theta": 0.5,
}  # fmt: skip


NO_NUMBERS = "1" + "0" * 400, "true", "nan"


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"count": "1e17"}, "count"),  # an array of petabytes
        ({"to": "1e300"}, "pi.omega_s"),  # an overflow
        ({"periods": "5e-324"}, "duration"),  # refused without a message
        ({"part": "[[study.part]]"}, "study"),  # two parts without a name: a KeyError
        *(({key: f"[{no}]"}, key) for key in ("marks", "fractiles") for no in NO_NUMBERS),
        ({"fractiles": "[]"}, "fractiles"),
        ({"theta": "1" + "0" * 400}, "theta"),
    ],
)
def test_studies_out_of_all_reason(changes, key, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(STUDY.format(**(SOUND_STUDY | changes)))
    with pytest.raises(InputError, match=key):
        load_study(file)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("cwb", "(Hz): 10", "(Hz): 1e308"),  # more samples than there are numbers
        ("cwb", "N(+); E(+)", ""),  # columns without a component
        ("knet", "10Hz", "9e999Hz"),
        ("usc", "G/10", "G/0"),  # a division by zero
        ("csmip_v1", " 10 pts", " 0d0 pts"),  # a ValueError
        ("itsak_fixed", "(8F", "(0F"),  # a division by zero
        ("cosmos", "approx    6", "approx 6.0.0"),  # a ValueError
        ("at2", "NPTS=     60", "NPTS= " + "9" * 5000),  # a number that Python refuses
        ("knet", "3920(gal)", "9" * 5000 + "(gal"),  # hours in a regular expression
        ("one_column", "0.0", "1e308\n0.0"),  # a sample whose square is no number
        ("two_columns", "0.100000", "1e-" + "9" * 80),  # a decimal.InvalidOperation
    ],
)
def test_records_that_were_not_refused(name, old, new, tmp_path):
    written = dict(written_records())[name]
    file = tmp_path / "damaged.txt"
    file.write_text(written.text.replace(old, new, 1))
    options = {"units": written.units or "g", "time_step": written.time_step or 0.1}
    with pytest.raises(InputError) as caught:
        read_record(file, component="#1", as_needed=True, format=written.format, **options)
    assert all(str(file) in problem for problem in caught.value.problems)


def test_thousands_of_channels_take_no_hours(tmp_path):
    """The header of each was looked for in all lines before it."""
    written = dict(written_records())["csmip_v2"]
    lines = written.text.splitlines()
    points = next(i for i, line in enumerate(lines) if "POINTS OF ACCEL" in line)
    file = tmp_path / "many.txt"
    file.write_text("\n".join(lines[:points] + lines[points : points + 9] * 1000))
    assert len(read_components(file, format="csmip")) == 1000
