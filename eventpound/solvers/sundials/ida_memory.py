"""One IDA object, made and freed through the library's own functions."""

from __future__ import annotations

import ctypes
import weakref
from typing import Any

import numpy as np

from eventpound.numerics.arrays import Bools, Floats
from eventpound.solvers.sundials.ida_library import IdaLibrary
from eventpound.solvers.sundials.memory import MOST_STEPS, free_parts, vector_values

MOST_FAILURES = 40
"""Times a step may be shortened. SUNDIALS' ten are too few where z turns at a reversal: a step
of order one whose square is the tolerance may be a millionth of the one before."""


class IdaMemory:
    """An IDA object with its vectors, matrix and linear solver.

    Parameters
    ----------
    library : IdaLibrary
        See `eventpound.solvers.sundials.ida_library.ida_library`.
    rtol : float
        Relative tolerance.
    atol : ndarray, shape (size,)
        Absolute tolerances.
    algebraic : ndarray of bool, shape (size,)
        Unknowns whose rates do not appear; they are left out of the error test.
    residual, jacobian, data : int
        Addresses of the callbacks and of what they are handed.

    Attributes
    ----------
    address, vector, rate_vector, look : int
        The object, the vectors of its unknowns and their rates, and another to
        interpolate into.
    state, rate : ndarray, shape (size,)
        Values of the first two.
    state_address, rate_address : int
        Where these are.
    """

    def __init__(
        self,
        library: IdaLibrary,
        rtol: float,
        atol: Floats,
        algebraic: Bools,
        residual: int,
        jacobian: int,
        data: int,
    ) -> None:
        common, ida = library
        self._ida, size = ida, atol.size
        context = ctypes.c_void_p()
        common.SUNContext_Create(0, ctypes.byref(context))
        # Messages of failures reach the user by way of the flag a call returns.
        common.SUNContext_ClearErrHandlers(context)
        self.address = ida.IDACreate(context)
        vectors = [common.N_VNew_Serial(size, context) for _ in range(5)]
        self.vector, self.rate_vector, self.look, tolerances, differential = vectors
        self.state, self.rate = (
            vector_values(common, vector, size) for vector in (self.vector, self.rate_vector)
        )
        self.state_address, self.rate_address = self.state.ctypes.data, self.rate.ctypes.data
        vector_values(common, tolerances, size)[:] = atol
        vector_values(common, differential, size)[:] = np.where(algebraic, 0.0, 1.0)
        matrix = common.SUNDenseMatrix(size, size, context)
        solver = common.SUNLinSol_Dense(self.vector, matrix, context)
        self._finalizer = weakref.finalize(
            self, _free, library, self.address, vectors, matrix, solver, context
        )
        # At the end of the process another thread may still be at it.
        self._finalizer.atexit = False
        self.state[:] = 0.0
        self.rate[:] = 0.0
        for flag in (
            ida.IDAInit(self.address, residual, 0.0, self.vector, self.rate_vector),
            ida.IDASetUserData(self.address, data),
            ida.IDASVtolerances(self.address, rtol, tolerances),
            ida.IDASetLinearSolver(self.address, solver, matrix),
            ida.IDASetJacFn(self.address, jacobian),
            ida.IDASetDeltaCjLSetup(self.address, 0.0),
            ida.IDASetMaxErrTestFails(self.address, MOST_FAILURES),
            ida.IDASetMaxConvFails(self.address, MOST_FAILURES),
            ida.IDASetId(self.address, differential),
            ida.IDASetSuppressAlg(self.address, 1),
            ida.IDASetMaxNumSteps(self.address, MOST_STEPS),
        ):
            if flag != 0:
                raise MemoryError(f"SUNDIALS could not set up IDA (flag {flag})")

    def start(self, tau: float, first_step: float) -> None:
        """Begin anew at the time `tau` (s) with the present values of `state` and `rate`."""
        self._ida.IDAReInit(self.address, tau, self.vector, self.rate_vector)
        self._ida.IDASetInitStep(self.address, first_step)

    def jacobian_calls(self) -> int:
        """Jacobians since the first step after the last start."""
        count = ctypes.c_long()
        self._ida.IDAGetNumJacEvals(self.address, ctypes.byref(count))
        return count.value

    def last_order(self) -> int:
        """Order of the last step."""
        order = ctypes.c_int()
        self._ida.IDAGetLastOrder(self.address, ctypes.byref(order))
        return order.value


def _free(library: IdaLibrary, memory: int, *parts: Any) -> None:
    common, ida = library
    ida.IDAFree(ctypes.byref(ctypes.c_void_p(memory)))
    free_parts(common, *parts)
