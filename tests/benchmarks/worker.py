"""A contender that needs a Python of its own, as a process: diffrax and OpenSeesPy.

That Python is named by an environment variable, or is this one where the package is
installed beside us. The process reads an oscillator as a line of JSON and writes what it
found as another; see `diffrax_worker` and `opensees_worker`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from dataclasses import asdict
from pathlib import Path
from typing import Any

from eventpound.solvers.base import Task
from tests.benchmarks.oscillator import baseline_run, oscillator_of
from tests.benchmarks.scipy_baseline import BaselineRun

KEYS = (
    "mass", "stiffness", "strength", "yield_displacement", "gap", "restitution", "cosine", "sine",
    "omega", "sample_step",
)  # fmt: skip
PATIENCE = 100.0
"""Seconds after which a request, compilation included, is given up."""


class Worker:
    """A contender in another process.

    Parameters
    ----------
    name : str
        What the tables call it.
    package : str
        What must be importable there.
    script : str
        File of the process, beside this one.
    variable : str
        Environment variable that names its Python.
    """

    def __init__(self, name: str, package: str, script: str, variable: str) -> None:
        self.name, self.package, self.variable = name, package, variable
        self._script = Path(__file__).with_name(script)
        self._python = os.environ.get(variable) or sys.executable
        self._process: subprocess.Popen[str] | None = None
        self._asked: tuple[str, dict[str, Any] | None] = ("", None)

    def missing(self) -> str:
        """Why it cannot run; empty where it can."""
        probe = [self._python, "-c", f"import {self.package}"]
        if subprocess.run(probe, capture_output=True, check=False).returncode == 0:
            return ""
        return f"{self.package} does not import ({self.variable} may name a Python that has it)"

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        """Run a task; it has `PATIENCE`, since it may compile."""
        found = self._ask(task)
        if found is None:
            return baseline_run((0.0, 0.0), 0.0, [], "process ended or took too long", 0.0)
        low, high = found["extremes"]
        impacts = [(t, v) for t, v in found["impacts"]]
        return baseline_run((low, high), found["u"], impacts, found["trouble"], found["reached"])

    def seconds(self, task: Task) -> float:
        """Wall time of a warm run (s), as called from its Python."""
        found = self._ask(task)
        return found["seconds"] if found else PATIENCE

    def _ask(self, task: Task) -> dict[str, Any] | None:
        oscillator = oscillator_of(task)
        if oscillator is None:
            raise ValueError("not an oscillator at a barrier")
        request = {key: value for key, value in asdict(oscillator).items() if key in KEYS}
        record = oscillator.samples.size > 0
        request |= {
            "samples": oscillator.samples.tolist(),
            "stops": [oscillator.end] if record else oscillator.breaks(),
            "length": oscillator.length,
            "rate": oscillator.rate,
            "rtol": task.rtol,
        }
        line = json.dumps(request)
        if line != self._asked[0]:
            self._asked = line, self._exchange(line)
        return self._asked[1]

    def _exchange(self, line: str) -> dict[str, Any] | None:
        if self._process is None:
            self._process = subprocess.Popen(
                [self._python, str(self._script)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
            )
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        guard = threading.Timer(PATIENCE, process.kill)
        guard.start()
        try:
            process.stdin.write(line + "\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        guard.cancel()
        if not answer:
            self.close()
            return None
        found: dict[str, Any] = json.loads(answer)
        return found
