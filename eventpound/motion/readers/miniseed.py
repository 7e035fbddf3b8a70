"""miniSEED, read by ObsPy: usually counts, which need the response of the instrument.

The sensitivity comes from a StationXML file, ``response``, or as the unit of a
count, ``units = "2.3e-6 m/s2"``.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.waveforms import waveform_channels

_FIRST_BYTES = re.compile(rb"\d{6}[DRQM][ \x00]|MS\x03")


def _detect(source: Source) -> bool:
    """Whether the file begins with the header of a record."""
    return bool(_FIRST_BYTES.match(source.content))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The channels of the file."""
    return waveform_channels(source, given, READER.name, "MSEED")


READER = Reader("miniseed", _detect, _channels)
