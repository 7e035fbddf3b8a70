"""The two forms of a table of many runs: its files, and what a row tells beside its quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import ClassVar

import numpy as np

from eventpound.case.suite import Member
from eventpound.numerics.arrays import Floats
from eventpound.study.records import FAILED, about, peak_errors, reason
from eventpound.study.runs import Results

TABLE, MANIFEST = "study.csv", "manifest.json"
SUITE_TABLE, SUITE_MANIFEST = "suite.csv", "suite.json"
"""Names of the files."""
SUCCESS, MESSAGE = "success", "message"
"""Last two columns of the table of a study."""
_SECONDS, _ERRORS = "seconds.solve", "error_estimate"
"""Of that of a suite."""
_FINAL = "t_final"
Told = Mapping[str, object]
"""What a row tells of its record."""


@dataclass(frozen=True)
class OfStudy:
    """The table of a study: whether each run succeeded, else why not."""

    table: ClassVar[str] = TABLE
    manifest: ClassVar[str] = MANIFEST
    whole: ClassVar[bool] = True
    """Whether there is no table before all runs are made."""
    binary: ClassVar[bool] = True
    """Whether it is written as Parquet, too."""

    def described(self) -> dict[str, object]:
        """What of it decides the numbers of the table."""
        return {}

    def last_columns(self, ran: bool) -> list[str]:
        """Columns behind the quantities, where there are runs and where there are none."""
        return [SUCCESS, MESSAGE]

    def told(self, records: Sequence[Member]) -> list[Told]:
        """What rows tell of their records, a row each, where rows are one a record."""
        return []

    def numbers(
        self, part: Results, found: Mapping[str, Floats], solver: str, rtol: float
    ) -> Mapping[str, Floats]:
        """Numbers of some runs by their columns, from the quantities that were found."""
        return found

    def outcome(
        self, told: Sequence[Told], said: Sequence[str | None], columns: Sequence[str]
    ) -> dict[str, Sequence[object]]:
        """Cells that tell how runs ended, from why each failed, None where it did not."""
        texts = [" ".join((text or "").split()) for text in said]
        return {SUCCESS: [text is None for text in said], MESSAGE: texts}


@dataclass(frozen=True)
class OfSuite(OfStudy):
    """The table of a suite: a row tells all of its record, and why there are no numbers.

    Parameters
    ----------
    sa : tuple of float, optional
        Period (s) and damping at which Sa of each record is given, PGV beside it; else neither.
    errors : bool
        Whether errors of the peaks are estimated.
    """

    sa: tuple[float, float] | None = None
    errors: bool = False
    table: ClassVar[str] = SUITE_TABLE
    manifest: ClassVar[str] = SUITE_MANIFEST
    whole: ClassVar[bool] = False
    binary: ClassVar[bool] = False

    def described(self) -> dict[str, object]:
        """What is asked for beside the quantities."""
        return {"suite": asdict(self)}

    def last_columns(self, ran: bool) -> list[str]:
        """Time and error of each run."""
        return [_SECONDS] * ran + [_ERRORS] * (ran and self.errors)

    def told(self, records: Sequence[Member]) -> list[Told]:
        """All that is known of each record."""
        return [about(member, self.sa) for member in records]

    def numbers(
        self, part: Results, found: Mapping[str, Floats], solver: str, rtol: float
    ) -> Mapping[str, Floats]:
        """Those of runs that succeeded, and what a suite tells of each run."""
        columns = {**found, _SECONDS: part.seconds}
        if self.errors:
            columns[_ERRORS] = peak_errors(part, solver, rtol)
        good = part.many.success
        return {n: v if n == _FINAL else np.where(good, v, np.nan) for n, v in columns.items()}

    def outcome(
        self, told: Sequence[Told], said: Sequence[str | None], columns: Sequence[str]
    ) -> dict[str, Sequence[object]]:
        """Cells of the columns of records, and why there are no numbers."""
        cells: dict[str, Sequence[object]] = {
            name: [_plain(row.get(name)) for row in told] for name in columns
        }
        pairs = zip(told, said, strict=True)
        failed = [row[FAILED] or reason(text or "", str(row["file"])) for row, text in pairs]
        return cells | {FAILED: failed}


def _plain(value: object) -> object:
    """A cell; nothing of what is not known."""
    return "" if value is None or value != value else value
