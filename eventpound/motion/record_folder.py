"""The records of a folder, read one after the other whatever is wrong with some."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eventpound.basics.progress import Counted
from eventpound.errors import InputError
from eventpound.motion.readers import RecordData, read_components, read_record
from eventpound.motion.record_list import read_list


@dataclass(frozen=True)
class RecordFile:
    """A file, and what is known of it where it does not say so itself.

    Parameters
    ----------
    path : Path
        The file.
    units : str, optional
        Unit of its numbers.
    time_step : float, optional
        Their distance (s).
    component : str, optional
        The one wanted of several; None: all.
    response : str, optional
        StationXML file.
    format : str, optional
        Its format.
    """

    path: Path
    units: str | None = None
    time_step: float | None = None
    component: str | None = None
    response: str | None = None
    format: str | None = None

    def read(self) -> list[RecordData]:
        """The component wanted, or all of them.

        Raises
        ------
        InputError
            As `read_record` does.
        """
        said: Any = asdict(self) | {"as_needed": True}
        if self.component is None:
            del said["component"]
            return read_components(**said)
        return [read_record(**said)]


def files_in(folder: Path) -> list[Path]:
    """All files in a folder and those within it, but hidden ones, in order.

    Parameters
    ----------
    folder : Path
        The folder.
    """
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and not any(x.startswith(".") for x in path.relative_to(folder).parts)
    )


def listed_files(table: Path) -> list[RecordFile]:
    """Files of a list, each once, with the units and the time step that it gives them.

    Parameters
    ----------
    table : Path
        A list as `eventpound.motion.record_list` says; components are passed over, too.

    Raises
    ------
    InputError
        Where it cannot be read, is no list, or names no file or no number in a line.
    """
    rows = read_list(table)
    if not rows:
        raise InputError(
            f"{table}: a list of records has a line of titles, one of them 'file', "
            "and a line for each record"
        )
    files: dict[Path, RecordFile] = {}
    for row in rows:
        if row.problem:
            raise InputError(row.problem)
        path = table.parent / row.file
        files.setdefault(path, RecordFile(path, row.units, row.time_step))
    return list(files.values())


def read_each(
    files: list[RecordFile], progress: Counted | None = None
) -> Iterator[tuple[RecordFile, list[RecordData] | InputError]]:
    """Records of each file, or why there are none.

    Parameters
    ----------
    files : list of RecordFile
        The files.
    progress : callable, optional
        Told how many files are done, and of how many.
    """
    for done, file in enumerate(files):
        if progress is not None:
            progress(done, len(files))
        try:
            yield file, file.read()
        except InputError as error:
            yield file, error
