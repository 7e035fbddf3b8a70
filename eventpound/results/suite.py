"""``suite.csv`` and ``suite.json``: what one scene did under many records."""

from __future__ import annotations

import os
from datetime import datetime
from typing import TYPE_CHECKING

from eventpound.case.case import Case
from eventpound.results.files import write_together
from eventpound.results.jsontext import canonical, to_json
from eventpound.results.manifest import machine, sha256, versions

if TYPE_CHECKING:
    import pandas as pd

SUITE_TABLE, SUITE_MANIFEST = "suite.csv", "suite.json"
SUITE_FORMAT = "eventpound-suite/1"
"""Name and number of the form of the files."""


def write_suite(
    table: pd.DataFrame,
    directory: str | os.PathLike[str],
    case: Case,
    *,
    solver: str,
    rtol: float,
    started: datetime | None = None,
) -> None:
    """Write suite.csv and suite.json, both or none.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; the hash of every record's file
        is a column of it.
    directory : path
        Where the files go.
    case : Case
        The case of the suite.
    solver : str
        What computed it.
    rtol : float
        To which relative tolerance.
    started : datetime, optional
        When it began.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    content = table.to_csv(index=False, lineterminator="\n").encode("utf-8")
    failed = table[table["failed"] != ""]
    manifest: dict[str, object] = {
        "format": SUITE_FORMAT,
        "started": None if started is None else started.isoformat(),
        "records": len(table),
        "failed": dict(zip(failed["record"], failed["failed"], strict=True)),
        "options": {"solver": solver, "rtol": rtol, "settings": dict(case.solver.settings)},
        "case": case.understood,
        "case_sha256": sha256(canonical(case.understood)),
        "case_file_sha256": case.source_hash,
        "versions": versions(),
        "machine": machine(),
        "files": {SUITE_TABLE: sha256(content)},
    }
    write_together(directory, {SUITE_TABLE: content, SUITE_MANIFEST: to_json(manifest)})
