"""Printing neither fails nor stops the work, whatever the terminal is."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from eventpound.cli import main
from eventpound.errors import AccuracyWarning
from eventpound.quantities import lookup

CASE = """
title = "Überbau"
[excitation]
kind = "none"
[[body]]
name = "плита"
mass = 1.0
[run]
duration = 1.0
"""
COMMAND = [sys.executable, "-m", "eventpound"]


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    "encoding",
    ["ascii", *(pytest.param(e, marks=pytest.mark.sweep) for e in ("latin-1", "cp1252"))],
)
def test_a_terminal_that_is_not_utf_8(case, encoding):
    done = subprocess.run(
        [*COMMAND, "run", str(case), "--no-figures"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": encoding},
        check=False,
    )
    out = done.stdout.decode(encoding)
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)
    assert r"\u043f\u043b\u0438\u0442\u0430" in out
    assert (case / "results" / "summary.json").is_file()


@pytest.mark.parametrize("words", [["run", "{case}", "--no-figures"], ["--help"]])
def test_a_reader_that_stops_reading(case, words):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [*COMMAND, *(word.format(case=case) for word in words)],
            stdout=writing,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    finally:
        os.close(writing)
    assert done.returncode == 0
    assert "BrokenPipe" not in done.stderr
    assert "Traceback" not in done.stderr
    if words[0] == "run":
        assert (case / "results" / "summary.json").is_file()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_file_on_a_full_disk(case):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, "check", str(case)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr == "eventpound: stdout: cannot be written to: No space left on device\n"


@pytest.mark.filterwarnings("default")
def test_a_warning_is_a_line_without_its_place_in_the_source(case, monkeypatch, capsys):
    def names(_: object) -> list[str]:
        warnings.warn("the peak is not known", AccuracyWarning, stacklevel=2)
        warnings.warn("divided\nby zero", RuntimeWarning, stacklevel=2)
        return ["t_final"]

    monkeypatch.setattr(lookup, "names_of", names)
    assert main(["check", "--quantities", str(case)]) == 0
    said = "eventpound: warning: the peak is not known\n"
    said += "eventpound: warning: RuntimeWarning: divided by zero\n"
    assert capsys.readouterr().err == said


def test_without_a_command_the_help_is_shown(capsys):
    assert main([]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("usage: eventpound")
    assert "one case:" in err
    assert "eventpound run pulse" in err
