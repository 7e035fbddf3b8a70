"""Options that say how figures are written: kinds of files, width, resolution."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from eventpound.cli.arguments import count_argument
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.report.style import Paper


def add_paper(parser: argparse.ArgumentParser) -> None:
    """Add the options to the parser of a command."""
    group = parser.add_argument_group("how figures are written")
    group.add_argument(
        "--format",
        metavar="KIND,...",
        type=_formats,
        default=("png",),
        help="png, pdf, svg, or some of them (png)",
    )
    group.add_argument("--width", metavar="WIDTH", help='of a figure, as "90 mm"')
    group.add_argument(
        "--dpi", type=count_argument, default=150, help="dots an inch of a PNG (150)"
    )


def paper_of(options: argparse.Namespace) -> Paper:
    """What the options say.

    Raises
    ------
    InputError
        Where the width is none.
    """
    from eventpound.report.style import Paper

    return Paper(options.format, _width(options.width), options.dpi)


def _formats(text: str) -> tuple[str, ...]:
    kinds = tuple(dict.fromkeys(text.split(",")))
    if not set(kinds) <= {"png", "pdf", "svg"}:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: some of png, pdf, svg")
    return kinds


def _width(text: str | None) -> float | None:
    """Width of a figure (mm)."""
    if text is None:
        return None
    from eventpound.units import Dimension, quantity

    try:
        width = quantity(text, Dimension.LENGTH)
    except InputError as error:
        raise InputError(f"--width: {error}") from None
    if not 0.02 <= width <= 2.0:
        raise InputError(f'--width: found {text!r}; accepted: 20 mm to 2 m, as "90 mm"')
    return 1e3 * width
