"""``suite.csv`` and ``suite.json``: what one scene did under many records."""

from __future__ import annotations

import os
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.results.files import write_together
from eventpound.results.jsontext import canonical, read_json, to_json
from eventpound.results.manifest import machine, sha256, versions
from eventpound.results.tables import table_csv

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
    started: datetime | None = None,
    total: int | None = None,
    further: Mapping[str, pd.DataFrame] | None = None,
) -> None:
    """Write suite.csv, suite.json and further tables, all or none.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; the hash of every record's file
        is a column of it.
    directory : path
        Where the files go.
    case : Case
        The case of the suite, its solver and relative tolerance those of the table.
    started : datetime, optional
        When it began.
    total : int, optional
        Number of records of the suite, where it was stopped before all were run.
    further : mapping of str to DataFrame
        Tables that are made of it, by the names of their files.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    contents = {SUITE_TABLE: table_csv(table)}
    contents |= {name: table_csv(other) for name, other in (further or {}).items()}
    failed = table[table["failed"] != ""]
    manifest: dict[str, object] = {
        "format": SUITE_FORMAT,
        "started": None if started is None else started.isoformat(),
        "complete": total is None or len(table) == total,
        "records": len(table),
        "records_of_suite": len(table) if total is None else total,
        "failed": dict(zip(failed["record"], failed["failed"], strict=True)),
        "options": {
            "solver": case.solver.name,
            "rtol": case.solver.rtol,
            "settings": dict(case.solver.settings),
        },
        "case": case.understood,
        "case_sha256": sha256(canonical(case.understood)),
        "case_file_sha256": case.source_hash,
        "versions": versions(),
        "machine": machine(),
        "files": {name: sha256(content) for name, content in contents.items()},
    }
    write_together(directory, contents | {SUITE_MANIFEST: to_json(manifest)})


def read_suite(directory: str | os.PathLike[str]) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Results of a suite from its directory.

    Parameters
    ----------
    directory : path
        Where `write_suite` wrote them.

    Returns
    -------
    DataFrame
        The table.
    dict
        The manifest; ``case`` in it is the case as it was understood.

    Raises
    ------
    InputError
        Where a file is missing, unreadable or not of the manifest's run.
    """
    import pandas as pd

    folder = Path(directory)
    try:
        manifest = read_json(folder / SUITE_MANIFEST)
        content = (folder / SUITE_TABLE).read_bytes()
    except (InputError, OSError) as error:
        raise InputError(f"{folder}: holds no complete results of a suite: {error}") from error
    lacking = [key for key in ("case", "options") if not isinstance(manifest.get(key), dict)]
    if manifest.get("format") == SUITE_FORMAT and lacking:
        raise InputError(f"{folder / SUITE_MANIFEST}: has no table {', '.join(lacking)}")
    if manifest.get("format") != SUITE_FORMAT:
        found = manifest.get("format")
        raise InputError(
            f"{folder / SUITE_MANIFEST}: format is {found!r}, this reads {SUITE_FORMAT!r}"
        )
    files = manifest.get("files")
    if not isinstance(files, dict) or files.get(SUITE_TABLE) != sha256(content):
        raise InputError(
            f"{folder}: {SUITE_TABLE} not as the run of {SUITE_MANIFEST} wrote it "
            "(interrupted or edited since); run the case again"
        )
    texts = dict.fromkeys(("record", "file", "failed"), str)
    table = pd.read_csv(folder / SUITE_TABLE, dtype=texts)
    # Numbers may differ in the last digit: no more is drawn of them.
    table["failed"] = table["failed"].fillna("")
    return table, manifest
