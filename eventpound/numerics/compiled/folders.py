"""Where what is kept between processes lies.

That is `__pycache__` beside the sources. Where that cannot be written, new files go to the user's
cache folder, and both are read; `NUMBA_CACHE_DIR` replaces both.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

import numba


@cache
def folders(file: str) -> tuple[Path, ...]:
    """Where files of a source file are looked for, the first choice first."""
    from numba.misc.appdirs import AppDirs

    folder = Path(file).resolve().parent
    below = f"{folder.name}_{hashlib.sha1(str(folder).encode()).hexdigest()}"
    if numba.config.CACHE_DIR:
        return (Path(numba.config.CACHE_DIR) / below,)
    users = Path(AppDirs("eventpound", appauthor=False).user_cache_dir)
    return folder / "__pycache__", users / below


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that other processes see whole or not at all; its folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    number, made = tempfile.mkstemp(dir=path.parent, prefix=".kernel-")
    try:
        with os.fdopen(number, "wb") as opened:
            opened.write(content)
        os.chmod(made, 0o644)
        os.replace(made, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(made)
        raise
