"""How the kernels of the fast stepper are compiled.

Both ways: kept between processes, without the interpreter's lock, division by
zero gives inf as in NumPy, and a product and a sum may be one rounding (fused);
nothing else is reordered.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from numba import njit

F = TypeVar("F", bound=Callable)


def compiled(function: F) -> F:
    """Compile a kernel that makes no arrays.

    It does without Numba's counting of references, which costs an atomic
    operation each time an array is named and made up two thirds of a step.
    """
    return njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False)(
        function
    )


def compiled_with_arrays(function: F) -> F:
    """Compile a kernel that may make arrays: what happens at events only."""
    return njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=True)(
        function
    )
