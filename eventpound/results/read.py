"""Results in memory: gathered from a response, or read back from a directory."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.response import Response
from eventpound.results.events import read_events
from eventpound.results.history import read_history
from eventpound.results.jsontext import read_json
from eventpound.results.manifest import FORMAT, describe_run, sha256
from eventpound.results.summary import summarise

if TYPE_CHECKING:
    import pandas as pd

SUMMARY, HISTORY, EVENTS, MANIFEST = "summary.json", "history.csv", "events.csv", "manifest.json"


@dataclass(frozen=True)
class StoredResults:
    """What the four files of a run hold.

    Parameters
    ----------
    summary, manifest : dict
        Content of ``summary.json`` and ``manifest.json``.
    history, events : DataFrame
        Content of ``history.csv`` and ``events.csv``.
    """

    summary: dict[str, Any]
    history: pd.DataFrame
    events: pd.DataFrame
    manifest: dict[str, Any]


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
        history=response.history,
        events=response.events,
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
    manifest = read_json(folder / MANIFEST)
    if manifest.get("format") != FORMAT:
        found = manifest.get("format")
        raise InputError(f"{folder / MANIFEST}: format is {found!r}, this reads {FORMAT!r}")
    _check_files(folder, manifest)
    return StoredResults(
        summary=read_json(folder / SUMMARY),
        history=read_history(folder / HISTORY),
        events=read_events(folder / EVENTS),
        manifest=manifest,
    )


def _check_files(folder: Path, manifest: Mapping[str, object]) -> None:
    """Refuse files of different runs, as an interruption or an edit leaves them."""
    hashes = manifest.get("files")
    known = hashes if isinstance(hashes, Mapping) else {}
    changed = [
        name
        for name in (SUMMARY, HISTORY, EVENTS)
        if known.get(name) != sha256(_read_bytes(folder / name))
    ]
    if changed:
        raise InputError(
            f"{folder}: {', '.join(changed)} not as the run of {MANIFEST} wrote it "
            "(interrupted or edited since); run the case again"
        )


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
