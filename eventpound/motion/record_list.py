"""Lists and folders of record files.

Lists of record files: CSV, with what the files do not say themselves.

A column ``file`` (relative to the list) and perhaps ``units``, ``time_step`` (s;
also ``dt_s``) and, of several in a file, ``component``. An empty cell says nothing;
other columns are passed over. Files with semicolons between them are a sequence.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eventpound.basics.input_files import read_bytes
from eventpound.basics.told import Counted
from eventpound.errors import InputError
from eventpound.motion.readers import RecordData, read_components, read_record

_TIME_STEP_COLUMNS = ("time_step", "dt_s")


@dataclass(frozen=True, slots=True)
class ListedRecord:
    """A line of a list.

    Parameters
    ----------
    file : str
        As it stands there.
    units, component : str or None
        What the line says of them.
    time_step : float or None
        Likewise (s).
    problem : str
        What is wrong with the line; empty where nothing is.
    """

    file: str
    units: str | None
    component: str | None
    time_step: float | None
    problem: str

    @property
    def files(self) -> tuple[str, ...]:
        """The files of a sequence, else the one."""
        return tuple(file.strip() for file in self.file.split(";"))


def read_list(path: Path) -> list[ListedRecord] | None:
    """Read a list of records.

    Parameters
    ----------
    path : Path
        The CSV file.

    Returns
    -------
    list of ListedRecord or None
        None where the file is something else.

    Raises
    ------
    InputError
        Where the file cannot be opened.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
        reader = csv.DictReader(io.StringIO(text, newline=""))
        if "file" not in (reader.fieldnames or ()):
            return None
        return [_listed(row, f"{path}, line {reader.line_num}") for row in reader]
    except (UnicodeDecodeError, csv.Error):
        return None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error


def _listed(row: Mapping[str, str | None], place: str) -> ListedRecord:
    """The record of one line; `place` says which."""

    def cell(name: str) -> str | None:
        return (row.get(name) or "").strip() or None

    file = cell("file") or ""
    problem = "" if file else f"{place}: no file is named"
    time_step = None
    for column in _TIME_STEP_COLUMNS:
        text = cell(column)
        if text and time_step is None:
            try:
                time_step = float(text)
            except ValueError:
                problem = f"{place}: {column} is {text!r}; accepted: a time step in s"
    return ListedRecord(file, cell("units"), cell("component"), time_step, problem)


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
