"""How functions are compiled: kept between processes, and the same whoever calls them.

Numba lets a compiled function take every option it does not name from the one
that calls it first, and keeps the result under the same name; so every option
that matters is named here. Division by zero gives inf, as in NumPy. What is kept
is used as long as no source of it has changed (`eventpound.numerics.sources`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit
from numba.core.ccallback import CFunc

from eventpound.numerics.sources import source_stamp

F = TypeVar("F", bound=Callable[..., Any])


def compile_with(function: F, *, counted: bool, inlined: bool = False, fused: bool = False) -> F:
    """Compile a function.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    counted : bool
        Whether arrays are counted references, without which none can be made or
        returned. Each array named then costs two atomic operations.
    inlined : bool
        Compile it into whoever calls it.
    fused : bool
        Whether a product and a sum may be one rounding.
    """
    options: dict[str, Any] = {
        "cache": True,
        "nogil": True,
        "error_model": "numpy",
        "fastmath": {"contract"} if fused else False,
        "forceinline": inlined,
        "_nrt": counted,
    }
    compiled = njit(**options)(function)
    if compiled is not function:
        _keep_until_changed(compiled, function)
    return compiled


def kernel(function: F) -> F:
    """Compile a function that may make arrays."""
    return compile_with(function, counted=True)


def scalar_kernel(function: F) -> F:
    """Compile a function that makes and returns no arrays."""
    return compile_with(function, counted=False)


def callback(function: Callable[..., Any], signature: Any) -> Any:
    """Compile a function that a library written in C calls.

    Parameters
    ----------
    function : callable
        In Numba's part of Python.
    signature : numba signature
        Types of what it returns and is given.
    """
    # What `numba.cfunc` does, which leaves no moment to say what the sources are.
    made = CFunc(function, (signature.args, signature.return_type), locals={}, options={})
    made.enable_caching()
    _keep_until_changed(made, function)
    made.compile()
    return made


def _keep_until_changed(compiled: Any, function: Callable[..., Any]) -> None:
    """Let kept code hold for all its sources, where Numba looks at the function's own file.

    Numba has no public place for this; a test sees to it that this one is heeded.
    """
    stamp = source_stamp(function.__code__.co_filename)
    compiled._cache._cache_file._source_stamp = stamp
