"""Records read from files; a format is one module here, or one `Dialect`.

A module gives a `Reader`: its name, how to tell the format by its content, and the
components it finds. Where the numbers follow a header of text, a `Dialect` says what stands
in it (`dialects.py`, `archives.py`). `registry.READERS` lists them; other packages bring theirs
by the entry points ``eventpound.readers`` (docs/your-format.md).
"""

from eventpound.motion.readers.base import (
    Channel,
    Given,
    Reader,
    RecordData,
    Source,
    UnstatedError,
)
from eventpound.motion.readers.block import Stated, block_channel
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.reading import components_of, read_components, read_record
from eventpound.motion.readers.registry import READERS, format_names

__all__ = [
    "READERS",
    "Channel",
    "Given",
    "Header",
    "Reader",
    "RecordData",
    "Source",
    "Stated",
    "UnstatedError",
    "block_channel",
    "components_of",
    "format_names",
    "read_components",
    "read_record",
]
