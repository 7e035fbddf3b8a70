"""The folder of real records, which is no part of the project, and its index.

It is looked for beside the checkout, or where EVENTPOUND_RECORDS says.
"""

import csv
import os
from pathlib import Path

from eventpound.motion import RecordData, read_record

_BESIDE = Path(__file__).resolve().parents[4] / "shared" / "records"
FOLDER = Path(os.environ.get("EVENTPOUND_RECORDS", _BESIDE))


def rows_of_index() -> list[dict[str, str]]:
    """Rows of the index."""
    if not FOLDER.is_dir():
        return []
    with (FOLDER / "index.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


COMPONENTS = {
    "networks/ce36456p_CE36456.V2": "90",
    # Its columns have no titles; the index says (time, NS, EW, V).
    "two_column/sct190985.txt": "#2",
}
"""What the index calls otherwise than the file."""


def read_row(row: dict[str, str]) -> RecordData:
    """Read a file of the index, told only what it does not say itself."""
    file = row["file"]
    counts = row["units"] == "counts"
    return read_record(
        FOLDER / file,
        units=None if counts else row["units"],
        time_step=float(row["dt_s"]),
        component=COMPONENTS.get(file, row["component"]),
        response=FOLDER / "networks" / "AK.BPAW.xml" if counts else None,
        as_needed=True,
    )
