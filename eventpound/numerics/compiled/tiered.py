"""Kernels that Python runs by itself until compiling them pays.

When that is `eventpound.numerics.patience` says. The answers are the same to the last bit:
only functions without fused sums are made so, and what is meant by an array, a group that is
lent, and a division by zero is the same in both.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.numerics.compiled.linked import Entry, in_this_thread
from eventpound.numerics.compiled.recipe import Recipe
from eventpound.numerics.patience import Account, StoppedInPythonError


class _NotYetError(Exception):
    """There is no compiled kernel, and it is too early to make one."""


class TieredEntry(Entry):
    """An `Entry` that is compiled when that pays.

    Parameters
    ----------
    function, options, recipe, store
        As of an `Entry`.
    patience : float
        Time that Python may spend on it first (s).
    """

    def __init__(
        self,
        function: Callable[..., Any],
        options: dict[str, Any],
        recipe: Recipe,
        store: Any,
        patience: float,
    ) -> None:
        super().__init__(function, options, recipe, store)
        self._account = Account(store, patience)
        self._waits = False

    def __call__(self, *arguments: Any) -> Any:
        """Call the function, compiled where it is.

        Raises
        ------
        StoppedInPythonError
            Where Python cannot go on as compiled code does.
        """
        if in_this_thread.interprets:
            return self.py_func(*arguments)
        if self.overloads or not (self._waits and self._account.patient):
            try:
                return super().__call__(*arguments)
            except _NotYetError:
                # To ask for a kernel takes as long as to run the function in Python.
                self._waits = True
        return self._in_python(*arguments)

    def _in_python(self, *arguments: Any) -> Any:
        """Let Python run the function, and all that it calls."""
        began = time.thread_time()
        in_this_thread.interprets = True
        try:
            with np.errstate(all="ignore"):
                return self.py_func(*arguments)
        except (ArithmeticError, ValueError, IndexError) as error:
            raise StoppedInPythonError from error
        finally:
            in_this_thread.interprets = False
            self._account.add(time.thread_time() - began)

    def compile(self, signature: Any) -> Any:
        """Make the function ready, unless it is too early for that.

        Raises
        ------
        _NotYetError
            Where Python is to run it.
        """
        if self._account.patient and not self._cache.has(signature, self.targetctx):
            raise _NotYetError
        return super().compile(signature)
