"""Results in memory: gathered from a response, or read back from a directory."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.case.loading import SUMMARY as SUMMARY
from eventpound.errors import InputError
from eventpound.response import Response
from eventpound.results.events import read_events
from eventpound.results.history import read_history
from eventpound.results.jsontext import read_json
from eventpound.results.manifest import FORMAT, describe_run, sha256
from eventpound.results.summary import summarise

if TYPE_CHECKING:
    import pandas as pd

HISTORY, EVENTS, SHOCKS = "history.csv", "events.csv", "shocks.csv"
MANIFEST = "manifest.json"


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
    manifest = read_manifest(folder / MANIFEST, FORMAT, (SUMMARY, HISTORY, EVENTS))
    return StoredResults(
        summary=read_json(folder / SUMMARY),
        history=read_history(folder / HISTORY),
        events=read_events(folder / EVENTS),
        manifest=manifest,
    )


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
