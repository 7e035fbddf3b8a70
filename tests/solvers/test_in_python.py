"""What instants demand, done by Python and by compiled code: the same runs to the last bit."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from eventpound.numerics.compiled import PLAIN
from eventpound.numerics.compiled.linked import in_this_thread
from eventpound.numerics.compiled.tiered import TieredEntry
from eventpound.numerics.patience import StoppedInPythonError
from eventpound.simulation import simulate
from eventpound.solvers.base import Recording
from tests.solvers.random_scenes import random_scene

pytestmark = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")
SEEDS = (36, 57)


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the kernels that Python has run, all there are, compiled or not."""
    run: list[str] = []

    def call(entry: TieredEntry, *arguments: Any) -> Any:
        if in_this_thread.interprets:
            return entry.py_func(*arguments)
        run.append(entry.py_func.__name__)
        return entry._in_python(*arguments)

    monkeypatch.setattr(TieredEntry, "__call__", call)
    return run


def recorded(seed: int, solver: str) -> Recording:
    scene, duration = random_scene(seed)
    found = simulate(scene, solver, 1e-7, duration=duration, energy=True).recording
    return replace(found, work=replace(found.work, seconds=0.0, compilation=0.0))


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_the_same_bits(solver: str, request: pytest.FixtureRequest) -> None:
    compiled = [recorded(seed, solver) for seed in SEEDS]
    run = request.getfixturevalue("interpreted")
    for seed, first in zip(SEEDS, compiled, strict=True):
        np.testing.assert_equal(asdict(recorded(seed, solver)), asdict(first))
    assert "proceed" in run
    assert sum(len(each.events) for each in compiled) > 50


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_where_python_is_stopped_compiled_code_runs_it_all(
    solver: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = recorded(SEEDS[0], solver)
    itself, calls = TieredEntry.__call__, []

    def call(entry: TieredEntry, *arguments: Any) -> Any:
        calls.append(entry)
        if len(calls) == 20:
            raise StoppedInPythonError
        return itself(entry, *arguments)

    monkeypatch.setattr(TieredEntry, "__call__", call)
    np.testing.assert_equal(asdict(recorded(SEEDS[0], solver)), asdict(expected))
    assert len(calls) > 40
