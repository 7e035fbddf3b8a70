"""What is given in Python, read and checked by the type that it is declared to have.

A field that is read as one type and may be given as others says so once::

    mass: Annotated[Number, Dimension.MASS]

Type checkers see that the constructor takes a number or a text with a unit, and that the
attribute is a number. When the program runs, `read_fields` finds the same in the declaration:
it makes numbers of texts with units and tuples of sequences, and whatever is of another type is
an `InputError` that names class and field. `checked` does so for the arguments of a function.
"""

from __future__ import annotations

import inspect
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, wraps
from numbers import Integral, Real
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Generic,
    NamedTuple,
    TypeVar,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
    get_type_hints,
    overload,
)

from eventpound.errors import InputError, told_of
from eventpound.units import Dimension, quantity

_Class = TypeVar("_Class")
_Function = TypeVar("_Function", bound=Callable[..., Any])

if TYPE_CHECKING:
    _Read = TypeVar("_Read")
    _Taken = TypeVar("_Taken")

    class Given(Generic[_Read, _Taken]):
        """Type of a field that is read as `_Read` and may be given as `_Taken`."""

        def __get__(self, owner: object, kind: type | None = None) -> _Read: ...

        def __set__(self, owner: object, value: _Taken) -> None: ...
else:

    class Given:
        """Type of a field that is read as the first and may be given as the second."""

        def __class_getitem__(cls, of):
            return of[0]


Number = Given[float, float | str]
"""A number, or a text with a unit."""
OptionalNumber = Given[float | None, float | str | None]
"""The same, or None."""
_LARGEST_WHOLE = 2**53
"""Up to which every whole number is a double."""


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def converting(made: type[_Class]) -> type[_Class]:
    """Decorate a frozen dataclass whose fields may be given as other types than they are read as.

    Its ``__post_init__`` is `read_fields`; one of its own calls that.
    """
    return dataclass(frozen=True, slots=True)(_reading(made))


@dataclass_transform(field_specifiers=(field,))
def converting_base(*, eq: bool = True) -> Callable[[type[_Class]], type[_Class]]:
    """`converting` for classes that inherit from each other or keep what they have computed.

    They are frozen, too. Type checkers are not told so, because mypy forgets otherwise in which
    type an inherited field is read.
    """
    return lambda made: dataclass(frozen=True, eq=eq)(_reading(made))


def _reading(made: type[_Class]) -> type[_Class]:
    if not hasattr(made, "__post_init__"):
        made.__post_init__ = read_fields  # type: ignore[attr-defined]
    return made


class Accepted(NamedTuple):
    """Which finite numbers a field may be, asked when its owner is used, not when it is made."""

    words: str
    fits: Callable[[Any, float], bool] = lambda owner, value: True


def above_zero(owner: object, value: float) -> bool:
    """Whether a number is positive, whatever it belongs to."""
    return value > 0.0


def not_negative(owner: object, value: float) -> bool:
    """Whether a number is not negative, whatever it belongs to."""
    return value >= 0.0


def default(value: object) -> Any:
    """Give a field its default, of the type that it is read as."""
    return value


def read_fields(owner: object, **dimensions: Dimension) -> None:
    """Read and check the fields of a frozen dataclass that is being made.

    Parameters
    ----------
    owner : object
        Called from its ``__post_init__``.
    **dimensions : Dimension
        Of numbers that have another than is declared, by the names of their fields.

    Raises
    ------
    InputError
        Naming class and field, with what was found and what is accepted.
    """
    made: Any = type(owner)
    for name, as_it_is, kind in _kinds_of_fields(made):
        value = getattr(owner, name)
        if type(value) not in as_it_is:
            if name in dimensions:
                kind = _quantity(dimensions[name], optional=False)
            read = _read(f"{made.__name__}: {name}", kind, value)
            if read is not value:
                object.__setattr__(owner, name, read)


def checked(function: _Function) -> _Function:
    """Decorate a function whose arguments are to be checked by their annotations.

    A call without an argument that is needed, or with one that there is not, stays Python's
    TypeError.
    """
    signature = inspect.signature(function)
    called = function.__qualname__.removesuffix(".__init__")
    parameters = signature.parameters.values()
    places = [each.name for each in parameters if each.kind is each.POSITIONAL_OR_KEYWORD]
    needed = {each.name for each in parameters if each.default is each.empty}
    known = {each.name for each in parameters}

    @wraps(function)
    def calling(*args: Any, **kwargs: Any) -> Any:
        given = dict(zip(places, args, strict=False)) | kwargs
        if len(given) < len(args) + len(kwargs) or not needed <= given.keys() <= known:
            # Says what is wrong, which takes it long to tell where nothing is.
            signature.bind(*args, **kwargs)
        for name, kind in _kinds_of_arguments(function):
            if name in given and type(given[name]) not in kind.as_it_is:
                given[name] = _read(f"{called}: {name}", kind, given[name])
        return function(**given)

    return calling  # type: ignore[return-value]


