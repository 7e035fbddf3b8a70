"""Lines below a figure: what its curves cannot say."""

from __future__ import annotations

import re
from collections.abc import Sequence

from matplotlib.figure import Figure

LINE, LETTER = 0.18, 0.06
"""Inches that a line of a note and a letter of it take."""
_SIZE = 7.5
_FORMULA = re.compile(r"\\[a-zA-Z]+|[${}_^\\]|,\\,")


def letters(text: str) -> int:
    """How many letters a text with formulas shows, about."""
    return len(_FORMULA.sub("x", text))


def wrapped(text: str, most: float) -> list[str]:
    """Lines of a text of at most so many letters, broken between words, formulas kept whole."""
    lines = [""]
    # A space within a formula breaks nothing.
    for word in re.findall(r"(?:\$[^$]*\$|[^\s$]+)+", text):
        line = f"{lines[-1]} {word}".strip()
        if lines[-1] and letters(line) > most:
            lines.append(word)
        else:
            lines[-1] = line
    return lines


def write_below(figure: Figure, lines: Sequence[str]) -> None:
    """Write lines at the foot of a figure."""
    height = figure.get_size_inches()[1]
    figure.text(0.01, 0.06 / height, "\n".join(lines), fontsize=_SIZE, va="bottom")


def add_notes(figure: Figure, notes: Sequence[str]) -> None:
    """Make room below a figure of constrained layout, its legend and all, and write notes there.

    Parameters
    ----------
    figure : Figure
        It grows by what the notes need.
    notes : sequence of str
        Each begins a line; empty ones are left out.
    """
    width, height = figure.get_size_inches()
    lines = [part for note in notes if note for part in wrapped(note, width / LETTER)]
    if not lines:
        return
    below = LINE * (len(lines) + 0.5)
    figure.set_size_inches(width, height + below)
    part = below / (height + below)
    # With a place of their own, legends below the axes are no more part of the layout.
    boxes = [legend.get_window_extent() for legend in figure.legends]
    legends = sum(box.height for box in boxes)
    for legend in figure.legends:
        legend.set_bbox_to_anchor((0.0, part, 1.0, 1.0 - part), transform=figure.transFigure)
    low = part + legends / figure.bbox.height
    figure.set_layout_engine("constrained", rect=(0.0, low, 1.0, 1.0 - low))
    write_below(figure, lines)
