"""Which component of a file is meant: by its name, or by its place (``#2``)."""

from __future__ import annotations

import re
from collections.abc import Sequence

from eventpound.motion.readers.base import Channel, Source, UnstatedError
from eventpound.motion.readers.numbers import to_count

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
