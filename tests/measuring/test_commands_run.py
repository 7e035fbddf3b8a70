"""Every command of the tests that the documentation names runs, here or in another test."""

import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.models import ROOT
from tests.reference.problems import load

PAGES = [
    page for page in sorted((ROOT / "docs").rglob("*.md")) if "generated" not in page.parts
] + [ROOT / "README.md"]
COMMAND = re.compile(r"python -m (tests(?:\.[a-z_]+)+)")


@dataclass(frozen=True)
class Small:
    """A command with little to do.

    Parameters
    ----------
    words : str
        Its arguments.
    call : callable
        How its `main` is called, beside them.
    constants : mapping
        Of its module, in place of larger ones.
    """

    words: str = ""
    call: Callable[[ModuleType], Any] = lambda module: module.main()
    constants: Mapping[str, object] = field(default_factory=dict)


def _one_problem() -> dict[str, Any]:
    return {"A07": load()["A07"]}


def _once(**others: object) -> dict[str, object]:
    return {"REPEATS": 1, **others}


RUN = {
    "tests.benchmarks.agreement": Small("1 0"),
    "tests.benchmarks.amortized": Small(
        call=lambda m: m.main(["--problems", "P1", "--runs", "64", "--rtol", "1e-6"]),
        constants=_once(C_RUNS=2),
    ),
    "tests.benchmarks.choices": Small(constants=_once(TOLERANCES=(1e-6,))),
    "tests.benchmarks.contact_laws": Small(constants=_once(MULTIPLES=(1e3,))),
    "tests.benchmarks.estimate_cost": Small(call=lambda m: m.main(1)),
    "tests.benchmarks.figure_agreement": Small(call=lambda m: m.main(12, 1)),
    "tests.benchmarks.studies": Small(call=lambda m: m.main([1000])),
    "tests.hard.stiff": Small(call=lambda m: m.main(1, 0, 20.0)),
    "tests.motion.readers.outcomes": Small(
        call=lambda m: m.main(named=False),
        constants={"FOLDER": Path(__file__).parent, "DAMAGED_REAL": 0, "DAMAGED_WRITTEN": 0},
    ),
    "tests.properties": Small("1 0 fast"),
    "tests.reference.certificates": Small("A07"),
    "tests.reference.comparison": Small("1e-6", constants={"load": _one_problem}),
}
"""Those that run here."""

ELSEWHERE = {
    "tests.accuracy.honesty": "accuracy/test_honesty.py",
    "tests.benchmarks.claims": "paper/test_claims.py",
    "tests.benchmarks.cvode_steps": "measuring/test_cvode_steps.py",
    "tests.benchmarks.opensees_laws": "solvers/opensees/test_opensees.py",
    "tests.benchmarks.orders": "measuring/test_stepper_tables.py",
    "tests.benchmarks.peers": "measuring/test_benchmarks_run.py",
    "tests.benchmarks.penalty_split": "measuring/test_stepper_tables.py",
    "tests.benchmarks.rows": "measuring/test_benchmarks_run.py",
    "tests.benchmarks.suite": "measuring/test_benchmarks_run.py",
    "tests.benchmarks.work_precision": "measuring/test_work_precision.py",
    "tests.docs.follow": "docs/test_tutorials.py",
    "tests.docs.solvers": "docs/test_solvers.py",
    "tests.docs.measure": "docs/test_measure.py",
    "tests.equilibria": "equilibria/test_equilibria.py",
    "tests.fuzz": "fuzz/test_fuzz.py",
    "tests.hard": "hard/test_hard.py",
    "tests.hard.generated": "hard/test_hard.py",
    "tests.interrupts": "interrupts/test_interrupts.py",
    "tests.motion.published": "motion/test_published.py",
    "tests.oracle": "oracle/test_oracle.py",
    "tests.paper.abutments": "paper/test_abutments.py",
    "tests.paper.persistency": "paper/test_persistency.py",
    "tests.paper.points": "paper/test_points.py",
}
"""Those whose parts another test calls."""

BY_HAND = {
    "tests.benchmarks.front": "needs OpenSeesPy, and two minutes of it",
    "tests.benchmarks.first_run": "compiles every kernel anew",
    "tests.problems.league": "gives every problem to every program, for hours",
    "tests.oracle.problems": "writes into the problem set what the independent program says",
}
"""Those that no test can run, and why."""


@pytest.mark.pages
@pytest.mark.parametrize("name", sorted(RUN))
def test_runs(name, monkeypatch, capsys, request):
    if request.config.option.quick:
        pytest.skip("compiles, some of them in processes of their own")
    small = RUN[name]
    folder = ROOT / name.replace(".", "/")
    module = import_module(f"{name}.__main__" if folder.is_dir() else name)
    for constant, value in small.constants.items():
        monkeypatch.setattr(module, constant, value)
    monkeypatch.setattr(sys, "argv", [name, *small.words.split()])
    assert small.call(module) in (None, 0)
    assert capsys.readouterr().out.strip()


def test_every_command_of_the_pages_is_run():
    named = {
        found.removesuffix(".") for page in PAGES for found in COMMAND.findall(page.read_text())
    }
    assert named <= {*RUN, *ELSEWHERE, *BY_HAND, "tests.benchmarks"}


@pytest.mark.parametrize("name", sorted(ELSEWHERE))
def test_is_called_elsewhere(name):
    text = (ROOT / "tests" / ELSEWHERE[name]).read_text(encoding="utf-8")
    package, _, module = name.rpartition(".")
    assert re.search(rf"from {package} import .*\b{module}\b|(from|import) {name}\b", text)
