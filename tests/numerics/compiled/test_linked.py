"""Entries and parts: one specialisation, nothing twice, others as ever."""

import pickle
import signal
import threading
import tomllib
from pathlib import Path

import numba
import numpy as np
import pytest
from llvmlite import ir
from numba.core.registry import cpu_target
from numba.core.runtime.nrtdynmod import create_nrt_module

from eventpound.numerics import compiled
from eventpound.numerics.compiled import PLAIN, kernel, scalar_kernel
from eventpound.numerics.compiling import Compiling, Stopwatch, watched
from tests.numerics.compiled.modules import imported, in_a_process, written

linked = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")


@pytest.fixture(scope="module")
def kernels(tmp_path_factory):
    return imported(written(tmp_path_factory.mktemp("kernels")))


def test_an_error_of_a_part_reaches_python(kernels):
    assert kernels.refused(2) == 2
    with pytest.raises(ValueError, match="more than three"):
        kernels.refused(4)


def test_an_error_of_a_kept_kernel_reaches_python(tmp_path):
    file = written(tmp_path)
    for _ in range(2):
        with pytest.raises(ValueError, match="more than three"):
            imported(file).refused(4)


def test_other_packages_compile_as_ever(kernels):
    """A plain Numba function may call a kernel, and is no entry of ours."""
    power = kernels.power

    @numba.njit
    def summed(x):
        return power(x, 2) + np.sum(np.ones(3))

    kernels.powers(2.0)
    assert summed(3.0) == 12.0
    (made,) = summed.overloads.values()
    assert type(made.library) is numba.core.codegen.JITCodeLibrary


def test_the_collector_is_left_as_it_was(kernels):
    import gc

    assert gc.isenabled()
    kernels.doubled(np.float32(1.0))
    assert gc.isenabled()
    gc.disable()
    try:
        kernels.powers(np.float32(1.0))
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_threads_that_ask_at_once(tmp_path):
    module = imported(written(tmp_path))
    found: list[float] = []
    threads = [
        threading.Thread(target=lambda: found.append(float(module.powers(2.0)[2])))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [8.0] * 8


def test_a_kernel_is_pickled_by_where_it_is():
    from eventpound.mechanics.elements import z_rate

    assert pickle.loads(pickle.dumps(z_rate)) is z_rate


def test_a_compilation_is_watched_and_timed(tmp_path):
    seen: list[Compiling | None] = []
    module = imported(written(tmp_path))
    watch = Stopwatch()
    with watched(seen.append):
        module.powers(2.0)
        module.powers(3.0)
    assert seen[-1] is None
    states = [state for state in seen if state is not None]
    assert states[0].done == 0
    assert {state.total for state in states} == {3}  # powers, power, halved
    assert watch.compilation > 0.0
    assert watch.seconds >= 0.0
    assert imported(tmp_path / "kernels.py").powers(2.0)[2] == 8.0
    with watched(seen.append):
        pass
    assert seen.count(None) == 1


@linked
def test_an_interrupt_leaves_no_part_half_made(tmp_path, monkeypatch):
    from eventpound.numerics.compiled.linked import PartLibrary

    file, whole, add = written(tmp_path), [], PartLibrary.add_ir_module

    def interrupted(self, module):
        signal.raise_signal(signal.SIGINT)
        add(self, module)
        whole.append(self)

    # A process that was started in the background ignores it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with monkeypatch.context() as patch:
            patch.setattr(PartLibrary, "add_ir_module", interrupted)
            with pytest.raises(KeyboardInterrupt):
                imported(file).powers(2.0)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(whole) == 1
    assert imported(file).powers(2.0)[2] == 8.0


def test_an_unknown_numba_is_named_once_and_gives_the_same(tmp_path):
    file = written(tmp_path)
    own = imported(file).powers(1.7).tolist()
    text = file.read_text().replace(
        "import numpy as np", "import numpy as np\nimport numba\nnumba.__version__ = '9.1.0'", 1
    )
    file.write_text(text)
    done = in_a_process(file, "powers(1.7).tolist(), power(2.0, 2)")
    assert done.stdout == f"{own} 4.0\n", done.stderr
    assert done.stderr.count("Numba 9.1.0 is not one that this version was tested with") == 1


def test_the_oldest_numba_asked_for_is_known():
    asked = tomllib.loads(Path(__file__).parents[3].joinpath("pyproject.toml").read_text())
    (least,) = (each for each in asked["project"]["dependencies"] if each.startswith("numba"))
    assert least == f"numba>={compiled.KNOWN_NUMBA[0]}"
    assert len(compiled.KNOWN_NUMBA) >= 3


def test_without_compilation(tmp_path):
    done = in_a_process(written(tmp_path), "powers(2.0).tolist()", NUMBA_DISABLE_JIT="1")
    assert done.stdout == "[2.0, 4.0, 8.0, 2.0]\n", done.stderr


def test_kernels_say_whether_sums_may_be_fused():
    """What a kernel is compiled with is part of the name under which it is kept."""

    def product(x: float, y: float) -> float:
        return x * y + 1.0

    ways = {repr(scalar_kernel.but(fused=fused)(product)._cache._way) for fused in (False, True)}
    assert len(ways) == 2
    assert kernel(product)(2.0, 3.0) == scalar_kernel(product)(2.0, 3.0) == 7.0


@linked
def test_an_interrupt_that_numba_takes_for_a_fault_is_an_interrupt(kernels, monkeypatch):
    """As when Ctrl-C comes while the type of an argument is told, or a result is made."""

    def interrupted(self, *_):
        complaint = SystemError("returned a result with an exception set")
        complaint.__cause__ = KeyboardInterrupt()
        raise SystemError("returned a result with an exception set") from complaint

    kernels.doubled(1.0)
    monkeypatch.setattr(type(kernels.doubled), "typeof_pyval", interrupted)
    with pytest.raises(KeyboardInterrupt):
        kernels.doubled((1.0, 2.0))


COUNTED_BY_NUMBA = {
    "NRT_incref": "icmp br ret void bitcast nrt_atomic_add ret void",
    "NRT_decref": "icmp br ret void fence bitcast nrt_atomic_sub icmp br"
    " fence NRT_MemInfo_call_dtor br ret void",
    "nrt_atomic_add": "atomicrmw add ret",
    "nrt_atomic_sub": "atomicrmw sub ret",
}


@linked
@pytest.mark.parametrize("name", COUNTED_BY_NUMBA)
def test_references_are_counted_as_numba_counts_them(name):
    """Ours stand in for Numba's, as plain sums: nothing else may happen in these."""
    module, _ = create_nrt_module(cpu_target.target_context)
    done = [each for block in module.globals[name].blocks for each in block.instructions]
    words = [e.callee.name if isinstance(e, ir.CallInstr) else e.opname for e in done]
    assert " ".join(words) == COUNTED_BY_NUMBA[name]
