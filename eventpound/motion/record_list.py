"""Lists of record files: CSV, with what the files do not say themselves.

A column ``file`` (relative to the list) and perhaps ``units``, ``time_step`` (s;
also ``dt_s``) and, of several in a file, ``component``. An empty cell says nothing;
other columns are passed over. Files with semicolons between them are a sequence.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eventpound.basics.input_files import read_bytes
from eventpound.errors import InputError

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
