"""Tables of records, and of the pulses fitted to them.

Records that could not be read are rows with nothing but their file and the
reason, in the column ``problem``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path

from eventpound.motion.intensity import Characteristics
from eventpound.motion.processing import Processing
from eventpound.motion.pulse_fit import PulseFit
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import machine, sha256, versions
from eventpound.results.tables import rows_csv

FORMAT = "eventpound-records/1"
"""Name and number of the form of the files."""
TABLE, MANIFEST = "records.csv", "manifest.json"
_PROBLEM = "problem"
_SUMS = {
    "arias_m_s": "pi/(2 g) times the trapezoid sum of a^2 over the samples",
    "d5_95_s": "from 5 to 95 % of the trapezoid sum of a^2 over the samples",
    "cav_m_s": "trapezoid sum of |a| over the samples",
}
"""Columns that are sums, as published ones are, and not integrals of straight lines."""


def records_csv(
    records: Sequence[Characteristics], unread: Mapping[str, str], folder: Path
) -> bytes:
    """Table of records as CSV, one row a component; a list of records as well.

    Parameters
    ----------
    records : sequence of Characteristics
        Those that were read.
    unread : mapping of str to str
        Files that were not, and why.
    folder : Path
        Where the table goes, to which its files are relative, unless they are absolute.
    """
    rows: list[dict[str, object]] = [{**record.row(), _PROBLEM: ""} for record in records]
    rows += [{"file": file, _PROBLEM: problem} for file, problem in unread.items()]
    for row in rows:
        row["file"] = _relative_to(folder, str(row["file"]))
    names = list(rows[0]) if records else ["file", _PROBLEM]
    return rows_csv([names, *([row.get(name, "") for name in names] for row in rows)])


def _relative_to(folder: Path, file: str) -> str:
    if Path(file).is_absolute():
        return file
    return Path(os.path.relpath(file, folder)).as_posix()


def records_manifest(
    records: Sequence[Characteristics],
    unread: Mapping[str, str],
    processing: Processing,
    table: bytes,
    started: datetime,
) -> bytes:
    """What was read, how it was processed and by what, as JSON.

    Parameters
    ----------
    records, unread
        As for `records_csv`.
    processing : Processing
        What was done to every record.
    table : bytes
        The table as it is written.
    started : datetime
        When the reading began.
    """
    return to_json(
        {
            "format": FORMAT,
            "started": started.isoformat(),
            "processing": processing.described(),
            "sums": _SUMS,
            "mean_period": sorted({record.convention for record in records}),
            "records": [
                {
                    "file": record.data.file,
                    "file_sha256": record.data.sha256,
                    "format": record.data.format,
                    "units": record.data.units,
                    "component": record.data.component,
                    "samples": record.data.acceleration.size,
                    "samples_sha256": sha256(record.data.acceleration.astype("<f8").tobytes()),
                    "time_step": record.data.time_step,
                    "notes": record.data.notes,
                }
                for record in records
            ],
            "unread": unread,
            "versions": versions(),
            "machine": machine(),
            "files": {TABLE: sha256(table)},
        }
    )


PULSE_TABLE = "pulses.csv"
_SHAPE = ("gamma", "phase", "cycles")


def pulses_csv(records: Sequence[tuple[Characteristics, Sequence[PulseFit]]]) -> bytes:
    """Table of pulses as CSV.

    Parameters
    ----------
    records : sequence of (Characteristics, sequence of PulseFit)
        The records with their pulses, the best first.
    """
    rows = [_row(record, fit) for record, fits in records for fit in fits]
    return rows_csv([rows[0], *(row.values() for row in rows)])


def _row(record: Characteristics, fit: PulseFit) -> dict[str, object]:
    motion = fit.motion
    return {
        "file": record.data.file,
        "component": record.data.component or "",
        "pulse": fit.kind,
        "a_p": fit.a_p,
        "T_p": fit.T_p,
        "L_e": fit.length,
        "start": getattr(motion, "start"),  # noqa: B009
        "reverse": getattr(motion, "reverse"),  # noqa: B009
        **{key: getattr(motion, key, "") for key in _SHAPE},
        "fitted_to": fit.on,
        "explained": fit.explained,
    }
