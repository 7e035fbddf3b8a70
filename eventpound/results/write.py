"""Results of a run to files: the tables first, the manifest last."""

from __future__ import annotations

import os
from collections.abc import Mapping
from datetime import datetime

from eventpound.case.case import Case
from eventpound.given import checked
from eventpound.response import Response
from eventpound.results.files import write_together
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import sha256
from eventpound.results.read import EVENTS, HISTORY, MANIFEST, SUMMARY, gather
from eventpound.results.tables import table_csv


@checked
def write(
    response: Response,
    directory: str | os.PathLike[str],
    case: Case | None = None,
    *,
    error_estimate: Mapping[str, object] | None = None,
    started: datetime | None = None,
) -> None:
    """Write history.csv, events.csv, summary.json and manifest.json, all or none.

    A run that ended before its time is written too: ``success`` of the summary
    and ``complete`` of the manifest are then false.

    Parameters
    ----------
    response : Response
        What the run returned.
    directory : path
        Where the files go; made where it is missing.
    case : Case, optional
        The case the run came from, for the manifest.
    error_estimate : mapping, optional
        Errors of peaks and final values, as `eventpound.accuracy.estimate` finds them, in
        place of those of the response.
    started : datetime, optional
        When the run began, for the manifest.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    results = gather(response, case, started, error_estimate)
    contents = {
        HISTORY: table_csv(results.history),
        EVENTS: table_csv(results.events),
        SUMMARY: to_json(results.summary),
    }
    hashes = {name: sha256(content) for name, content in contents.items()}
    contents[MANIFEST] = to_json(results.manifest | {"files": hashes})
    write_together(directory, contents)
