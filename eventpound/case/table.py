"""A table of a case, read key by key, that collects what is wrong with it.

Reading never stops at a problem: it is noted, and a placeholder (NaN, an empty
text) is handed on, so that all problems of a case are reported together. A key
that nobody asked for is unknown.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, fields

from eventpound.basics.given import numbers_of
from eventpound.errors import InputError
from eventpound.units import Dimension, quantity

_CONTROL = re.compile(r"[^\n\t\x20-\x7e\x80-\U0010ffff]|[\x80-\x9f]")
"""What no text that is read by people has; lines may end."""


@dataclass(frozen=True, slots=True)
class CaseProblem:
    """One thing that is wrong with a case.

    Parameters
    ----------
    where : str
        The table, ``[[spring]] 2 (frame1)``; empty for the whole file.
    key : str
        The key; empty for the whole table.
    text : str
        What was found and what is accepted.
    """

    where: str
    key: str
    text: str

    def __str__(self) -> str:
        return ": ".join(part for part in (self.where, self.key, self.text) if part)


class Table:
    """One table of a case and the problems found in it.

    Parameters
    ----------
    data : mapping
        As tomllib gives it.
    where : str
        How messages call the table.
    problems : list of CaseProblem
        Where problems are noted, shared by all tables of a case.
    prefix : str
        What stands before a key of a table within a table.
    """

    def __init__(
        self, data: Mapping[str, object], where: str, problems: list[CaseProblem], prefix: str = ""
    ) -> None:
        self.data = data
        self.where = where
        self._problems = problems
        self._prefix = prefix
        self._asked: list[str] = []
        self._missing: dict[str, CaseProblem] = {}

    def report(self, key: str, text: str) -> CaseProblem:
        """Note a problem with a key."""
        place = f"{self._prefix}{key}".removesuffix(".")
        problem = CaseProblem(self.where, place, text)
        self._problems.append(problem)
        return problem

    @contextmanager
    def noting(self, key: str) -> Iterator[None]:
        """Note the problems of an InputError from within with a key, and go on behind."""
        try:
            yield
        except InputError as error:
            for problem in error.problems:
                self.report(key, problem)

    def reject(self, key: str, accepted: str) -> None:
        """Note that the value of a key is not accepted."""
        self.report(key, f"found {self.data[key]!r}; accepted: {accepted}")

    def report_missing(self, key: str, accepted: str) -> None:
        """Note that a key is needed."""
        self.blame(self.report(key, f"missing; accepted: {accepted}"), [key])

    def blame(self, problem: CaseProblem, keys: Sequence[str]) -> None:
        """Forget a problem if one of these missing keys turns out to be there, misspelt."""
        self._missing |= dict.fromkeys(keys, problem)

    def has(self, key: str) -> bool:
        """Whether a key is given; from now on it is known."""
        if key not in self._asked:
            self._asked.append(key)
        return key in self.data

    def optional_quantity(self, key: str, dimension: Dimension, positive: str = "") -> float | None:
        """Value in SI; None where it is not given, NaN where it is wrong.

        `positive` is what is accepted of a key that may be neither zero nor negative.
        """
        if not self.has(key):
            return None
        with self.noting(key):
            value = quantity(self.data[key], dimension)
            if positive:
                self.require(key, value > 0.0, positive)
            return value
        return math.nan

    def whole_number(
        self, key: str, least: int, most: int, default: int | None = None
    ) -> int | None:
        """A whole number; None where it is wrong or, without a default, missing."""
        accepted = f"a whole number from {least} to {most}"
        if not self.has(key):
            if default is None:
                self.report_missing(key, accepted)
            return default
        value = self.data[key]
        if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
            return value
        self.reject(key, accepted)
        return None

    def quantity(self, key: str, dimension: Dimension, default: float | None = None) -> float:
        """Value in SI; NaN where it is wrong or, without a default, missing."""
        value = self.optional_quantity(key, dimension)
        if value is not None:
            return value
        if default is None:
            self.report_missing(key, dimension.accepted)
            return math.nan
        return default

    def require(self, key: str, condition: bool, accepted: str) -> None:
        """Note a problem with a given value that does not satisfy a condition."""
        if not condition and not self.noted(key):
            self.reject(key, accepted)

    def noted(self, key: str) -> bool:
        """Whether a problem with a key is noted."""
        at = self.where, self._prefix + key
        return any((problem.where, problem.key) == at for problem in self._problems)

    def text(self, key: str, accepted: str, default: str | None = None) -> str:
        """A text; empty where it is wrong or, without a default, missing."""
        if not self.has(key):
            if default is None:
                self.report_missing(key, accepted)
            return default or ""
        value = self.data[key]
        if isinstance(value, str) and value.strip():
            self.require(key, not _CONTROL.search(value), f"{accepted}, no control characters")
            return value
        self.reject(key, accepted)
        return ""

    def file_name(self, key: str, default: str) -> str:
        """A text that files in the results are called by; no folder can be in it."""
        accepted = "a name for files, without / and not beginning with a dot"
        name = self.text(key, accepted, default)
        plain = name.isprintable() and not name.startswith(".") and "/" not in name
        self.require(key, plain and len(name) <= 100, accepted)
        return name

    def choice(
        self, key: str, choices: Sequence[str], called: Mapping[str, str] | None = None
    ) -> str:
        """One of some words; empty where it is missing or none of them.

        `called` answers words that others use for them, in small letters without hyphens.
        """
        accepted = "one of " + ", ".join(choices)
        value = self.text(key, accepted)
        if value and value not in choices:
            plain = re.sub("[^a-z]", "", value.lower())
            answer = (called or {}).get(plain) or suggestion(value, choices)
            self.report(key, f"found {value!r}{answer}; accepted: {accepted}")
            return ""
        return value

    def one_of(self, keys: Sequence[str], more: str = "") -> str:
        """Which of some keys is given; empty, with a problem noted, where that is not just one."""
        given = [key for key in keys if self.has(key)]
        if len(given) == 1:
            return given[0]
        found = f"found {' and '.join(given) or 'none'} of {', '.join(keys)}"
        self.report(keys[0], f"{found}; accepted: one of them{more}")
        return ""

    def flag(self, key: str) -> bool:
        """True or false; false where it is not given."""
        value = self.data[key] if self.has(key) else False
        if not isinstance(value, bool):
            self.reject(key, "true or false")
            return False
        return value

    def texts(self, key: str, accepted: str) -> tuple[str, ...]:
        """A list of texts; empty where it is missing or wrong."""
        if not self.has(key):
            self.report_missing(key, accepted)
            return ()
        value = self.data[key]
        if isinstance(value, list) and value and all(isinstance(v, str) for v in value):
            return tuple(value)
        self.reject(key, accepted)
        return ()

    def numbers(self, key: str, accepted: str) -> tuple[float, ...]:
        """A list of finite numbers without units; empty where it is missing or wrong."""
        if not self.has(key):
            self.report_missing(key, accepted)
            return ()
        value = self.data[key]
        if isinstance(value, list) and not any(isinstance(v, str) for v in value):
            try:
                return tuple(quantity(v, Dimension.NUMBER) for v in value)
            except InputError:
                pass
        self.reject(key, accepted)
        return ()

    def pair(self, key: str, accepted: str) -> tuple[str, str]:
        """Two texts; empty ones where they are missing or wrong."""
        texts = self.texts(key, accepted)
        if len(texts) == 2:
            return texts[0], texts[1]
        if texts:
            self.reject(key, accepted)
        return "", ""

    def table(self, key: str) -> Table:
        """A table within this one, empty where it is not given."""
        where, prefix = (self.where, f"{key}.") if self.where else (f"[{key}]", "")
        data = self.data[key] if self.has(key) else {}
        if not isinstance(data, dict):
            shown = f"a table, {key} = {{ ... }}" if self.where else f"a table, [{key}]"
            self.report(key, f"found {_brief(data)}; accepted: {shown}")
            data = {}
        return Table(data, where, self._problems, prefix)

    def with_data(self, data: Mapping[str, object]) -> Table:
        """The same table with other values, of which nothing was asked yet."""
        return Table(data, self.where, self._problems, self._prefix)

    def tables(self, key: str) -> list[Table]:
        """A list of tables within this one, empty where it is not given."""
        data = self.data[key] if self.has(key) else []
        if not isinstance(data, list) or not all(isinstance(item, dict) for item in data):
            shown = f"a list of tables, {key} = [{{ ... }}, ...]" if self.where else f"[[{key}]]"
            self.report(key, f"found {_brief(data)}; accepted: {shown}")
            return []
        if self.where:
            return [
                Table(item, self.where, self._problems, f"{key} {i}: ")
                for i, item in enumerate(data, 1)
            ]
        return [
            Table(item, f"[[{key}]] {i}{_named(item)}", self._problems)
            for i, item in enumerate(data, 1)
        ]

    def close(self) -> None:
        """Note the keys that nobody asked for."""
        for key in self.data:
            if key in self._asked:
                continue
            meant = suggestion(key, self._asked)
            accepted = "" if meant else f"; accepted: {', '.join(self._asked)}"
            for near in difflib.get_close_matches(key, self._missing, n=1):
                if self._missing[near] in self._problems:
                    self._problems.remove(self._missing[near])
            self.report(key, f"unknown key{meant}{accepted}")


def read_numbers(table: Table, made: type, *others: str) -> dict[str, float]:
    """Numbers by the fields of a class, but for others; those left open are not among them."""
    found: dict[str, float | None] = {}
    dimensions = numbers_of(made)
    for key, default in ((each.name, each.default) for each in fields(made)):
        if key in others or key not in dimensions:
            continue
        if default is None:
            found[key] = table.optional_quantity(key, dimensions[key])
        else:
            usual = None if default is MISSING else float(default)
            found[key] = table.quantity(key, dimensions[key], usual)
    return {key: value for key, value in found.items() if value is not None}


def suggestion(word: str, known: Sequence[str]) -> str:
    """What was meant instead, as the end of a message; empty where nothing is near.

    Of a name with dots every part has to be near: what two names share, such as that of a
    body, makes them no more alike.
    """
    near = difflib.get_close_matches(word, [name for name in known if _alike(word, name)], n=1)
    return f", did you mean '{near[0]}'?" if near else ""


def _alike(word: str, name: str) -> bool:
    """Whether two names have as many parts, each near the other's."""
    if "." not in word:
        return "." not in name
    parts, others = word.split("."), name.split(".")
    return len(parts) == len(others) and all(
        part == other or bool(difflib.get_close_matches(part, [other]))
        for part, other in zip(parts, others, strict=True)
    )


def _named(item: Mapping[str, object]) -> str:
    name = item.get("name")
    return f" ({name})" if isinstance(name, str) and name else ""


def _brief(value: object) -> str:
    return "a table" if isinstance(value, dict) else repr(value)
