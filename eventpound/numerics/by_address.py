"""Groups of arrays handed from one compiled function to another as one address.

Numba takes a named tuple apart at every call: an array is seven numbers, so a group of
thirty arrays is two hundred arguments, and to compile the calls costs several times what is
done in the functions. A group *by address* is one address, of a table that tells where
its arrays are and how long; a field is read from the table where it is used. The table does
not change meanwhile, which the compiler is told, so that what was read from it once
need not be read again.

Nothing here is counted as a reference: whoever hands over a group keeps its arrays alive. Only
Numba's interface for extensions is used.

Python gives a group one by `with_address`: to hand over sixty arrays costs what one address does
then. Several functions may be given it, one after the other,
and one group may be a field of another.
"""

from __future__ import annotations

import ctypes
import struct
from array import array
from hashlib import sha256
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel.models import PrimitiveModel
from numba.core.errors import TypingError
from numba.core.imputils import lower_builtin, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, register_model, type_callable, unbox
from numba.np.numpy_support import from_dtype

_GROUPS = (types.NamedTuple, types.NamedUniTuple)
_LENGTH = ir.IntType(64)
_ADDRESS = ir.IntType(8).as_pointer()
_unpacked: Any = cgutils.unpack_tuple
_stack_slot: Any = cgutils.alloca_once
_named_tuple: Any = types.BaseTuple.from_types
_tuple_of: Any = types.UniTuple
_native: Any = NativeValue
_WORD = 8
"""Bytes of a place in a table."""
_FLOAT, _INTEGER = struct.Struct("d"), struct.Struct("q")
_NOTHING = ctypes.c_char * 0
Group = TypeVar("Group")


class ByAddress(types.Type):
    """A named tuple of arrays, records, numbers and such tuples, by the address of its table."""

    def __init__(self, group: Any) -> None:
        self.group = group
        name = group.instance_class.__name__
        super().__init__(f"ByAddress[{name}:{sha256(str(group).encode()).hexdigest()[:16]}]")


@register_model(ByAddress)
class _ByAddressModel(PrimitiveModel):
    def __init__(self, manager: Any, addressed: Any) -> None:
        super().__init__(manager, addressed, _ADDRESS)  # type: ignore[no-untyped-call]


def _words(kind: Any) -> int:
    """Places that a field takes in a table: those of its own fields; data and shape; or one."""
    if isinstance(kind, _GROUPS):
        return sum(map(_words, kind.types))
    if isinstance(kind, types.Array):
        if kind.layout != "C":
            raise TypingError(f"only contiguous arrays have an address, not {kind}")
        return 1 + int(kind.ndim)
    if isinstance(kind, types.UniTuple) and isinstance(kind.dtype, ByAddress):
        return int(kind.count)
    if isinstance(kind, ByAddress | types.Record | types.Number | types.Boolean):
        return 1
    raise TypingError(f"{kind} cannot go by address")


def _at(builder: Any, table: Any, word: int, kind: Any) -> Any:
    """Pointer to a place in a table."""
    return builder.bitcast(builder.gep(table, [_LENGTH(word * _WORD)]), kind.as_pointer())


def _fill(context: Any, builder: Any, table: Any, word: int, kind: Any, value: Any) -> None:
    """Put a field into its place."""
    if isinstance(kind, _GROUPS):
        for i, each in enumerate(kind.types):
            _fill(context, builder, table, word, each, builder.extract_value(value, i))
            word += _words(each)
    elif isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        shape = _unpacked(builder, array.shape, kind.ndim)
        for i, each in enumerate((array.data, *shape)):
            builder.store(each, _at(builder, table, word + i, each.type))
    elif isinstance(kind, types.UniTuple):
        for i, each in enumerate(_unpacked(builder, value, kind.count)):
            builder.store(each, _at(builder, table, word + i, each.type))
    elif isinstance(kind, types.Record):
        builder.store(value, _at(builder, table, word, value.type))
    else:
        data = context.data_model_manager[kind].as_data(builder, value)
        builder.store(data, _at(builder, table, word, data.type))


def _read(builder: Any, table: Any, word: int, kind: Any) -> Any:
    """What stands in a place, the same whenever it is read."""
    found = builder.load(_at(builder, table, word, kind))
    found.set_metadata("invariant.load", builder.module.add_metadata([]))
    return found


def by_address(group: Any) -> Any:
    """A group as one address, for the time of the function that asks for it; see the module.

    Where Python runs that function, it is the group itself.
    """
    return group


