"""Parts that are compiled when a run first calls them: what only some scenes need.

Compiled code calls such a part through a slot, which is empty at first. Whoever finds it
empty asks Python for the address; the part is then loaded or compiled as if Python called
it. A run that never comes there pays for a test of the slot, and nothing for the part.

What a part returns has to be known beforehand, so it is read from its annotation.
"""

from __future__ import annotations

import _thread
import ctypes
import importlib
import os
import pickle
import threading
import traceback
import zlib
from collections.abc import Callable
from functools import cached_property
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba.core import sigutils, types
from numba.core.compiler import compile_result
from numba.core.compiler_lock import global_compiler_lock
from numba.core.funcdesc import ExternalFunctionDescriptor

from eventpound.numerics.compiled.beside import Wanted
from eventpound.numerics.compiled.linked import Entry, KernelPart, PartLibrary

_FILL_SLOT = "eventpound_fill_slot"
"""The name under which machine code finds `_fill_slot`."""
_SOON = 0.01
"""After which a Ctrl-C that waited is raised; machine code runs again long before (s)."""
_stopped = False
_RETURNED = {
    "None": types.none,
    "bool": types.boolean,
    "int": types.int64,
    "float": types.float64,
    "tuple[float, float]": types.UniTuple(types.float64, 2),
    "tuple[float, int, float]": types.Tuple((types.float64, types.int64, types.float64)),
}
"""Numba's types of what a deferred part may return."""


class DeferredEntry(Entry):
    """An `Entry` that other compiled functions call through a slot.

    Attributes
    ----------
    ahead : bool
        Whether every run comes there: another process compiles it beside its caller.
    """

    ahead = False

    @cached_property
    def part(self) -> KernelPart:
        """The same function as other compiled functions call it."""
        return _DeferredPart(self)

    def address_for(self, arguments: tuple[Any, ...]) -> int:
        """Where the machine code for arguments of these types begins."""
        self.compile(arguments)
        made = self.overloads[arguments]
        if made.signature.return_type != _returned_by(self.py_func):
            raise TypeError(f"{self.py_func.__name__} returns {made.signature.return_type}")
        name = made.fndesc.llvm_func_name
        return int(made.library.get_pointer_to_function(name))


class _DeferredPart(KernelPart):
    """A few instructions that call the part through its slot."""

    def __init__(self, entry: DeferredEntry) -> None:
        super().__init__(entry.py_func, entry._options)
        self._entry = entry

    def compile(self, signature: Any) -> Any:
        """Write the call for arguments of these types; the key under which it is called."""
        with global_compiler_lock, self._compiling_counter:
            arguments, _ = sigutils.normalize_signature(signature)
            known = self.overloads.get(tuple(arguments))
            if known is None:
                known = self._call(tuple(arguments))
                self.overloads[tuple(arguments)] = known
            return known.entry_point

    def _call(self, arguments: tuple[Any, ...]) -> Any:
        name = f"{self.py_func.__module__}.{self.py_func.__qualname__}"
        returned = _returned_by(self.py_func)
        mark = f"{name}.{'.'.join(map(str, arguments))}"
        described = ExternalFunctionDescriptor(f"deferred {mark}", returned, arguments)
        library = PartLibrary(self.targetctx.codegen(), name)
        module = library.create_ir_module(name)
        wanted = Wanted(self.py_func.__module__, self.py_func.__qualname__, arguments)
        if self._entry.ahead:
            self._entry.foresee(arguments)
        # Types have long names, which say the same again and again.
        asked = zlib.compress(pickle.dumps(wanted))
        _write_call(self.targetctx.declare_function(module, described), module, mark, asked)
        library.add_ir_module(module)
        library.finalize()
        made = compile_result(
            signature=returned(*arguments),
            entry_point=object(),
            library=library,
            fndesc=described,
            objectmode=False,
        )
        self.targetctx.insert_user_function(made.entry_point, described, [library])
        return made


def _returned_by(function: Callable[..., Any]) -> Any:
    return _RETURNED[function.__annotations__["return"]]


def _write_call(function: ir.Function, module: ir.Module, mark: str, asked: bytes) -> None:
    """The body of a function that hands its arguments on to what the slot points to."""
    byte = ir.IntType(8)
    content = ir.ArrayType(byte, len(asked))
    text = ir.GlobalVariable(module, content, f"asked {mark}")
    text.linkage, text.global_constant = "private", True
    text.initializer = ir.Constant(content, bytearray(asked))
    slot = ir.GlobalVariable(module, byte.as_pointer(), f"slot {mark}")
    slot.linkage, slot.initializer = "internal", ir.Constant(byte.as_pointer(), None)
    size = ir.IntType(64)
    ask = ir.Function(
        module,
        ir.FunctionType(ir.VoidType(), (byte.as_pointer(), size, byte.as_pointer())),
        _FILL_SLOT,
    )
    # What few runs need is not to stand among what every step does.
    function.attributes.add("noinline")
    function.attributes.add("cold")
    builder = ir.IRBuilder(function.append_basic_block())
    check = function.append_basic_block()
    empty, filled = function.append_basic_block(), function.append_basic_block()
    builder.branch(check)
    builder.position_at_end(check)
    found = builder.load(slot)
    none = ir.Constant(byte.as_pointer(), None)
    builder.cbranch(builder.icmp_unsigned("==", found, none), empty, filled)
    builder.position_at_end(empty)
    start, place = (builder.bitcast(each, byte.as_pointer()) for each in (text, slot))
    builder.call(ask, (start, ir.Constant(size, len(asked)), place))
    builder.branch(check)
    builder.position_at_end(filled)
    target = builder.bitcast(found, function.function_type.as_pointer())
    builder.ret(builder.call(target, function.args))


@ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p)
def _fill_slot(asked: int, size: int, slot: int) -> None:
    """What machine code calls while a slot is empty.

    Machine code cannot be left on the way. So it asks again after a Ctrl-C, which is raised
    once the part is made and Python runs again.
    """
    global _stopped
    try:
        wanted: Wanted = pickle.loads(zlib.decompress(ctypes.string_at(asked, size)))
        entry: DeferredEntry = getattr(importlib.import_module(wanted.module), wanted.name)
        address = entry.address_for(wanted.arguments)
        if _stopped:
            _stopped = False
            threading.Timer(_SOON, _thread.interrupt_main).start()
        ctypes.c_void_p.from_address(slot).value = address
    except KeyboardInterrupt:
        _stopped = True
    except BaseException:
        traceback.print_exc()
        os._exit(1)


llvm.add_symbol(_FILL_SLOT, ctypes.cast(_fill_slot, ctypes.c_void_p).value)
