"""Records read from files; a format is one module here, or one `Dialect`.

A module gives a `Reader`: its name, how to tell the format by its content, and the
components it finds. Where the numbers follow a header of text, a `Dialect` says what stands
in it (`dialects.py`, `archives.py`). `registry.READERS` lists them; other packages bring theirs
by the entry points ``eventpound.readers`` (page "your-format" of the docs).
"""

from eventpound.motion.readers.base import (
    Channel,
    Given,
    Reader,
    RecordData,
    Source,
    UnstatedError,
)
from eventpound.motion.readers.header import Header, record_data
from eventpound.motion.readers.labelled import Dialect, of_length, until_like, while_like
from eventpound.motion.readers.reading import components_of, read_components, read_record
from eventpound.motion.readers.registry import READERS, format_names

__all__ = [
    "READERS",
    "Channel",
    "Dialect",
    "Given",
    "Header",
    "Reader",
    "RecordData",
    "Source",
    "UnstatedError",
    "components_of",
    "format_names",
    "of_length",
    "read_components",
    "read_record",
    "record_data",
    "until_like",
    "while_like",
]
