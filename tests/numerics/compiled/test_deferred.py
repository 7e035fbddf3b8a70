"""Parts that are compiled when compiled code first calls them."""

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from eventpound.numerics.compiled import PLAIN
from tests.numerics.compiled.modules import imported, in_a_process

pytestmark = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")

KERNELS = """\
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel


class Group(NamedTuple):
    x: np.ndarray
    factor: float


@deferred_kernel
def scaled_sum(group, n: int) -> float:
    terms = np.zeros(n)
    for i in range(n):
        terms[i] = group.factor * group.x[i % group.x.size]
    return terms.sum()


@deferred_kernel
def fill(x, value: float) -> None:
    for i in range(x.size):
        x[i] = value


@deferred_kernel
def ends(x) -> tuple[float, float]:
    return x[0], x[x.size - 1]


@kernel
def whole(x, factor, n):
    total = 0.0
    if n > 2:
        total += scaled_sum(Group(x, factor), n)
    if n > 5:
        fill(x, 2.0)
    first, last = ends(x) if n > 3 else (0.0, 0.0)
    return total, first, last


@deferred_kernel
def told_wrongly(x: float) -> int:
    return 0.5 * x


@kernel
def asks_for_it(x):
    return told_wrongly(x)
"""
FOLLOWS = 7.0, 1.0, 3.0
"""`whole` of 1, 2, 3 with the factor 1 and n = 4."""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """The module, whose kernels are kept from test to test."""
    made = tmp_path_factory.mktemp("deferred") / "kernels.py"
    made.write_text(KERNELS)
    return made


def of(module, n):
    x = np.array([1.0, 2.0, 3.0])
    return module.whole(x, 1.0, n), x


def kept(folder):
    return {path.name.split("-")[0] for path in (folder / "__pycache__").glob("*.kernel")}


def test_nothing_is_compiled_before_it_is_called(tmp_path):
    file = tmp_path / "kernels.py"
    file.write_text(KERNELS)
    module = imported(file)
    assert of(module, 2)[0] == (0.0, 0.0, 0.0)
    assert kept(tmp_path) == {"kernels.whole"}
    assert of(module, 4)[0] == FOLLOWS
    assert kept(tmp_path) == {"kernels.whole", "kernels.scaled_sum", "kernels.ends"}


def test_the_answers_are_those_of_python(file):
    module = imported(file)
    for n in (2, 3, 4, 6, 11):
        expected = np.array([1.0, 2.0, 3.0])
        assert of(module, n)[0] == module.whole.py_func(expected, 1.0, n)
        np.testing.assert_array_equal(of(module, n)[1], expected)


def test_a_kept_kernel_finds_its_parts_again(file):
    of(imported(file), 4)
    done = in_a_process(file, "[whole(np.arange(1.0, 4.0), 1.0, 4), whole.stats.cache_misses]")
    assert done.stdout.strip() == f"[{FOLLOWS}, Counter()]"


def test_several_threads_may_come_there_first(file):
    module = imported(file)
    of(module, 2)
    with ThreadPoolExecutor(8) as pool:
        assert {answer for answer, _ in pool.map(lambda _: of(module, 4), range(40))} == {FOLLOWS}


def test_an_interrupt_waits_until_machine_code_is_left(file, monkeypatch):
    module = imported(file)
    of(module, 2)
    entry, stops = type(module.scaled_sum), iter([True])
    made = entry.address_for

    def stopped_once(self, arguments):
        if next(stops, False):
            raise KeyboardInterrupt
        return made(self, arguments)

    monkeypatch.setattr(entry, "address_for", stopped_once)
    answers = []

    def wait_for_it():
        answers.append(of(module, 4)[0])
        for _ in range(1000):
            # It does not end a sleep.
            time.sleep(0.01)

    with pytest.raises(KeyboardInterrupt):
        wait_for_it()
    assert answers == [FOLLOWS]


def test_what_is_not_what_was_told_ends_the_process(file):
    """There is no way back into compiled code without a part that it can call."""
    done = in_a_process(file, "asks_for_it(1.0)")
    assert done.returncode == 1
    assert "told_wrongly returns float64" in done.stderr
