"""The real records beside the checkout as a list that a suite takes.

Their ``index.csv`` says units and time step of every file. What a file says itself
is left to it; where it does not say, the index does; of several components the one
the index names, or the first.
"""

import csv
from pathlib import Path

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.readers import UnstatedError

INDEX = Path(__file__).resolve().parents[3] / "shared" / "records" / "index.csv"


def write_list(folder: Path, index: Path = INDEX) -> tuple[Path, list[str]]:
    """Write ``records.csv``.

    Parameters
    ----------
    folder : Path
        Where it goes.
    index : Path
        The index of the records.

    Returns
    -------
    Path
        The list.
    list of str
        What cannot be read, with the reason.
    """
    with index.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    lines, left_out = ["file,units,time_step,component"], []
    for row in rows:
        path = index.parent / row["file"]
        try:
            units, step, component = _needed(path, row)
        except InputError as error:
            left_out.append(f"{row['file']}: {error}")
            continue
        lines.append(f"{path},{units},{step},{component}")
    target = folder / "records.csv"
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return target, left_out


def _needed(path: Path, row: dict[str, str]) -> tuple[str, str, str]:
    """Units, time step and component as far as the file does not say them."""
    components = ("", row["component"], "#2" if row["component"] == "EW" else "#1")
    said = [(units, step) for units in ("", row["units"]) for step in ("", row["dt_s"])]
    problem: InputError | None = None
    for units, step in said:
        for component in components:
            try:
                read_record(
                    path,
                    units=units or None,
                    time_step=float(step) if step else None,
                    component=component or None,
                )
            except UnstatedError as error:
                problem = error
            except InputError as error:
                problem = problem or error
            else:
                return units, step, component
    assert problem is not None
    raise problem
