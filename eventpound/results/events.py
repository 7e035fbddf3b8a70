"""``events.csv``: one row for every contact of every event.

Columns: ``t`` (s), ``kind``, ``group``, ``contact``, ``gap_velocity_before``
and ``gap_velocity_after`` (m/s), ``impulse`` (N s), ``energy_lost`` (J),
``count``.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.errors import InputError
from eventpound.response import EVENT_COLUMNS
from eventpound.results.tables import read_columns, to_numbers

if TYPE_CHECKING:
    import pandas as pd

_WORDS = ("kind", "contact")
_COUNTS = ("group", "count")


def read_events(path: Path) -> pd.DataFrame:
    """Table of events from a CSV file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    import pandas as pd

    columns = read_columns(path)
    missing = [name for name in EVENT_COLUMNS if name not in columns]
    if missing:
        raise InputError(f"{path}: has no column {', '.join(missing)}")
    table = {}
    for name in EVENT_COLUMNS:
        if name in _WORDS:
            table[name] = pd.Series(columns[name], dtype=str)
        else:
            numbers = pd.Series(to_numbers(path, name, columns[name]))
            table[name] = numbers.astype(int) if name in _COUNTS else numbers
    return pd.DataFrame(table)
