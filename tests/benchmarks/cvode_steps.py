"""A step of a default run on cvode beside a step of CVODE called from C.

``python -m tests.benchmarks.cvode_steps [CASE ...]``

Both go from event to event with the same method and right-hand side, stop at the same times,
write the same rows of the history, and call the same library. The C program
(``yardstick/cvode.c``) looks for nothing and starts each stretch from the state that eventpound
found there. Processor times, the smallest of runs taken in turns; `largest difference` is that
of the rows, in parts of the largest displacement.
"""

import ctypes
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eventpound import load_case
from eventpound.mechanics.model import assemble
from eventpound.numerics.arrays import Floats
from eventpound.simulation import task_of
from eventpound.solvers.base import History, Recording, Task
from eventpound.solvers.cvode import METHODS, Cvode
from eventpound.solvers.events.scales import scene_scales, tolerances
from eventpound.solvers.sundials.library import library
from eventpound.solvers.sundials.memory import CvodeMemory, MemoryLayout
from tests.benchmarks.c_programs import FLAGS, FOLDER, Problem, compiler, problem_of
from tests.benchmarks.oscillator import oscillator_of

CASES = ("elastoplastic-barrier",)
TURNS = 30
COLUMNS = 7
CALLS = ("CVode", "CVodeGetDky", "CVodeReInit", "CVodeSetStopTime", "N_VGetArrayPointer")


class _Integrator(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_void_p) for name in (*CALLS, "memory", "vector", "look"))


class _Data(ctypes.Structure):
    _fields_ = (
        ("problem", ctypes.POINTER(Problem)),
        ("integrator", ctypes.POINTER(_Integrator)),
    )


class _Run(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("start", "end", "state")),
        ("rows", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("times", "table")),
    )


@dataclass(frozen=True)
class Stretches:
    """Smooth stretches of a run: start and end (s), shape (n,), and u, v, z at the start (n, 3)."""

    start: Floats
    end: Floats
    state: Floats


def stretches_of(task: Task, recording: Recording, breaks: list[float]) -> Stretches:
    """Those between the events, and where the ground motion is not smooth."""
    h: History = recording.history
    inner = sorted({*(event.t for event in recording.events), *breaks} - {task.end})
    starts = np.array([task.start, *inner])
    # The last of the rows of an instant is that after what happens there.
    rows = np.searchsorted(h.t, starts, side="right") - 1
    state = np.column_stack((h.u[rows, 0], h.v[rows, 0], h.z[rows, 0]))
    return Stretches(starts, np.append(starts[1:], task.end), np.ascontiguousarray(state))


class Program:
    """The C program on a task; `rows` is the table that it fills."""

    def __init__(self, task: Task, recording: Recording) -> None:
        oscillator = oscillator_of(task)
        sundials: Any = library()
        if oscillator is None or sundials is None or recording.resting_time.any():
            raise ValueError("an oscillator that never rests, and a library in reach, are needed")
        self._code = _compiled()
        self._problem = problem_of(oscillator, task.rtol)
        self.rows = np.zeros((task.output_times.size, COLUMNS))
        self._stretches = stretches_of(task, recording, oscillator.breaks())
        self._times = np.ascontiguousarray(task.output_times)
        self._data = _Data(ctypes.pointer(self._problem))
        atol = tolerances(task, scene_scales(task.scene, assemble(task.scene), task.end))
        own = np.array([float(np.max(atol[key])) for key in ("displacement", "velocity", "z")])
        callback = ctypes.cast(self._code.rate_of_state, ctypes.c_void_p).value
        self._memory = CvodeMemory(
            sundials,
            METHODS[0],
            MemoryLayout(task.rtol, own, 0),
            callback or 0,
            ctypes.addressof(self._data),
        )
        calls = [ctypes.cast(getattr(sundials, name), ctypes.c_void_p).value for name in CALLS]
        memory = self._memory
        self._integrator = _Integrator(*calls, memory.address, memory.vector, memory.interpolated)
        self._data.integrator = ctypes.pointer(self._integrator)
        s = self._stretches
        self._run = _Run(
            s.start.size,
            *(each.ctypes.data for each in (s.start, s.end, s.state)),
            self._times.size,
            self._times.ctypes.data,
            self.rows.ctypes.data,
        )

    def follow(self) -> int:
        """Run; returns the number of steps."""
        parts = (self._problem, self._integrator, self._run)
        steps = int(self._code.follow(*map(ctypes.byref, parts)))
        if steps < 0:
            raise RuntimeError("CVODE failed")
        return steps


def _compiled() -> ctypes.CDLL:
    command = compiler()
    if command is None:
        raise ValueError("there is no C compiler here")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "program.so"
        subprocess.run([command, *FLAGS, "-o", target, FOLDER / "cvode.c", "-lm"], check=True)
        found = ctypes.CDLL(str(target))
    found.follow.restype = ctypes.c_long
    return found


def measure(case: str, turns: int = TURNS) -> str:
    """A line of the table."""
    task, solver = task_of(load_case(Path("cases") / case)), Cvode()
    recording = solver.solve(task)
    program = Program(task, recording)
    ours, theirs, steps = [], [], 0
    for _ in range(turns):
        began = time.process_time()
        recording = solver.solve(task)
        ours.append(time.process_time() - began)
        began = time.process_time()
        steps = program.follow()
        theirs.append(time.process_time() - began)
    h = recording.history
    rows = np.searchsorted(h.t, task.output_times, side="right") - 1
    off = np.abs(program.rows[:, 2] - h.u[rows, 0]).max() / np.abs(h.u).max()
    a_step = min(ours) / recording.work.steps * 1e6, min(theirs) / steps * 1e6
    return (
        f"| {case} | {recording.work.steps} | {a_step[0]:.2f} | {steps} | {a_step[1]:.2f} | "
        f"{a_step[0] / a_step[1]:.2f} | {off:.1e} |"
    )


def main(cases: list[str]) -> None:
    """Print the table."""
    print("| case | steps | µs a step | steps in C | µs a step in C | ratio | largest difference |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for case in cases or CASES:
        print(measure(case))


if __name__ == "__main__":
    main(sys.argv[1:])
