"""The functions of the SUNDIALS library behind scikit-sundae, by their C names.

scikit-sundae calls its right-hand side through Python, some 3 µs each time,
and each step costs a `RichResult` besides; both are several times the cost of
the step. The library it has loaded is the same CVODE and IDA for whoever calls
it, and a symbol is found through the extension module, whatever file it lives
in. What is declared here is the part of the C interface that scikit-sundae
itself uses, and `CVodeGetDky`, `IDAGetDky`, `IDAGetLastOrder`,
`IDASetSuppressAlg` and `SUNDenseMatrix_Data` (SUNDIALS 7, "Using CVODE" and
"Using IDA").
"""

from __future__ import annotations

import ctypes
import re
from contextlib import suppress
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from llvmlite.binding import add_symbol
from numba import types

from eventpound.numerics.compiled import INTERPRETED

PREFIX = "eventpound_"
ONE_STEP = 2
"""SUNDIALS' CV_ONE_STEP and IDA_ONE_STEP."""
_CVODE_COMPILED: list[str] = []
"""Functions of CVODE, and of vectors, that compiled code calls."""
_IDA_COMPILED: list[str] = []
"""Those of IDA, and of matrices."""
# Pointers travel as integers; a symbol is looked up when compiled code is loaded.
_int, _pointer, _real = types.intc, types.intp, types.float64


def _declared(name: str, signature: Any, among: list[str]) -> Any:
    """A function of the library for compiled code, which is written down among the others."""
    among.append(name)
    return types.ExternalFunction(PREFIX + name, signature)


cvode = _declared("CVode", _int(_pointer, _real, _pointer, _pointer, _int), _CVODE_COMPILED)
get_dky = _declared("CVodeGetDky", _int(_pointer, _real, _int, _pointer), _CVODE_COMPILED)
current_time = _declared("CVodeGetCurrentTime", _int(_pointer, _pointer), _CVODE_COMPILED)
jacobians = _declared("CVodeGetNumJacEvals", _int(_pointer, _pointer), _CVODE_COMPILED)
last_order = _declared("CVodeGetLastOrder", _int(_pointer, _pointer), _CVODE_COMPILED)
reinit = _declared("CVodeReInit", _int(_pointer, _real, _pointer), _CVODE_COMPILED)
set_stop_time = _declared("CVodeSetStopTime", _int(_pointer, _real), _CVODE_COMPILED)
array_pointer = _declared("N_VGetArrayPointer", _pointer(_pointer), _CVODE_COMPILED)
ida_solve = _declared(
    "IDASolve", _int(_pointer, _real, _pointer, _pointer, _pointer, _int), _IDA_COMPILED
)
ida_get_dky = _declared("IDAGetDky", _int(_pointer, _real, _int, _pointer), _IDA_COMPILED)
ida_current_time = _declared("IDAGetCurrentTime", _int(_pointer, _pointer), _IDA_COMPILED)
ida_last_order = _declared("IDAGetLastOrder", _int(_pointer, _pointer), _IDA_COMPILED)
ida_set_stop_time = _declared("IDASetStopTime", _int(_pointer, _real), _IDA_COMPILED)
matrix_data = _declared("SUNDenseMatrix_Data", _pointer(_pointer), _IDA_COMPILED)


class IdaLibrary(NamedTuple):
    """What both integrators use (`library`), and IDA's own."""

    common: Any
    ida: Any


@cache
def library() -> ctypes.CDLL | None:
    """The library, CVODE's functions made known to compiled code.

    None where it is not to be had in this way: the symbols cannot be reached
    through the extension module (as on Windows), its numbers are not doubles, its
    interface is that of another major version, or it was built with MPI; nor where nothing
    is compiled (`NUMBA_DISABLE_JIT`).
    """
    if INTERPRETED:
        return None
    built = _built()
    if (
        not built.get("SUNDIALS_VERSION", "").startswith("7.")
        or built.get("SUNDIALS_FLOAT_TYPE") != "double"
        or ctypes.sizeof(ctypes.c_long) != 8
    ):
        return None
    index = ctypes.c_int32 if built.get("SUNDIALS_INT_TYPE") == "int" else ctypes.c_int64
    return _made_known("_cy_cvode", _CVODE_COMPILED, _cvode_signatures(index))


