"""What a record reader is given, what it returns, and what it may assume.

A reader returns the right numbers or stops: what a file does not say (units,
time step) is asked for, and what does not fit is an `InputError` with the
file, the line, what was found and what was expected.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats


@dataclass(frozen=True, eq=False)
class RecordData:
    """One component of a record as read from its file.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        Samples (m/s^2).
    time_step : float
        Their distance (s).
    units : str
        Unit of the numbers in the file.
    format : str
        Name of the reader.
    file : str
        Path of the file as it was given.
    sha256 : str
        Hash of its bytes.
    event, station, component, date : str, optional
        As the header has them.
    notes : tuple of str
        What was passed over in reading.
    """

    acceleration: Floats
    time_step: float
    units: str
    format: str
    file: str
    sha256: str
    event: str | None = None
    station: str | None = None
    component: str | None = None
    date: str | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Source:
    """The bytes of a file and the lines they make.

    Parameters
    ----------
    file : str
        Path as given, for messages.
    content : bytes
        The whole file.
    """

    file: str
    content: bytes

    @cached_property
    def lines(self) -> list[str]:
        """Lines without their ends (LF, CRLF, CR CR LF or CR); line i is `lines[i - 1]`.

        Bytes that are not UTF-8 are read as Latin-1, which never fails;
        a byte-order mark is dropped.
        """
        try:
            text = self.content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = self.content.decode("latin-1")
        return re.split(r"\r*\n|\r", text)

    @property
    def sha256(self) -> str:
        """Hash of the bytes."""
        return hashlib.sha256(self.content).hexdigest()

    def error(self, line: int | None, message: str) -> InputError:
        """An error that names the file and, where there is one, the line (from 1)."""
        where = self.file if line is None else f"{self.file}, line {line}"
        return InputError(f"{where}: {message}")


@dataclass(frozen=True)
class Reader:
    """A file format.

    Parameters
    ----------
    name : str
        The word a case names the format by.
    detect : callable
        Whether a `Source` looks like this format, by its content.
    read : callable
        ``read(source, units, time_step) -> RecordData``; units and time step
        (s) are None where they were not given.
    """

    name: str
    detect: Callable[[Source], bool]
    read: Callable[[Source, str | None, float | None], RecordData]


def load(path: str | Path) -> Source:
    """Read the bytes of a record file.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Source
        Its bytes.

    Raises
    ------
    InputError
        Where there is no such file, it cannot be read or is empty.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: the record cannot be read ({error.strerror})") from error
    if not content.strip():
        raise InputError(f"{path}: the file is empty; an accelerogram is needed")
    return Source(str(path), content)
