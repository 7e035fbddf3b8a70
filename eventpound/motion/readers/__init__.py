"""Records read from files; a format is one module here and one entry of `READERS`.

A module gives a `Reader`: its name, how to tell the format by its content, and
how to read it. The first that recognises a file reads it, so the most particular
formats come first and plain columns last.
"""

from __future__ import annotations

from pathlib import Path

from eventpound.errors import InputError
from eventpound.motion.readers import at2, columns
from eventpound.motion.readers.base import Reader, RecordData, Source, load

__all__ = ["READERS", "Reader", "RecordData", "format_names", "read_record"]

READERS: tuple[Reader, ...] = (at2.READER, columns.READER)


def format_names() -> list[str]:
    """The formats a record may have, by name."""
    return [reader.name for reader in READERS]


def read_record(
    path: str | Path,
    *,
    format: str | None = None,
    units: str | None = None,
    time_step: float | None = None,
) -> RecordData:
    """Read one component of a record.

    Parameters
    ----------
    path : str or Path
        The file.
    format : str, optional
        Name of its format; without it the content decides.
    units : str, optional
        Unit of its numbers, where the file does not say; else it must agree.
    time_step : float, optional
        Time step (s), where the file does not say; else it must agree.

    Returns
    -------
    RecordData
        Samples in m/s^2 and where they come from.

    Raises
    ------
    InputError
        Naming the file and, where there is one, the line, with what was found
        and what was expected.
    """
    source = load(path)
    return _reader(source, format).read(source, units, time_step)


def _reader(source: Source, name: str | None) -> Reader:
    """The reader asked for, or the first that recognises the file."""
    known = ", ".join(format_names())
    if name is not None:
        for reader in READERS:
            if reader.name == name:
                return reader
        raise InputError(f"{source.file}: format '{name}' is not known; accepted: {known}")
    for reader in READERS:
        if reader.detect(source):
            return reader
    number, line = next((i, x) for i, x in enumerate(source.lines, start=1) if x.strip())
    raise source.error(
        number,
        f"not an accelerogram in a known format ({known}); found {line.strip()[:60]!r}",
    )
