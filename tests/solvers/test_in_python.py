"""What instants demand, done by Python and by compiled code: the same runs to the last bit."""

from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from eventpound.numerics.compiled import PLAIN, by_python
from eventpound.numerics.compiled.linked import Entry
from eventpound.simulation import response_of
from eventpound.solvers.base import Recording
from eventpound.solvers.events.instant import proceed
from tests.solvers.random_scenes import random_scene

pytestmark = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")
SEEDS = (36, 57)


def recorded(seed: int) -> Recording:
    scene, duration = random_scene(seed)
    found = response_of(scene, "cvode", 1e-7, duration=duration, energy=True).recording
    return replace(found, work=replace(found.work, seconds=0.0, compilation=0.0))


def test_the_same_bits(monkeypatch):
    compiled = [recorded(seed) for seed in SEEDS]
    itself, run = Entry.__call__, []

    def call(entry: Entry, *arguments: Any) -> Any:
        if entry is not proceed:
            return itself(entry, *arguments)
        run.append(entry)
        with by_python():
            return entry.py_func(*arguments)

    monkeypatch.setattr(Entry, "__call__", call)
    for seed, first in zip(SEEDS, compiled, strict=True):
        np.testing.assert_equal(asdict(recorded(seed)), asdict(first))
    assert len(run) > 50
    assert sum(len(each.events) for each in compiled) > 50
