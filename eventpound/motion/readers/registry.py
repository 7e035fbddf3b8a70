"""The formats there are; the first that recognises a file reads it.

The most particular formats come first and plain columns last.
"""

from __future__ import annotations

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
from eventpound.motion.readers.base import Reader, Source

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


def format_names() -> list[str]:
    """The formats a record may have, by name."""
    return [reader.name for reader in READERS]


def reader_of(source: Source, name: str | None) -> Reader:
    """The reader asked for by name, or the first that recognises the file.

    Parameters
    ----------
    source : Source
        The file.
    name : str or None
        Of the format.

    Raises
    ------
    InputError
        For an unknown name, or a file that none recognises.
    """
    known = ", ".join(format_names())
    if name is not None:
        for reader in READERS:
            if reader.name == name:
                return reader
        raise InputError(f"{source.file}: format '{name}' is not known; accepted: {known}")
    for reader in READERS:
        if reader.detect(source):
            return reader
    lines = enumerate(source.lines, start=1)
    number, line = next(((i, x) for i, x in lines if x.strip()), (1, source.line(1)))
    raise source.error(
        number,
        f"not an accelerogram in a known format ({known}); found {line.strip()[:60]!r}",
    )
