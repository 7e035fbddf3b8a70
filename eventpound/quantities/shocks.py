"""The shocks of a sequence of records, as runs of their own.

Each begins in the state in which the whole run has it begin and ends where the next begins, so that
extremes, impacts and what is left are those of one shock.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from eventpound.motion.record import Record
from eventpound.quantities.rows import SIDES, Rerun, rows_at
from eventpound.scene.continuation import FinalState, state_of
from eventpound.solvers.base import Task


def shocks_of(task: Task, rerun: Rerun) -> list[tuple[Task, FinalState | None]]:
    """A task for each shock that begins within one, and the state that it goes on from.

    None where there is one record only; the first goes on from nothing.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task; a failure is a ComputationError.
    """
    scene, motion = task.scene, task.scene.motion
    begins = motion.begins[1:] if isinstance(motion, Record) else np.empty(0)
    begins = begins[(begins > task.start) & (begins < task.end)]
    if not begins.size:
        return []
    run, places = rows_at(task, rerun, begins, SIDES[0])
    h = run.history
    states = [None, *(state_of(scene, h.u[i], h.v[i], h.z[i]) for i in places)]
    ends = pairwise([task.start, *begins.tolist(), task.end])
    parts = [replace(task, start=a, end=b, output_times=np.empty(0)) for a, b in ends]
    return list(zip(parts, states, strict=True))
