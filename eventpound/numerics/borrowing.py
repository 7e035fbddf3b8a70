"""Arrays to which compiled code does not count references.

Numba counts the references to an array with atomic operations whenever it takes
it out of a tuple, some 5 ns each; in kernels that do little with each of some
forty views this was nine tenths of the time.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numba import carray, errors, types  # type: ignore[attr-defined]
from numba.extending import intrinsic

from eventpound.numerics.compiled import PlainInPython, kernel, scalar_kernel


@intrinsic
def _pointer(typing: Any, address: Any, like: Any) -> Any:
    """A pointer from an address; `like` is a type of numbers or an array of them."""
    if isinstance(like, types.Array) and like.layout != "C":
        raise errors.TypingError("only contiguous arrays can be borrowed")

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    return types.CPointer(like.dtype)(types.intp, like), generate  # type: ignore[no-untyped-call]


_pointer_to: Any = _pointer


def _array_at(address: int, shape: Any, like: Any) -> Any:
    """The array of this shape at an address.

    Parameters
    ----------
    address : int
        Where it is in memory.
    shape : int or tuple of int
        Its shape.
    like : type, dtype or ndarray
        What its elements are.
    """
    return carray(_pointer_to(address, like), shape)


def _array_at_in_python(address: int, shape: Any, like: Any) -> Any:
    """The same where Python runs what asks for it; records have attributes there, too."""
    kind = like.dtype if isinstance(like, np.ndarray) else np.dtype(like)
    memory = (ctypes.c_char * (int(np.prod(shape)) * kind.itemsize)).from_address(int(address))
    found = np.frombuffer(memory, kind).reshape(shape)
    return found.view(np.recarray) if kind.names else found


array_at: Any = PlainInPython(_array_at_in_python, kernel(_array_at))


def _borrowed(array: Any) -> Any:
    """The same contiguous array without a share in its ownership.

    For use within a call whose caller keeps the array alive; views of the
    result are not counted either.
    """
    return array_at(array.ctypes.data, array.shape, array)


def _itself(array: Any) -> Any:
    """The array: nothing is counted where nothing is compiled."""
    return array


borrow: Any = PlainInPython(_itself, kernel(_borrowed))


@scalar_kernel
def copy_numbers(source: Any, target: Any) -> None:
    """Copy one-dimensional numbers to the front of others; a slice takes seconds to compile.

    Parameters
    ----------
    source, target : ndarray
        `target` at least as long.
    """
    for i in range(source.size):
        target[i] = source[i]


@scalar_kernel
def put_numbers(source: Any, places: Any, target: Any) -> None:
    """Put one-dimensional numbers into these places of others."""
    for i in range(places.size):
        target[places[i]] = source[i]
