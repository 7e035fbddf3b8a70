"""The hard scenes of ``cases/hard`` and what must come out of them."""

import tomllib
from dataclasses import dataclass
from functools import cached_property

from eventpound import Case, load_case
from tests.hard.generated import FOLDER, folder_of

REFUSED = {"endless": "impacts in one instant do not end"}
"""Cases without an answer, and what the refusal must say."""
WARNED = ("chaotic", "event-at-breakpoint", "graze-hit-1e-12", "stiff-beside-soft")
"""Cases whose counts the tolerance cannot tell, as the runs say."""
LONG = (
    *("bounces-for-a-day", "long-yielding-pair", "record-of-a-million-samples", "row-of-200"),
    "stiff-beside-soft",
)
"""Scenes that take a solver many seconds: the tests leave them to ``-m sweep``."""
SOLVERS = ("cvode", "fast", "ida")
"""Those that locate events."""


@dataclass(frozen=True)
class Hard:
    """A hard scene.

    Parameters
    ----------
    name : str
        Its directory.
    values : dict
        Entries of ``summary.json`` by dotted name, where they are known.
    within : float
        What they may be wrong by, absolute.
    solvers : tuple of str
        Those of `SOLVERS` that take such a scene.
    """

    name: str
    values: dict[str, float]
    within: float
    solvers: tuple[str, ...] = SOLVERS

    @cached_property
    def case(self) -> Case:
        """What its directory says."""
        return load_case(folder_of(self.name))


def catalogue() -> list[Hard]:
    """Every hard scene, by name."""
    return [_read(path.name) for path in sorted(FOLDER.iterdir()) if path.is_dir()]


def _read(name: str) -> Hard:
    known = FOLDER / name / "expected.toml"
    expected = tomllib.loads(known.read_text()) if known.is_file() else {}
    solvers = tuple(expected.get("solvers", SOLVERS))
    return Hard(name, expected.get("values", {}), expected.get("within", 0.0), solvers)
