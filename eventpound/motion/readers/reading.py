"""Files of records as they are read, and which component of several."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isclose
from pathlib import Path
from typing import TypeVar

import numpy as np

from eventpound.basics.given import checked, number
from eventpound.errors import InputError
from eventpound.motion.readers.base import (
    SAME_STEP,
    Channel,
    Given,
    RecordData,
    Source,
    UnstatedError,
    load,
)
from eventpound.motion.readers.header import unit_factor
from eventpound.motion.readers.numbers import to_count
from eventpound.motion.readers.registry import reader_of
from eventpound.units import Dimension

_PLACE = re.compile(r"#([1-9]\d*)")


def component_asked_for(
    source: Source, channels: Sequence[Channel], component: str | None
) -> Channel:
    """The component asked for; it must be told where there are several.

    Parameters
    ----------
    source : Source
        The file, for messages.
    channels : sequence of Channel
        Its components.
    component : str or None
        A name as the file has it (capitals, blanks and hyphens do not matter),
        or ``#2`` for the second.

    Returns
    -------
    Channel
        The one.

    Raises
    ------
    InputError
        Listing the components, where none is asked for and there are several,
        or none or several answer to the name.
    """
    if component is None:
        if len(channels) == 1:
            return channels[0]
        raise UnstatedError(
            f"{source.file}: the file holds {len(channels)} components ({_list(channels)}); "
            f'say which, component = "{channels[0].name or "#1"}" for the first',
            ["component"],
        )
    if place := _PLACE.fullmatch(component.strip()):
        index = to_count(place.group(1))
        if index <= len(channels):
            return channels[index - 1]
    else:
        found = [channel for channel in channels if _answers(channel, component)]
        if len(found) == 1:
            return found[0]
        if found:
            raise source.error(
                None,
                f"component = '{component}' is the name of {len(found)} of its components; name "
                f"one by its place: {_list(channels)}",
            )
    raise source.error(
        None, f"component = '{component}' is not one of its components: {_list(channels)}"
    )


def component_names(channels: Sequence[Channel]) -> list[str]:
    """A name for each component by which it can be asked for."""
    names = [channel.name for channel in channels]
    return [name if name and names.count(name) == 1 else f"#{i}" for i, name in enumerate(names, 1)]


def _answers(channel: Channel, component: str) -> bool:
    return _plain(component) in {
        _plain(name) for name in (channel.name, *channel.other_names) if name
    }


def _plain(name: str) -> str:
    """A name without what is written in many ways: N-S, n s and NS are one."""
    return re.sub(r"[\s_-]", "", name).casefold()


def _list(channels: Sequence[Channel]) -> str:
    """All by place and name, and with what else they may be asked for by where names are shared."""
    names = [channel.name for channel in channels]

    def shown(place: int, channel: Channel) -> str:
        others = ", ".join(filter(None, channel.other_names[1:]))
        more = f" ({others})" if others and names.count(channel.name) > 1 else ""
        return f"#{place} {channel.name}{more}" if channel.name else f"#{place}"

    return ", ".join(shown(i, channel) for i, channel in enumerate(channels, 1))


_T = TypeVar("_T")
_WITH_COUNTS = ("miniseed", "sac")


@checked
def read_record(
    path: str | Path,
    *,
    format: str | None = None,
    units: str | None = None,
    time_step: float | str | None = None,
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
        Use what is given only where the file does not say it, and note where it
        says otherwise instead of refusing it: for many files in one go.

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
    step = None if time_step is None else number("time_step", time_step, Dimension.TIME)
    given = Given(units, step, component, None if response is None else str(response))

    def read(source: Source, known: Given) -> RecordData:
        return component_asked_for(source, _channels(source, format, known), known.component).read()

    return _noting_others(_answering(load(path), given, as_needed, read), given)


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
    given = Given(units, time_step, None, None if response is None else str(response))

    def read(source: Source, known: Given) -> list[RecordData]:
        return [channel.read() for channel in _channels(source, format, known)]

    found = _answering(load(path), given, as_needed, read)
    return [_noting_others(data, given) for data in found]


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


def _answering(
    source: Source, given: Given, as_needed: bool, read: Callable[[Source, Given], _T]
) -> _T:
    """Read with what is given, or with no more of it than the file asks for."""
    known = Given() if as_needed else given
    while True:
        try:
            # Numbers too large become samples that are not finite, which are refused.
            with np.errstate(all="ignore"):
                return read(source, known)
        except UnstatedError as error:
            answers = {name: value for name in error.missing if (value := getattr(given, name))}
            if all(getattr(known, name) == value for name, value in answers.items()):
                raise
            known = replace(known, **answers)


def _noting_others(data: RecordData, given: Given) -> RecordData:
    """The record with a note where the file says otherwise than what was given."""
    notes = list(data.notes)
    step = given.time_step
    if step is not None and not isclose(step, data.time_step, rel_tol=SAME_STEP):
        found, other = data.time_step, given.time_step
        notes.append(f"time step {found:g} s of the file, not the {other:g} s given")
    if given.units is not None and unit_factor(given.units) != unit_factor(data.units):
        notes.append(f"units {data.units} of the file, not the {given.units} given")
    return replace(data, notes=tuple(notes))


def _channels(source: Source, format: str | None, given: Given) -> Sequence[Channel]:
    """The components of a file, by the reader that is named or recognises it."""
    reader = reader_of(source, format)
    if given.response is not None and reader.name not in _WITH_COUNTS:
        raise InputError(
            f"{source.file}: response was given, but a file in the format '{reader.name}' "
            "holds accelerations, not counts"
        )
    channels = reader.channels(source, given)
    if not channels:
        raise InputError(
            f"{source.file}: no component of acceleration in this file, "
            f"read in the format '{reader.name}'"
        )
    return channels
