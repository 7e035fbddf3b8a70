"""Groups of arrays handed from one compiled function to another as one address.

Numba takes a named tuple apart at every call: an array is seven numbers, so a group of
thirty arrays is two hundred arguments, and to compile the calls costs several times what is
done in the functions. A group that is *lent* is one address, of a table that tells where
its arrays are and how long; a field is read from the table where it is used. The table does
not change while it is lent, which the compiler is told, so that what was read from it once
need not be read again.

Nothing here is counted as a reference: whoever lends a group keeps its arrays alive. Only
Numba's interface for extensions is used.
"""

from __future__ import annotations

from hashlib import sha256
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel.models import PrimitiveModel
from numba.core.errors import TypingError
from numba.core.imputils import lower_builtin, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import register_model, type_callable
from numba.np.arrayobj import populate_array

_GROUPS = (types.NamedTuple, types.NamedUniTuple)
_LENGTH = ir.IntType(64)
_ADDRESS = ir.IntType(8).as_pointer()
_unpacked: Any = cgutils.unpack_tuple
_room_for: Any = cgutils.alloca_once
_populate: Any = populate_array
_WORD = 8
"""Bytes of a place in a table."""


class Lent(types.Type):
    """A named tuple of arrays, numbers and such tuples, by the address of its table."""

    def __init__(self, group: Any) -> None:
        self.group = group
        name = group.instance_class.__name__
        super().__init__(f"Lent[{name}:{sha256(str(group).encode()).hexdigest()[:16]}]")


@register_model(Lent)
class _LentModel(PrimitiveModel):
    def __init__(self, manager: Any, lent: Any) -> None:
        super().__init__(manager, lent, _ADDRESS)  # type: ignore[no-untyped-call]


def _words(kind: Any) -> int:
    """Places that a field takes in a table: those of its own fields; data and shape; or one."""
    if isinstance(kind, _GROUPS):
        return sum(map(_words, kind.types))
    if isinstance(kind, types.Array):
        if kind.layout != "C":
            raise TypingError(f"only contiguous arrays can be lent, not {kind}")
        return 1 + int(kind.ndim)
    if isinstance(kind, Lent | types.Number | types.Boolean):
        return 1
    raise TypingError(f"{kind} cannot be lent")


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
    else:
        data = context.data_model_manager[kind].as_data(builder, value)
        builder.store(data, _at(builder, table, word, data.type))


def _read(builder: Any, table: Any, word: int, kind: Any) -> Any:
    """What stands in a place, the same whenever it is read."""
    found = builder.load(_at(builder, table, word, kind))
    found.set_metadata("invariant.load", builder.module.add_metadata([]))
    return found


def lend(group: Any) -> Any:
    """A group as one address, for the time of the function that lends it; see the module.

    Where Python runs that function, it is the group itself.
    """
    return group


@type_callable(lend)
def _type_of_lent(context: Any) -> Any:
    def lent(group: Any) -> Any:
        if isinstance(group, Lent):
            return group
        if not isinstance(group, _GROUPS):
            raise TypingError(f"{group} is no named tuple")
        _words(group)
        return Lent(group)

    return lent


@lower_builtin(lend, types.Any)  # type: ignore[no-untyped-call]
def _lend(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    group = signature.args[0]
    if isinstance(group, Lent):
        return given[0]
    table = _room_for(builder, ir.ArrayType(_LENGTH, _words(group)))
    address = builder.bitcast(table, _ADDRESS)
    _fill(context, builder, address, 0, group, given[0])
    # An address of which the compiler does not know whose it is: it may not move a reading
    # that does not change before the table is filled.
    same = ir.FunctionType(_ADDRESS, [_ADDRESS])
    return builder.asm(same, "", "=r,0,~{memory}", [address], True)


@infer_getattr
class _Fields(AttributeTemplate):
    key = Lent

    def generic_resolve(self, lent: Any, name: str) -> Any:  # type: ignore[override]
        """The type of a field: of a group in a group, one that is lent."""
        if name not in lent.group.fields:
            return None
        kind = lent.group.types[lent.group.fields.index(name)]
        return Lent(kind) if isinstance(kind, _GROUPS) else kind


@lower_getattr_generic(Lent)  # type: ignore[no-untyped-call]
def _field(context: Any, builder: Any, lent: Any, table: Any, name: str) -> Any:
    place = lent.group.fields.index(name)
    kind, word = lent.group.types[place], sum(map(_words, lent.group.types[:place]))
    if isinstance(kind, _GROUPS):
        return builder.gep(table, [_LENGTH(word * _WORD)])
    if isinstance(kind, types.Array):
        return _array(context, builder, kind, table, word)
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
    array = context.make_array(kind)(context, builder)
    _populate(
        array,
        data=_read(builder, table, word, element.as_pointer()),
        shape=shape,
        strides=strides,
        itemsize=size,
        meminfo=None,
    )
    return array._getvalue()
