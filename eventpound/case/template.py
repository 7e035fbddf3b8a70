"""The case that ``eventpound new`` writes: small, commented, ready to run."""

from __future__ import annotations

import json
import os
from importlib.resources import files
from pathlib import Path

from eventpound.case.loading import CASE_FILE
from eventpound.errors import InputError

_TITLES = {
    "oscillator": "An oscillator beside a barrier, under a cosine pulse",
    "bridge": "A bridge of three segments with two joints",
    "buildings": "Two buildings of five and four storeys that pound",
    "isolated": "A building on isolators, with a moat wall on either side",
}
SCENES = tuple(_TITLES)
"""What a case to begin with may be of."""


def write_template(
    directory: str | Path, scene: str = SCENES[0], record: str | Path | None = None
) -> Path:
    """Write a case to begin with.

    Parameters
    ----------
    directory : str or Path
        Made where it is missing.
    scene : str
        One of `SCENES`.
    record : str or Path, optional
        A record in the place of the pulse.

    Returns
    -------
    Path
        The ``case.toml`` written.

    Raises
    ------
    InputError
        Where there is a ``case.toml`` already, or it cannot be written.
    """
    folder = Path(directory)
    file = folder / CASE_FILE
    if file.exists():
        raise InputError(f"{file}: is there already; it is not overwritten")
    temporary = folder / f".{CASE_FILE}.{os.getpid()}.partial"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary.write_text(template(scene, record), encoding="utf-8")
        temporary.replace(file)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to: {error.strerror}") from error
    return file


def template(scene: str = SCENES[0], record: str | Path | None = None) -> str:
    """Text of a case to begin with; `scene` and `record` as for `write_template`."""
    title, motion = _TITLES[scene], _part("pulse")
    if record is not None:
        title = title.replace(", under a cosine pulse", "")
        # A string of JSON is one of TOML.
        motion = _part("record").replace('"NAME.AT2"', json.dumps(str(Path(record).resolve())))
    head = f"{_part('head')}title = {json.dumps(title)}\n"
    return f"{head}\n{motion}\n{_part(scene)}{_part('end')}"


def _part(name: str) -> str:
    """A part of a case, as it is kept beside this module."""
    return (files("eventpound.case") / "templates" / f"{name}.toml").read_text(encoding="utf-8")
