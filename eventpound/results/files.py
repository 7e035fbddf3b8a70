"""Files that belong together, written whole or not at all.

Every file first gets a temporary name in the same directory and is flushed to
the disk; only when all are there do they take their names, the last one last.
Whoever finds the last file therefore finds all of them.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from eventpound.basics.interruption import Deferred
from eventpound.errors import InputError

_LONGEST_NAME = 100
"""Characters of a part of a file's name."""


def plain_name(text: str) -> str:
    """A text as part of a file's name: no folder, no blank, nothing a terminal obeys."""
    return re.sub(r"[^\w.+#()=,-]+", "-", text).lstrip(".")[:_LONGEST_NAME]


def write_together(
    directory: str | os.PathLike[str], contents: Mapping[str, bytes], gone: Iterable[str] = ()
) -> list[Path]:
    """Write files of one directory together, making the directory where it is missing.

    Ctrl-C and termination wait until the set is whole.

    Parameters
    ----------
    directory : path
        Where they go.
    contents : mapping of str to bytes
        File names and what they hold; the last one is put in place last.
    gone : iterable of str
        Files of an earlier set that this one has not.

    Returns
    -------
    list of Path
        The files written, in that order.

    Raises
    ------
    InputError
        Where the directory cannot be made or written to, or a name leads out of it. Then,
        as after any interruption, neither a temporary file nor a part of the set stays.
    """
    folder = Path(directory)
    for name in contents:
        if Path(name).name != name or name in ("", "..") or "\0" in name:
            raise InputError(f"{folder}: {name!r} is no name of a file in this directory")
    temporary = {name: folder / f".{name}.{os.getpid()}.partial" for name in contents}
    placed: list[Path] = []
    with Deferred(patient=True):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, content in contents.items():
                _write_through(temporary[name], content)
            with _alone(folder):
                for name, path in temporary.items():
                    path.replace(folder / name)
                    placed.append(folder / name)
                for name in gone:
                    _remove(folder / name)
        except BaseException as error:
            for path in (*temporary.values(), *placed):
                _remove(path)
            if isinstance(error, OSError):
                raise _not_written(folder, error) from error
            raise
    return placed


def write_stream(
    directory: str | os.PathLike[str], name: str, pieces: Iterable[bytes]
) -> tuple[int, str]:
    """Write one file piece by piece, whole or not at all.

    Parameters
    ----------
    directory : path
        Where it goes; made where it is missing.
    name : str
        Its name.
    pieces : iterable of bytes
        What it holds, in order; never all in memory.

    Returns
    -------
    int
        Its size (bytes).
    str
        Its SHA-256, in hexadecimal digits.

    Raises
    ------
    InputError
        Where the directory cannot be made or written to.
    """
    folder = Path(directory)
    temporary = folder / f".{name}.{os.getpid()}.partial"
    size, digest = 0, hashlib.sha256()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            for piece in pieces:
                file.write(piece)
                digest.update(piece)
                size += len(piece)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(folder / name)
    except BaseException as error:
        _remove(temporary)
        if isinstance(error, OSError):
            raise _not_written(folder, error) from error
        raise
    return size, digest.hexdigest()


def check_writable(directory: str | os.PathLike[str]) -> None:
    """Make sure that results can be written, before hours are spent computing them.

    Parameters
    ----------
    directory : path
        Where they will go; neither it nor anything in it is made or changed.

    Raises
    ------
    InputError
        Where it is not a directory, or one that may not be written to.
    """
    folder = Path(directory)
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    if not folder.is_dir():
        raise InputError(f"{directory}: cannot be written to: {folder} is not a directory")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{directory}: cannot be written to: no permission to write in {folder}")


@contextmanager
def only_one(directory: str | os.PathLike[str], name: str) -> Iterator[None]:
    """Refuse the directory to every other program that asks for the same name, for as long as this.

    Where a file system has no locks nobody is refused.

    Parameters
    ----------
    directory : path
        Made where it is missing.
    name : str
        Of a file that is there meanwhile.

    Raises
    ------
    InputError
        Where another program is at it, or the directory cannot be made or written to.
    """
    folder = Path(directory)
    path = folder / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = _locked(path)
    except BlockingIOError:
        raise InputError(
            f"{folder}: another program is at work on it; wait for it to end, "
            "or give another directory"
        ) from None
    except OSError as error:
        raise _not_written(folder, error) from error
    try:
        yield
    finally:
        _remove(path)
        os.close(lock)


def _locked(path: Path) -> int:
    """The descriptor of a file that is locked, made where it is missing."""
    while True:
        lock = os.open(path, os.O_RDWR | os.O_CREAT)
        try:
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            raise
        except (ImportError, OSError):
            return lock
        # Whoever held it may have removed the file since it was opened here.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(lock), path.stat()):
                return lock
        os.close(lock)


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other programs that write a set here waiting; the last one's is what stays.

    Where a file system has no locks, two sets at the same time may mix; their hashes tell.
    """
    directory = None
    with suppress(ImportError, OSError):
        import fcntl

        directory = os.open(folder, os.O_RDONLY)
        fcntl.flock(directory, fcntl.LOCK_EX)
    try:
        yield
    finally:
        if directory is not None:
            os.close(directory)


def _write_through(path: Path, content: bytes) -> None:
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _remove(path: Path) -> None:
    """Remove a file of a set that failed; the failure itself is what gets reported."""
    with suppress(OSError):
        path.unlink(missing_ok=True)


def _not_written(folder: Path, error: OSError) -> InputError:
    reason = error.strerror or str(error)
    return InputError(f"{folder}: cannot be written to: {reason}; give another directory")
