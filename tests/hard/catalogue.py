"""The hard scenes of ``cases/hard`` and what must come out of them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from eventpound import load_case
from eventpound.case import Case

FOLDER = Path(__file__).parents[2] / "cases" / "hard"
REFUSED = {
    "endless": "impacts in one instant do not end",
}
"""Cases without an answer, and what the refusal must say."""


@dataclass(frozen=True)
class Hard:
    """A hard scene.

    Parameters
    ----------
    name : str
        Its directory.
    case : Case
        What it says.
    values : dict
        Entries of ``summary.json`` by dotted name, where they are known.
    within : float
        What they may be wrong by, absolute.
    """

    name: str
    case: Case
    values: dict[str, float]
    within: float


def catalogue() -> list[Hard]:
    """Every hard scene, by name."""
    return [_read(path) for path in sorted(FOLDER.iterdir()) if path.is_dir()]


def _read(path: Path) -> Hard:
    known = path / "expected.toml"
    expected = tomllib.loads(known.read_text()) if known.is_file() else {}
    return Hard(path.name, load_case(path), expected.get("values", {}), expected.get("within", 0.0))
