"""Results in memory: gathered from a response, or read back from a directory.

``history.csv`` has the motion at the output times and, before and after, at events. Its columns:
``t`` (s), ``a_g`` (m/s^2); ``u.<body>`` (m) and ``v.<body>`` (m/s) relative to the ground,
``a.<body>`` (m/s^2) absolute; ``z.<spring>`` (-); ``force.<spring>`` (N); ``gap.<contact>`` (m);
``lambda.<contact>`` (N); ``s.<support>``, ``sv.<support>`` (m, m/s) relative to the ground,
``sf.<support>``, the force on it (N). ``events.csv`` has one row for every contact of every event:
``t`` (s), ``kind``, ``group``, ``contact``, ``gap_velocity_before`` and ``gap_velocity_after``
(m/s), ``impulse`` (N s), ``energy_lost`` (J), ``count``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.basics.input_files import read_columns, to_numbers
from eventpound.case.case import Case
from eventpound.case.loading import SUMMARY as SUMMARY
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.response import EVENT_COLUMNS, Response
from eventpound.results.jsontext import read_json
from eventpound.results.manifest import FORMAT, describe_run, sha256
from eventpound.results.summary import summarise

if TYPE_CHECKING:
    import pandas as pd

HISTORY, EVENTS, SHOCKS = "history.csv", "events.csv", "shocks.csv"
SPRING_EVENTS = "spring_events.csv"
MANIFEST = "manifest.json"
_WORDS, _COUNTS = ("kind", "contact"), ("group", "count")


@dataclass(frozen=True)
class StoredResults:
    """What the four files of a run hold.

    Parameters
    ----------
    summary, manifest : dict
        Content of ``summary.json`` and ``manifest.json``.
    history_columns : mapping of str to ndarray, shape (n,)
        Columns of ``history.csv``.
    event_columns : mapping of str to list of str or ndarray, shape (E,)
        Columns of ``events.csv``.
    """

    summary: dict[str, Any]
    history_columns: Mapping[str, Floats]
    event_columns: Mapping[str, Any]
    manifest: dict[str, Any]

    # As tables only where they are asked for: figures do without what makes them.
    @property
    def history(self) -> pd.DataFrame:
        """Content of ``history.csv``."""
        import pandas as pd

        return pd.DataFrame(self.history_columns)

    @property
    def events(self) -> pd.DataFrame:
        """Content of ``events.csv``."""
        import pandas as pd

        return pd.DataFrame(self.event_columns)


def gather(
    response: Response,
    case: Case | None = None,
    started: datetime | None = None,
    error_estimate: Mapping[str, object] | None = None,
) -> StoredResults:
    """Results of a response as they would be stored, without a file.

    Parameters
    ----------
    response : Response
        What a run returned.
    case, started, error_estimate : optional
        As for `eventpound.results.write`.
    """
    return StoredResults(
        summary=summarise(response, error_estimate),
        history_columns=response.history_columns(),
        event_columns=_in_columns(response.event_rows()),
        manifest=describe_run(response, case, started),
    )


def read(directory: str | os.PathLike[str]) -> StoredResults:
    """Results of a run from its directory.

    Parameters
    ----------
    directory : path
        Where `eventpound.results.write` wrote them.

    Raises
    ------
    InputError
        Where a file is missing, unreadable, of another form, or not of the
        same run as the manifest.
    """
    folder = Path(directory)
    if not folder.is_dir():
        raise InputError(f"{folder}: no such directory; run the case first")
    missing = [n for n in (SUMMARY, HISTORY, EVENTS, MANIFEST) if not (folder / n).is_file()]
    if missing:
        raise InputError(
            f"{folder}: holds no complete results: {', '.join(missing)} missing; run the case first"
        )
    manifest = read_manifest(folder / MANIFEST, FORMAT, (SUMMARY, HISTORY, EVENTS))
    return StoredResults(
        summary=read_json(folder / SUMMARY),
        history_columns=read_history(folder / HISTORY),
        event_columns=read_events(folder / EVENTS),
        manifest=manifest,
    )


def _in_columns(rows: list[tuple[Any, ...]]) -> dict[str, Any]:
    columns = {name: [row[i] for row in rows] for i, name in enumerate(EVENT_COLUMNS)}
    return {name: _typed(name, cells) for name, cells in columns.items()}


def _typed(name: str, cells: Any) -> Any:
    """A column of events as it is kept."""
    return cells if name in _WORDS else np.array(cells, int if name in _COUNTS else float)


def read_history(path: Path) -> dict[str, Floats]:
    """Columns of a motion from a CSV file, ours or another program's of the same form.

    Parameters
    ----------
    path : Path
        The file; it needs a column ``t`` and numbers in every cell.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    columns = read_columns(path)
    if "t" not in columns:
        raise InputError(f"{path}: has no column 't'; its columns begin with {list(columns)[:6]}")
    return {name: to_numbers(path, name, cells) for name, cells in columns.items()}


def read_events(path: Path) -> dict[str, Any]:
    """Columns of events from a CSV file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    columns = read_columns(path)
    if missing := [name for name in EVENT_COLUMNS if name not in columns]:
        raise InputError(f"{path}: has no column {', '.join(missing)}")
    return {
        name: _typed(
            name, columns[name] if name in _WORDS else to_numbers(path, name, columns[name])
        )
        for name in EVENT_COLUMNS
    }


def read_manifest(path: Path, form: str, files: Sequence[str]) -> dict[str, Any]:
    """The manifest of files beside it, which are those that it tells of.

    Parameters
    ----------
    path : Path
        The manifest.
    form : str
        Name and number of the form that it has to have.
    files : sequence of str
        What has to lie beside it.

    Raises
    ------
    InputError
        Where it cannot be read, is of another form, or files are not of its run, as an
        interruption or an edit leaves them.
    """
    manifest = read_json(path)
    if (found := manifest.get("format")) != form:
        raise InputError(f"{path}: format is {found!r}, this reads {form!r}")
    hashes = manifest.get("files")
    known = hashes if isinstance(hashes, Mapping) else {}
    changed = [n for n in files if known.get(n) != sha256(_read_bytes(path.parent / n))]
    if changed:
        raise InputError(
            f"{path.parent}: {', '.join(changed)} not as the run of {path.name} wrote it "
            "(interrupted or edited since); run the case again"
        )
    return manifest


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
