"""Kernels whose parts are linked and optimised once, under the function that Python calls.

To Numba every function is an end product: the whole tree of calls below it is
optimised, made into machine code and kept, though only the top one is called from
Python. A part at depth d is so made d times. Here a function is two things:

* an *entry*, when Python calls it: the parts below it are linked into its module,
  made internal to it, and the module is optimised once;
* a *part*, when another compiled function calls it: it is lowered to LLVM's
  language, and nothing more.

Each has a dispatcher of its own, and Numba's typing sees the part's only, so that
which of the two is meant is never in question. Compiled functions of other packages
are compiled as ever, and may call ours: a part hands over its whole tree then.

Numba's interfaces used are the dispatcher, the compiler's pipeline class and the
code library (Numba 0.68, `numba.core.dispatcher`, `compiler`, `codegen`); where the
Numba installed is one that the tests do not know, `eventpound.numerics.compiled`
does without this module.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, cached_property, update_wrapper
from typing import Any

import llvmlite.binding as llvm
from numba.core import sigutils, types
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import _FunctionCompiler
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher

from eventpound.basics.interruption import is_interruption
from eventpound.numerics.compiled.beside import Wanted, compile_beside
from eventpound.numerics.compiled.recipe import Recipe
from eventpound.numerics.compiling import function_read, getting_ready

_ENVIRONMENT = "_ZN08NumbaEnv"
"""How the names begin under which Numba's code finds its Python objects."""
_UNWINDING = "__excinfo"
"""How the names of helpers begin that several functions may define alike."""
_COUNTING = """
define void @NRT_incref(ptr %array) {
  %none = icmp eq ptr %array, null
  br i1 %none, label %end, label %count
count:
  %before = load i64, ptr %array, align 8
  %after = add i64 %before, 1
  store i64 %after, ptr %array, align 8
  br label %end
end:
  ret void
}

define void @NRT_decref(ptr %array) {
  %none = icmp eq ptr %array, null
  br i1 %none, label %end, label %count
count:
  %before = load i64, ptr %array, align 8
  %after = add i64 %before, -1
  store i64 %after, ptr %array, align 8
  %last = icmp eq i64 %after, 0
  br i1 %last, label %free, label %end
free:
  tail call void @NRT_MemInfo_call_dtor(ptr nonnull %array)
  ret void
end:
  ret void
}

declare void @NRT_MemInfo_call_dtor(ptr)
"""
"""References counted by plain sums. Numba's are atomic, for arrays that several threads share
within one call; here none does, and a call from Python counts on counters of its own. They are
compiled in where arrays are named: most are borrowed or by address and have no counter, and a call
that finds none takes numbers out of all registers."""


class PartLibrary(JITCodeLibrary):
    """Code of one function, neither linked nor made into machine code."""

    inlined = False
    recipe: Recipe | None = None

    def _optimize_functions(self, module: Any) -> None:
        """Passes over each function by itself, which make its code a third as long."""
        module.data_layout = self._codegen._data_layout
        manager, builder = self._codegen._function_pass_manager()
        for function in module.functions:
            manager.run(function, builder)

    def finalize(self) -> None:
        """Nothing is left to do."""
        self._raise_if_finalized()
        self._finalized = True

    @cached_property
    def shared(self) -> Any:
        """The module, its functions free to be dropped by whoever links it."""
        self._ensure_finalized()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.external:
                function.linkage = "linkonce_odr"
        return self._final_module

    def _get_module_for_linking(self) -> Any:
        """The module and all below it, for a library of Numba's own kind."""
        if self._shared_module is None:
            whole = self.shared.clone()
            for library in _callers_first(self):
                whole.link_in(_module_of(library), preserve=True)
            self._shared_module = whole
        return self._shared_module


