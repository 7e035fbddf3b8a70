"""Records read from files; a format is one module here and one entry of `READERS`.

A module gives a `Reader`: its name, how to tell the format by its content, and
the components it finds. The first that recognises a file reads it, so the most
particular formats come first and plain columns last.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

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
from eventpound.motion.readers.base import (
    Channel,
    Given,
    Reader,
    RecordData,
    Source,
    UnstatedError,
    load,
)
from eventpound.motion.readers.components import chosen, component_names

_T = TypeVar("_T")

__all__ = [
    "READERS",
    "Reader",
    "RecordData",
    "UnstatedError",
    "components_of",
    "format_names",
    "read_components",
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
    as_needed: bool = False,
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
    as_needed : bool
        Use what is given only where the file does not say it, instead of
        refusing a file that says otherwise: for many files in one go.

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
    given = Given(units, time_step, component, None if response is None else str(response))
    return _answering(
        given,
        as_needed,
        lambda known: chosen(source, _channels(source, format, known), known.component).read(),
    )


def read_components(
    path: str | Path,
    *,
    format: str | None = None,
    units: str | None = None,
    time_step: float | None = None,
    response: str | Path | None = None,
    as_needed: bool = False,
) -> list[RecordData]:
    """Read all components of a record.

    Parameters
    ----------
    path, format, units, time_step, response, as_needed
        As for `read_record`.

    Returns
    -------
    list of RecordData
        In the order of the file.

    Raises
    ------
    InputError
        As for `read_record`.
    """
    source = load(path)
    given = Given(units, time_step, None, None if response is None else str(response))
    return _answering(
        given,
        as_needed,
        lambda known: [channel.read() for channel in _channels(source, format, known)],
    )


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
    return component_names(_channels(source, format, Given(units, time_step)))


def _answering(given: Given, as_needed: bool, read: Callable[[Given], _T]) -> _T:
    """Read with what is given, or with no more of it than the file asks for."""
    known = Given() if as_needed else given
    while True:
        try:
            return read(known)
        except UnstatedError as error:
            answers = {name: value for name in error.missing if (value := getattr(given, name))}
            if all(getattr(known, name) == value for name, value in answers.items()):
                raise
            known = replace(known, **answers)


def _channels(source: Source, format: str | None, given: Given) -> Sequence[Channel]:
    """The components of a file, by the reader that is named or recognises it."""
    reader = _reader(source, format)
    if given.response is not None and reader not in _WITH_COUNTS:
        raise InputError(
            f"{source.file}: response was given, but a file in the format '{reader.name}' "
            "holds accelerations, not counts"
        )
    return reader.channels(source, given)


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
