"""Two slow spots of Numba's front end, and Python's collector, while kernels are compiled.

Replaced are, with the same results:

* `TargetConfig.__eq__`: two sets of compiler flags are compared some 600 000 times for a
  kernel of five hundred functions, each time through 44 properties. Here the values that
  were set are compared first, and the hash, which upstream is made of the names of the
  options and so the same for all, is made once.
* `BaseFunction.get_call_type`: a builtin called with the same types is resolved once.

They stay in place once the first kernel is compiled, since they change no result; Numba's
functions are put aside, not copied, and called wherever the shortcut does not apply.
Python's cyclic collector, which finds nothing and goes through millions of objects again
and again, is held off while a kernel is compiled.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from numba.core import types
from numba.core.targetconfig import ConfigStack, TargetConfig
from numba.core.types.functions import BaseFunction

_CALLS = "_eventpound_calls"
_slow_equal = TargetConfig.__eq__
_slow_call_type = BaseFunction.get_call_type
_hashes: dict[Any, int] = {}


@contextmanager
def quick_front_end() -> Iterator[None]:
    """Compile with the shortcuts in place and the collector held off.

    For one who holds Numba's compiler lock.
    """
    _install()
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@cache
def _install() -> None:
    TargetConfig.__eq__ = _equal
    TargetConfig.__hash__ = _hash
    BaseFunction.get_call_type = _call_type


def _equal(self: Any, other: Any) -> Any:
    if self is other or (type(self) is type(other) and self._values == other._values):
        return True
    if type(self) is not type(other):
        return _slow_equal(self, other)
    ours, theirs, options = self._values, other._values, type(self).options
    return all(
        ours.get(name, options[name].default) == theirs.get(name, options[name].default)
        for name in ours.keys() | theirs.keys()
    )


def _hash(self: Any) -> int:
    kind = type(self)
    if kind not in _hashes:
        _hashes[kind] = hash(tuple(sorted(kind.options)))
    return _hashes[kind]


def _call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
    known = self.__dict__.setdefault(_CALLS, {})
    flags = ConfigStack.top_or_none()
    try:
        key = (id(context), args, tuple(kws.items()), flags)
        found = known.get(key)
    except TypeError:  # a type that cannot be looked up
        return _slow_call_type(self, context, args, kws)
    if found is not None:
        signature, implementation = found
        self._impl_keys[signature.args] = implementation
        return signature
    signature = _slow_call_type(self, context, args, kws)
    # What a function given as an argument returns may change as that is compiled.
    if signature is not None and not any(isinstance(a, types.Callable) for a in args):
        key = (id(context), args, tuple(kws.items()), None if flags is None else flags.copy())
        known[key] = signature, self._impl_keys[signature.args]
    return signature