class EntryLibrary(PartLibrary):
    """Code of one function and of everything below it."""

    recipe: Recipe

    def finalize(self) -> None:
        """Link all parts, optimise once, and make machine code."""
        self._raise_if_finalized()
        self._codegen._check_llvm_bugs()
        module = self._final_module
        own = {
            function.name
            for function in module.functions
            if not (function.is_declaration or function.name.startswith(_UNWINDING))
        }
        forced: set[str] = set()
        module.link_in(llvm.parse_assembly(_COUNTING))
        for library in _callers_first(self):
            self._reload_init.update(library._reload_init)
            part = _module_of(library)
            if self.recipe.forced and getattr(library, "inlined", False):
                forced.update(f.name for f in part.functions if not f.is_declaration)
            module.link_in(part, preserve=True)
        _hide(module, own, forced)
        self._optimize_final_module()
        module.verify()
        self._finalize_final_module()

    def _optimize_final_module(self) -> None:
        manager, builder = self._codegen._module_pass_manager(
            opt=self.recipe.level, loop_vectorize=False
        )
        manager.run(self._final_module, builder)

    def _finalize_specific(self) -> None:
        super()._finalize_specific()
        # Parts have no executable of their own that would do this.
        for variable in self._final_module.global_variables:
            if variable.name.startswith(_ENVIRONMENT):
                environment = lookup_environment(variable.name)
                if environment is not None:
                    self._codegen.set_env(variable.name, environment)

    def serialize_using_object_code(self) -> Any:
        """Machine code and the names in it; Numba keeps the code for linking besides.

        No one links an entry: whoever calls the function links the part.
        """
        self._ensure_finalized()
        names = [f"define void @{_quoted(f)}() {{ ret void }}" for f in self._named("functions")]
        names += [
            f"@{_quoted(v)} = common global ptr null" for v in self._named("global_variables")
        ]
        stub = llvm.parse_assembly("\n".join(names))
        return (self.name, "object", (self._get_compiled_object(), stub.as_bitcode()))

    def _named(self, what: str) -> Iterator[str]:
        """Names of what can be looked up from outside."""
        for value in getattr(self._final_module, what):
            hidden = value.linkage in (llvm.Linkage.internal, llvm.Linkage.private)
            if not (value.is_declaration or hidden):
                yield value.name


def _hide(module: Any, own: set[str], forced: set[str]) -> None:
    """Make all functions but its `own` internal to a module, to be compiled in where `forced`."""
    for function in module.functions:
        if function.is_declaration or function.name in own:
            continue
        function.linkage = "internal"
        if function.name in forced:
            function.add_function_attribute("alwaysinline")


def _quoted(name: str) -> str:
    return f'"{name}"'


def _module_of(library: Any) -> Any:
    return library.shared if isinstance(library, PartLibrary) else library._get_module_for_linking()


def _callers_first(library: Any) -> list[Any]:
    """All libraries below one, whoever calls before whom it calls.

    LLVM links what may be dropped only where something linked before asks for it.
    """
    visited: set[int] = set()
    found: list[Any] = []

    def visit(caller: Any) -> None:
        for each in caller._linking_libraries:
            if id(each) not in visited:
                visited.add(id(each))
                if isinstance(each, PartLibrary):
                    visit(each)
                found.append(each)

    visit(library)
    return found[::-1]


@cache
def _pipeline(recipe: Recipe | None) -> type[Compiler]:
    """Numba's pipeline with a library of ours: of entries that are optimised so, else of parts."""

    class Pipeline(Compiler):
        def compile_extra(self, function: Callable[..., Any]) -> Any:
            kind = PartLibrary if recipe is None else EntryLibrary
            library = kind(self.state.targetctx.codegen(), function.__qualname__)
            library.recipe = recipe
            library.enable_object_caching()
            self.state.library = library
            return super().compile_extra(function)

    return Pipeline


class _PartCompiler(_FunctionCompiler):
    def _customize_flags(self, flags: Any) -> Any:
        flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        # Who is compiled into whom is the entry's to say.
        flags.forceinline = False
        return flags


class _EntryCompiler(_FunctionCompiler):
    def _customize_flags(self, flags: Any) -> Any:
        flags.no_cfunc_wrapper = True
        flags.forceinline = False
        return flags


class KernelPart(CPUDispatcher):
    """A kernel as other compiled functions call it."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        super().__init__(function, {}, options)
        self._compiler = _PartCompiler(function, self.targetdescr, options, {}, _pipeline(None))
        self._inlined = options.get("forceinline", False)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """One specialisation for all values of a constant: LLVM sees the value all the same."""
        return super().get_call_template(
            tuple(map(types.unliteral, args)),
            {name: types.unliteral(each) for name, each in kws.items()},
        )

    def compile(self, signature: Any) -> Any:
        """Lower the function for arguments of these types; the key under which it is called."""
        with global_compiler_lock, self._compiling_counter:
            args, return_type = sigutils.normalize_signature(signature)
            known = self.overloads.get(tuple(args))
            if known is None:
                known = self._compiler.compile(args, return_type)
                known = known._replace(entry_point=object())
                known.library.inlined = self._inlined
                self.targetctx.insert_user_function(
                    known.entry_point, known.fndesc, [known.library]
                )
                self.overloads[tuple(known.signature.args)] = known
            function_read(self.py_func)
            return known.entry_point


class _Thread(threading.local):
    """What holds for one thread."""

    interprets = False
    """Whether the function that it runs, and all that one calls, is run by Python."""


in_this_thread = _Thread()


@contextmanager
def _collector_held_off() -> Iterator[None]:
    """Compile without Python's collector, which goes through millions of objects for nothing.

    For one who holds Numba's compiler lock.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


