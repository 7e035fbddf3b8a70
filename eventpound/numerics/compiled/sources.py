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
# What begins with a text is looked for quickly.
_IMPORT = re.compile(r"from eventpound((?:\.\w+)*) import (\([^)]*\)|.*)")
_NAME = re.compile(r"\w+")
# Most modules are imported by several.
_is_file, _is_folder = cache(os.path.isfile), cache(os.path.isdir)


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
    with open(file, "rb") as opened:
        content = opened.read()
    candidates = []
    for dotted, names in _IMPORT.findall(content.decode()):
        module = PACKAGE + dotted.replace(".", os.sep)
        # A name may be one of a module, or a module of a package.
        candidates += [module + ".py", f"{module}{os.sep}__init__.py"]
        if _is_folder(module):
            candidates += [f"{module}{os.sep}{name}.py" for name in _NAME.findall(names)]
    return hashlib.blake2b(content).digest(), frozenset(filter(_is_file, candidates))
