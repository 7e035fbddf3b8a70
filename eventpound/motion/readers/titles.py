"""What titles and words before plain numbers state: unit, time step, number, what they are.

A unit stands in brackets, ``Time (sec)`` and ``t [ms]``, or after the name of what it measures,
``time_ms``, ``acc, cm/s2`` and ``disp in mm``. Letter case does not matter.

``# dt = 0.01 s``, ``Sampling rate: 100 Hz``, ``UNITS OF G``, ``NPTS= 2000``. Where lines state two
different values, as of a record before and after processing, neither counts.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.block import StatedCount, miscounted
from eventpound.motion.readers.header import Header, unit_factor, word_pattern
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.units import STANDARD_GRAVITY, Dimension, quantity


class Content(Enum):
    """What a column holds; the value is what messages call it."""

    TIME = "a time"
    COUNT = "a count of the rows"
    ACCELERATION = "an acceleration"
    VELOCITY = "a velocity"
    DISPLACEMENT = "a displacement"
    FORCE = "a force"


_NAMES = {
    Content.TIME: r"t|([a-z]+\W*)?times?(\W+(of|since|from|after)\b.*)?|date|timestamp|datetime|"
    r"clock|zeit|temps|tiempo|tempo",
    Content.COUNT: r"(data)?\W*(samples?|index|idx|i|n|no|nr|num|number|points?|pts?|row|record|"
    r"rec|step|scan|id|count)?\W*(no|nr|num|number|index|id|#)?",
    Content.ACCELERATION: r"(.*[^a-z])?acc(el.*|[^a-z].*)?|a_?g|a([^a-z].*)?",
    Content.VELOCITY: r"(.*[^a-z])?vel(oc.*|[^a-z].*)?",
    Content.DISPLACEMENT: r"(.*[^a-z])?dis(pl?|placem.*)?([^a-z].*)?",
    Content.FORCE: r"(.*[^a-z])?(force|load)s?|f|p",
}
"""What they are called, each with everything before a unit."""
_BESIDE_ACCELERATION = {"v": Content.VELOCITY, "d": Content.DISPLACEMENT, "u": Content.DISPLACEMENT}
"""Letters with which names begin that are components elsewhere (V is vertical)."""
_LETTER = re.compile(r"([vdu])([^a-z].*)?", re.IGNORECASE)
_SECONDS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisec", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs", "usec", "microsec", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("min", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
}
_ACCELERATIONS = {
    "gs": STANDARD_GRAVITY,
    "mg": 0.001 * STANDARD_GRAVITY,
    "%g": 0.01 * STANDARD_GRAVITY,
    "gals": 0.01,
    "in/s2": 0.0254,
    "ft/s2": 0.3048,
}
"""Those of titles that `unit_factor` does not know (m/s^2)."""
_LENGTHS = {
    **{"m": 1.0, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6},
    **dict.fromkeys(("in", "inch", "inches"), 0.0254),
    **dict.fromkeys(("ft", "foot", "feet"), 0.3048),
}
_BRACKETED = re.compile(r"(.*?)\s*[(\[{<]\s*((?:[^()\[\]{}<>]|\([^()]*\)|\{[^{}]*\})*)[)\]}>]\s*")
_PLACES = re.compile(r"[\s,;:_/]+")
"""Where a unit without brackets may begin."""
_RAISED = str.maketrans("²⁻¹", "2-1")
_BETWEEN_BLANKS = re.compile(r"\s+(?![(\[])(?![^(\[]*[)\]])")
_OUTRIGHT = re.compile(r".*/.*|gals?|m?secs?|m?s|g")
"""Units that need no name."""


@dataclass(frozen=True)
class Title:
    """The title of a column.

    Parameters
    ----------
    text : str
        As printed.
    name : str
        Without its unit.
    kind : Content or None
        What is in the column; None where the title does not say.
    unit : str or None
        As printed; None where there is none that is known.
    factor : float
        Its SI value; 1 without one.
    """

    text: str = ""
    name: str = ""
    kind: Content | None = None
    unit: str | None = None
    factor: float = 1.0

    @property
    def units(self) -> str | None:
        """The unit of an acceleration as the unit of a record is written; None without one."""
        if self.unit is None or unit_factor(self.unit) == self.factor:
            return self.unit
        return "g" if self.factor == STANDARD_GRAVITY else f"{self.factor!r} m/s2"


def title_of(text: str) -> Title:
    """What a title says."""
    bracketed = _BRACKETED.fullmatch(text)
    if bracketed is not None:
        name, unit = bracketed.groups()
        named = _kind_of(name)
        if (found := _measured(unit.strip(), named)) is not None:
            return Title(text, name or text, found[0], unit.strip(), found[1])
        return Title(text, text, named)
    starts = [match.end() for match in _PLACES.finditer(text)]
    for start in [0, *starts]:
        name, unit = _PLACES.sub(" ", text[:start]).strip(), text[start:].strip()
        name = re.sub(r"\s+in$", "", name)
        named = _kind_of(name) if name else None
        sure = named is not None or _OUTRIGHT.fullmatch(unit.lower())
        # "a_g" is what the ground's acceleration is called.
        ground = re.fullmatch(r"[auv][\s_]+g", text.lower())
        if not unit or not sure or ground or (name and named is None and len(unit) < 2):
            continue
        if (found := _measured(unit, named)) is not None and named in (None, found[0]):
            return Title(text, name or text, found[0], unit, found[1])
    return Title(text, text, _kind_of(text))


_LAST_PART = re.compile(r".*(?=[\s_,/(\[{<])")
_CALLED = {
    Content.TIME: "time",
    Content.DISPLACEMENT: "disp",
    Content.VELOCITY: "vel",
    Content.FORCE: "force",
}


def title_of_kind(text: str, kind: Content) -> Title:
    """What a title says of a column that is known to hold this, whatever its name."""
    title = title_of(text)
    if title.unit is None:
        before = _LAST_PART.match(text)
        named = title_of(_CALLED[kind] + (text[before.end() :] if before else f" {text}"))
        if named.unit is not None and named.kind is kind:
            return replace(title, kind=kind, unit=named.unit, factor=named.factor)
    return title


def titles_of(lines: list[str], width: int) -> list[Title] | None:
    """Titles of so many columns, from the last of the lines before them; None where there are none.

    Parameters
    ----------
    lines : list of str
        Without the marks of comments.
    width : int
        Number of columns.
    """
    found = _fields(lines[-1], width) if lines else None
    if found is None:
        return None
    titles = [title_of(text) for text in found]
    above = _fields(lines[-2], width) if len(lines) > 1 else None
    if above is not None and all(title.unit and title.name == title.text for title in titles):
        # A line of names, and one of units below it.
        bare = [text.strip("()[]{}<> ") for text in found]
        titles = [title_of(f"{name} [{unit}]") for name, unit in zip(above, bare, strict=True)]
    if any(title.kind is Content.ACCELERATION for title in titles):
        for i, title in enumerate(titles):
            if title.kind is None and (letter := _LETTER.fullmatch(title.name)):
                titles[i] = replace(title, kind=_BESIDE_ACCELERATION[letter.group(1).lower()])
    return titles


def _fields(line: str, width: int) -> list[str] | None:
    """A line parted into so many titles, which may have blanks within; None where it has not."""
    line = line.strip().rstrip(",; ")
    by_mark = (next(csv.reader([line], delimiter=mark), []) for mark in "\t,;")
    by_blanks = (pattern.split(line) for pattern in (re.compile(r"\s{2,}"), _BETWEEN_BLANKS))
    for parts in (*by_mark, *by_blanks, re.split(r"\s*[,;]\s*|\s+", line)):
        fields = [part.strip("\"' \t") for part in parts]
        if len(fields) == width and all(fields):
            return fields
    return None


def _kind_of(name: str) -> Content | None:
    """What a name says is in its column."""
    plain = name.strip(" .:").lower()
    if not plain:
        return None
    return next((kind for kind, like in _NAMES.items() if re.fullmatch(like, plain)), None)


def _measured(unit: str, named: Content | None) -> tuple[Content, float] | None:
    """What is measured in a unit, and its SI value; None for what is no unit."""
    plain = re.sub(r"[\s*^.·'’(){}]", "", unit.lower()).translate(_RAISED).replace("_", "/")
    if plain in _SECONDS and named in (None, Content.TIME):
        return Content.TIME, _SECONDS[plain]
    if named is Content.FORCE:
        try:
            return named, quantity(f"1 {unit}", Dimension.FORCE)
        except InputError:
            return None
    plain = re.sub(r"sec(onds?)?", "s", plain).replace("/s/s", "/s2")
    plain = re.sub(r"(?<=[mnt])/?s-?2", "/s2", plain)
    factor = _ACCELERATIONS.get(plain) or unit_factor(plain)
    if factor is not None:
        return Content.ACCELERATION, factor
    length, slash, per = plain.partition("/")
    if length in _LENGTHS and per == ("s" if slash else ""):
        return (Content.VELOCITY if slash else Content.DISPLACEMENT), _LENGTHS[length]
    return None


_COUNT = word_pattern(
    r"(?:\bNPTS?|\b(?:NUMBER|NO\.?) OF (?:\w+ )?(?:POINTS|SAMPLES|DATA|VALUES))\W*(\d+)"
)
_STEP = word_pattern(
    r"(?:\bDT|\bTIME[ _-]?STEP|\bTSTEP|\bDELTA[ _-]?T|\bSAMPLING (?:INTERVAL|PERIOD))\b"
    rf"([^\d.\n]{{0,20}}?)({NUMBER})(\s*ms)?"
)
_RATE = word_pattern(
    rf"(?:\bsampl\w*\W+(?:rate|freq\w*)[^\d.\n]{{0,20}}?|\b(?:fs|rate)\s*[=:]\s*|\A\W*)({NUMBER})"
    r"(?=\W*(?:Hz|sps|samples\W*(?:per|/))|\W*$)"
)
_HERTZ = word_pattern(r"\b(?:Hz|sps|rate|freq\w*|fs|samples\W*(?:per|/))")
_UNIT = word_pattern(
    r"\bUNITS? *(?:OF|ARE|IN|:|=) *[(\[]? *([%A-Z]+(?:/[A-Z0-9/^*]+)?)|"
    r"(?<![\d.])(?<![\d.] )(?<![\w/])((?:[cm]?m|ft|in)/s(?:ec)?(?:\W{0,2}2|²|/s(?:ec)?)|gals?)\b"
)
LARGEST_STEP = 1.0
"""What is longer (s) is no time step, whatever words or places say."""


def step_in(text: str) -> float | None:
    """The time step (s) that words state, or their sampling rate does; None where none does."""
    if found := _STEP.search(text):
        between, number, milli = found.groups()
        step = to_float(number) * (1e-3 if milli or "ms" in between.lower() else 1.0)
    elif (found := _RATE.search(text)) and _HERTZ.search(text):
        rate = to_float(found.group(1))
        step = 1.0 / rate if rate > 0.0 else 0.0
    else:
        return None
    return step if 0.0 < step <= LARGEST_STEP else None


def count_in(text: str) -> str | None:
    """The number of samples that words state."""
    found = _COUNT.search(text)
    return found.group(1) if found else None


def _unit_in(text: str) -> Title | None:
    """The title that words are, or the unit that they state."""
    title = title_of(text)
    if title.unit is not None:
        # "PGV = 12 cm/s" is a value.
        return None if re.search(r"\d\W*$", title.name) else title
    found = _UNIT.search(text)
    title = title_of(f"[{found.group(1) or found.group(2)}]") if found else Title()
    return title if title.unit is not None else None


def stated_before(
    source: Source, end: int, numbers: Header | None = None
) -> tuple[Header, StatedCount | None]:
    """What the lines before one (from 1) state.

    Parameters
    ----------
    source : Source
        The file.
    end : int
        The line.
    numbers : Header, optional
        With the step that numbers among them state.

    Raises
    ------
    InputError
        Where they state a unit of another quantity than acceleration, and none of one, or
        another step than the numbers do.
    """
    lines = [(i, x.strip(" \t#%!/*\"'")) for i, x in enumerate(source.lines[: end - 1], start=1)]
    steps = [(step, i) for i, text in lines if (step := step_in(text)) is not None]
    counts = [(count, i) for i, text in lines if (count := count_in(text)) is not None]
    titles = [(title, i) for i, text in lines if (title := _unit_in(text)) is not None]
    units = [(one, i) for one, i in titles if one.kind is Content.ACCELERATION]
    other = [(one, i) for one, i in titles if one.kind in (Content.VELOCITY, Content.DISPLACEMENT)]
    if other and not units:
        title, line = other[0]
        assert title.kind is not None
        raise source.error(
            line,
            f"states '{title.unit}', the unit of {title.kind.value}; an acceleration is needed",
        )
    header = numbers or Header()
    if _are_one(one.factor for one, _ in units):
        header = replace(header, units=units[0][0].units, units_line=units[0][1])
    if _are_one(step for step, _ in steps):
        step, line = steps[0]
        if header.time_step not in (None, step):
            raise source.error(
                line, f"states {step!r} s, line {header.time_step_line} {header.time_step!r} s"
            )
        header = replace(header, time_step=step, time_step_line=line)
    one = _are_one(count for count, _ in counts)
    return header, StatedCount(to_count(counts[0][0]), counts[0][1]) if one else None


def _are_one(values: Iterable[object]) -> bool:
    return len(set(values)) == 1


def refuse_other_count(source: Source, stated: StatedCount | None, found: int, last: int) -> None:
    """Stop where there are not so many samples, up to a line (from 1), as are stated."""
    if stated is not None and stated.count != found:
        raise InputError(miscounted(source, stated, found, last, "samples"))
