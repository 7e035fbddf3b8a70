"""How functions are compiled: kept between processes, and the same whoever calls them.

Numba lets a compiled function take every option it does not name from the one
that calls it first; so every option that matters is named here. Division by zero gives
inf, as in NumPy. A function called from Python is linked and optimised once with all its
parts (`linked`), and kept as long as no source of it has changed (`store`, `sources`).

`linked` works on the inside of Numba. Where the Numba installed is none that the tests
know, or `EVENTPOUND_PLAIN_NUMBA` is set, Numba compiles in its own way: the same answers,
but for the last bit of sums that are fused, and some four times the time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba import config

from eventpound.numerics.compiled.recipe import EVERY_STEP, ONCE_AN_EVENT, Recipe
from eventpound.numerics.compiled.store import KernelStore, say_once
from eventpound.numerics.compiling import function_read, getting_ready

F = TypeVar("F", bound=Callable[..., Any])

KNOWN_NUMBA = ("0.66", "0.67", "0.68")
"""Series of Numba whose inside the tests know."""
_UNKNOWN = numba.__version__.rpartition(".")[0] not in KNOWN_NUMBA
PLAIN = _UNKNOWN or os.environ.get("EVENTPOUND_PLAIN_NUMBA", "0") != "0"
"""Whether Numba compiles in its own way."""
INTERPRETED = bool(config.DISABLE_JIT)
"""Whether nothing is compiled, as `NUMBA_DISABLE_JIT` has it: slow, for debuggers."""


@dataclass(frozen=True)
class KernelKind:
    """A way in which functions are compiled, and the decorator that has it done.

    Attributes
    ----------
    counted : bool
        Whether arrays are counted references, without which none can be made or
        returned. Each array named then costs two sums.
    inlined : bool
        Compile it into whoever calls it, where the recipe of the whole is `SMALL`.
    fused : bool
        Whether a product and a sum may be one rounding.
    recipe : Recipe
        How it is optimised with all its parts where Python calls it.
    deferred : bool
        Whether compiled code that calls it has it compiled only when it comes there; see
        `eventpound.numerics.compiled.deferred`.
    ahead : bool
        Whether every run comes to a deferred one, which another process then compiles meanwhile.
    """

    counted: bool = False
    inlined: bool = False
    fused: bool = False
    recipe: Recipe = ONCE_AN_EVENT
    deferred: bool = False
    ahead: bool = False

    def but(self, **others: Any) -> KernelKind:
        """The same with other attributes."""
        return replace(self, **others)

    def __call__(self, function: F) -> F:
        """Compile a function, which is in Numba's part of Python."""
        if INTERPRETED:
            return function
        options: dict[str, Any] = {
            "nogil": True,
            "error_model": "numpy",
            "fastmath": {"contract"} if self.fused else False,
            "forceinline": self.inlined,
            "_nrt": self.counted,
        }
        store = KernelStore(function, (sorted(options.items()), self.recipe), PLAIN)
        made: Any
        if PLAIN:
            made = numba.njit(**options)(function)
            made._cache = store
            made.compile = _timed(made.compile, function)
            return cast(F, made)
        options = {"nopython": True, "boundscheck": None, **options}
        if self.deferred:
            from eventpound.numerics.compiled.deferred import DeferredEntry

            made = DeferredEntry(function, options, self.recipe, store)
            made.ahead = self.ahead
        else:
            from eventpound.numerics.compiled.linked import Entry

            made = Entry(function, options, self.recipe, store)
        return cast(F, made)


kernel = KernelKind(counted=True)
"""May make arrays."""
scalar_kernel = KernelKind()
"""Makes and returns no arrays."""
step_kernel = KernelKind(inlined=True)
"""Makes no arrays either, and is done in every step: a call that copies the groups of arrays it is
given may cost more than what it does."""
deferred_kernel = KernelKind(counted=True, recipe=EVERY_STEP, deferred=True)
"""May make arrays, and is compiled by itself when compiled code first calls it: what only some
scenes need, or, with `ahead`, what another core compiles meanwhile. What it returns is one of those
that `eventpound.numerics.compiled.deferred` lists."""


def _timed(compile_for: Callable[[Any], Any], function: Callable[..., Any]) -> Any:
    """What compiles a function in Numba's own way, its time counted as compilation."""

    def timed(signature: Any) -> Any:
        if _UNKNOWN:
            say_once(
                f"Numba {numba.__version__} is not one that this version was tested with "
                f"({', '.join(KNOWN_NUMBA)}): the same results, but compiling takes four times "
                "as long"
            )
        with getting_ready(function):
            found = compile_for(signature)
            function_read(function)
            return found

    return timed


def foresee(function: Callable[..., Any], *given: Any) -> None:
    """Have a kernel to which a run will come compiled on another core from now on."""
    if hasattr(function, "foresee"):
        function.foresee(tuple(map(numba.typeof, given)))


class PlainInPython:
    """A kernel to compiled code; Python runs another function in its place.

    For kernels whose arrays own nothing: Python could not keep alive what they lie in.

    Parameters
    ----------
    plain : callable
        What Python runs.
    made : callable
        The kernel.
    """

    def __init__(self, plain: Callable[..., Any], made: Any) -> None:
        self._plain, self._made = plain, made

    def __call__(self, *arguments: Any) -> Any:
        """Run what Python runs."""
        return self._plain(*arguments)

    @property
    def _numba_type_(self) -> Any:
        return self._made._numba_type_


def in_python(function: F) -> F:
    """A compiled function as Python runs it: for what costs less than handing it over."""
    plain: F = getattr(function, "py_func", function)
    return plain


@contextmanager
def by_python() -> Iterator[None]:
    """Let Python run every compiled function that is called meanwhile: what is done seldom."""
    with np.errstate(all="ignore"):
        if PLAIN or INTERPRETED:
            yield
            return
        from eventpound.numerics.compiled.linked import in_this_thread

        before, in_this_thread.interprets = in_this_thread.interprets, True
        try:
            yield
        finally:
            in_this_thread.interprets = before


def callback(function: Callable[..., Any], signature: Any) -> Any:
    """Compile a function that a library written in C calls.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    signature : numba signature
        Types of what it returns and is given.
    """
    store = KernelStore(function, ("callback", EVERY_STEP), PLAIN)
    made: Any
    if PLAIN:
        from numba.core.ccallback import CFunc

        made = CFunc(function, (signature.args, signature.return_type), locals={}, options={})
    else:
        from eventpound.numerics.compiled.linked import linked_callback

        made = linked_callback(function, signature, EVERY_STEP)
    made._cache = store
    with getting_ready(function):
        made.compile()
    return made
