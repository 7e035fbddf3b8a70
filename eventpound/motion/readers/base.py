"""What a record reader is given, what it returns, and what it may assume.

A reader returns the right numbers or stops: what a file does not say (units,
time step, which of several components) is asked for, and what does not fit is
an `InputError` with the file, the line, what was found and what was expected.
"""

from __future__ import annotations

import hashlib
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePath

from eventpound.basics.input_files import read_bytes
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats

SAME_STEP = 1e-9
"""Relative difference of two time steps, stated, given or read off times, that are one."""
_MESSAGES = 5
"""Unreadable tokens that are named one by one."""


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
        What was passed over, removed or found odd in reading.
    begins : tuple of int
        Samples at which the records of a sequence begin; of one record none.
    shocks : tuple of str
        What these records are called.
    factors : tuple of float
        What each of them was multiplied by, where a case says so of each.
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
    begins: tuple[int, ...] = ()
    shocks: tuple[str, ...] = ()
    factors: tuple[float, ...] = ()

    @property
    def called(self) -> str:
        """Event, station and component, as far as its file says, else its name."""
        said = [word for word in (self.event, self.station, self.component) if word]
        return ", ".join(said) or PurePath(self.file).name


@dataclass(frozen=True)
class Given:
    """What the caller knows of a file, where the file may not say it.

    Parameters
    ----------
    units : str, optional
        Unit of the numbers.
    time_step : float, optional
        Their distance (s).
    component : str, optional
        Which of several components: its name, or ``#2`` for the second.
    response : str, optional
        StationXML file with the sensitivity of the instrument, for counts.
    """

    units: str | None = None
    time_step: float | None = None
    component: str | None = None
    response: str | None = None


class UnstatedError(InputError):
    """A file does not say something that the caller has to.

    Parameters
    ----------
    message : str
        What is missing and how it is given.
    missing : sequence of str
        Fields of `Given` that would answer, or one of which would.
    """

    def __init__(self, message: str, missing: Sequence[str]) -> None:
        self.missing = tuple(missing)
        super().__init__(message)


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

        Bytes that are not UTF-8, or UTF-16 with a byte-order mark, are read as Latin-1, which
        never fails; a byte-order mark is dropped.
        """
        wide = self.content.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
        try:
            text = self.content.decode("utf-16" if wide else "utf-8-sig")
        except UnicodeDecodeError:
            text = self.content.decode("latin-1")
        while "\r\n" in text:
            text = text.replace("\r\n", "\n")
        # Ctrl-Z and zeros end files of DOS and of tapes.
        return text.rstrip("\0\x1a\r\n ").replace("\r", "\n").split("\n")

    @cached_property
    def sha256(self) -> str:
        """Hash of the bytes; once a file, which may have thousands of channels."""
        return hashlib.sha256(self.content).hexdigest()

    def line(self, number: int) -> str:
        """A line by its number (from 1); empty after the last."""
        return self.lines[number - 1] if number <= len(self.lines) else ""

    def error(self, line: int | None, message: str) -> InputError:
        """An error that names the file and, where there is one, the line (from 1)."""
        where = self.file if line is None else f"{self.file}, line {line}"
        return InputError(f"{where}: {message}")

    def unreadable(self, tokens: Sequence[tuple[int, str]]) -> list[str]:
        """A message for each of the first few tokens that are not numbers, given with its line."""
        messages = [
            f"{self.file}, line {line}: found '{token}'; a finite number is expected"
            for line, token in tokens[:_MESSAGES]
        ]
        if len(tokens) > _MESSAGES:
            messages.append(f"{self.file}: {len(tokens) - _MESSAGES} more that are not numbers")
        return messages


@dataclass(frozen=True)
class Channel:
    """One component of a file, not read yet.

    Parameters
    ----------
    name : str or None
        As the file has it.
    read : callable
        Reads it.
    other_names : tuple of str
        What it may be asked for by, too.
    """

    name: str | None
    read: Callable[[], RecordData]
    other_names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reader:
    """A file format.

    Parameters
    ----------
    name : str
        The word a case names the format by.
    detect : callable
        Whether a `Source` looks like this format, by its content.
    channels : callable
        ``channels(source, given)``: the components of acceleration in the file,
        in its order, at least one.
    """

    name: str
    detect: Callable[[Source], bool]
    channels: Callable[[Source, Given], Sequence[Channel]]


def load(path: str | Path) -> Source:
    """Read the bytes of a record file.

    Raises
    ------
    InputError
        Where there is no such file, it cannot be read or is empty.
    """
    try:
        content = read_bytes(Path(path))
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: the record cannot be read ({why})") from error
    if not content.strip():
        raise InputError(f"{path}: the file is empty; an accelerogram is needed")
    return Source(str(path), content)
