"""The table of a study, read back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.results.jsontext import read_json
from eventpound.results.read import MANIFEST
from eventpound.results.tables import read_columns, to_numbers

if TYPE_CHECKING:
    import pandas as pd

TABLE = "study.csv"
"""Name of the table of a study."""
SUCCESS, MESSAGE = "success", "message"
"""Its last two columns."""


def read_manifest(directory: Path) -> dict[str, object] | None:
    """Manifest of a directory of results; None where there is none that can be read."""
    try:
        return read_json(directory / MANIFEST)
    except InputError:
        return None


def read_table(directory: Path) -> pd.DataFrame:
    """Table of a study.

    Parameters
    ----------
    directory : Path
        Results of a study.

    Returns
    -------
    DataFrame
        As written, a row a run; every number is the double that was written,
        an empty cell NaN.

    Raises
    ------
    InputError
        Where there is none.
    """
    import pandas as pd

    path = directory / TABLE
    if not path.is_file():
        raise InputError(f"{path}: no such file; `eventpound study CASE` writes it")
    cells = read_columns(path)
    columns = {name: _column(path, name, cells[name]) for name in cells}
    return pd.DataFrame(columns)


def _column(path: Path, name: str, cells: list[str]) -> Floats | list[str] | list[bool]:
    """Numbers, where all cells are some or empty, else words."""
    if name == SUCCESS:
        return [cell == "True" for cell in cells]
    try:
        return to_numbers(path, name, cells) if name != MESSAGE else cells
    except InputError:
        return cells
