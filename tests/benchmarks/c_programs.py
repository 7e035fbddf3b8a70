"""The hand-written C programs under yardstick/: compiled where there is a compiler, and run.

Each is compiled on first use, with ``cc -O3 -march=native -ffp-contract=off``, into a
temporary directory, and called through ctypes. A program exports ``prepare()`` and
``solve(problem, answer, repeats)``; its structures are those of ``yardstick/oscillator.h``.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
import time
from functools import cache
from pathlib import Path

from eventpound.solvers.base import Task
from tests.benchmarks.oscillator import Oscillator, baseline_run, oscillator_of
from tests.benchmarks.scipy_baseline import BaselineRun

FOLDER = Path(__file__).parent / "yardstick"
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC")
LISTED = 64
TRIALS, LEAST_SECONDS = 7, 2e-3
"""Timed calls, of which the fastest counts, and how long each lasts at least (s)."""


class Problem(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in (
            "mass", "stiffness", "strength", "yield_displacement", "gap", "restitution",
            "cosine", "sine", "omega", "duration", "sample_step")),
        ("record", ctypes.POINTER(ctypes.c_double)),
        ("samples", ctypes.c_int),
        *((name, ctypes.c_double) for name in ("end", "length", "rate", "rtol")),
    )  # fmt: skip


class _Answer(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in (
            "u_min", "u_max", "u", "v", "z", "rest", "detachment")),
        *((name, ctypes.c_int) for name in (
            "impacts", "listed", "steps", "knee_steps", "refused", "trouble")),
        ("time", ctypes.c_double * LISTED),
        ("speed", ctypes.c_double * LISTED),
    )  # fmt: skip


@cache
def compiler() -> str | None:
    """The C compiler, or None where there is none."""
    return shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


@cache
def _library(source: str) -> ctypes.CDLL:
    command = compiler()
    if command is None:
        raise RuntimeError("no C compiler")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "program.so"
        subprocess.run([command, *FLAGS, "-o", target, FOLDER / source, "-lm"], check=True)
        library = ctypes.CDLL(str(target))
    library.prepare()
    library.loading_curve.argtypes = [ctypes.c_double]
    library.loading_curve.restype = ctypes.c_double
    return library


def problem_of(oscillator: Oscillator, rtol: float) -> Problem:
    shared = {name for name, *_ in Problem._fields_} - {"record", "samples", "rtol"}
    problem = Problem(rtol=rtol, samples=oscillator.samples.size)
    for name in shared:
        setattr(problem, name, getattr(oscillator, name))
    # The caller keeps the array alive.
    problem.record = oscillator.samples.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
    return problem


class CProgram:
    """One of the programs as a contender.

    Parameters
    ----------
    name : str
        What the tables call it.
    source : str
        File under ``yardstick/``.
    """

    def __init__(self, name: str, source: str) -> None:
        self.name, self.source = name, source

    def missing(self) -> str:
        """Why it cannot run; empty where it can."""
        return "" if compiler() else "no C compiler"

    def loading_curve(self, xi: float) -> float:
        """Its Phi(xi): see ``yardstick/backbone.h``."""
        return float(_library(self.source).loading_curve(xi))

    def answer(self, task: Task) -> _Answer:
        """The structure that the program fills in."""
        return self._call(task, 1)[0]

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        """Run a task; `seconds` has no part in it, every run is short."""
        found = self.answer(task)
        impacts = list(zip(found.time[: found.listed], found.speed, strict=False))
        trouble = "did not end" if found.trouble else ""
        return baseline_run((found.u_min, found.u_max), found.u, impacts, trouble)

    def seconds(self, task: Task) -> float:
        """Wall time of a warm run (s), many within one call from Python."""
        repeats = 1 + int(LEAST_SECONDS / self._call(task, 3)[1])
        return min(self._call(task, repeats)[1] for _ in range(TRIALS))

    def repeat(self, task: Task, repeats: int) -> None:
        """Run a task a number of times within one call from Python."""
        self._call(task, repeats)

    def _call(self, task: Task, repeats: int) -> tuple[_Answer, float]:
        oscillator = oscillator_of(task)
        if oscillator is None:
            raise ValueError("not an oscillator at a barrier")
        library, answer = _library(self.source), _Answer()
        problem = problem_of(oscillator, task.rtol)
        began = time.perf_counter()
        library.solve(ctypes.byref(problem), ctypes.byref(answer), repeats)
        return answer, (time.perf_counter() - began) / repeats
