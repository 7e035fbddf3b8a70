"""Borrowed arrays are the same memory."""

import numpy as np
import pytest
from numba.core.errors import TypingError

from eventpound.numerics.borrowing import array_at, borrow
from eventpound.numerics.compiled import kernel


@kernel
def _double(array):
    view = borrow(array)
    for i in range(view.shape[0]):
        view[i] = view[i] + view[i]
    return view.shape


@kernel
def _second(address, count):
    return array_at(address, count, np.float64)[1]


@pytest.mark.parametrize("kind", [np.float64, np.int64])
def test_written_through(kind):
    array = np.arange(6, dtype=kind).reshape(3, 2)
    assert _double(array) == (3, 2)
    np.testing.assert_array_equal(array, 2 * np.arange(6).reshape(3, 2))


def test_empty_and_boolean():
    assert _double(np.zeros((0, 4))) == (0, 4)
    flags = np.array([True, False])
    assert _double(flags) == (2,)
    np.testing.assert_array_equal(flags, [True, False])


def test_at_an_address():
    array = np.array([1.5, 2.5, 3.5])
    assert _second(array.ctypes.data, array.size) == 2.5


def test_no_strides():
    with pytest.raises(TypingError, match="only contiguous arrays can be borrowed"):
        _double(np.zeros((4, 4))[:, ::2])
