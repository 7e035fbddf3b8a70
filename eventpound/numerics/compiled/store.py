"""Where compiled kernels are kept, and what becomes of one that is damaged.

A kernel is one file. Its name is made of the function's and of a digest of everything
that it depends on: the sources, the types of its arguments, the processor, the versions
of Python, Numba and llvmlite. So a file is never out of date, two processes that compile
the same kernel write the same file, and nothing has to be kept in step with an index.
It begins with a checksum, since a flipped bit in machine code ends the process.

Kernels lie in `__pycache__` beside the sources. Where that cannot be written, new ones
go to the user's cache folder, and both are read; `NUMBA_CACHE_DIR` replaces both.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core import sigutils
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.misc.appdirs import AppDirs

from eventpound.numerics.compiled.sources import source_stamp

SUFFIX = ".kernel"
_DIGEST = 16
_VERSIONS = f"{sys.implementation.cache_tag} numba {numba.__version__} llvm {llvmlite.__version__}"


class KernelStore:
    """What Numba's dispatcher asks of a cache.

    Parameters
    ----------
    function : callable
        Whose compiled forms are kept.
    way : object
        How it is compiled; whatever tells it has a representation of its own.
    """

    def __init__(self, function: Callable[..., Any], way: Any) -> None:
        self._file = function.__code__.co_filename
        self._way = way
        self._name = f"{Path(self._file).stem}.{function.__qualname__}".replace("<locals>.", "")

    @property
    def cache_path(self) -> str:
        """The folder in which kernels are looked for first."""
        return str(_folders(self._file)[0])

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The kept kernel for arguments of these types, or None."""
        context.refresh()
        name = self._name_of(signature, context.codegen())
        for folder in _folders(self._file):
            path = folder / name
            try:
                content = path.read_bytes()
            except OSError:
                continue
            try:
                return CompileResult._rebuild(context, *pickle.loads(_checked(content)))
            except Exception as error:
                _drop(path, error)
        return None

    def has(self, signature: Any, context: Any) -> bool:
        """Whether there is a kept kernel for arguments of these types; nothing is loaded."""
        name = self._name_of(signature, context.codegen())
        return any((folder / name).is_file() for folder in _folders(self._file))

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep a kernel, in the first folder that can be written."""
        if result.library.has_dynamic_globals:
            return
        name = self._name_of(signature, result.codegen)
        content = dumps(result._reduce())
        content = hashlib.blake2b(content, digest_size=_DIGEST).digest() + content
        trouble: OSError | None = None
        for folder in _folders(self._file):
            try:
                _write_whole(folder / name, content)
            except OSError as error:
                trouble = trouble or error
            else:
                return
        _say_once(f"kernels cannot be kept ({trouble}): they are compiled anew each time")

    def _name_of(self, signature: Any, codegen: Any) -> str:
        args, _ = sigutils.normalize_signature(signature)
        whole = repr((_VERSIONS, source_stamp(self._file), codegen.magic_tuple(), self._way, args))
        digest = hashlib.blake2b(whole.encode(), digest_size=_DIGEST).hexdigest()
        return f"{self._name}-{digest}{SUFFIX}"


def _checked(content: bytes) -> bytes:
    digest, content = content[:_DIGEST], content[_DIGEST:]
    if hashlib.blake2b(content, digest_size=_DIGEST).digest() != digest:
        raise ValueError("its checksum is wrong")
    return content


def _write_whole(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    number, made = tempfile.mkstemp(dir=path.parent, prefix=path.stem[:40])
    try:
        with os.fdopen(number, "wb") as opened:
            opened.write(content)
        os.replace(made, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(made)
        raise


def _drop(path: Path, error: Exception) -> None:
    _say_once(f"a kept kernel is damaged and is made again ({path.name}: {error})")
    with contextlib.suppress(OSError):
        path.unlink()


@cache
def _say_once(text: str) -> None:
    print(f"eventpound: {text}", file=sys.stderr)


@cache
def _folders(file: str) -> tuple[Path, ...]:
    """Where kernels of a source file are looked for, the first choice first."""
    folder = Path(file).resolve().parent
    below = f"{folder.name}_{hashlib.sha1(str(folder).encode()).hexdigest()}"
    chosen = numba.config.CACHE_DIR
    if chosen:
        return (Path(chosen) / below,)
    users = Path(AppDirs("eventpound", appauthor=False).user_cache_dir)
    return folder / "__pycache__", users / below
