"""CVODE and IDA objects, made and freed through the library's own functions.

How CVODE is set up for a mode, its `MemoryLayout`, stands here; what IDA is,
`eventpound.solvers.sundials.descriptor_modes` says.
"""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.contact_elements import SMOOTH_CODES
from eventpound.mechanics.reduced import Reduced, bandwidth
from eventpound.numerics.arrays import Bools, Floats
from eventpound.solvers.sundials.library import IdaLibrary
from eventpound.tolerances import NO_RTOL

FAMILIES = {"Adams": 1, "BDF": 2}
"""SUNDIALS' numbers of the multistep families."""
MOST_STEPS = 100_000
"""Internal steps of one call."""
MOST_FAILURES = 40
"""Times IDA may shorten a step. SUNDIALS' ten are too few where z turns at a reversal: a step
of order one whose square is the tolerance may be a millionth of the one before."""
LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step, since the errors of many steps add up."""
BENT_SHARE = 0.1
"""Part of that for a step with a contact element whose force is no smooth function of the
overlap: the method's own estimate of its error falls short where the contact ends."""
BANDED_FROM = 48
"""Length of the state vector from which a banded Jacobian is used where it is narrow."""


class Tolerances(NamedTuple):
    """Relative and absolute tolerances (size,) of the unknowns in one step."""

    rtol: float
    atol: Floats


def step_tolerances(share: float, rtol: float, atol: Floats, frame: Floats) -> Tolerances:
    """A share of the tolerances of a motion, in a moving frame if it has any."""
    if frame.shape[1] > 0:
        # Positions there are larger than what they stand for.
        return Tolerances(NO_RTOL, 2.0 * share * atol)
    return Tolerances(max(share * rtol, NO_RTOL), share * atol)


class MemoryLayout(NamedTuple):
    """Tolerances of a step and half bandwidth of the Jacobian, 0 where it is dense.

    `key` tells layouts apart.
    """

    rtol: float
    atol: Floats
    band: int

    @property
    def key(self) -> tuple[float, bytes, int]:
        """What one CVODE object can serve."""
        return self.rtol, self.atol.tobytes(), self.band


def layout(system: Reduced, frame: Floats, rtol: float, atol: Floats) -> MemoryLayout:
    """The layout for a mode.

    Parameters
    ----------
    system : Reduced
        The equations of motion.
    frame : ndarray, shape (4, n)
        The moving frame.
    rtol : float
        Relative tolerance of the motion.
    atol : ndarray, shape (size,)
        Absolute tolerances of the motion.
    """
    band = bandwidth(system) if system.size > BANDED_FROM else system.size
    share = LOCAL_SHARE * (BENT_SHARE if (system.iz < SMOOTH_CODES).any() else 1.0)
    tolerances = step_tolerances(share, rtol, atol, frame)
    return MemoryLayout(*tolerances, band if 3 * band < system.size else 0)


class _Memory:
    """An object of CVODE or IDA with its vectors, matrix and linear solver.

    Parameters
    ----------
    common : ctypes.CDLL
        What both integrators use.
    own : ctypes.CDLL
        Where the integrator's own functions are.
    create : callable
        Makes the object, of a context.
    size, vectors, band : int
        Of the state; how many vectors; half bandwidth of the Jacobian, 0 for a dense one.
    """

    prefix: str
    """Of the integrator's functions."""

    def __init__(
        self,
        common: Any,
        own: Any,
        create: Callable[[Any], int],
        size: int,
        vectors: int,
        band: int = 0,
    ) -> None:
        self._common, self._own = common, own
        context = ctypes.c_void_p()
        common.SUNContext_Create(0, ctypes.byref(context))
        # Messages of failures reach the user by way of the flag a call returns.
        common.SUNContext_ClearErrHandlers(context)
        self.address = create(context)
        self._vectors = [common.N_VNew_Serial(size, context) for _ in range(vectors)]
        vector = self._vectors[0]
        if band:
            self._matrix = common.SUNBandMatrix(size, band, band, context)
            self._solver = common.SUNLinSol_Band(vector, self._matrix, context)
        else:
            self._matrix = common.SUNDenseMatrix(size, size, context)
            self._solver = common.SUNLinSol_Dense(vector, self._matrix, context)
        parts = self._vectors, self._matrix, self._solver, context
        free = getattr(own, self.prefix + "Free")
        self._finalizer = weakref.finalize(self, _free, common, free, self.address, *parts)
        # At the end of the process another thread may still be at it.
        self._finalizer.atexit = False

    def _values(self, vector: int, size: int) -> Floats:
        """Values of a vector, as an array over them."""
        address = self._common.N_VGetArrayPointer(vector)
        pointer = ctypes.cast(address, ctypes.POINTER(ctypes.c_double))
        return np.ctypeslib.as_array(pointer, (size,))

    def find_roots(self, callback: int, directions: list[int]) -> None:
        """Look for the roots of functions, the callback's, that pass zero this way each."""
        own, count = self._own, len(directions)
        flag = getattr(own, self.prefix + "RootInit")(self.address, count, callback)
        if flag == 0 and count:
            # Held by a name: a call lets other threads run, which take memory that is free.
            ways = np.array(directions, ctypes.c_int)
            flag = getattr(own, self.prefix + "SetRootDirection")(self.address, ways.ctypes.data)
        self._set_up((flag,))

    def _set_up(self, flags: Iterable[int]) -> None:
        """Go through calls that return a flag."""
        for flag in flags:
            if flag != 0:
                raise MemoryError(f"SUNDIALS could not set up {self.prefix.upper()} (flag {flag})")


