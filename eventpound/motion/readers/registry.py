"""The formats there are; the first that recognises a file reads it.

The most particular formats come first, then those of other packages (entry points
``eventpound.readers``, each a `Reader`), plain numbers last.
"""

from __future__ import annotations

from functools import cache

from eventpound.basics.plugins import Plugins, plugged_in
from eventpound.errors import InputError
from eventpound.motion.readers import (
    archives,
    columns,
    dialects,
    interchange,
    knet_csv,
    volumes,
    waveforms,
)
from eventpound.motion.readers.base import Reader, Source
from eventpound.motion.readers.binary import binary_kind

_DIALECTS = (
    dialects.AT2,
    dialects.ESM,
    dialects.KNET,
    archives.GEONET,
    dialects.CWB,
    dialects.AFAD,
    dialects.ITACA,
    dialects.ITSAK,
    dialects.UNAM,
    dialects.CSMNC,
    archives.COSMOS,
    volumes.CDMG,
    volumes.CSMIP,
    archives.SMC,
    volumes.USC,
    volumes.BHRC,
    dialects.ITSAK_FIXED,
    interchange.TIMESERIES,
    interchange.SAC_ALPHANUMERIC,
    interchange.COUNT_AND_STEP,
)
_OF_TEXT = (
    knet_csv.KNET_CSV,
    *(dialect.reader() for dialect in _DIALECTS),
    columns.OPENSEES,
    columns.COLUMNS,
)
READERS: tuple[Reader, ...] = (waveforms.MINISEED, waveforms.SAC, *_OF_TEXT)

GROUP = "eventpound.readers"
_PLAIN = 3
"""The last of `READERS`, which take what no other recognises."""


def format_names() -> list[str]:
    """The formats a record may have, by name."""
    return [reader.name for reader in _readers(_plugged_in())]


def reader_of(source: Source, name: str | None) -> Reader:
    """The reader asked for by the name of a format, or the first that recognises the file.

    Raises
    ------
    InputError
        For an unknown name, one of a package that does not work, a file that none
        recognises, or one that is no text where text is needed.
    """
    plugins = _plugged_in()
    readers = _readers(plugins)
    known = ", ".join(reader.name for reader in readers)
    asked = (x for x in readers if (x.detect(source) if name is None else x.name == name))
    found = next(asked, None)
    if name is not None and found is None:
        if name in plugins.troubles:
            raise InputError(f"{source.file}: format '{name}': {plugins.troubles[name]}")
        raise InputError(f"{source.file}: format '{name}' is not known; accepted: {known}")
    if found is None or found in _OF_TEXT:
        told = found is not None and (name is None or found.detect(source))
        if kind := binary_kind(source.content, may_have_zeros=told):
            raise source.error(None, f"found {kind}; a record is needed")
    if found is not None:
        return found
    lines = enumerate(source.lines, start=1)
    number, line = next(((i, x) for i, x in lines if x.strip()), (1, source.line(1)))
    raise source.error(
        number,
        f"not an accelerogram in a known format ({known}); found {line.strip()[:60]!r}. Plain "
        "numbers are read after comment lines (#) and at most one line of titles",
    )


@cache
def _plugged_in() -> Plugins[Reader]:
    """Readers of other packages; looked for once, because a folder has many files."""
    own = {reader.name for reader in READERS}
    return plugged_in(GROUP, "format", own, _trouble)


def _trouble(reader: object) -> str:
    return "" if isinstance(reader, Reader) else "is no eventpound.motion.readers.Reader"


def _readers(plugins: Plugins[Reader]) -> tuple[Reader, ...]:
    """All readers in the order in which they are asked."""
    return (*READERS[:-_PLAIN], *plugins.found.values(), *READERS[-_PLAIN:])
