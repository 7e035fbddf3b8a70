"""Records that are scaled by much are told, however they are scaled, in one line."""

from pathlib import Path

import pytest

from eventpound import load_case
from eventpound.case.record_scaling import large_scales
from eventpound.cli import main
from tests.study.test_suite import CASE, time_series

PEAKS = {"a": 0.02, "b": 0.2, "c": 0.5}
"""Of the records (g)."""
READ = 'units = "g"\ntime_step = "0.02 s"\n'


@pytest.fixture
def folder(tmp_path):
    for name, amplitude in PEAKS.items():
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    return tmp_path


def told(folder: Path, excitation: str, rest: str, capsys: pytest.CaptureFixture[str]) -> str:
    """What `check` says of scales."""
    (folder / "case.toml").write_text(CASE.format(READ + excitation) + rest)
    assert main(["check", str(folder)]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if "largest_scale" in line]
    assert len(lines) <= 1
    return "".join(lines)


@pytest.mark.parametrize(
    ("size", "factors"),
    [
        ("scale = 4.5", "abc"),
        ('pga = "1.2 g"', "ab"),
        ('pga = "1.2 g"\nlargest_scale = 8', "a"),
        ("scale = 4", ""),
        ('pga = "0.01 g"', ""),
    ],
)
def test_a_suite_lists_its_records(folder, size, factors, capsys):
    said = told(folder, f'suite = "?.txt"\n{size}', "", capsys)
    for name in PEAKS:
        assert (f"{name}.txt times " in said) == (name in factors)
    if factors:
        assert f"{len(factors)} of 3 records are scaled by more than" in said


def test_a_run_says_it_of_its_record(folder, capsys):
    psa = 'file = "a.txt"\npsa = "3 g"\npsa_period = "T1"'
    said = told(folder, psa, "", capsys)
    assert "the record is scaled by more than 4 (largest_scale in [excitation])" in said
    motion = load_case(folder).scene.motion
    assert f"a.txt times {motion.factor:.3g}" in said
    assert told(folder, f"{psa}\nlargest_scale = 1e6", "", capsys) == ""


def test_a_study_says_it_in_one_line(folder, capsys):
    axis = '[study]\n[[study.axis]]\nkey = "excitation.{}"\nvalues = {}\n'
    files = axis.format("file", ["a.txt", "b.txt", "c.txt"])
    pga = axis.format("pga", [0.1, 0.5, 2.0, 10.0]).removeprefix("[study]\n")
    said = told(folder, 'file = "a.txt"\npga = 1', files + pga, capsys)
    factors = [
        load_case(_written(folder, f'file = "{name}.txt"\npga = {value}')).scene.motion.factor
        for name in PEAKS
        for value in (0.1, 0.5, 2.0, 10.0)
    ]
    over = sum(factor > 4.0 for factor in factors)
    assert 0 < over < 12
    assert f"{over} of 12 runs scale their record by more than 4" in said
    assert f"a.txt times {factors[3]:.3g}" in said
    records = '[study]\nrecords = "?.txt"\n' + pga
    assert f"{over} of 12 runs" in told(folder, "pga = 1", records, capsys)


def _written(folder: Path, excitation: str) -> Path:
    (folder / "case.toml").write_text(CASE.format(READ + excitation))
    return folder


def test_of_many_runs_only_the_largest_are_named():
    factors = [(f"r{i}", 5.0 + i + j) for i in range(9) for j in range(4)]
    said = large_scales(factors, 4.0)
    assert said.endswith("r8 times 16, r7 times 15, r6 times 14, r5 times 13 and 5 more")
    assert large_scales([("r", -4.1)], 4.0).endswith(": r times 4.1")


@pytest.mark.parametrize(
    ("value", "said"), [("-1", "accepted: a positive number"), ('"1 m"', "1 m")]
)
def test_a_limit_that_is_none_is_refused(folder, value, said, capsys):
    _written(folder, f'file = "a.txt"\nlargest_scale = {value}')
    assert main(["check", str(folder)]) == 2
    err = capsys.readouterr().err
    assert "largest_scale" in err
    assert said in err


def test_a_support_has_the_limit_of_the_case(folder, capsys):
    own = '[[support]]\nname = "east"\nexcitation = { kind = "record", file = "b.txt", scale = 5'
    own = f"{own}, {READ.replace(chr(10), ', ').removesuffix(', ')}"
    said = told(folder, 'file = "c.txt"', own + " }\n", capsys)
    assert "1 of 2 records are scaled" in said
    assert "b.txt times 5" in said
    (folder / "case.toml").write_text(
        CASE.format(READ + 'file = "c.txt"') + own + ", largest_scale = 9 }\n"
    )
    assert main(["check", str(folder)]) == 2
    assert "in [excitation] of the case, for all records" in capsys.readouterr().err
