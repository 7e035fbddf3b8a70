"""One CVODE object, made and freed through the library's own functions."""

from __future__ import annotations

import ctypes
import weakref
from typing import Any

import numpy as np

from eventpound.numerics.arrays import Floats

FAMILIES = {"Adams": 1, "BDF": 2}
"""SUNDIALS' numbers of the multistep families."""
MOST_STEPS = 100_000
"""Internal steps of one call."""


class Memory:
    """A CVODE object with its vectors, matrix and linear solver.

    Parameters
    ----------
    library : ctypes.CDLL
        See `eventpound.solvers.sundials.library.library`.
    method : str
        ``"Adams"`` or ``"BDF"``.
    rtol : float
        Relative tolerance.
    atol : ndarray, shape (size,)
        Absolute tolerances.
    band : int
        Half bandwidth of the Jacobian, 0 for a dense one.
    callback, data : int
        Addresses of the right-hand side and of what it is handed.

    Attributes
    ----------
    address, vector, look : int
        The object, the vector of its state, and another to interpolate into.
    state, looked : ndarray, shape (size,)
        Their values.
    """

    def __init__(
        self,
        library: Any,
        method: str,
        rtol: float,
        atol: Floats,
        band: int,
        callback: int,
        data: int,
    ) -> None:
        self._library = library
        size = atol.size
        context = ctypes.c_void_p()
        library.SUNContext_Create(0, ctypes.byref(context))
        # Messages of failures reach the user by way of the flag a call returns.
        library.SUNContext_ClearErrHandlers(context)
        self.address = library.CVodeCreate(FAMILIES[method], context)
        vectors = [library.N_VNew_Serial(size, context) for _ in range(3)]
        self.vector, self.look, tolerances = vectors
        self.state = vector_values(library, self.vector, size)
        vector_values(library, tolerances, size)[:] = atol
        if band:
            matrix = library.SUNBandMatrix(size, band, band, context)
            solver = library.SUNLinSol_Band(self.vector, matrix, context)
        else:
            matrix = library.SUNDenseMatrix(size, size, context)
            solver = library.SUNLinSol_Dense(self.vector, matrix, context)
        self._finalizer = weakref.finalize(
            self, _free, library, self.address, vectors, matrix, solver, context
        )
        # At the end of the process another thread may still be at it.
        self._finalizer.atexit = False
        self.state[:] = 0.0
        for flag in (
            library.CVodeInit(self.address, callback, 0.0, self.vector),
            library.CVodeSetUserData(self.address, data),
            library.CVodeSVtolerances(self.address, rtol, tolerances),
            library.CVodeSetLinearSolver(self.address, solver, matrix),
            library.CVodeSetMaxNumSteps(self.address, MOST_STEPS),
        ):
            if flag != 0:
                raise MemoryError(f"SUNDIALS could not set up CVODE (flag {flag})")

    def start(self, tau: float) -> None:
        """Begin anew at the time `tau` (s) with the present values of `state`."""
        self._library.CVodeReInit(self.address, tau, self.vector)

    def jacobian_calls(self) -> int:
        """Jacobians since the first step after the last start."""
        count = ctypes.c_long()
        self._library.CVodeGetNumJacEvals(self.address, ctypes.byref(count))
        return count.value

    def last_order(self) -> int:
        """Order of the last step."""
        order = ctypes.c_int()
        self._library.CVodeGetLastOrder(self.address, ctypes.byref(order))
        return order.value


def _free(library: Any, memory: int, *parts: Any) -> None:
    library.CVodeFree(ctypes.byref(ctypes.c_void_p(memory)))
    free_parts(library, *parts)


def vector_values(library: Any, vector: int, size: int) -> Floats:
    """Values of a vector of SUNDIALS, as an array over them."""
    pointer = ctypes.cast(library.N_VGetArrayPointer(vector), ctypes.POINTER(ctypes.c_double))
    return np.ctypeslib.as_array(pointer, (size,))


def free_parts(library: Any, vectors: list[int], matrix: int, solver: int, context: Any) -> None:
    """Free what an integrator was set up with, once it is freed itself."""
    for vector in vectors:
        library.N_VDestroy(vector)
    library.SUNMatDestroy(matrix)
    library.SUNLinSolFree(solver)
    library.SUNContext_Free(ctypes.byref(context))
