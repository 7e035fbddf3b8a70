"""The folder of real records, which is no part of the project, and its index.

It is looked for beside the checkout, or where EVENTPOUND_RECORDS says.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

from eventpound.motion import RecordData, read_record
from eventpound.motion.readers import UnstatedError

_BESIDE = Path(__file__).resolve().parents[4] / "shared" / "records"
FOLDER = Path(os.environ.get("EVENTPOUND_RECORDS", _BESIDE))


def rows_of_index() -> list[dict[str, str]]:
    """Rows of the index."""
    if not FOLDER.is_dir():
        return []
    with (FOLDER / "index.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


COMPONENTS = {"first channel (90)": "90", "first channel": "#1"}
"""What the index calls otherwise than the file."""


def read_row(row: dict[str, str]) -> RecordData:
    """Read a file of the index, told only what it asks for."""
    known: dict[str, Any] = {}
    while True:
        try:
            return read_record(FOLDER / row["file"], **known)
        except UnstatedError as error:
            more = _answer(str(error), row)
            if not more or more.items() <= known.items():
                raise
            known |= more


def _answer(question: str, row: dict[str, str]) -> dict[str, Any]:
    answer: dict[str, Any] = {}
    if "its units" in question:
        answer["units"] = row["units"]
    if "time_step =" in question:
        answer["time_step"] = float(row["dt_s"])
    if "components" in question:
        # Its columns have no titles; the index says (time, NS, EW, V).
        unnamed = row["file"] == "two_column/sct190985.txt"
        component = row["component"]
        answer["component"] = "#2" if unnamed else COMPONENTS.get(component, component)
    if "response =" in question:
        answer["response"] = FOLDER / "networks" / "AK.BPAW.xml"
    return answer
