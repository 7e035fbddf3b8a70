"""How a warning reaches somebody who uses commands: one line, without a place in the source."""

from __future__ import annotations

import sys
from typing import TextIO


class OptionWarning(UserWarning):
    """An option of a case plays no part in what is computed of it."""


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
