"""The programs, by what a table calls them: what each needs, how it is made ready, its lines."""

import io
import tokenize
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from eventpound import Response, prepare, simulate, simulate_many
from eventpound.solvers import solver_named
from tests.benchmarks import scipy_baseline
from tests.benchmarks.answers import Answer, answer_of
from tests.benchmarks.problem import Problem

HERE = Path(__file__).parent
MANY, LANES = 1000, 8
SECONDS = 20.0
"""Processor time after which a program of SciPy's kind is given up."""
OURS = """\
from math import pi
from eventpound import Body, BoucWen, Contact, Scene, Spring, simulate
from eventpound.motion import Cosine
law = BoucWen(stiffness=0.0, strength=0.2, yield_displacement=0.2)
scene = Scene(
    bodies=(Body("deck", mass=1.0),),
    springs=(Spring("frame", ("ground", "deck"), law),),
    contacts=(Contact("joint", "deck", "barrier", gap=0.5, restitution=0.7),),
    motion=Cosine(amplitude=1.0, period=2.0 * pi),
)
simulate(scene, "{solver}", 1e-9, duration=8.0 * pi, error_estimate=False)
"""
"""P1 as a user of ours writes it."""
THEIRS = """\
from tests.benchmarks import yardsticks
from tests.benchmarks.peers import programs
programs.PROGRAMS["{name}"].ready(yardsticks.load()["P1"], 1e-9)[0]()
"""
Ready = tuple[Callable[[], Response | Answer | None], int]
"""A call that returns what it finds, None where it gives up, and how many runs it makes."""


@dataclass(frozen=True)
class Program:
    """A program.

    Parameters
    ----------
    package : str
        What has to be installed.
    ready : callable
        Makes it ready for a problem at a tolerance.
    problems : str
        Those that it is written for.
    sources : tuple of str
        Files beside this one, or functions of it, that a user writes; none of ours.
    text : str
        What a process of its own runs, to tell what a first run costs.
    """

    package: str
    ready: Callable[[Problem, float], Ready]
    problems: str
    sources: tuple[str, ...]
    text: str

    @property
    def installed(self) -> bool:
        """Whether it can run here."""
        return find_spec(self.package) is not None

    @property
    def lines(self) -> int:
        """Lines that a user writes, without comments, docstrings and empty ones."""
        texts = [(HERE / source).read_text(encoding="utf-8") for source in self.sources]
        return sum(map(lines_of, texts or [self.text]))


def lines_of(text: str) -> int:
    """Lines of a program with something on them beside comments and docstrings."""
    found: set[int] = set()
    names = "COMMENT", "NL", "NEWLINE", "INDENT", "DEDENT", "ENDMARKER"
    skipped = {getattr(tokenize, name) for name in names}
    before = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        alone = token.type == tokenize.STRING and before in skipped
        if token.type not in skipped and not alone:
            found |= {*range(token.start[0], token.end[0] + 1)}
        before = token.type
    return len(found)


def _many(problem: Problem, rtol: float) -> Ready:
    task, name = problem.task, problem.scene.contacts[0].name
    gaps = {f"contact.{name}.gap": np.full(MANY, problem.scene.contacts[0].gap)}
    found = answer_of(solver_named("fast").solve(replace(task, rtol=rtol)))

    def call() -> Answer:
        simulate_many(task.scene, gaps, rtol=rtol, duration=task.end, workers=1)
        return found

    return call, MANY


def _call(problem: Problem, rtol: float, solver: str) -> Ready:
    end = problem.task.end
    options: Any = {"duration": end, "output_step": end, "error_estimate": False}
    return lambda: simulate(problem.scene, solver, rtol, **options), 1


def _prepared(problem: Problem, rtol: float) -> Ready:
    ready = prepare(problem.scene, "fast", rtol, duration=problem.task.end)
    return ready.run, 1


def _heyoka(problem: Problem, rtol: float, lanes: int = 0) -> Ready:
    made = import_module("tests.benchmarks.peers.by_heyoka").Heyoka
    task = replace(problem.task, rtol=rtol)
    return made(task, problem.name == "PZ", lanes).run, lanes or 1


def _diffrax(problem: Problem, rtol: float) -> Ready:
    made = import_module("tests.benchmarks.peers.by_diffrax").Diffrax
    return made(replace(problem.task, rtol=rtol)).run, 1


def _as_scipy(problem: Problem, rtol: float, method: str) -> Ready:
    def call() -> Answer | None:
        run = scipy_baseline.solve(replace(problem.task, rtol=rtol), method, SECONDS)
        return None if run.trouble else run.answer

    return call, 1


def _all_programs() -> dict[str, Program]:
    own, pulses = "P1 P3 P5 P6 P7 PZ", "P1 P3 P5 P6"
    heyoka, diffrax = ("rules.py", "by_heyoka.py"), ("rules.py", "by_diffrax.py")
    scipy = "../scipy_baseline.py", "../scipy_equations.py"
    fast, cvode = OURS.format(solver="fast"), OURS.format(solver="cvode")
    found = {
        f"`fast`, one of {MANY}": Program("eventpound", _many, own, (), fast),
        "`fast`, prepared": Program("eventpound", _prepared, own, (), fast),
        "`fast`, a call": Program(
            "eventpound", lambda p, rtol: _call(p, rtol, "fast"), own, (), fast
        ),
        "`cvode`, a call": Program(
            "eventpound", lambda p, rtol: _call(p, rtol, "cvode"), own, (), cvode
        ),
        f"heyoka, {LANES} at a time": Program(
            "heyoka", lambda p, rtol: _heyoka(p, rtol, LANES), own, heyoka, THEIRS
        ),
        "heyoka": Program("heyoka", _heyoka, own, heyoka, THEIRS),
        "diffrax": Program("diffrax", _diffrax, pulses, diffrax, THEIRS),
        "sundials4py": Program("sundials4py", _diffrax, "", (), ""),
    }
    for method in (scipy_baseline.SUNDIALS, "LSODA", "DOP853"):
        name = "scikit-sundae, CVODE" if method == scipy_baseline.SUNDIALS else f"SciPy, {method}"
        found[name] = Program(
            "scipy",
            lambda p, rtol, method=method: _as_scipy(p, rtol, method),
            f"{pulses} P7",
            scipy,
            THEIRS,
        )
    return {
        name: replace(program, text=program.text.format(name=name))
        for name, program in found.items()
    }


PROGRAMS = _all_programs()
