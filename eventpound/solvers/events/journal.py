"""The history of a run, as compiled steps and the event loop write it.

Lines are written in the order of time: one at every output time, two at every event. The
array has room for all output times that are left, so that a compiled step never needs more.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import scalar_kernel

PASSED, WRITTEN = 0, 1
"""Places in `Journal.cursor`: output times passed, and lines written."""


class Journal(NamedTuple):
    """Lines of the history and where the next ones go.

    times (n,): output times (s), increasing. rows (m, width): lines, of which the first are
    written. cursor (2,): `PASSED` and `WRITTEN`. damping (S,): of the springs (N s/m).
    """

    times: Floats
    rows: Floats
    cursor: Ints
    damping: Floats


@scalar_kernel
def is_due(t: float, journal: Journal) -> bool:
    """Whether an output time that is not passed lies before t (s)."""
    passed = journal.cursor[PASSED]
    return passed < journal.times.size and journal.times[passed] < t


@scalar_kernel
def write_row(t: float, seen: Observed, journal: Journal) -> None:
    """Add the line of one instant; a spring's force is without the dashpot beside it."""
    row = journal.rows[journal.cursor[WRITTEN]]
    journal.cursor[WRITTEN] += 1
    row[0], row[1] = t, seen.ground[0]
    at = 2
    for values in (seen.u, seen.v, seen.acceleration[0], seen.z[0]):
        for i in range(values.size):
            row[at + i] = values[i]
        at += values.size
    for s in range(journal.damping.size):
        row[at + s] = seen.force[0, s] - journal.damping[s] * seen.elongation[1, s]
    at += journal.damping.size
    for values in (seen.gap[0], seen.contact_force[0]):
        for j in range(values.size):
            row[at + j] = values[j]
        at += values.size
