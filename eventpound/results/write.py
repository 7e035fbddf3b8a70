"""Results of a run to files: the tables first, the manifest last."""

from __future__ import annotations

import os
from collections.abc import Mapping
from datetime import datetime

from eventpound.basics.given import checked
from eventpound.case.case import Case
from eventpound.quantities.spring_events import SpringEvent, spring_events
from eventpound.response import EVENT_COLUMNS, Response
from eventpound.results.files import write_together
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import describe_run, sha256
from eventpound.results.read import EVENTS, HISTORY, MANIFEST, SHOCKS, SPRING_EVENTS, SUMMARY
from eventpound.results.summary import summarise
from eventpound.results.tables import rows_csv, table_csv


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

    For a sequence of records shocks.csv, too, and spring_events.csv where `events` asks for it.
    Those of an earlier run are removed.

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
    history = response.history_columns()
    rows = zip(*(column.tolist() for column in history.values()), strict=True)
    contents = {
        HISTORY: rows_csv([history, *rows]),
        EVENTS: rows_csv([EVENT_COLUMNS, *response.event_rows()]),
        SUMMARY: to_json(summarise(response, error_estimate)),
    }
    if response.success and response.shock_rows:
        contents[SHOCKS] = table_csv(response.shocks)
    if words := response.stated.events:
        listed = spring_events(response.scene, response.recording, words)
        contents[SPRING_EVENTS] = rows_csv([SpringEvent._fields, *listed])
    hashes = {name: sha256(content) for name, content in contents.items()}
    contents[MANIFEST] = to_json(describe_run(response, case, started) | {"files": hashes})
    write_together(directory, contents, {SHOCKS, SPRING_EVENTS} - contents.keys())
