"""Where compiled kernels are kept, and what becomes of one that is damaged.

A kernel is one file. Its name is made of the function's and of a digest of everything
that it depends on: the sources, the types of its arguments, how it is compiled, the
processor, the versions of Python, Numba and llvmlite. So a file is never out of date, two
processes that compile the same kernel write the same file, and nothing has to be kept in
step with an index. It begins with a checksum, since a flipped bit in machine code ends
the process.

They lie in `folders`. After these comes what the installation came with
(`eventpound.numerics.compiled.shipped`).
"""

from __future__ import annotations

import contextlib
import glob
import hashlib
import importlib
import io
import pickle
import sys
from collections.abc import Callable, Iterator
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from eventpound.numerics.compiled import shipped
from eventpound.numerics.compiled.beside import Claim, Wanted, compile_meanwhile
from eventpound.numerics.compiled.folders import folders, write_whole
from eventpound.numerics.compiled.shipped import SUFFIX
from eventpound.numerics.compiled.sources import source_stamp
from eventpound.numerics.compiling import compilation_begins, compilation_waits

_DIGEST = 16
_LONGEST_NAME = 80


class KernelStore:
    """What Numba's dispatcher asks of a cache.

    Parameters
    ----------
    function : callable
        Whose compiled forms are kept.
    way : object
        How it is compiled; whatever tells it has a representation of its own.
    plain : bool
        Whether Numba compiles, and loads, in its own way.
    """

    def __init__(self, function: Callable[..., Any], way: object, plain: bool) -> None:
        self._file, self._function = function.__code__.co_filename, function.__qualname__
        self._module, self._way, self._plain = function.__module__, way, plain
        self._claim: Claim | None = None

    @cached_property
    def _name(self) -> str:
        name = f"{Path(self._file).stem}.{self._function}".replace("<locals>.", "")
        return name[:_LONGEST_NAME]

    @property
    def cache_path(self) -> str:
        """The folder in which kernels are looked for first."""
        return str(folders(self._file)[0])

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The kept kernel for arguments of these types, or None: then it is this process's to make.

        A damaged file is taken away, and said so. What another process is making is waited for.
        """
        if self._plain:
            context.refresh()
        else:
            _make_names_known()
        found = self._kept(signature, context)
        if found is None:
            self._say_why_none()
            compilation_begins()
            if not self._plain:
                first = next(self._places(signature, context.codegen()))
                self._claim = Claim(first, lambda: self._wait(signature))
                found = self._kept(signature, context)
        return found

    def _kept(self, signature: Any, context: Any) -> Any:
        """What is in the first file that is whole, or None."""
        from numba.core.compiler import CompileResult

        for path in self._places(signature, context.codegen()):
            try:
                content = path.read_bytes()
            except OSError:
                continue
            try:
                kept = _Reader(io.BytesIO(_checked(content, path.name))).load()
                return CompileResult._rebuild(context, *kept)
            except Exception as error:
                _drop(path, error)
        return None

    def _wait(self, signature: Any) -> None:
        from numba.core.sigutils import normalize_signature

        compilation_waits()
        arguments, _ = normalize_signature(signature)
        compile_meanwhile(Wanted(self._module, self._function, tuple(arguments)))

    def release(self) -> None:
        """Let other processes go on that wait for what this one was to make."""
        if self._claim is not None:
            self._claim.release()
            self._claim = None

    def has(self, signature: Any, context: Any) -> bool:
        """Whether there is a kept kernel for arguments of these types; nothing is loaded."""
        return any(path.is_file() for path in self._places(signature, context.codegen()))

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep a kernel, in the first folder that can be written.

        Where there is none that is said once, and the kernel serves this process only. So does
        one that takes a kernel: the type of that tells where it lies, not what it was made of.
        """
        from numba.core.types import Dispatcher

        if result.library.has_dynamic_globals:
            return
        if any(isinstance(each, Dispatcher) for each in result.signature.args):
            return
        trouble: Exception | None = None
        try:
            name = self._name_of(signature, result.codegen.magic_tuple())
            content = _with_checksum(result, name)
        except Exception as error:
            trouble, content = error, b""
        for folder in folders(self._file) if content else ():
            try:
                write_whole(folder / name, content)
            except OSError as error:
                trouble = trouble or error
            else:
                self._clear_outdated(folder)
                return
        say_once(f"warning: kernels cannot be kept, so each run compiles anew ({trouble})")

    def _places(self, signature: Any, codegen: Any) -> Iterator[Path]:
        """The files in which a kernel may be kept, the first choice first."""
        machine = codegen.magic_tuple()
        name = self._name_of(signature, machine)
        yield from (folder / name for folder in folders(self._file))
        made = shipped.made()
        if made is not None and not shipped.misfit():
            yield shipped.FOLDER / self._name_of(signature, (machine[0], made.processor, ""))

    def _say_why_none(self) -> None:
        """Say why a kernel that the installation came with does not serve, if that is so."""
        if shipped.made() is None:
            return
        why = shipped.misfit()
        others = shipped.FOLDER.glob(f"{glob.escape(self._name)}-*{SUFFIX}")
        stamps = {path.name.rsplit("-", 2)[1] for path in others}
        if not why and stamps and source_stamp(self._file) not in stamps:
            why = "sources were changed"
        if why:
            say_once(f"kernels that eventpound came with are not used, but compiled here: {why}")

    def _name_of(self, signature: Any, machine: tuple[str, ...]) -> str:
        from numba.core.sigutils import normalize_signature

        arguments, _ = normalize_signature(signature)
        whole = repr((shipped.VERSIONS, machine, self._plain, self._way, arguments))
        digest = hashlib.blake2b(whole.encode(), digest_size=_DIGEST).hexdigest()
        return f"{self._name}-{source_stamp(self._file)}-{digest}{SUFFIX}"

    def _clear_outdated(self, folder: Path) -> None:
        """Take away what was made of other sources than the present ones."""
        for path in folder.glob(f"{glob.escape(self._name)}-*{SUFFIX}"):
            name, stamp, _ = path.name.rsplit("-", 2)
            if name == self._name and stamp != source_stamp(self._file):
                with contextlib.suppress(OSError):
                    path.unlink()


