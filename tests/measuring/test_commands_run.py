"""Commands of the tests that the documentation names, with little to do."""

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
    "tests.benchmarks.orders": Small(
        call=lambda m: m.main(["--solvers", "moreau", "fast"]),
        constants={"STEPS": (50, 100), "TOLERANCES": (1e-5, 1e-7)},
    ),
    "tests.benchmarks.peers": Small(
        call=lambda m: m.main(["--programs", "SciPy, DOP853", "--problems", "P3", "--no-bridge"])
    ),
    "tests.benchmarks.penalty_split": Small(
        call=lambda m: m.main(["--problems", "chain"]), constants={"FINE": 100}
    ),
    "tests.benchmarks.rows": Small(call=lambda m: m.main(["--bodies", "1", "3", "--end", "0.5"])),
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
