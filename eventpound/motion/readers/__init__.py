"""Records read from files; a format is one module here and one entry of `READERS`.

A module gives a `Reader`: its name, how to tell the format by its content, and
the components it finds. The first that recognises a file reads it, so the most
particular formats come first and plain columns last.
"""

from __future__ import annotations

from pathlib import Path

from eventpound.errors import InputError
from eventpound.motion.readers import (
    afad,
    at2,
    columns,
    cosmos,
    csmip,
    cwb,
    esm,
    geonet,
    itaca,
    itsak,
    itsak_fixed,
    knet,
    miniseed,
    opensees,
    sac,
    smc,
    usc,
)
from eventpound.motion.readers.base import Given, Reader, RecordData, Source, UnstatedError, load
from eventpound.motion.readers.components import chosen, component_names

__all__ = [
    "READERS",
    "Reader",
    "RecordData",
    "UnstatedError",
    "components_of",
    "format_names",
    "read_record",
]

READERS: tuple[Reader, ...] = (
    miniseed.READER,
    sac.READER,
    at2.READER,
    esm.READER,
    cosmos.READER,
    csmip.READER,
    smc.READER,
    knet.READER,
    geonet.READER,
    cwb.READER,
    usc.READER,
    afad.READER,
    itaca.READER,
    itsak.READER,
    itsak_fixed.READER,
    opensees.READER,
    columns.READER,
)
_WITH_COUNTS = (miniseed.READER, sac.READER)


def format_names() -> list[str]:
    """The formats a record may have, by name."""
    return [reader.name for reader in READERS]


def read_record(
    path: str | Path,
    *,
    format: str | None = None,
    units: str | None = None,
    time_step: float | None = None,
    component: str | None = None,
    response: str | Path | None = None,
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
    component : str, optional
        Which of several components: its name in the file, or ``#2`` for the
        second.
    response : str or Path, optional
        StationXML file with the sensitivity of the instrument, for counts.

    Returns
    -------
    RecordData
        Samples in m/s^2 and where they come from.

    Raises
    ------
    UnstatedError
        Where the file does not say its units or time step, or which of its
        components is meant, and the caller does not either.
    InputError
        Naming the file and, where there is one, the line, with what was found
        and what was expected.
    """
    source = load(path)
    reader = _reader(source, format)
    if response is not None and reader not in _WITH_COUNTS:
        raise InputError(
            f"{source.file}: response was given, but a file in the format '{reader.name}' "
            "holds accelerations, not counts"
        )
    given = Given(units, time_step, component, None if response is None else str(response))
    return chosen(source, reader.channels(source, given), component).read()


def components_of(
    path: str | Path,
    *,
    format: str | None = None,
    units: str | None = None,
    time_step: float | None = None,
) -> list[str]:
    """Names by which `read_record` can be asked for the components of a file.

    Parameters
    ----------
    path, format, units, time_step
        As for `read_record`.

    Returns
    -------
    list of str
        One a component, in the order of the file.

    Raises
    ------
    InputError
        As for `read_record`.
    """
    source = load(path)
    given = Given(units, time_step)
    return component_names(_reader(source, format).channels(source, given))


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