@type_callable(by_address)
def _type_by_address(context: Any) -> Any:
    def addressed(group: Any) -> Any:
        if isinstance(group, ByAddress):
            return group
        if not isinstance(group, _GROUPS):
            raise TypingError(f"{group} is no named tuple")
        _words(group)
        return ByAddress(group)

    return addressed


@lower_builtin(by_address, types.Any)  # type: ignore[no-untyped-call]
def _by_address(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    group = signature.args[0]
    if isinstance(group, ByAddress):
        return given[0]
    table = _stack_slot(builder, ir.ArrayType(_LENGTH, _words(group)))
    address = builder.bitcast(table, _ADDRESS)
    _fill(context, builder, address, 0, group, given[0])
    # An address of which the compiler does not know whose it is: it may not move a reading
    # that does not change before the table is filled.
    same = ir.FunctionType(_ADDRESS, [_ADDRESS])
    return builder.asm(same, "", "=r,0,~{memory}", [address], True)


def whole(addressed: Any) -> Any:
    """A group by address as a named tuple again; where Python runs it, what it is given."""
    return addressed


@type_callable(whole)
def _type_of_whole(context: Any) -> Any:
    return lambda addressed: addressed.group


@lower_builtin(whole, ByAddress)  # type: ignore[no-untyped-call]
def _whole(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    def gathered(addressed: Any, table: Any) -> Any:
        values = []
        for name, kind in zip(addressed.group.fields, addressed.group.types, strict=True):
            value = _field(context, builder, addressed, table, name)
            values.append(gathered(ByAddress(kind), value) if isinstance(kind, _GROUPS) else value)
        return context.make_tuple(builder, addressed.group, values)

    return gathered(signature.args[0], given[0])


@infer_getattr
class _Fields(AttributeTemplate):
    key = ByAddress

    def generic_resolve(self, addressed: Any, name: str) -> Any:  # type: ignore[override]
        """The type of a field: of a group in a group, one by address."""
        if name not in addressed.group.fields:
            return None
        kind = addressed.group.types[addressed.group.fields.index(name)]
        return ByAddress(kind) if isinstance(kind, _GROUPS) else kind


@lower_getattr_generic(ByAddress)  # type: ignore[no-untyped-call]
def _field(context: Any, builder: Any, addressed: Any, table: Any, name: str) -> Any:
    place = addressed.group.fields.index(name)
    kind, word = addressed.group.types[place], sum(map(_words, addressed.group.types[:place]))
    if isinstance(kind, _GROUPS):
        return builder.gep(table, [_LENGTH(word * _WORD)])
    if isinstance(kind, types.Array):
        return _array(context, builder, kind, table, word)
    if isinstance(kind, types.UniTuple):
        each = [_read(builder, table, word + i, _ADDRESS) for i in range(kind.count)]
        return context.make_tuple(builder, kind, each)
    if isinstance(kind, types.Record):
        return _read(builder, table, word, context.get_value_type(kind))
    model: Any = context.data_model_manager[kind]
    return model.from_data(builder, _read(builder, table, word, model.get_data_type()))


def _array(context: Any, builder: Any, kind: Any, table: Any, word: int) -> Any:
    """An array from its places in a table."""
    element = context.get_data_type(kind.dtype)
    size = _LENGTH(context.get_abi_sizeof(element))
    shape = [_read(builder, table, word + 1 + axis, _LENGTH) for axis in range(kind.ndim)]
    strides = [size]
    for length in shape[:0:-1]:
        strides.insert(0, builder.mul(strides[0], length))
    # A tenth of Numba, which only who compiles needs.
    from numba.np import arrayobj

    array = context.make_array(kind)(context, builder)
    populate: Any = arrayobj.populate_array
    populate(
        array,
        data=_read(builder, table, word, element.as_pointer()),
        shape=shape,
        strides=strides,
        itemsize=size,
        meminfo=None,
    )
    return array._getvalue()


class WithAddress:
    """A group with an address, of which fields are read as of the group itself.

    Parameters
    ----------
    group : named tuple
        Of contiguous arrays, numbers, named tuples, others like it, and tuples of such of one kind.
        Arrays of records have a class of records for each layout.

    Attributes
    ----------
    group : named tuple
        The same; its arrays are kept alive.
    address : int
        Of the table, which stays where it is.

    Raises
    ------
    TypeError
        Where there is anything else in it.
    """

    __slots__ = ("_numba_type_", "_parts", "_table", "address", "group")

    def __init__(self, group: Any) -> None:
        self._parts: Any = None
        self._numba_type_, self._table = _listed(group)
        self.address = self._table.buffer_info()[0]
        self.group = group

    def change_to(self, group: Any, *, first: bool = False) -> None:
        """Put another group of the same kind at the same address, or into the first field.

        Only fields that are others are listed anew. Of one group it is always the same of the two.
        """
        present = self.group[0] if first else self.group
        if self._parts is None:
            self._parts = [_marked(each) for each in present]
        begin = 0
        for known, was, now in zip(self._parts, present, group, strict=True):
            end = begin + len(known[1])
            if now is not was:
                marks, words = _marked(now)
                if marks != known[0]:
                    raise TypeError(f"{type(group).__name__} is of another kind than before")
                self._table[begin:end] = array("q", words)
            begin = end
        self.group = type(self.group)(group, *self.group[1:]) if first else group

    def __getattr__(self, name: str) -> Any:
        return getattr(self.group, name)


def with_address(group: Group) -> Group:
    """A group that Python hands to compiled functions by address, to be read like the group."""
    addressed: Any = WithAddress(group)
    return addressed


def change_group(addressed: Group, group: Group) -> None:
    """Put another group of the same kind at an address; see `WithAddress.change_to`."""
    present: Any = addressed
    present.change_to(group)


def change_first(addressed: Any, group: Any) -> None:
    """Put another group of the same kind into the first field of one with an address."""
    addressed.change_to(group, first=True)


def fields_of(addressed: Any) -> tuple[Any, ...]:
    """The fields of a group with an address, one after the other."""
    group: tuple[Any, ...] = addressed.group
    return group


def type_by_address(addressed: Any) -> Any:
    """Numba's type of a group by address, for the signature of a callback that is handed one."""
    return addressed._numba_type_


_KINDS: dict[tuple[Any, ...], ByAddress] = {}
"""Types of what has had an address, by the marks that `_list` makes: to make one takes longer."""


def _listed(group: Any) -> tuple[ByAddress, array[int]]:
    """The type of a group with an address, and its table."""
    words: list[int] = []
    marks: list[Any] = []
    _list(group, words, marks)
    mark = tuple(marks)
    if mark not in _KINDS:
        _KINDS[mark] = ByAddress(_kind(group))
    return _KINDS[mark], array("q", words)


def _marked(value: Any) -> tuple[list[Any], list[int]]:
    """Marks and words of a field."""
    words: list[int] = []
    marks: list[Any] = []
    _list((value,), words, marks)
    return marks, words


def _list(group: tuple[Any, ...], words: list[int], marks: list[Any]) -> None:
    """Put what stands for fields behind the words of a table, and what they are behind the marks.

    Some hundreds of arrays are listed in a run, whose steps take no longer.
    """
    marks += type(group), len(group)
    for value in group:
        if isinstance(value, np.ndarray):
            words.append(_address_of(value))
            words += value.shape
            # A layout takes long to look up; the class of its records stands for it.
            kind: Any = value.dtype.char if value.dtype.names is None else value.dtype.type
            marks += kind, value.ndim
        elif isinstance(value, WithAddress):
            words.append(value.address)
            marks.append(id(value._numba_type_))
        elif isinstance(value, tuple):
            _list(value, words, marks)
        elif isinstance(value, float):
            words += _INTEGER.unpack(_FLOAT.pack(value))
            marks.append(float)
        elif isinstance(value, int | np.integer | np.bool_):
            words.append(int(value))
            marks.append(bool if isinstance(value, bool | np.bool_) else int)
        else:
            raise TypeError(f"{type(value).__name__} cannot go by address")


def _address_of(value: Any) -> int:
    """Where an array is."""
    try:
        # A quarter of the time in which NumPy tells.
        return ctypes.addressof(_NOTHING.from_buffer(value))
    except TypeError:
        if not value.flags.c_contiguous:
            raise TypeError("only contiguous arrays have an address") from None
        # Not to be written.
        return int(value.ctypes.data)


def _kind(value: Any) -> Any:
    """Numba's type of a field."""
    if isinstance(value, np.ndarray):
        return types.Array(from_dtype(value.dtype), value.ndim, "C")
    if isinstance(value, WithAddress):
        return value._numba_type_
    if isinstance(value, tuple):
        kinds = [_kind(each) for each in value]
        if hasattr(value, "_fields"):
            return _named_tuple(kinds, type(value))
        return _tuple_of(kinds[0], len(kinds))
    if isinstance(value, bool | np.bool_):
        return types.boolean
    return types.float64 if isinstance(value, float) else types.int64


@unbox(ByAddress)  # type: ignore[no-untyped-call]
def _unboxed(kind: Any, addressed: Any, c: Any) -> Any:
    address = c.pyapi.object_getattr_string(addressed, "address")
    number = c.pyapi.long_as_longlong(address)
    c.pyapi.decref(address)
    return _native(c.builder.inttoptr(number, _ADDRESS))