def _free(
    common: Any, free: Any, memory: int, vectors: list[int], matrix: int, solver: int, context: Any
) -> None:
    free(ctypes.byref(ctypes.c_void_p(memory)))
    for vector in vectors:
        common.N_VDestroy(vector)
    common.SUNMatDestroy(matrix)
    common.SUNLinSolFree(solver)
    common.SUNContext_Free(ctypes.byref(context))


class CvodeMemory(_Memory):
    """A CVODE object.

    Parameters
    ----------
    library : ctypes.CDLL
        See `eventpound.solvers.sundials.library.library`.
    method : str
        ``"Adams"`` or ``"BDF"``.
    layout : MemoryLayout
        Tolerances, and which Jacobian.
    callback, data : int
        Addresses of the right-hand side and of what it is handed.

    Attributes
    ----------
    address, vector, interpolated : int
        The object, the vector of its state, and another to interpolate into.
    """

    prefix = "CVode"

    def __init__(
        self, library: Any, method: str, layout: MemoryLayout, callback: int, data: int
    ) -> None:
        def create(context: Any) -> int:
            made: int = library.CVodeCreate(FAMILIES[method], context)
            return made

        size = layout.atol.size
        super().__init__(library, library, create, size, 3, layout.band)
        self.vector, self.interpolated, tolerances = self._vectors
        self._values(self.vector, size)[:] = 0.0
        self._values(tolerances, size)[:] = layout.atol
        self._set_up(
            (
                library.CVodeInit(self.address, callback, 0.0, self.vector),
                library.CVodeSetUserData(self.address, data),
                library.CVodeSVtolerances(self.address, layout.rtol, tolerances),
                library.CVodeSetLinearSolver(self.address, self._solver, self._matrix),
                library.CVodeSetMaxNumSteps(self.address, MOST_STEPS),
            )
        )


class IdaMemory(_Memory):
    """An IDA object.

    Parameters
    ----------
    library : IdaLibrary
        See `eventpound.solvers.sundials.library.ida_library`.
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
    address, vector, rate_vector, interpolated : int
        The object, the vectors of its unknowns and their rates, and another to
        interpolate into.
    unknowns, rates : ndarray, shape (size,)
        What stands in the first two vectors.
    """

    prefix = "IDA"

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
        size = atol.size
        super().__init__(common, ida, ida.IDACreate, size, 5)
        self.vector, self.rate_vector, self.interpolated, tolerances, differential = self._vectors
        self.unknowns, self.rates = (self._values(each, size) for each in self._vectors[:2])
        self.unknowns[:] = self.rates[:] = 0.0
        self._values(tolerances, size)[:] = atol
        self._values(differential, size)[:] = np.where(algebraic, 0.0, 1.0)
        self._set_up(
            (
                ida.IDAInit(self.address, residual, 0.0, self.vector, self.rate_vector),
                ida.IDASetUserData(self.address, data),
                ida.IDASVtolerances(self.address, rtol, tolerances),
                ida.IDASetLinearSolver(self.address, self._solver, self._matrix),
                ida.IDASetJacFn(self.address, jacobian),
                ida.IDASetDeltaCjLSetup(self.address, 0.0),
                ida.IDASetMaxErrTestFails(self.address, MOST_FAILURES),
                ida.IDASetMaxConvFails(self.address, MOST_FAILURES),
                ida.IDASetId(self.address, differential),
                ida.IDASetSuppressAlg(self.address, 1),
                ida.IDASetMaxNumSteps(self.address, MOST_STEPS),
            )
        )

    def start(self, tau: float, first_step: float) -> None:
        """Begin anew at the time `tau` (s) with what its first vectors hold."""
        self._own.IDAReInit(self.address, tau, self.vector, self.rate_vector)
        self._own.IDASetInitStep(self.address, first_step)
