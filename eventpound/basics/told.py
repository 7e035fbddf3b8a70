"""What is told as work goes on: warnings, and how much is done."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from typing import TextIO

Reached = Callable[[float], None]
"""Called with the time that a run has reached (s)."""
Counted = Callable[[int, int], None]
"""Called with how many are done, and of how many; at first with what was there before."""


class OptionWarning(UserWarning):
    """An option of a case that plays no part in what is computed of it, or is hardly meant so."""


def warn_caller(text: str, category: type[Warning]) -> None:
    """Warn of what the first caller from outside of the package asked for."""
    level, frame = 1, sys._getframe()
    # Code that was handed to `exec` with globals of its own has no name.
    inside = ("eventpound.", "functools")
    while frame.f_back and frame.f_globals.get("__name__", "").startswith(inside):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)


def show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str = "",
    lineno: int = 0,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Show a warning on stderr; to stand in the place of ``warnings.showwarning``.

    Of another package's warning its kind is said, for its text may not tell what it is about.
    """
    kind = "" if category.__module__.startswith("eventpound.") else f"{category.__name__}: "
    over = "\r\033[K" if sys.stderr.isatty() else ""
    text = " ".join(str(message).split())
    print(f"{over}eventpound: warning: {kind}{text}", file=sys.stderr)
