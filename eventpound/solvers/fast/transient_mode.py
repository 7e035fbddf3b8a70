"""A mode that is none: it ends as soon as a contact has come to rest (`FLEETING`).

What it left in history and extremes is taken back, and no time passes in it.
"""

from __future__ import annotations

from eventpound.solvers.events.cascade import FLEETING, RESTED_AT, T
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.run import HELD, ROWS, Plan, Run, State


@compiled
def is_fleeting(tau: float, plan: Plan, state: State) -> bool:
    """Whether a mode that ends after tau (s) is none: a contact has only just come to rest."""
    since = state.clock[T] - state.clock[RESTED_AT]
    return bool(since + tau < FLEETING * plan.limits.time)


@compiled_apart
def hold(run: Run) -> None:
    """Remember history and extremes as they are before a mode that may be none."""
    plan, state, series, record = run.plan, run.state, run.series, run.record
    if not is_fleeting(0.0, plan, state):
        return
    state.count[HELD] = state.count[ROWS]
    for row in range(series.held.shape[0]):
        for i in range(record.extremes.shape[1]):
            series.held[row, i] = record.extremes[row, i]


@compiled_apart
def forget(run: Run) -> None:
    """Take back what has come into history and extremes since `hold`."""
    state, series, record = run.state, run.series, run.record
    state.count[ROWS] = state.count[HELD]
    for row in range(series.held.shape[0]):
        for i in range(record.extremes.shape[1]):
            record.extremes[row, i] = series.held[row, i]
