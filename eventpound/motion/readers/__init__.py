"""Records read from files; a format is one module here and one entry of `registry.READERS`.

A module gives a `Reader`: its name, how to tell the format by its content, and
the components it finds.
"""

from eventpound.motion.readers.base import Reader, RecordData, UnstatedError
from eventpound.motion.readers.reading import components_of, read_components, read_record
from eventpound.motion.readers.registry import READERS, format_names

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
