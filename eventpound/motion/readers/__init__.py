"""Records read from files; a format is one module here, or one `Dialect`.

A module gives a `Reader`: its name, how to tell the format by its content, and the
components it finds. Where the numbers follow a header of text, a `Dialect` says what stands
in it (`dialects.py`, `archives.py`). `registry.READERS` lists them; other packages bring theirs
by the entry points ``eventpound.readers`` (page "your-format" of the docs).
"""

from eventpound.motion.readers.base import Channel as Channel
from eventpound.motion.readers.base import Given as Given
from eventpound.motion.readers.base import Reader as Reader
from eventpound.motion.readers.base import RecordData as RecordData
from eventpound.motion.readers.base import Source as Source
from eventpound.motion.readers.base import UnstatedError as UnstatedError
from eventpound.motion.readers.header import Header as Header
from eventpound.motion.readers.header import of_length as of_length
from eventpound.motion.readers.header import record_data as record_data
from eventpound.motion.readers.header import until_like as until_like
from eventpound.motion.readers.header import while_like as while_like
from eventpound.motion.readers.labelled import Dialect as Dialect
from eventpound.motion.readers.reading import components_of as components_of
from eventpound.motion.readers.reading import read_components as read_components
from eventpound.motion.readers.reading import read_record as read_record
from eventpound.motion.readers.registry import READERS as READERS
from eventpound.motion.readers.registry import format_names as format_names
