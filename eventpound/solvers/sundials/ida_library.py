"""The functions of SUNDIALS IDA behind scikit-sundae, by their C names.

As `eventpound.solvers.sundials.library` does for CVODE ("Using IDA", SUNDIALS 7).
Beyond what scikit-sundae calls itself, this takes `IDAGetDky`, `IDAGetLastOrder`,
`IDASetSuppressAlg` and `SUNDenseMatrix_Data`.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any, NamedTuple

from llvmlite.binding import add_symbol
from numba import types

from eventpound.solvers.sundials.library import PREFIX, library

COMPILED = (
    "IDASolve",
    "IDAGetCurrentTime",
    "IDAGetDky",
    "IDAGetLastOrder",
    "IDASetStopTime",
    "SUNDenseMatrix_Data",
)
"""Functions that compiled code calls."""
_int, _pointer, _real = types.intc, types.intp, types.float64
ida_solve: Any = types.ExternalFunction(
    PREFIX + "IDASolve", _int(_pointer, _real, _pointer, _pointer, _pointer, _int)
)
ida_get_dky: Any = types.ExternalFunction(
    PREFIX + "IDAGetDky", _int(_pointer, _real, _int, _pointer)
)
ida_current_time: Any = types.ExternalFunction(
    PREFIX + "IDAGetCurrentTime", _int(_pointer, _pointer)
)
ida_last_order: Any = types.ExternalFunction(PREFIX + "IDAGetLastOrder", _int(_pointer, _pointer))
ida_set_stop_time: Any = types.ExternalFunction(PREFIX + "IDASetStopTime", _int(_pointer, _real))
matrix_data: Any = types.ExternalFunction(PREFIX + "SUNDenseMatrix_Data", _pointer(_pointer))


class IdaLibrary(NamedTuple):
    """What both integrators use (`eventpound.solvers.sundials.library`), and IDA's own."""

    common: Any
    ida: Any


@cache
def ida_library() -> IdaLibrary | None:
    """The library, its functions made known to compiled code; None where out of reach."""
    common = library()
    if common is None:
        return None
    from sksundae import _cy_ida

    found: Any = ctypes.CDLL(_cy_ida.__file__)
    signatures = _signatures()
    if not hasattr(_cy_ida, "IDAMESSAGES") or not all(
        hasattr(found, name) for name in (*COMPILED, *signatures)
    ):
        return None
    for name in COMPILED:
        add_symbol(PREFIX + name, ctypes.cast(getattr(found, name), ctypes.c_void_p).value)
    for name, (result, *arguments) in signatures.items():
        function = getattr(found, name)
        function.restype, function.argtypes = result, arguments
    return IdaLibrary(common, found)


def _signatures() -> dict[str, tuple[Any, ...]]:
    """Types of the result and the arguments of what is called from Python."""
    pointer, integer, real = ctypes.c_void_p, ctypes.c_int, ctypes.c_double
    return {
        "IDACreate": (pointer, pointer),
        "IDAInit": (integer, pointer, pointer, real, pointer, pointer),
        "IDAReInit": (integer, pointer, real, pointer, pointer),
        "IDASetUserData": (integer, pointer, pointer),
        "IDASVtolerances": (integer, pointer, real, pointer),
        "IDASetLinearSolver": (integer, pointer, pointer, pointer),
        "IDASetJacFn": (integer, pointer, pointer),
        "IDASetId": (integer, pointer, pointer),
        "IDASetSuppressAlg": (integer, pointer, integer),
        "IDASetDeltaCjLSetup": (integer, pointer, real),
        "IDASetMaxErrTestFails": (integer, pointer, integer),
        "IDASetMaxConvFails": (integer, pointer, integer),
        "IDASetInitStep": (integer, pointer, real),
        "IDASetMaxNumSteps": (integer, pointer, ctypes.c_long),
        "IDARootInit": (integer, pointer, integer, pointer),
        "IDASetRootDirection": (integer, pointer, pointer),
        "IDAGetNumJacEvals": (integer, pointer, ctypes.POINTER(ctypes.c_long)),
        "IDAGetLastOrder": (integer, pointer, ctypes.POINTER(integer)),
        "IDAFree": (None, ctypes.POINTER(pointer)),
    }
