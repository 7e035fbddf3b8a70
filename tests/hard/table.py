"""The catalogue as a table, as text and as CSV."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from tests.hard.catalogue import SOLVERS, Hard
from tests.hard.outcome import Verdict, outcome, verdict

CHECKED = SOLVERS[1:]
"""Solvers whose digits are counted, from the first one's."""


@dataclass(frozen=True)
class Row:
    """A scene."""

    name: str
    verdict: Verdict


def row(hard: Hard) -> Row:
    """Run a scene by every solver."""
    return Row(hard.name, verdict(hard, [outcome(hard, solver) for solver in hard.solvers]))


def head() -> str:
    """Titles of the text."""
    cells = [f"{'scene':<31}", f"{'word':<7}", *(f"{f'{s} digits':>11}" for s in CHECKED)]
    return "  ".join([*cells, "remark"])


def line(row: Row) -> str:
    """A scene in the text."""
    shown = [str(row.verdict.digits.get(solver, "-")) for solver in CHECKED]
    cells = [f"{row.name:<31}", f"{row.verdict.word:<7}", *(f"{text:>11}" for text in shown)]
    return "  ".join([*cells, row.verdict.remark]).rstrip()


def write(rows: Iterable[Row], path: Path) -> None:
    """The same, in full, as CSV."""
    titles = ["scene", "word", *(f"{s}_digits" for s in CHECKED), "remark"]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(titles)
        for each in rows:
            found = [each.verdict.digits.get(solver, "") for solver in CHECKED]
            writer.writerow([each.name, each.verdict.word, *found, each.verdict.remark])
