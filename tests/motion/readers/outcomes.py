"""What reading gives, a line a file and way: two checkouts read alike where these are the same.

    python -m tests.motion.readers.outcomes > before      # in one checkout
    python -m tests.motion.readers.outcomes > after       # in the other
    diff before after

Files are the real records (`real_records.FOLDER`), whole and damaged at random, and one of
every format that the tests write, damaged too. Values and metadata are told by their hash,
refusals by their message.
"""

import hashlib
import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from eventpound.errors import InputError
from eventpound.motion.readers import (
    RecordData,
    components_of,
    format_names,
    read_components,
    read_record,
)
from tests.fuzz.damage import damaged_record
from tests.motion.readers.real_records import FOLDER
from tests.motion.readers.writers import WRITERS, motion

DAMAGED_REAL, DAMAGED_WRITTEN = 6, 60
"""Damaged copies of each file."""

WAYS: dict[str, Callable[[Path], Any]] = {
    "names": components_of,
    "alone": read_record,
    "first": lambda path: read_record(path, component="#1", units="g", time_step=0.01),
    "all": lambda path: read_components(path, units="cm/s2", time_step=0.02, as_needed=True),
}


def outcome(read: Callable[[Path], Any], path: Path) -> str:
    """What a way of reading makes of a file, as one line."""
    try:
        found = read(path)
    except InputError as error:
        return "refused: " + " | ".join(error.problems).replace(str(path.parent), "")
    if isinstance(found, RecordData):
        return _told(found)
    return " ; ".join(x if isinstance(x, str) else _told(x) for x in found)


def _told(data: RecordData) -> str:
    values = hashlib.sha256(data.acceleration.tobytes()).hexdigest()[:12]
    said = (data.time_step, data.units, data.format, data.event, data.station, data.component)
    return f"{data.acceleration.size} {values} {said!r} {data.date!r} {data.notes!r}"


def _files(folder: Path) -> Iterator[Path]:
    """Real and written files, each followed by damaged copies of it."""
    real = [path for path in sorted(FOLDER.rglob("*")) if path.is_file()]
    written = {name: write(motion(60, 0.1), 0.1).text.encode() for name, write in WRITERS.items()}
    contents = [(path.name, path.read_bytes(), DAMAGED_REAL) for path in real]
    contents += [(name, content, DAMAGED_WRITTEN) for name, content in written.items()]
    for name, content, copies in contents:
        random_ = random.Random(name)
        for i in range(copies + 1):
            path = folder / f"{i}-{name}"
            path.write_bytes(damaged_record(content, random_) if i else content)
            yield path
            path.unlink()


def main(named: bool) -> None:
    """Print the outcomes; with `named`, also of every format asked for by its name."""
    with tempfile.TemporaryDirectory() as folder:
        for path in _files(Path(folder)):
            for way, read in WAYS.items():
                print(path.name, way, outcome(read, path))
            if named and path.name.startswith("0-"):
                for name in format_names():
                    asked = outcome(lambda path, name=name: read_record(path, format=name), path)
                    print(path.name, name, asked)


if __name__ == "__main__":
    main("named" in sys.argv)
