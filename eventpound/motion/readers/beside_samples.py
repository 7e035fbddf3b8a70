"""Numbers among the rows that are no samples: a count and a step before them, numbers of the rows.

A count before the samples is known by their number; a step by a count beside it, or because it
is the one that the caller gives. What only may be one is refused, and never becomes a sample.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.plausible import STEP
from eventpound.motion.readers.base import SAME_STEP, Source, UnstatedError
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.numbers import to_float
from eventpound.motion.readers.rows import NumberRows
from eventpound.motion.readers.time_column import increases

_LONGEST = 2
"""Numbers before the samples that are understood: a count and a step."""
_JUMP = 3.0
"""A number this far from the next, in the largest of the steps after it, is no sample."""
_COMPARED = 20
"""Samples with which the first number is compared."""


def without_head(
    source: Source, rows: NumberRows, given: float | None
) -> tuple[NumberRows, Header, tuple[str, ...]]:
    """Rows after a count, a step, or both, which stand on one line or on two.

    Parameters
    ----------
    source : Source
        The file, for messages.
    rows : NumberRows
        All of its rows.
    given : float or None
        The time step that the caller gives (s).

    Returns
    -------
    NumberRows
        Those of samples.
    Header
        The step that is stated before them.
    tuple of str
        A note on what stood there.

    Raises
    ------
    InputError
        For numbers before the rows, or a first number, that may be a count or a step and agree
        with nothing.
    """
    line = rows.lines[0]
    for lines in (2, 1):
        if len(rows.rows) < lines + 2 or (lines == 2 and any(len(r) > 1 for r in rows.rows[:2])):
            continue
        head = [text for row in rows.rows[:lines] for text in row]
        rest = rows.without_rows(lines)
        if len(head) <= _LONGEST and (step := _stated_step(head, rest, given)) is not None:
            header = Header(time_step=step or None, time_step_line=line if step else None)
            what = ["a count"] * (len(head) > 1 or not step) + ["the time step"] * bool(step)
            note = f"line {line}: '{' '.join(head)}' read as {' and '.join(what)}"
            return rest, header, (note,)
    if _stands_apart(rows) or (rows.width == 1 and _may_be_step(rows)):
        raise _unknown_head(source, rows, given)
    return rows, Header(), ()


def without_edges(rows: NumberRows) -> NumberRows:
    """Rows without those before them that are shorter, and without their numbers at either end."""
    for _ in range(_LONGEST):
        if _stands_apart(rows) or (rows.width == 1 and len(rows.rows) > 2):
            rows = rows.without_rows(1)
    return without_counts(rows)[0]


def without_counts(rows: NumberRows) -> tuple[NumberRows, list[int]]:
    """Rows of three numbers and more without counts at their ends, and where these stood."""
    dropped = [index for index in (-1, 0) if rows.width > 2 and counts(rows, index)]
    for index in dropped:
        rows = rows.without_column(index)
    return rows, dropped


def _stands_apart(rows: NumberRows) -> bool:
    """Whether all rows after the first are of one length, which it is not."""
    widths = {len(row) for row in rows.rows[1:-1]}
    return len(widths) == 1 and rows.width not in widths


def _stated_step(head: list[str], rest: NumberRows, given: float | None) -> float | None:
    """The step (s) that the first numbers state, 0 where they are a count only.

    None where they are something else.
    """
    numbers = [to_float(text) for text in head]
    counts = {float(len(rest.rows)), float(sum(map(len, rest.rows)))}
    others = [x for x in numbers if x not in counts]
    times = rest.column_texts(0)
    if len(head) == rest.width > 1 and not (increases(times) and numbers[0] > to_float(times[0])):
        return None
    if not others:
        return 0.0
    if len(others) > 1:
        return None
    if len(head) > 1:
        return others[0] if others[0] in STEP or _same(others[0], given) else None
    unlike = rest.width > 1 or _stands_out(head[0], rest)
    return others[0] if _same(others[0], given) and unlike else None


def _same(step: float, given: float | None) -> bool:
    return given is not None and math.isclose(step, given, rel_tol=SAME_STEP)


def _may_be_step(rows: NumberRows) -> bool:
    """Whether the first number of one column is round, in the range of steps, and stands out."""
    text = rows.rows[0][0]
    step = to_float(text)
    if len(rows.rows) < 4 or step not in STEP:
        return False
    a_second = 1.0 / step
    is_round = float(f"{step:.1e}") == step or abs(a_second - round(a_second)) < 1e-6 * a_second
    return is_round and _stands_out(text, rows.without_rows(1))


def _stands_out(text: str, rest: NumberRows) -> bool:
    """Whether a number is printed otherwise than all samples, or does not go on in them."""
    texts = rest.column_texts(0)
    styles = {_style(one) for one in texts}
    if len(texts) > 2 and len(styles) == 1 and _style(text) not in styles:
        return True
    near = np.array([to_float(one) for one in texts[:_COMPARED]])
    return len(texts) > 2 and abs(to_float(text) - near[0]) > _JUMP * np.abs(np.diff(near)).max()


def _style(text: str) -> tuple[int, bool]:
    """Decimals of a printed number, and whether it has an exponent."""
    mantissa, exponent, _ = text.lower().replace("d", "e").partition("e")
    return len(mantissa.partition(".")[2]), bool(exponent)


def _unknown_head(source: Source, rows: NumberRows, given: float | None) -> InputError:
    """First numbers that may be a count or a step and agree with nothing."""
    line, found = rows.lines[0], " ".join(rows.rows[0])
    steps = [text for text in rows.rows[0] if to_float(text) in STEP]
    samples = sum(map(len, rows.rows[1:]))
    what = f"found '{found}', unlike the {samples} numbers after it"
    if given is None and len(steps) == 1:
        what += (
            f'; if it states the time step, give time_step = "{steps[0]} s", else remove the line'
        )
        return UnstatedError(str(source.error(line, what)), ["time_step"])
    agreed = "their number" if given is None else f"their number nor with time_step = {given!r} s"
    return source.error(
        line,
        f"{what}; it agrees {'not' if given is None else 'neither'} with {agreed}: "
        "give what it states, or remove the line",
    )


def counts(rows: NumberRows, index: int) -> bool:
    """Whether numbers at one end of all rows count these, or the samples in them."""
    if len(rows.rows) < 3 or min(map(len, rows.rows)) < max(2, index + 1):
        return False
    texts = [row[index] for row in rows.rows]
    if not all(text.isdecimal() for text in texts):
        return False
    steps = {int(b) - int(a) for a, b in pairwise(texts)}
    return steps in ({1}, {max(rows.width - 1, 1)})
