"""The table of a study or a suite: its rows as text, chunk by chunk, and read back.

The rows of a chunk depend on nothing but the plan and the chunk: not on the number of workers,
nor on what ran before; but for the times that a suite tells.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.basics.input_files import read_columns, to_numbers
from eventpound.case.suite import Member
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.quantities.lookup import is_whole
from eventpound.response import Response
from eventpound.results.jsontext import read_json
from eventpound.results.run_files import read_manifest as read_stated
from eventpound.results.tables import rows_csv
from eventpound.study.base import RECORD
from eventpound.study.forms import (
    MANIFEST,
    MESSAGE,
    SUCCESS,
    SUITE_MANIFEST,
    SUITE_TABLE,
    TABLE,
    Told,
)
from eventpound.study.plan import Chunk, Plan
from eventpound.study.records import FAILED
from eventpound.study.runs import Refused, Results, runs_in_parts
from eventpound.study.sweep import WantedRuns
from eventpound.study.variants import axis_cells

if TYPE_CHECKING:
    import pandas as pd

SUITE_FORMAT = "eventpound-suite/1"
"""Name and number of the form of the files of a suite."""
_WORDS = {RECORD, "file", FAILED, MESSAGE, "event", "date", "station", "component", "format"} | {
    "sha256",
    "notes",
}
Keep = Callable[[Member, Response], None]
"""Called with a record and its response, all rows of the history in it."""
Cells = Mapping[str, Sequence[object]]


def column_names(study: Plan) -> list[str]:
    """Names of the columns."""
    ran = any(base.case.scene.bodies for base in study.bases)
    return [*study.columns, *study.quantities, *study.form.last_columns(ran)]


def header(study: Plan) -> bytes:
    """Line of the names of the columns."""
    return rows_csv([column_names(study)])


def compute(study: Plan, chunk: Chunk, keep: Keep | None = None) -> bytes:
    """Run a chunk.

    Parameters
    ----------
    study : Plan
        Whose chunk it is.
    chunk : Chunk
        Which one.
    keep : callable, optional
        Given every record and its response.

    Returns
    -------
    bytes
        Its rows, CSV.
    """
    base, low, high = study.bases[chunk.base], chunk.low, chunk.high
    told = study.form.told(base.records[low:high])
    if not base.case.scene.bodies:
        return rows_csv([row.get(name, "") for name in column_names(study)] for row in told)
    own = None if keep is None else lambda i, response: keep(base.records[i], response)
    wanted = WantedRuns(study.solver, study.rtol, study.quantities, keep=own)
    rows: list[bytes] = []
    for part in runs_in_parts(base, low, high, wanted):
        at = part.at if isinstance(part, Refused) else part.rows.at
        own_told = told[at.start - low : at.stop - low]
        cells = _cells_of(study, part, own_told)
        empty = [""] * len(at)
        columns = (cells.get(name, empty) for name in column_names(study))
        rows.append(rows_csv(zip(*columns, strict=True)))
    return b"".join(rows)


def _cells_of(
    study: Plan, part: Results | Refused, told: Sequence[Told]
) -> dict[str, Sequence[object]]:
    """Cells of some rows by their columns, of those that they have."""
    said: list[str | None]
    if isinstance(part, Refused):
        cells, said = axis_cells(part.base, part.at), [str(part.error)] * len(part.at)
    else:
        # An estimate that fails marks its run as failed.
        cells = axis_cells(part.rows.base, part.rows.at) | _numbers_of(study, part)
        ended = zip(part.many.success.tolist(), part.many.message, strict=True)
        said = [None if good else text for good, text in ended]
    return cells | study.form.outcome(told, said, study.columns)


def _numbers_of(study: Plan, part: Results) -> dict[str, Sequence[object]]:
    """Cells of the numbers of some runs."""
    found = {name: part.quantity(name) for name in study.quantities}
    columns = {name: values for name, values in found.items() if values is not None}
    whole = study.form.numbers(part, columns, study.solver, study.rtol)
    return {name: _cells(name, values) for name, values in whole.items()}


def _cells(name: str, values: Floats) -> list[object]:
    """Cells of a column; nothing where a run has no such number, counts as whole numbers."""
    kind = int if is_whole(name) else None
    return ["" if v != v else kind(v) if kind else v for v in values.tolist()]


def manifest_there(directory: Path, name: str = MANIFEST) -> dict[str, object] | None:
    """Manifest of a directory of results; None where there is none that can be read."""
    try:
        return read_json(directory / name)
    except InputError:
        return None


def table_there(directory: Path) -> str:
    """Name of the table of a suite, else of a study, in a directory; empty where there is none."""
    return next((name for name in (SUITE_TABLE, TABLE) if (directory / name).is_file()), "")


def read_many(out: Path) -> tuple[pd.DataFrame, list[Mapping[str, Any]]]:
    """The table of a suite or a study, and each ``[excitation]`` it was made with.

    Raises
    ------
    InputError
        Where there is none.
    """
    name = table_there(out)
    if not name:
        writes = "`eventpound study` or `eventpound run` of a suite writes it"
        raise InputError(f"{out}: neither {TABLE} nor {SUITE_TABLE}; {writes}")
    if name == SUITE_TABLE:
        table, manifest = read_suite(out)
        return table, [manifest["case"].get("excitation", {})]
    scenes: Any = (manifest_there(out) or {}).get("scenes", [])
    return read_table(out), [scene["case"].get("excitation", {}) for scene in scenes]


def read_table(directory: Path, name: str = TABLE) -> pd.DataFrame:
    """Table of a study or a suite.

    Parameters
    ----------
    directory : Path
        Results.
    name : str
        Of the file.

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

    path = directory / name
    if not path.is_file():
        raise InputError(f"{path}: no such file; `eventpound study CASE` writes it")
    cells = read_columns(path)
    return pd.DataFrame({key: _column(path, key, cells[key]) for key in cells})


def read_suite(directory: str | os.PathLike[str]) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Results of a suite from its directory.

    Parameters
    ----------
    directory : path
        Results.

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
    folder = Path(directory)
    if lacking := [n for n in (SUITE_MANIFEST, SUITE_TABLE) if not (folder / n).is_file()]:
        raise InputError(
            f"{folder}: holds no complete results of a suite: {', '.join(lacking)} missing"
        )
    manifest = read_stated(folder / SUITE_MANIFEST, SUITE_FORMAT, [SUITE_TABLE])
    if lacking := [key for key in ("case", "options") if not isinstance(manifest.get(key), dict)]:
        raise InputError(f"{folder / SUITE_MANIFEST}: has no table {', '.join(lacking)}")
    return read_table(folder, SUITE_TABLE), manifest


def _column(path: Path, name: str, cells: list[str]) -> Floats | Ints | list[str] | list[bool]:
    """Numbers, where all cells are some or empty, else words."""
    if name == SUCCESS:
        return [cell == "True" for cell in cells]
    if name.partition(".")[0] in _WORDS:
        return cells
    try:
        numbers = to_numbers(path, name, cells)
    except InputError:
        return cells
    whole = (name == "samples" or is_whole(name)) and not np.isnan(numbers).any()
    return numbers.astype(np.int64) if whole else numbers
