"""Steps by matrices in a row, as long as the bodies stay in their room.

Nothing happens in such a step and no extreme is exceeded, so there is nothing to take down
but where it ends. Every other step is left to `eventpound.solvers.fast.sample_steps`.
"""

from __future__ import annotations

from eventpound.solvers.events.cascade import SINCE_IMPACT, T
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.elongation import elongations, gap_of
from eventpound.solvers.fast.exact_step import (
    ACCELERATION,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    PULLED,
    X_RATE,
    X,
    propose_by_matrices,
)
from eventpound.solvers.fast.history import sample_step
from eventpound.solvers.fast.run import (
    GUESS,
    OUTPUT,
    STALLED,
    STEPS,
    Piece,
    Plan,
    Run,
    State,
)
from eventpound.solvers.fast.safe_box import forces_stay_inside, set_room, stays_in_room
from eventpound.solvers.fast.sample_forces import linear_accelerations
from eventpound.solvers.fast.sample_line import line_at
from eventpound.solvers.fast.sample_series import expand_linear


@compiled
def stretch(n: int, i: int, segment: int, budget: int, until: float, piece: Piece, run: Run) -> int:
    """Steps of n bodies by table i from the sample `segment`, no more than `budget`.

    Returned is how many were taken, which end at `until` (s) at the latest.
    """
    plan, state, series, running = run.plan, run.state, run.series, run.running
    tables, bodies, u, v = series.tables, series.tables.bodies, state.u, state.v
    set_room(tables, run)
    dt, t, since = tables.step[i], state.clock[T], state.clock[SINCE_IMPACT]
    taken, output = 0, _next_output(plan, state)
    while taken < budget:
        line = line_at(segment + taken, dt, piece, t)
        if not line.end < until:
            break
        for b in range(n):
            bodies[PULLED, b] = bodies[ACCELERATION, b] - line.g
        propose_by_matrices(n, i, line.slope, u, v, tables)
        if not stays_in_room(n, dt, state, tables):
            break
        linear_accelerations(
            n, i, bodies[NEXT_U], bodies[NEXT_V], tables, bodies[NEXT_ACCELERATION]
        )
        if not forces_stay_inside(n, plan, tables, running):
            break
        if output < line.end:
            _arrive(t, since, dt, run)
            write_line(i, line.slope, line.end, piece, run)
            output = _next_output(plan, state)
        for b in range(n):
            u[b], v[b] = bodies[NEXT_U, b], bodies[NEXT_V, b]
            bodies[ACCELERATION, b] = bodies[NEXT_ACCELERATION, b]
        t, since = line.end, since + dt
        taken += 1
    if taken > 0:
        _arrive(t, since, dt, run)
        state.count[STEPS] += taken
        state.count[STALLED] = 0
    return taken


@compiled
def _next_output(plan: Plan, state: State) -> float:
    """Time of the next row of the history (s), 1e300 where there is none."""
    i = state.count[OUTPUT]
    return float(plan.output_times[i]) if i < plan.output_times.size else 1e300


@compiled
def _arrive(t: float, since: float, dt: float, run: Run) -> None:
    """What goes with the displacements and velocities at t (s)."""
    plan, state, series = run.plan, run.state, run.series
    clock, along = state.clock, series.tables.along
    clock[T], clock[SINCE_IMPACT], clock[GUESS] = t, since, dt
    elongations(plan.links.ends, state.u, state.v, along[X], along[X_RATE])
    set_gaps(plan, state)


@compiled
def set_gaps(plan: Plan, state: State) -> None:
    """Gaps and their rates by the displacements and velocities."""
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        state.gap[j], state.gap_rate[j] = gap_of(j, contacts, state.u, state.v)


@compiled_apart
def write_line(i: int, slope: float, t_end: float, piece: Piece, run: Run) -> None:
    """Rows of the history before the end of a step by matrices (s)."""
    plan, state = run.plan, run.state
    order = plan.limits.order
    expand_linear(i, order, slope, run)
    sample_step(state.clock[T], t_end, order, piece, run)