def numbers_of(made: type) -> dict[str, Dimension]:
    """Fields of a class of `converting` that hold a number, given or not, with their dimensions."""
    return {
        name: kind.dimension
        for name, _, kind in _kinds_of_fields(made)
        if kind.dimension is not None
    }


@cache
def accepted_numbers(made: Any) -> tuple[tuple[str, Any], ...]:
    """Fields of a class of `converting` that say which numbers they may be, with what they say."""
    hints = get_type_hints(made, include_extras=True)
    said = ((name, getattr(hint, "__metadata__", ())) for name, hint in hints.items())
    return tuple((name, each) for name, all_of in said for each in all_of[1:])


def number(key: str, value: object, dimension: Dimension) -> float:
    """An argument that is a number, perhaps with a unit.

    Raises
    ------
    InputError
        Naming the argument, where it is no such number.
    """
    with told_of(f"{key}: "):
        return quantity(value, dimension)


@overload
def positive(key: str, value: float | str, dimension: Dimension) -> float: ...


@overload
def positive(key: str, value: float | str | None, dimension: Dimension) -> float | None: ...


def positive(key: str, value: float | str | None, dimension: Dimension) -> float | None:
    """An argument that is a positive number, perhaps with a unit, or None.

    Raises
    ------
    InputError
        Naming the argument, where it is no such number.
    """
    if value is None:
        return None
    found = number(key, value, dimension)
    if found <= 0.0:
        raise InputError(f"{key}: found {value!r}; accepted: a positive number")
    return found


class _UnfitError(Exception):
    """A value is not of a kind."""


@dataclass(frozen=True)
class _Kind:
    """What a declared type accepts.

    Parameters
    ----------
    accepted : str
        As a phrase.
    read : callable
        Makes of a value what it is read as; an `_UnfitError` or InputError where it cannot.
    as_it_is : set of type
        Of these every value is taken as it is.
    dimension : Dimension, optional
        Of a number.
    """

    accepted: str
    read: Callable[[Any], Any]
    as_it_is: frozenset[Any] | set[Any] = frozenset()
    dimension: Dimension | None = None


def _read(where: str, kind: _Kind, value: object) -> Any:
    try:
        return kind.read(value)
    except _UnfitError:
        raise InputError(f"{where}: found {value!r}; accepted: {kind.accepted}") from None
    except InputError as error:
        raise InputError([f"{where}: {problem}" for problem in error.problems]) from None


@cache
def _kinds_of_fields(made: Any) -> tuple[tuple[str, frozenset[Any] | set[Any], _Kind], ...]:
    """Name of each field, the types that are taken as they are, and what else is."""
    hints = get_type_hints(made, include_extras=True)
    kinds = {part.name: _kind_of(hints[part.name]) for part in fields(made)}
    return tuple((name, kind.as_it_is, kind) for name, kind in kinds.items())


@cache
def _kinds_of_arguments(function: Callable[..., Any]) -> tuple[tuple[str, _Kind], ...]:
    names = [name for name in function.__annotations__ if name != "return"]
    # What is returned may be known to type checkers only.
    scope = function.__globals__
    return tuple((name, _kind_of(eval(function.__annotations__[name], scope))) for name in names)


def _kind_of(hint: Any) -> _Kind:
    """What a type accepts."""
    origin = get_origin(hint)
    if hint in (Any, object):
        return _Kind("anything", lambda value: value)
    if origin is Annotated:
        base, of, *_ = get_args(hint)
        return _quantity(of, type(None) in get_args(base)) if isinstance(of, Dimension) else of
    if origin in (Union, types.UnionType):
        return _one_of([_kind_of(part) for part in get_args(hint)])
    if origin is tuple and get_args(hint)[-1] is not Ellipsis:
        return _row([_kind_of(part) for part in get_args(hint)])
    if origin in (tuple, Sequence, Iterable):
        return _several(_kind_of(get_args(hint)[0]))
    if origin is Mapping:
        return _mapping(_kind_of(get_args(hint)[0]))
    if origin is Callable:
        return _Kind("a function", _of(callable))
    return _SIMPLE.get(hint) or _instance(origin or hint)


def _of(fits: Callable[[Any], bool], made: Callable[[Any], Any] | None = None) -> Any:
    def read(value: Any) -> Any:
        if not fits(value):
            raise _UnfitError
        return value if made is None else made(value)

    return read


