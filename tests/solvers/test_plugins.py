"""Solvers of other packages: found, named where broken, harmless to the rest."""

import math
import re
import sys
import tomllib
from pathlib import Path

import pytest

from eventpound import InputError, load_case, simulate
from eventpound.cli import main
from eventpound.solvers import available, plugins, solver_named
from tests.models import ROOT
from tests.plugged import plug_in

BARE = """
class Bare:
    name, summary, settings = "bare", "does nothing", {}
    def solve(self, task): ...
"""


@pytest.fixture(autouse=True)
def _forget_modules():
    known = set(sys.modules)
    yield
    for name in set(sys.modules) - known:
        if name in ("bare", "euler_steps", "broken", "lacking"):
            del sys.modules[name]


def _documented() -> dict[str, str]:
    """The files of docs/your-solver.md."""
    text = (ROOT / "docs" / "your-solver.md").read_text(encoding="utf-8")
    return dict(re.findall(r"<!-- example: (\S+) -->\n```\w+\n(.*?)```", text, re.DOTALL))


def test_a_class_and_an_object(monkeypatch, tmp_path):
    source = BARE + "other = Bare()\nother.name = 'other'\n"
    plug_in(monkeypatch, tmp_path, {"bare.py": source}, {"a": "bare:Bare", "b": "bare:other"})
    assert {"bare", "other", "cvode", "fast"} <= set(available())
    assert solver_named("other").summary == "does nothing"


def test_every_solver_has_the_name_it_is_asked_for_by():
    names = available()
    assert {"cvode", "ida", "fast", "moreau", "penalty"} <= set(names)
    assert {name: solver.name for name, solver in names.items()} == {name: name for name in names}


@pytest.mark.parametrize(
    ("source", "value", "words"),
    [
        ("import no_such_package", "broken:X", "ModuleNotFoundError: No module named"),
        ("1 / 0", "broken:X", "ZeroDivisionError"),
        ("", "broken:X", "AttributeError"),
        ("class X:\n    name = 'broken'", "broken:X", "has no summary, settings, solve"),
        (BARE.replace('"bare"', '"cvode"'), "broken:Bare", "another solver is called 'cvode'"),
        (BARE.replace("{}", "None"), "broken:Bare", "settings must be a mapping"),
    ],
)
def test_broken_ones_are_named_and_left_out(monkeypatch, tmp_path, capsys, source, value, words):
    plug_in(monkeypatch, tmp_path / "1", {"broken.py": source}, {"broken": value}, "bad-package")
    plug_in(monkeypatch, tmp_path / "2", {"bare.py": BARE}, {"bare": "bare:Bare"}, "good-package")
    assert set(plugins().found) == {"bare"}
    assert solver_named("bare").name == "bare"
    assert solver_named("cvode").summary.startswith("SUNDIALS")
    with pytest.raises(InputError, match=r"solver = 'broken': .* of bad-package") as caught:
        solver_named("broken")
    assert words in str(caught.value)
    assert main(["solvers"]) == 0
    out, err = capsys.readouterr()
    assert "bare" in out
    assert words in err


def test_one_that_is_not_there():
    with pytest.raises(InputError, match="solver = 'euler' is not known; accepted: cvode, "):
        solver_named("euler")


def test_the_documented_example(monkeypatch, tmp_path, capsys):
    files = _documented()
    project = tomllib.loads(files["pyproject.toml"])["project"]
    entries = project["entry-points"]["eventpound.solvers"]
    source = {"euler_steps.py": files["euler_steps.py"]}
    assert len(files["euler_steps.py"].splitlines()) <= 40
    plug_in(monkeypatch, tmp_path, source, entries, project["name"])
    case = load_case(ROOT / "cases" / "elastic-barrier")
    wanted = simulate(case, "fast", 1e-9).peaks["min"].iloc[0]
    step, omega = 1e-4, 2.0 * math.pi / 0.6
    found = simulate(case, "euler", settings={"time_step": step})
    assert found.impacts == 5
    # A method of first order errs by some h omega of the motion.
    assert abs(found.peaks["min"].iloc[0] - wanted) < 10.0 * step * omega * abs(wanted)
    pair, out = str(ROOT / "cases" / "pair"), str(tmp_path / "out")
    assert main(["compare", pair, "--solvers", "euler", "--steps", "1e-3", "--out", out]) == 2
    assert "runs one elastic body beside a barrier only" in capsys.readouterr().err
    assert not Path(out).exists()