@cache
def _make_names_known() -> None:
    """Make known by their names the functions that machine code calls of Numba's runtime.

    Numba refreshes its context instead: it learns all that can be compiled, and compiles the
    runtime, which takes longer than a short run and half its memory. Who compiles does so.
    """
    from numba.core.runtime import _nrt_python

    for name, address in _nrt_python.c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
    importlib.import_module("numba.cpython.hashing")


class _Reader(pickle.Unpickler):
    """Reads a kernel without importing what its parts were defined in, such as half of Numba."""

    def find_class(self, module: str, name: str) -> Any:
        """What stands for a name."""
        if (module, name) == ("numba.core.environment", "_rebuild_env"):
            return _environment
        return super().find_class(module, name)


def _environment(module: str, constants: list[Any], name: str) -> Any:
    """What machine code finds of Python: its constants.

    Numba adds the names of the module, which are for functions that are not compiled whole.
    """
    from numba.core.environment import Environment, lookup_environment

    known = lookup_environment(name)
    if known is not None:
        return known
    made = Environment({"__name__": module})
    made.consts[:] = constants
    made.env_name = name
    Environment._memo[name] = made
    return made


def _with_checksum(result: Any, name: str) -> bytes:
    from numba.core.serialize import dumps

    # Numba's report of the types would hold the text of the function, too.
    content: bytes = dumps(result._replace(type_annotation="")._reduce())
    return _checksum(content, name) + content


def _checksum(content: bytes, name: str) -> bytes:
    """Of a kernel under its own name: that of another is as wrong as a damaged one."""
    return hashlib.blake2b(name.encode() + content, digest_size=_DIGEST).digest()


def _checked(content: bytes, name: str) -> bytes:
    digest, content = content[:_DIGEST], content[_DIGEST:]
    if _checksum(content, name) != digest:
        raise ValueError("its checksum is wrong")
    return content


def _drop(path: Path, error: Exception) -> None:
    say_once(f"a kept kernel is damaged and is compiled again: {path.name} ({error})")
    if path.parent == shipped.FOLDER:
        return
    with contextlib.suppress(OSError):
        path.unlink()


@cache
def say_once(text: str) -> None:
    """A line on stderr, the first time it is said in a process."""
    print(f"eventpound: {text}", file=sys.stderr)
