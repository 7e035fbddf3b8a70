"""Kernels that Python runs until compiling them pays."""

from __future__ import annotations

import math
import threading

import numpy as np
import pytest

from eventpound.numerics import patience
from eventpound.numerics.compiled import PLAIN
from eventpound.numerics.patience import (
    StoppedInPythonError,
    compiled_at_once,
    in_python_or_compiled,
)
from tests.numerics.compiled.modules import imported, in_a_process

pytestmark = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")

KERNELS = """\
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.borrowing import array_at, borrow
from eventpound.numerics.compiled import kernel, scalar_kernel, tiered_kernel
from eventpound.numerics.lending import lend


class Group(NamedTuple):
    x: np.ndarray
    factor: float


@scalar_kernel
def scaled(group, i):
    return group.factor * group.x[i]


@kernel
def first_of(address):
    return array_at(address, 2, np.float64)[0]


@tiered_kernel(0.05)
def whole(x, factor, address):
    group = lend(Group(borrow(x), factor))
    result = 0.0
    for i in range(x.size):
        result += scaled(group, i)
    return result + first_of(address)


@tiered_kernel(0.05)
def inverse(x):
    return 1.0 / x
"""


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Whoever measures time in this process may have everything compiled at once."""
    monkeypatch.setattr(patience, "_at_once", 0)


@pytest.fixture
def file(tmp_path):
    made = tmp_path / "kernels.py"
    made.write_text(KERNELS)
    return made


def sample(module):
    x = np.array([0.1, 0.2, 0.3])
    return module.whole(x, 1.7, x.ctypes.data)


def compiled_of(module):
    """Whether a kernel of the module has been compiled."""
    return [name for name in ("whole", "scaled", "first_of") if getattr(module, name).overloads]


def test_python_runs_it_first_and_all_that_it_calls(file):
    module = imported(file)
    interpreted = sample(module)
    assert not compiled_of(module)
    with compiled_at_once():
        assert sample(module) == interpreted
    assert compiled_of(module) == ["whole"]


def test_a_kept_kernel_is_used_at_once(file):
    with compiled_at_once():
        sample(imported(file))
    later = imported(file)
    sample(later)
    assert compiled_of(later) == ["whole"]


def test_it_is_compiled_when_python_has_spent_enough(file, monkeypatch):
    clock = iter(np.arange(0.0, 10.0, 0.015))
    monkeypatch.setattr("time.thread_time", lambda: float(next(clock)))
    module, calls = imported(file), 0
    while not compiled_of(module):
        sample(module)
        calls += 1
    # Each takes 0.015 s by this clock, of which 0.01 s are written down as a whole.
    assert 4 <= calls <= 6


def test_what_other_processes_spend_counts(file):
    expression = "[inverse._cache.spend(0.03), inverse._cache.spent()][1]"
    for spent in (0.03, 0.06):
        done = in_a_process(file, expression)
        assert float(done.stdout) == pytest.approx(spent)
    module = imported(file)
    assert module.inverse(4.0) == 0.25
    assert module.inverse.overloads
    # What was spent on a kernel of other sources is forgotten with it.
    file.write_text(KERNELS.replace("1.0 / x", "2.0 / x"))
    done = in_a_process(file, "[inverse(4.0), inverse._cache.spent() < 0.05]")
    assert done.stdout.strip() == "[0.5, True]"


def test_what_python_cannot_do_is_done_by_compiled_code(file):
    module = imported(file)
    with pytest.raises(StoppedInPythonError):
        module.inverse(0.0)
    assert not module.inverse.overloads
    assert in_python_or_compiled(lambda: module.inverse(0.0)) == math.inf
    assert module.inverse(0.0) == math.inf


def test_other_threads_call_compiled_code_meanwhile(file):
    module = imported(file)
    seen = []

    def other():
        module.scaled(module.Group(np.ones(1), 2.0), 0)
        seen.append(list(module.scaled.overloads))

    class Waiting(float):
        """A number in whose product another thread has its turn."""

        def __mul__(self, each):
            if not seen:
                thread = threading.Thread(target=other)
                thread.start()
                thread.join()
            return float(self) * each

    x = np.array([0.1, 0.2])
    module.whole._in_python(x, Waiting(1.7), x.ctypes.data)
    assert seen
    assert seen[0]


def test_nothing_is_lost_where_nothing_can_be_written(file, monkeypatch):
    module = imported(file)
    monkeypatch.setattr(module.inverse._cache, "spend", lambda seconds: None)
    clock = iter(np.arange(0.0, 10.0, 0.015))
    monkeypatch.setattr("time.thread_time", lambda: float(next(clock)))
    for _ in range(5):
        module.inverse(2.0)
    assert module.inverse.overloads