class Entry(CPUDispatcher):
    """A function as Python calls it.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    options : dict
        Numba's options of `jit`.
    recipe : Recipe
        How it is optimised with all its parts.
    store : Cache
        Where what is compiled is kept.

    Attributes
    ----------
    plain : callable
        What stands for it where Python runs the function that calls it.
    """

    def __init__(
        self, function: Callable[..., Any], options: dict[str, Any], recipe: Recipe, store: Any
    ) -> None:
        self.py_func, self._options, self._recipe, self._store = function, options, recipe, store
        update_wrapper(self, function)

    def __getattr__(self, name: str) -> Any:
        """What Numba's dispatcher has: of most entries nobody ever asks for it."""
        self._make()
        return object.__getattribute__(self, name)

    def _make(self) -> None:
        """Make the dispatcher, once."""
        with global_compiler_lock:
            if "_store" in self.__dict__:
                function, options = self.py_func, self._options
                super().__init__(function, {}, options)
                pipeline = _pipeline(self._recipe)
                self._compiler = _EntryCompiler(function, self.targetdescr, options, {}, pipeline)
                # At last: no other thread calls it before.
                self._cache = self.__dict__.pop("_store")

    @cached_property
    def part(self) -> KernelPart:
        """The same function as other compiled functions call it."""
        return KernelPart(self.py_func, self._options)

    @property
    def _numba_type_(self) -> Any:
        return self.part._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        """Call the function.

        To tell the type of a named tuple, and to make one, Numba runs Python, where a Ctrl-C
        is answered; it then complains of an exception that it did not expect.
        """
        if in_this_thread.interprets:
            return self.py_func(*arguments)
        if "_store" in self.__dict__:
            self._make()
        try:
            return super().__call__(*arguments)
        except SystemError as error:
            if is_interruption(error):
                raise KeyboardInterrupt from error
            raise

    @cached_property
    def _foreseen(self) -> set[tuple[Any, ...]]:
        return set()

    def foresee(self, arguments: tuple[Any, ...]) -> None:
        """Have another process make what is not kept yet, for arguments of these types."""
        if arguments in self._foreseen:
            return
        self._foreseen.add(arguments)
        self._make()
        if arguments not in self.overloads and not self._cache.has(arguments, self.targetctx):
            function = self.py_func
            compile_beside(Wanted(function.__module__, function.__qualname__, arguments))

    def compile(self, signature: Any) -> Any:
        """Make the function ready for arguments of these types."""
        self._make()
        with getting_ready(self.py_func), global_compiler_lock, _collector_held_off():
            try:
                return super().compile(signature)
            finally:
                self._cache.release()

    def __reduce__(self) -> Any:
        return _by_name, (self.py_func.__module__, self.py_func.__qualname__)


def _by_name(module: str, name: str) -> Any:
    """A kernel by where it is, which is how it is pickled."""
    import importlib

    return getattr(importlib.import_module(module), name)


class LinkedCallback(CFunc):
    """A function that a library written in C calls, linked like an entry."""

    def compile(self) -> None:
        """Make the function ready; its address is known then."""
        with global_compiler_lock, _collector_held_off():
            try:
                super().compile()
            finally:
                self._cache.release()


def linked_callback(function: Callable[..., Any], signature: Any, recipe: Recipe) -> CFunc:
    """A `LinkedCallback`, not compiled yet.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    signature : numba signature
        Types of what it returns and is given.
    recipe : Recipe
        How it is optimised.
    """
    types_of = (signature.args, signature.return_type)
    pipeline = _pipeline(recipe)
    return LinkedCallback(function, types_of, locals={}, options={}, pipeline_class=pipeline)
