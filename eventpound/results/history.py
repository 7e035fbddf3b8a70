"""``history.csv``: the motion at the output times and, before and after, at events.

Columns: ``t`` (s), ``a_g`` (m/s^2); ``u.<body>`` (m) and ``v.<body>`` (m/s)
relative to the ground, ``a.<body>`` (m/s^2) absolute; ``z.<spring>`` (-);
``force.<spring>`` (N); ``gap.<contact>`` (m); ``lambda.<contact>`` (N); ``s.<support>``,
``sv.<support>`` (m, m/s) relative to the ground, ``sf.<support>``, the force on it (N).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.errors import InputError
from eventpound.results.tables import read_columns, to_numbers

if TYPE_CHECKING:
    import pandas as pd


def read_history(path: Path) -> pd.DataFrame:
    """Table of a motion from a CSV file, ours or another program's of the same form.

    Parameters
    ----------
    path : Path
        The file; it needs a column ``t`` and numbers in every cell.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    import pandas as pd

    columns = read_columns(path)
    if "t" not in columns:
        raise InputError(f"{path}: has no column 't'; its columns begin with {list(columns)[:6]}")
    return pd.DataFrame({name: to_numbers(path, name, cells) for name, cells in columns.items()})
