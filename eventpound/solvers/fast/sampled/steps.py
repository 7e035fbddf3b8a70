"""Several bodies under a record, step by step as long as little happens.

From sample to sample the bodies go by exact steps (`eventpound.solvers.fast.sampled.exact`)
as long as all their links are linear and they stay in their box: nothing happens in such a step
and no extreme is exceeded, so there is nothing to take down but where it ends. Else they go by
short series (`eventpound.solvers.fast.sampled.series`), where a step is clear of all but simple
events (`eventpound.solvers.fast.sampled.choice`); any other is left to
`eventpound.solvers.fast.step`.
"""

from __future__ import annotations

from eventpound.motion.forcing import CurrentPiece
from eventpound.numerics.borrowing import copy_numbers
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.extremes import take_all
from eventpound.solvers.fast.links import elongations, gap_of, saturate
from eventpound.solvers.fast.record import end_if_over, is_due, next_output, pass_time, sample_step
from eventpound.solvers.fast.run import FastPlan, FastRun, FastState
from eventpound.solvers.fast.sampled.bounds import CLOSING, NOTHING, forces_covered
from eventpound.solvers.fast.sampled.choice import (
    ProposedStep,
    clear_step,
    do_event,
)
from eventpound.solvers.fast.sampled.exact import MOST_TURN, propose_by_matrices
from eventpound.solvers.fast.sampled.forces import (
    GroundLine,
    accelerations_now,
    begin,
    line_at,
    linear_accelerations,
)
from eventpound.solvers.fast.sampled.safe_box import set_safe_box, stays_in_safe_box
from eventpound.solvers.fast.sampled.series import expand_linear
from eventpound.solvers.fast.sdof.series import sample_after
from eventpound.tolerances import SAME_SAMPLE


@compiled
def table_steps(
    n: int, i: int, segment: int, budget: int, until: float, piece: CurrentPiece, run: FastRun
) -> int:
    """Steps of n bodies by table i from the sample `segment`, no more than `budget`.

    Returned is how many were taken, which end at `until` (s) at the latest.
    """
    plan, state, series, running = run.plan, run.state, run.series, run.running
    tables, bodies, u, v = series.tables, series.tables.bodies, state.u, state.v
    set_safe_box(tables, run)
    dt, t, taken, counted = tables.step[i], state.now[0].t, 0, 0
    output = next_output(plan.output_times, state.progress[0])
    while taken < budget:
        line = line_at(segment + taken, piece, t)
        if not line.end < until:
            break
        for b in range(n):
            bodies.pulled[b] = bodies.acceleration[b] - line.g
        propose_by_matrices(n, i, line.slope, u, v, tables)
        if not stays_in_safe_box(n, dt, state, tables):
            break
        linear_accelerations(n, i, bodies.next_u, bodies.next_v, tables, bodies.next_acceleration)
        if not forces_covered(n, plan.mass, tables, running):
            break
        if output < line.end:
            _arrive(t, taken - counted, dt, run)
            counted = taken
            write_line(i, line.slope, line.end, piece, run)
            output = next_output(plan.output_times, state.progress[0])
        for b in range(n):
            u[b], v[b] = bodies.next_u[b], bodies.next_v[b]
            bodies.acceleration[b] = bodies.next_acceleration[b]
        t, taken = line.end, taken + 1
    if taken > 0:
        _arrive(t, taken - counted, dt, run)
    return taken


@compiled
def _arrive(t: float, steps: int, dt: float, run: FastRun) -> None:
    """What goes with the displacements and velocities at t (s), after some steps."""
    plan, state, along = run.plan, run.state, run.series.tables.along
    state.progress[0].trial = dt
    pass_time(steps * dt, t, steps, state.now[0], state.progress[0])
    elongations(plan.links.ends, state.u, state.v, along.x, along.x_rate)
    set_gaps(plan, state)


@compiled
def set_gaps(plan: FastPlan, state: FastState) -> None:
    """Gaps and their rates by the displacements and velocities."""
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        state.gap[j], state.gap_rate[j] = gap_of(j, contacts, state.u, state.v)


