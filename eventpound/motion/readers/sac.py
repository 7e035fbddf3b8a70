"""SAC, binary, of either byte order, read by ObsPy.

The header has no unit (``IDEP`` says that the numbers are accelerations, and
would have them in nm/s^2, which few writers heed), so it has to be given.
"""

from __future__ import annotations

import struct

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.waveforms import waveform_channels

_HEADER_BYTES = 632
_VERSION_AT, _COUNT_AT, _KIND_AT = 304, 316, 344
_VERSIONS = (6, 7)
_VELOCITY_AND_DISPLACEMENT = (7, 6)


def _detect(source: Source) -> bool:
    """Whether version and number of samples are where a SAC header has them."""
    return _byte_order(source) is not None


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component.

    Raises
    ------
    InputError
        Also for velocities and displacements.
    """
    order = _byte_order(source)
    if order is not None and _integer(source, order, _KIND_AT) in _VELOCITY_AND_DISPLACEMENT:
        raise source.error(None, "its header says velocities or displacements, not accelerations")
    return waveform_channels(source, given, READER.name, "SAC")


READER = Reader("sac", _detect, _channels)


def _byte_order(source: Source) -> str | None:
    """``<`` or ``>``; None where the file is no SAC file."""
    size = len(source.content)
    if size < _HEADER_BYTES:
        return None
    for order in "<>":
        version = _integer(source, order, _VERSION_AT)
        count = _integer(source, order, _COUNT_AT)
        if version in _VERSIONS and 0 < _HEADER_BYTES + 4 * count <= size:
            return order
    return None


def _integer(source: Source, order: str, at: int) -> int:
    return int(struct.unpack_from(order + "i", source.content, at)[0])
