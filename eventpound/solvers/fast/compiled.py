"""How the kernels of the fast stepper are compiled.

Both ways: kept between processes, without the interpreter's lock, division by
zero gives inf as in NumPy, and a product and a sum may be one rounding (fused);
nothing else is reordered.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

F = TypeVar("F", bound=Callable)
_COMMON: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
}


def compiled(function: F) -> F:
    """Compile a part of every step, which makes no arrays, into whoever calls it.

    It does without Numba's counting of references, which costs an atomic
    operation each time an array is named, and without a call, which would copy
    the groups of arrays it is given: together nine tenths of a step.
    """
    return njit(**_COMMON, _nrt=False, forceinline=True)(function)


def compiled_apart(function: F) -> F:
    """Compile what few steps need, which makes no arrays either, as a function of its own."""
    return njit(**_COMMON, _nrt=False)(function)


def compiled_with_arrays(function: F) -> F:
    """Compile a kernel that may make arrays: what happens at events only."""
    return njit(**_COMMON, _nrt=True, forceinline=True)(function)