@compiled_noinline
def write_line(i: int, slope: float, t_end: float, piece: CurrentPiece, run: FastRun) -> None:
    """Rows of the history before the end of a step by matrices (s)."""
    plan, state = run.plan, run.state
    order = plan.limits.order
    expand_linear(i, order, slope, run)
    sample_step(state.now[0].t, t_end, order, piece, run)


@compiled
def may_go_by_samples(run: FastRun) -> bool:
    """Whether every body moves freely, and there are few enough of them."""
    plan, state, series = run.plan, run.state, run.series
    if state.progress[0].resting > 0 or plan.limits.ledger or series.tables.turn.shape[1] == 0:
        return False
    for b in range(state.u.size):
        if series.of_body[b] != b:
            return False
    return True


@compiled
def sample_steps(budget: int, piece_end: float, piece: CurrentPiece, run: FastRun) -> None:
    """Steps, as far as nothing but what ends a step can happen, and no more than `budget`.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them. A contact that has closed is due next.
    """
    state, dt = run.state, piece.coefficients[1]
    rounding, now, progress = SAME_SAMPLE * dt, state.now[0], state.progress[0]
    i, fresh = begin(dt, run), True
    until, last = piece_end - rounding, progress.steps + budget
    _, segment = sample_after(now.t, piece_end, piece)
    while progress.steps < last and progress.due == 0:
        line = line_at(segment, piece, now.t)
        if not (line.end < until and now.t + rounding < line.end):
            break
        linear = _is_straight(i, run) and line.since == 0.0
        if linear and fresh and now.in_a_row == 0:
            taken = _table_steps(i, segment, last - progress.steps, until, piece, run)
            fresh, segment = False, segment + taken
            if taken > 0:
                continue
        step = clear_step(i, line, run)
        if step.order == 0:
            break
        whole = step.h == line.end - now.t
        _take(step, line, line.end if whole else now.t + step.h, piece, run)
        fresh, segment = True, segment + 1 if whole else segment
        if step.what != NOTHING:
            i = begin(dt, run)


@compiled
def _is_straight(i: int, run: FastRun) -> bool:
    """Whether all links are linear at present and table i is good; saturates links that are due."""
    plan, state, series = run.plan, run.state, run.series
    tables = series.tables
    curved, changed = saturate(tables.along.x, plan.hysteresis, state)
    if changed:
        accelerations_now(i, run)
    return not curved and tables.most_turn[i] <= MOST_TURN


@compiled
def _table_steps(
    i: int, segment: int, budget: int, until: float, piece: CurrentPiece, run: FastRun
) -> int:
    """As `table_steps`, whose loops over bodies the compiler unrolls where there are two."""
    state = run.state
    if state.u.size == 2:
        return table_steps(2, i, segment, budget, until, piece, run)
    return table_steps(state.u.size, i, segment, budget, until, piece, run)


@compiled
def _take(
    step: ProposedStep, line: GroundLine, t_end: float, piece: CurrentPiece, run: FastRun
) -> None:
    """Take a step, which ends at t_end (s), and do what happens there."""
    if is_due(t_end, run.plan.output_times, run.state.progress[0]):
        sample_step(run.state.now[0].t, t_end, step.order, piece, run)
    _accept(step, t_end, run)
    if step.what != NOTHING:
        g = line.g + line.slope * step.h
        do_event(step.what, step.which, g, run)


@compiled
def _accept(step: ProposedStep, t: float, run: FastRun) -> None:
    """Make the end of the step, at t (s), the present state, and take it into the extremes."""
    plan, state, tables = run.plan, run.state, run.series.tables
    bodies, along, progress, shear = tables.bodies, tables.along, state.progress[0], 0.0
    copy_numbers(bodies.next_acceleration, bodies.acceleration)
    copy_numbers(along.next_x, along.x)
    copy_numbers(along.next_x_rate, along.x_rate)
    progress.trial = step.h
    pass_time(step.h, t, 1, state.now[0], progress)
    for b in range(state.u.size):
        state.u[b], state.v[b] = bodies.next_u[b], bodies.next_v[b]
        shear -= plan.mass[b] * bodies.acceleration[b]
    set_gaps(plan, state)
    if step.what == CLOSING:
        state.gap[step.which] = 0.0
    elif step.what == NOTHING:
        end_if_over(run)
    take_all(state.u, bodies.acceleration, state.gap, shear, t, run)
