"""Lines of the history, at output times and at both sides of events."""

from __future__ import annotations

from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events.event_rows import events_wanted
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.run import OUTPUT, ROWS, Piece, Run


@compiled
def rows_wanted(outputs: int, count: Ints) -> int:
    """Rows of the history for which there is to be room, with `outputs` output times in all."""
    return int(count[ROWS] + outputs - count[OUTPUT] + 4)


@compiled
def has_room(run: Run) -> bool:
    """Whether the record can take what one more step may write, at the least."""
    plan, state, record = run.plan, run.state, run.record
    rows = rows_wanted(plan.output_times.size, state.count)
    events = events_wanted(plan.contacts.gap.size, state.count)
    return rows <= record.rows.shape[0] and events <= record.events.shape[0]


@compiled
def _append(source: Floats, count: int, target: Floats, at: int) -> int:
    """Copy numbers into a row; returns the place behind them."""
    for i in range(count):
        target[at + i] = source[i]
    return at + count


@compiled_apart
def write_row(t: float, run: Run) -> None:
    """Add a line to the history."""
    put_row(t, run)


@compiled
def put_row(t: float, run: Run) -> None:
    """As `write_row`, where a call would cost more."""
    plan, state, record, seen = run.plan, run.state, run.record, run.seen
    row = record.rows[state.count[ROWS]]
    state.count[ROWS] += 1
    row[0], row[1] = t, seen.base[0]
    at = 2
    at = _append(seen.u, seen.u.size, row, at)
    at = _append(seen.v, seen.v.size, row, at)
    at = _append(seen.a, seen.a.size, row, at)
    at = _append(seen.z, seen.z.size, row, at)
    at = _append(seen.force, plan.links.springs, row, at)
    at = _append(seen.gap, seen.gap.size, row, at)
    _append(seen.contact_force, seen.gap.size, row, at)


@compiled_apart
def sample_step(t: float, t_end: float, order: int, piece: Piece, run: Run) -> None:
    """History at the output times of a step; `seen` is overwritten."""
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    plan, state = run.plan, run.state
    count, times = state.count, plan.output_times
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        at = times[count[OUTPUT]]
        if at >= t:
            g = ground_acceleration(family, coefficients, samples, at)
            look_apart(at - t, order, g, run)
            write_row(at, run)
        count[OUTPUT] += 1
