"""The hand-written C programs under yardstick/: compiled where there is a compiler, and run.

Each is compiled on first use, with ``cc -O3 -march=native -ffp-contract=off``, into a
temporary directory, and called through ctypes. A program exports ``prepare()`` and
``solve(problem, answer, repeats)``; its structures are those of ``yardstick/oscillator.h``.
"""

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer, Impact
from tests.benchmarks.oscillator import Oscillator, oscillator_of

FOLDER = Path(__file__).parent / "yardstick"
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC")
LISTED = 64


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
    """One of the programs.

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
        return self._call(task, 1)

    def solve(self, task: Task) -> Answer:
        """Run a task."""
        found = self.answer(task)
        if found.trouble:
            raise RuntimeError(f"{self.name} did not end")
        impacts = zip(found.time[: found.listed], found.speed, strict=False)
        u_min, u_max, u = (np.array([value]) for value in (found.u_min, found.u_max, found.u))
        return Answer(u_min, u_max, u, tuple(Impact(t, 0, speed) for t, speed in impacts))

    def repeat(self, task: Task, repeats: int) -> None:
        """Run a task a number of times within one call from Python."""
        self._call(task, repeats)

    def _call(self, task: Task, repeats: int) -> _Answer:
        oscillator = oscillator_of(task)
        if oscillator is None:
            raise ValueError("not an oscillator at a barrier")
        library, answer = _library(self.source), _Answer()
        problem = problem_of(oscillator, task.rtol)
        library.solve(ctypes.byref(problem), ctypes.byref(answer), repeats)
        return answer
