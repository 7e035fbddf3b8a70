"""What a compiled function was made of: its module and every module that one imports.

Numba keeps compiled code until the file of the function itself changes, but what the
function calls, and every constant, is compiled into it. The stamp made here changes with
any of them, so that no code of yesterday is ever run with arrays of today. It does not change
with comments, docstrings and blank lines, of which machine code knows nothing: where a kernel
raises an error, the error may name a line by the number that it had.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import re
import sys
import tokenize
from functools import cache
from typing import NamedTuple

from eventpound.numerics.compiled.folders import folders, write_whole

PACKAGE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
# What begins with a text is looked for quickly.
_IMPORT = re.compile(r"from eventpound((?:\.\w+)*) import (\([^)]*\)|.*)")
_NAME = re.compile(r"\w+")
_QUOTES = ("'", '"')
_LIST = "sources.json"
_LONGEST = 1000
"""Texts in the list; those that were seen last stay."""
# Most modules are imported by several.
_is_file, _is_folder = cache(os.path.isfile), cache(os.path.isdir)


class _Module(NamedTuple):
    """A module's text, the text's digest, and the files of this package that it imports."""

    content: bytes
    digest: str
    imports: frozenset[str]


@cache
def source_stamp(file: str) -> str:
    """Hash of the code of a module of this package and of all it imports from it.

    Parameters
    ----------
    file : str
        The module's file.
    """
    reached = {file}
    waiting = [file]
    while waiting:
        found = _module(waiting.pop()).imports - reached
        reached |= found
        waiting += found
    modules = [_module(each) for each in sorted(reached)]
    return _digest("".join(_code_digests(modules)).encode())


def _code_digests(modules: list[_Module]) -> list[str]:
    """Digests of the modules' code, of which those of texts once seen are kept in a list."""
    listed = _listed()
    new = {
        each.digest: _digest(code_of(each.content)) for each in modules if each.digest not in listed
    }
    if new:
        listed.update(new)
        by, *others = listed.items()
        text = json.dumps(dict([by, *others[-_LONGEST:]]))
        for folder in folders(__file__):
            with contextlib.suppress(OSError):
                write_whole(folder / _LIST, text.encode())
                break
    return [listed[each.digest] for each in modules]


@cache
def _listed() -> dict[str, str]:
    """Digests of code by those of texts, as this Python and the text of this module tell them."""
    made = {"by": f"{sys.version} {_module(__file__).digest}"}
    for folder in folders(__file__):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            found: dict[str, str] = json.loads((folder / _LIST).read_bytes())
            if found.items() >= made.items():
                return found
    return made


def code_of(text: bytes) -> bytes:
    """What Python makes something of in a module's text: no comments, docstrings, blank lines.

    Parameters
    ----------
    text : bytes
        The module's source.
    """
    kept: list[str] = []
    line: list[str] = []
    for kind, word, *_ in tokenize.tokenize(io.BytesIO(text).readline):
        if kind in (tokenize.ENCODING, tokenize.COMMENT, tokenize.NL):
            continue
        if kind in (tokenize.INDENT, tokenize.DEDENT):
            kept.append(f"\n{tokenize.tok_name[kind]}")
        elif kind != tokenize.NEWLINE:
            line.append(word)
        else:
            # A string alone is a docstring, or as good as one.
            if len(line) > 1 or line[0][-1] not in _QUOTES:
                kept += [*line, ""]
            line = []
    return "\0".join(kept).encode()


@cache
def _module(file: str) -> _Module:
    with open(file, "rb") as opened:
        content = opened.read()
    candidates = []
    for dotted, names in _IMPORT.findall(content.decode()):
        module = PACKAGE + dotted.replace(".", os.sep)
        # A name may be one of a module, or a module of a package.
        candidates += [module + ".py", f"{module}{os.sep}__init__.py"]
        if _is_folder(module):
            candidates += [f"{module}{os.sep}{name}.py" for name in _NAME.findall(names)]
    return _Module(content, _digest(content), frozenset(filter(_is_file, candidates)))


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=16).hexdigest()
