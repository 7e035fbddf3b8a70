"""How functions are compiled: kept between processes, and the same whoever calls them.

Numba lets a compiled function take every option it does not name from the one
that calls it first, and keeps the result under the same name; so every option
that matters is named here. Division by zero gives inf, as in NumPy. A function called
from Python is linked and optimised once with all its parts
(`eventpound.numerics.compiled.linked`), and kept as long as no source of it has
changed (`store`, `sources`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import config

from eventpound.numerics.compiled.linked import Entry, Recipe, linked_callback
from eventpound.numerics.compiled.store import KernelStore

F = TypeVar("F", bound=Callable[..., Any])

ONCE_AN_EVENT = Recipe(level=1, forced=False)
"""For what Python calls seldom: two thirds of the time to compile, a little slower."""
EVERY_STEP = Recipe(level=2, forced=False)
"""For large kernels: LLVM chooses what is compiled into what."""
SMALL = Recipe(level=3, forced=True)
"""For loops of a few thousand instructions, into which their parts are compiled."""


def compile_with(
    function: F,
    *,
    counted: bool,
    inlined: bool = False,
    fused: bool = False,
    recipe: Recipe = ONCE_AN_EVENT,
) -> F:
    """Compile a function.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    counted : bool
        Whether arrays are counted references, without which none can be made or
        returned. Each array named then costs two atomic operations.
    inlined : bool
        Compile it into whoever calls it, where the recipe of the whole is `SMALL`.
    fused : bool
        Whether a product and a sum may be one rounding.
    recipe : Recipe
        How it is optimised with all its parts where Python calls it.
    """
    if config.DISABLE_JIT:
        return function
    options: dict[str, Any] = {
        "nopython": True,
        "boundscheck": None,
        "nogil": True,
        "error_model": "numpy",
        "fastmath": {"contract"} if fused else False,
        "forceinline": inlined,
        "_nrt": counted,
    }
    way = (sorted(options.items()), recipe)
    entry: Any = Entry(function, options, recipe, KernelStore(function, way))
    return entry


def kernel(function: F) -> F:
    """Compile a function that may make arrays."""
    return compile_with(function, counted=True)


def loop_kernel(function: F) -> F:
    """Compile a loop over steps that may make arrays."""
    return compile_with(function, counted=True, recipe=EVERY_STEP)


def scalar_kernel(function: F) -> F:
    """Compile a function that makes and returns no arrays."""
    return compile_with(function, counted=False)


def in_python(function: F) -> F:
    """A compiled function as Python runs it: for what costs less than handing it over."""
    plain: F = getattr(function, "py_func", function)
    return plain


def callback(function: Callable[..., Any], signature: Any) -> Any:
    """Compile a function that a library written in C calls.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    signature : numba signature
        Types of what it returns and is given.
    """
    store = KernelStore(function, ("callback", EVERY_STEP))
    return linked_callback(function, signature, EVERY_STEP, store)
