"""Parts that another process compiles, and kernels that one makes while others wait."""

import subprocess
import sys
import threading
import time

import pytest
from numba import float64
from numba.core.errors import TypingError

from eventpound.numerics.compiled import PLAIN, beside, store
from tests.numerics.compiled.modules import imported

pytestmark = pytest.mark.skipif(
    PLAIN or beside.fcntl is None, reason="every process compiles for itself here"
)

KERNELS = """\
from __future__ import annotations

from eventpound.numerics.compiled import deferred_kernel, kernel


@deferred_kernel.but(ahead=True)
def cubed(x: float) -> float:
    return x * x * x


@kernel
def whole(x):
    return cubed(x) if x > 2.0 else 0.0


@kernel
def refused(x):
    return x.nothing
"""
LONG = 60.0
"""What a busy machine may take (s)."""


@pytest.fixture
def file(tmp_path, monkeypatch):
    made = tmp_path / "kernels.py"
    made.write_text(KERNELS)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    return made


WAIT = f"""
import time
from pathlib import Path
began = time.monotonic()
while time.monotonic() < began + {LONG} and not list(
    Path(__import__("kernels").__file__).parent.glob("__pycache__/kernels.cubed-*.kernel")
):
    time.sleep(0.05)
"""


@pytest.mark.parametrize(("cores", "times"), [(2, 1), (1, 0)])
def test_a_part_is_made_by_another_process(file, cores, times):
    """The caller never comes to the part, which is kept all the same where there is a core."""
    wait = WAIT if times else ""
    program = f"""
from eventpound.numerics.compiled import beside
beside.cores = lambda: {cores}
from kernels import cubed, whole
assert whole(1.0) == 0.0
{wait}
found = whole(3.0)
print(found, sum(cubed.stats.cache_hits.values()), beside._process is not None)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.split() == ["27.0", str(times), str(cores > 1)], done.stderr


def test_who_compiles_ends_with_whoever_asked(file):
    process = subprocess.Popen([sys.executable, "-c", beside._PROGRAM], stdin=subprocess.PIPE)
    process.stdin.close()
    assert process.wait(LONG) == 0


def test_a_kernel_that_is_being_made_is_waited_for(tmp_path):
    """Whoever comes second goes on once the first has let go, also without having made it."""
    path, order, asked = tmp_path / "any.kernel", [], threading.Event()
    first = beside.Claim(path, lambda: None)

    def comes_second():
        second = beside.Claim(path, asked.set)
        order.append("second")
        second.release()

    waiting = threading.Thread(target=comes_second)
    waiting.start()
    assert asked.wait(LONG)
    order.append("first")
    first.release()
    waiting.join(LONG)
    assert order == ["first", "second"]
    assert not list(tmp_path.iterdir())


def test_who_waits_compiles_what_is_asked_for(file, monkeypatch):
    """But not what is waited for, once more."""

    class Waiting(beside.Claim):
        @staticmethod
        def _take(opened, waits):
            waits()

    module = imported(file)
    asked = [beside.Wanted("kernels", name, (float64,)) for name in ("whole", "cubed")]
    monkeypatch.setattr(beside, "_asked", asked)
    monkeypatch.setattr(store, "Claim", Waiting)
    assert module.whole(1.0) == 0.0
    assert asked == []
    assert list(module.cubed.overloads) == [(float64,)]


def test_waiting_ends_by_a_signal(tmp_path):
    first = beside.Claim(tmp_path / "any.kernel", lambda: None)

    def interrupted():
        raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        beside.Claim(tmp_path / "any.kernel", interrupted)
    first.release()
    assert time.monotonic() - began < LONG


def test_what_cannot_be_compiled_is_let_go(file):
    with pytest.raises(TypingError):
        imported(file).refused(1.0)
    assert not list(file.parent.rglob("*.making"))
