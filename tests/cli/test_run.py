"""`run --solver NAME:key=value`: settings of a solver on the command line."""

import json
from pathlib import Path

import pytest

from eventpound.cli import main
from tests.plugged import plug_in

CASE = """
body = [{ name = "deck", mass = 1.0 }]
spring = [{ between = ["ground", "deck"], law = "linear", stiffness = 40.0 }]
[excitation]
kind = "sine"
amplitude = 1.0
period = 1.0
[run]
duration = 2.0
[solver]
name = "cvode"
method = "BDF"
"""
PLUGIN = """
import numpy as np
from eventpound.errors import InputError
from eventpound.solvers.from_samples import sampled_recording

class Still:
    name, summary, kernels = "still", "nothing moves", ""
    settings = {"time_step": "fixed step (s)", "colour": "a word"}

    def check_settings(self, settings):
        if settings.get("time_step", 1.0) > 1.0:
            raise InputError("[solver]: time_step: found a large one; accepted: up to 1 s")

    def solve(self, task):
        if task.settings.get("colour") == "mauve":
            return {}["mauve"]
        t = np.arange(task.start, task.end, task.settings["time_step"])
        rows = np.zeros((t.size, 1))
        return sampled_recording(task, t, rows, rows)
"""


@pytest.fixture
def case(tmp_path, monkeypatch):
    plug_in(monkeypatch, tmp_path / "plugin", {"still.py": PLUGIN}, {"still": "still:Still"})
    folder = tmp_path / "case"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    return folder


def options(case: Path) -> dict[str, object]:
    manifest = json.loads((case / "results" / "manifest.json").read_text())
    found: dict[str, object] = manifest["options"]
    return found


@pytest.mark.parametrize(
    ("words", "solver", "settings"),
    [
        ([], "cvode", {"method": "BDF"}),
        (["--solver", "cvode:method=Adams"], "cvode", {"method": "Adams"}),
        (["--solver", "still:time_step=10 ms"], "still", {"time_step": 0.01}),
    ],
)
def test_settings(case, words, solver, settings):
    assert main(["run", str(case), "--no-figures", *words]) == 0
    found = options(case)
    assert (found["solver"], found["settings"]) == (solver, settings)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--solver", "still"], "[solver]: time_step: missing, and the solver 'still' has no def"),
        (["--solver", "still:time_step=2"], "[solver]: time_step: found a large one; accepted"),
        (["--solver", "still:time_stop=2"], "not a setting of still, did you mean 'time_step'?"),
        (["--solver", "still:colour"], "--solver: still:colour: found 'colour'; accepted: key=va"),
        (["--solver", "cvode:theta=1"], "[solver]: theta is not a setting of cvode; accepted"),
        (["--solver", "cvode:rtol=1"], "--solver: cvode:rtol=1: rtol cannot stand here; give it"),
        (["--solver", "cvode:atol=1"], "atol cannot stand here; it stands in the case"),
        (["--solver", "cvod"], "[solver]: solver = 'cvod' is not known; accepted: cvode, ida"),
        (["--solver", ":"], "--solver: found ':'; accepted: NAME or NAME:key=value"),
        (["--rtol", "1e-20"], "[solver]: rtol: found 1e-20; accepted: a number from 1e-14"),
    ],
)
def test_refused(case, capsys, words, message):
    assert main(["run", str(case), *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert message in err
    assert not (case / "results").exists()


def test_check_asks_a_solver_for_its_settings(case, capsys):
    file = case / "case.toml"
    file.write_text(CASE.replace('"cvode"\nmethod = "BDF"', '"still"\ntime_step = "2 s"'))
    assert main(["check", str(case)]) == 2
    assert f"{file}: [solver]: time_step: found a large one" in capsys.readouterr().err


def test_a_fault_of_a_plug_in_is_not_taken_for_a_missing_setting(case):
    with pytest.raises(KeyError, match="mauve"):
        main(["run", str(case), "--solver", "still:time_step=0.1:colour=mauve"])
