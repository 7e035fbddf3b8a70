"""Axes of a study: numbers of a scene or Π-terms, and words of the case itself.

pi.<term>                        a Π-term, by the keys of `eventpound.scene.pi_terms`
body.<name>.mass, ...            a number of the scene, by its dotted key
excitation.kind, run.duration    a key of the case: other words, another scene
deck.skew, joint.middle.gap      a key of decks in plan, of all or of one: another scene
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eventpound.basics.input_files import matching_files
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.parameters import dimension_of_number
from eventpound.units import Dimension, quantity

PI = "pi."
"""What the key of a Π-term begins with."""
_FILE = "excitation.file"
_WORDS = ("excitation.kind", "excitation.reverse", _FILE, "pi.structure", "pi.row", "pi.periods")
MOST_VALUES = 1_000_000
"""Values of a range; more is a slip."""
_RUN = "run."
OF_PLAN = "deck.", "joint.", "pier.", "bearing."
"""Tables that are more than one number of a scene: of one by its name, or of all, ``deck.skew``."""
_ROOTS = (
    "pi.", "body.", "spring.", "dashpot.", "contact.", "support.", "excitation.", *OF_PLAN, _RUN
)  # fmt: skip
_SPACINGS = ("linear", "logarithmic")


@dataclass(frozen=True)
class NumberAxis:
    """Values of a number of the scene or of a Π-term.

    Parameters
    ----------
    key : str
        Which one.
    values : ndarray, shape (n,)
        In SI, or without dimension.
    together : str
        Axes with the same text here go along together; an empty one by itself.
    """

    key: str
    values: Floats
    together: str = ""


@dataclass(frozen=True)
class WordAxis:
    """Values of a key of the case, each of which makes a scene of its own.

    Parameters
    ----------
    key : str
        Table and key, ``excitation.kind``.
    values : tuple
        As a case has them.
    """

    key: str
    values: tuple[object, ...]


def read_axes(tables: Sequence[Table], directory: Path) -> list[NumberAxis | WordAxis]:
    """Axes from ``[[study.axis]]`` tables; problems are noted.

    Parameters
    ----------
    tables : sequence of Table
        One an axis.
    directory : Path
        Directory of the case, to which patterns of files are relative.
    """
    axes = [_read_axis(table, directory) for table in tables]
    for table, axis in zip(tables, axes, strict=True):
        if axis is not None and [a.key for a in axes if a is not None].count(axis.key) > 1:
            table.report("key", f"found {axis.key!r} on two axes; accepted: one axis a key")
    numbers = [axis for axis in axes if isinstance(axis, NumberAxis)]
    for table, axis in zip(tables, axes, strict=True):
        lengths = [] if axis is None else _unequal(numbers, axis)
        if lengths:
            found = [size for _, size in lengths]
            table.report("zip", f"found axes of {found} values; accepted: as many on each")
    return [axis for axis in axes if axis is not None]


def _unequal(axes: Sequence[NumberAxis], of: NumberAxis | WordAxis) -> list[tuple[str, int]]:
    """Keys and lengths of the axes that go along with one, where they differ."""
    word = of.together if isinstance(of, NumberAxis) else ""
    lengths = [(axis.key, axis.values.size) for axis in axes if word and axis.together == word]
    return lengths if len({size for _, size in lengths}) > 1 else []


def _read_axis(table: Table, directory: Path) -> NumberAxis | WordAxis | None:
    accepted = "a number of the case, pi.<term>, or a key of [excitation], [pi] or [run]"
    key = table.text("key", accepted)
    if key and not key.startswith(_ROOTS):
        table.reject("key", accepted)
        key = ""
    together = table.text("zip", "some text") if table.has("zip") else ""
    words = key in _WORDS or key.startswith((_RUN, *OF_PLAN))
    if table.has("files"):
        values = _files(table, key, directory)
    elif table.has("values"):
        given = table.data["values"]
        if not isinstance(given, list) or not given:
            table.reject("values", "a list with a value at least")
            return None
        values = given
    else:
        values = _read_range(table, _dimension(key))
    if words and together:
        table.reject("zip", "an axis of numbers")
    table.close()
    if not key or not values:
        return None
    return WordAxis(key, tuple(values)) if words else _numbers(table, key, values, together)


def _files(table: Table, key: str, directory: Path) -> list[object]:
    """Files that match a pattern, in the order of their names."""
    pattern = table.text("files", 'a pattern of files, "records/*.AT2"')
    if key != _FILE:
        table.reject("files", f"values; files are those of an axis {_FILE!r}")
        return []
    try:
        paths = matching_files(pattern, directory)
    except InputError as error:
        table.report("files", str(error))
        return []
    found: list[object] = [
        str(path.relative_to(directory) if path.is_relative_to(directory) else path)
        for path in paths
    ]
    if pattern and not found:
        table.reject("files", f"a pattern of files that are there, relative to {directory}")
    return found


def _numbers(table: Table, key: str, values: Sequence[object], together: str) -> NumberAxis | None:
    try:
        return number_axis(key, values, together)
    except InputError as error:
        table.report("values", str(error))
        return None


def number_axis(key: str, values: Iterable[object], together: str = "") -> NumberAxis:
    """An axis of numbers, which may have units.

    Raises
    ------
    InputError
        Where a value is none, or has the unit of something else.
    """
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise InputError(f"found {values!r}; accepted: a list of values")
    found = np.array(values) if isinstance(values, np.ndarray) else None
    if found is None or found.dtype.kind not in "fiu":
        found = np.array([quantity(value, _dimension(key)) for value in values])
    column = found.astype(np.float64)
    if column.ndim != 1:
        raise InputError(f"found shape {column.shape}; accepted: a list of values")
    if not np.isfinite(column).all():
        i = int(np.flatnonzero(~np.isfinite(column))[0])
        raise InputError(f"found {column[i]} as value {i}; accepted: finite numbers")
    return NumberAxis(key, column, together)


def given_axes(
    word: str, given: Mapping[str, Iterable[object]], together: Sequence[Sequence[str]] = ()
) -> tuple[NumberAxis, ...]:
    """Axes of a call, their values checked by themselves.

    Parameters
    ----------
    word : str
        What the call calls them.
    given : mapping of str to sequence
        Values by their keys.
    together : sequence of sequences of str
        Keys of axes that go along together.

    Raises
    ------
    InputError
        With a line for every problem.
    """
    group = {key: " ".join(keys) for keys in together for key in keys}
    problems = [f"together: {key!r} is no axis" for key in group if key not in given]
    found = []
    for key, values in given.items():
        try:
            found.append(number_axis(key, values, group.get(key, "")))
        except InputError as error:
            problems.append(f"{word}: {key}: {error}")
    problems += [f"{word}: {axis.key}: has no values" for axis in found if not axis.values.size]
    for lengths in {tuple(_unequal(found, axis)) for axis in found} - {()}:
        said = ", ".join(f"{key} has {size}" for key, size in lengths)
        problems.append(f"{word}: found different lengths: {said}; accepted: one length")
    if problems:
        raise InputError(problems)
    return tuple(found)


def _read_range(table: Table, dimension: Dimension) -> list[object]:
    """Values from ``from`` to ``to``; empty where something is wrong."""
    first = table.quantity("from", dimension)
    last = table.quantity("to", dimension)
    count = table.quantity("count", Dimension.NUMBER)
    spacing = table.choice("spacing", _SPACINGS) if table.has("spacing") else "linear"
    if not 2.0 <= count <= MOST_VALUES or count != round(count):
        if count == count:
            table.reject("count", f"a whole number from 2 to {MOST_VALUES}")
        return []
    if not (np.isfinite(first) and np.isfinite(last) and spacing):
        return []
    if spacing == "logarithmic" and not min(first, last) > 0.0:
        table.reject("from", "positive ends of a logarithmic range")
        return []
    space = np.geomspace if spacing == "logarithmic" else np.linspace
    # A range too wide for doubles has values that are not finite, which are refused.
    with np.errstate(all="ignore"):
        listed: list[object] = space(first, last, int(count)).tolist()
    return listed


def _dimension(key: str) -> Dimension:
    """Of the number that a key names."""
    return dimension_of_number(key) or Dimension.NUMBER


def sizes(axes: Sequence[NumberAxis]) -> dict[str, int]:
    """Lengths of the axes that vary by themselves, zipped ones once, the slowest first."""
    return {axis.together or f"key {axis.key}": axis.values.size for axis in axes}


def values_of_rows(axes: Sequence[NumberAxis], rows: Ints) -> dict[str, Floats]:
    """Values of every axis in some rows of their product.

    Parameters
    ----------
    axes : sequence of NumberAxis
        The last one varies fastest.
    rows : ndarray of int, shape (n,)
        Rows, from 0.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        By the keys of the axes.
    """
    shape = sizes(axes)
    if not shape:
        return {}
    at = dict(zip(shape, np.unravel_index(rows, tuple(shape.values())), strict=True))
    return {axis.key: axis.values[at[axis.together or f"key {axis.key}"]] for axis in axes}
