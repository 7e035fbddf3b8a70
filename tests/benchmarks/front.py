"""The table of the first page: ``python -m tests.benchmarks.front``.

One run of `cases/bridge-el-centro` by programs in turns. The error is that of the largest
displacement of a segment, in parts of it, against `fast` at rtol 1e-13; the time is the least
processor time of some turns. OpenSeesPy, where it is installed, has a Kelvin-Voigt spring in the
place of Newton's law.
"""

from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from eventpound import Case, load_case
from eventpound.numerics.arrays import Floats
from eventpound.solvers.opensees import PACKAGE
from tests.benchmarks.peers.bridge import CASE, peaks, with_spring

TIGHT = 1e-13
RUNS = (("fast", 1e-4), ("fast", 1e-9), ("cvode", 1e-9))
SPRINGS = ((1e9, 1e-3), (1e10, 1e-4))
"""Stiffness of the contact (N/m) and time step (s)."""
TURNS = 2


@dataclass(frozen=True)
class Row:
    """A program, the contact as it takes it, the case and what it is run by."""

    program: str
    contact: str
    case: Case
    solver: str
    options: dict[str, Any]

    def turn(self) -> tuple[Floats | None, float]:
        """Peaks (m) and processor time (s)."""
        return peaks(self.case, self.solver, **self.options)


def rows(case: Case) -> list[Row]:
    """What is run here."""
    ours = [
        Row(f"`{solver}`, rtol {rtol:.0e}", "Newton's law", case, solver, {"rtol": rtol})
        for solver, rtol in RUNS
    ]
    theirs = [
        Row(
            f"OpenSees, steps of {1e3 * step:g} ms",
            f"spring of {stiffness:.0e} N/m",
            with_spring(case, stiffness),
            "opensees",
            {"settings": {"time_step": step}},
        )
        for stiffness, step in SPRINGS
    ]
    return ours if find_spec(PACKAGE) is None else ours + theirs


def main() -> None:
    """Print the table."""
    case = load_case(CASE)
    programs = rows(case)
    true, _ = peaks(case, "fast", rtol=TIGHT)
    turns = [[row.turn() for row in programs] for _ in range(TURNS)]
    print("| program | contact | peaks off by | time of a run |\n| --- | --- | --- | --- |")
    for row, tries in zip(programs, zip(*turns, strict=True), strict=True):
        found, _ = tries[0]
        far = "fails" if found is None else f"{100 * float(np.abs(found / true - 1.0).max()):.2g} %"
        print(f"| {row.program} | {row.contact} | {far} | {_time(min(s for _, s in tries))} |")


def _time(seconds: float) -> str:
    return f"{1e3 * seconds:.0f} ms" if seconds < 1.0 else f"{seconds:.2g} s"


if __name__ == "__main__":
    main()