def _is_flag(value: object) -> bool:
    """Whether it is true or false, of NumPy too, which is not imported for it."""
    of = type(value)
    return of is bool or (of.__module__ == "numpy" and of.__name__ in ("bool", "bool_"))


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not _is_flag(value)


def _is_whole(value: object) -> bool:
    return isinstance(value, Integral) and not _is_flag(value)


_SIMPLE: dict[Any, _Kind] = {
    type(None): _Kind("None", _of(lambda value: value is None), frozenset({type(None)})),
    str: _Kind("a text", _of(lambda value: isinstance(value, str)), frozenset({str})),
    bool: _Kind("True or False", _of(_is_flag, bool), frozenset({bool})),
    int: _Kind("a whole number", _of(_is_whole, int), frozenset({int}), Dimension.NUMBER),
    float: _Kind("a number", _of(_is_number), frozenset({float}), Dimension.NUMBER),
}
Count = Annotated[int, _Kind("a whole number from 1", _of(lambda n: _is_whole(n) and n >= 1, int))]
"""How many of something there are, at least one, as an argument of a function of `checked`."""
_CALLED = {
    "Case": "a Case (load_case reads one)",
    "GroundMotion": "a ground motion, such as Cosine or Record",
    "PathLike": "a path",
    "ndarray": "an array",
}
"""Classes that a message does not call by their names alone."""


def _instance(kind: type) -> _Kind:
    """Objects of a class; those of a protocol that cannot be asked for are checked elsewhere."""
    if getattr(kind, "_is_protocol", False) and not getattr(kind, "_is_runtime_protocol", False):
        return _Kind(kind.__name__, lambda value: value)
    known = set() if getattr(kind, "_is_protocol", False) else {kind}

    def read(value: Any) -> Any:
        # A class has all that a protocol asks of its objects.
        if type(value) not in known:
            if not isinstance(value, kind) or isinstance(value, type):
                raise _UnfitError
            known.add(type(value))
        return value

    return _Kind(_CALLED.get(kind.__name__, f"a {kind.__name__}"), read, known)


def _quantity(dimension: Dimension, optional: bool) -> _Kind:
    """Numbers and texts with units, which become numbers."""

    def read(value: Any) -> float | None:
        if value is None and optional:
            return None
        if _is_whole(value) and abs(value) <= _LARGEST_WHOLE:
            return int(value)
        if not _is_number(value):
            return quantity(value, dimension)
        try:
            # One that is not finite is refused with what it belongs to.
            return float(value)
        except OverflowError:
            raise _UnfitError from None

    accepted = dimension.accepted + (", or None" if optional else "")
    return _Kind(accepted, read, {float, type(None)} if optional else {float}, dimension)


def _one_of(kinds: Sequence[_Kind]) -> _Kind:
    """The first kind that fits, or what the only one of them says that tells why not."""

    def read(value: Any) -> Any:
        for kind in kinds:
            try:
                return kind.read(value)
            except _UnfitError:
                continue
        raise _UnfitError

    *first, last = (kind.accepted for kind in kinds)
    as_it_is: set[Any] = set().union(*(kind.as_it_is for kind in kinds))
    own = {kind.dimension for kind in kinds if type(None) not in kind.as_it_is}
    dimension = own.pop() if len(own) == 1 else None
    return _Kind(f"{', '.join(first)} or {last}", read, as_it_is, dimension)


def _mapping(key: _Kind) -> _Kind:
    """Mappings from things of one kind; their values are checked where they are used."""

    def read(value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise _UnfitError
        for name in value:
            key.read(name)
        return value

    return _Kind(f"a mapping, each key {key.accepted}", read)


def _items(values: Any) -> tuple[Any, ...]:
    """Items of a sequence, which a text or a mapping is not meant to be."""
    if type(values) is tuple:
        return values
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise _UnfitError
    try:
        return tuple(values)
    except TypeError:  # of an array without dimensions
        raise _UnfitError from None


def _several(kind: _Kind) -> _Kind:
    """Sequences of things of one kind, which become tuples."""

    def read(values: Any) -> tuple[Any, ...]:
        items = _items(values)
        if kind.as_it_is.issuperset(map(type, items)):
            return items
        return tuple(map(kind.read, items))

    return _Kind(f"a sequence, each item {kind.accepted}", read)


def _row(kinds: Sequence[_Kind]) -> _Kind:
    """Sequences of one length with a kind for each place, which become tuples."""

    def read(values: Any) -> tuple[Any, ...]:
        items = _items(values)
        if len(items) != len(kinds):
            raise _UnfitError
        return tuple(kind.read(item) for kind, item in zip(kinds, items, strict=True))

    each = " and ".join(kind.accepted for kind in kinds)
    return _Kind(f"a sequence of {len(kinds)}: {each}", read)