@cache
def ida_library() -> IdaLibrary | None:
    """The library, IDA's functions made known, too; None where out of reach."""
    common = library()
    if common is None:
        return None
    ida = _made_known("_cy_ida", _IDA_COMPILED, _ida_signatures())
    return None if ida is None else IdaLibrary(common, ida)


def _built() -> dict[str, str]:
    """How scikit-sundae was built, from the text that it was built with; {} without it.

    The package is not imported: it brings SciPy's optimisers, a third of a short run.
    """
    for folder in _folders():
        with suppress(OSError):
            text = Path(folder, "py_config.pxi").read_text(encoding="utf-8")
            return dict(re.findall(r'^(\w+) = "(.*)"$', text, re.MULTILINE))
    return {}


def _folders() -> list[str]:
    """Where scikit-sundae is installed; [] where it is not."""
    found = find_spec("sksundae")
    return list((found and found.submodule_search_locations) or ())


def _made_known(
    extension: str, compiled: list[str], signatures: dict[str, tuple[Any, ...]]
) -> ctypes.CDLL | None:
    """The library behind an extension module, for compiled code and for Python.

    None where it lacks one of their functions, or was built with MPI.
    """
    file = PathFinder.find_spec(extension, _folders())
    try:
        found: Any = ctypes.CDLL(file.origin) if file else None
    except OSError:
        return None
    if (
        found is None
        or hasattr(found, "MPI_Init")
        or not all(hasattr(found, name) for name in (*compiled, *signatures))
    ):
        return None
    for name in compiled:
        add_symbol(PREFIX + name, ctypes.cast(getattr(found, name), ctypes.c_void_p).value)
    for name, (result, *arguments) in signatures.items():
        function = getattr(found, name)
        function.restype, function.argtypes = result, arguments
    return found


def _cvode_signatures(index: Any) -> dict[str, tuple[Any, ...]]:
    """Types of the result and the arguments of what Python calls of CVODE and its parts."""
    pointer, integer, real = ctypes.c_void_p, ctypes.c_int, ctypes.c_double
    return {
        "CVodeCreate": (pointer, integer, pointer),
        "CVodeInit": (integer, pointer, pointer, real, pointer),
        "CVodeSetUserData": (integer, pointer, pointer),
        "CVodeSVtolerances": (integer, pointer, real, pointer),
        "CVodeSetLinearSolver": (integer, pointer, pointer, pointer),
        "CVodeSetMaxNumSteps": (integer, pointer, ctypes.c_long),
        "CVodeRootInit": (integer, pointer, integer, pointer),
        "CVodeSetRootDirection": (integer, pointer, pointer),
        "CVodeFree": (None, ctypes.POINTER(pointer)),
        "N_VNew_Serial": (pointer, index, pointer),
        "N_VGetArrayPointer": (pointer, pointer),
        "N_VDestroy": (None, pointer),
        "SUNContext_Create": (integer, integer, ctypes.POINTER(pointer)),
        "SUNContext_ClearErrHandlers": (integer, pointer),
        "SUNContext_Free": (integer, ctypes.POINTER(pointer)),
        "SUNDenseMatrix": (pointer, index, index, pointer),
        "SUNBandMatrix": (pointer, index, index, index, pointer),
        "SUNMatDestroy": (None, pointer),
        "SUNLinSol_Dense": (pointer, pointer, pointer, pointer),
        "SUNLinSol_Band": (pointer, pointer, pointer, pointer),
        "SUNLinSolFree": (integer, pointer),
    }


def _ida_signatures() -> dict[str, tuple[Any, ...]]:
    """The same of what it calls of IDA."""
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
        "IDAFree": (None, ctypes.POINTER(pointer)),
    }
