"""What a compiled function was made of: its module and every module that one imports.

Numba keeps compiled code until the file of the function itself changes, but what the
function calls, and every constant, is compiled into it. The stamp made here changes with
any of them, so that no code of yesterday is ever run with arrays of today.
"""

from __future__ import annotations

import hashlib
import os
import re
from functools import cache

PACKAGE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
_IMPORT = re.compile(r"^\s*from eventpound((?:\.\w+)*) import (\([^)]*\)|.*)", re.MULTILINE)
_NAME = re.compile(r"\w+")


@cache
def source_stamp(file: str) -> str:
    """Hash of the texts of a module of this package and of all it imports from it.

    Parameters
    ----------
    file : str
        The module's file.
    """
    reached = {file}
    waiting = [file]
    while waiting:
        found = _text_and_imports(waiting.pop())[1] - reached
        reached |= found
        waiting += found
    whole = hashlib.blake2b(digest_size=16)
    for each in sorted(reached):
        whole.update(_text_and_imports(each)[0])
    return whole.hexdigest()


@cache
def _text_and_imports(file: str) -> tuple[bytes, frozenset[str]]:
    """Hash of the text of a module, and the files of this package that it imports."""
    with open(file, encoding="utf-8") as opened:
        text = opened.read()
    candidates = []
    for dotted, names in _IMPORT.findall(text):
        module = PACKAGE + dotted.replace(".", os.sep)
        # A name may be one of a module, or a module of a package.
        candidates += [module + ".py", f"{module}{os.sep}__init__.py"]
        if os.path.isdir(module):
            candidates += [f"{module}{os.sep}{name}.py" for name in _NAME.findall(names)]
    return hashlib.blake2b(text.encode()).digest(), frozenset(filter(os.path.isfile, candidates))
