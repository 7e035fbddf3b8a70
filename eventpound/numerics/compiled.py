"""How functions are compiled: kept between processes, and the same whoever calls them.

Numba lets a compiled function take every option it does not name from the one
that calls it first, and keeps the result under the same name; so every option
that matters is named here. Division by zero gives inf, as in NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

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
    return njit(**options)(function)


def kernel(function: F) -> F:
    """Compile a function that may make arrays."""
    return compile_with(function, counted=True)


def scalar_kernel(function: F) -> F:
    """Compile a function that makes and returns no arrays."""
    return compile_with(function, counted=False)
