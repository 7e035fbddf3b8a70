"""What a single body leaves in its record: lines of the history, and extremes.

Displacement, spring elongations and gaps have their extremes where the body turns and
where a stretch ends; without dashpots so have acceleration and base shear, for
the spring forces grow with the displacement. Only with dashpots the acceleration is
looked at within each step. The order is that of
`eventpound.solvers.events.event_bounds.Running`.
"""

from __future__ import annotations

from eventpound.motion.forcing import ground_acceleration
from eventpound.solvers.events.event_bounds import (
    SETTLED,
    Running,
    update_beyond,
    update_extreme,
    update_turning_point,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.extremes import turning_times
from eventpound.solvers.fast.run import OUTPUT, ROWS, Piece
from eventpound.solvers.fast.single.body import (
    SingleRun,
    absolute_acceleration,
    spring_state,
)
from eventpound.solvers.fast.single.series import motion


@compiled_apart
def write_single_row(
    t: float, g: float, change: float, v: float, a: float, z: float, run: SingleRun
) -> None:
    """Add a line to the history: what `eventpound.solvers.fast.record.write_row` writes.

    Parameters
    ----------
    t, g : float
        Time (s) and acceleration of the ground (m/s²).
    change, v, a : float
        Displacement beyond the present one (m), velocity, absolute acceleration.
    z : float
        ``σ y``.
    run : SingleRun
        The run, with the present gaps and contact forces.
    """
    body, contacts = run.body, run.contacts.gap.size
    row, u = run.rows[run.count[ROWS]], body.u + change
    row[0], row[1], row[2], row[3], row[4] = t, g, u, v, a
    at = 5
    if run.body.whole != 0.0:
        row[at] = run.body.whole * z
        at += 1
    for s in range(run.links.springs):
        x = u if run.links.ends[s, 1] >= 0 else -u
        row[at] = run.links.extension[s] * (x - run.links.offset[s])
        if run.links.z_of_link[s] >= 0:
            row[at] += run.links.law.strength[s] * row[5]
        at += 1
    right, left = run.oscillator.right, run.oscillator.left
    if right >= 0:
        row[at + right] = body.right - change
        row[at + contacts + right] = body.right_force
    if left >= 0:
        row[at + left] = body.left + change
        row[at + contacts + left] = body.left_force
    run.count[ROWS] += 1


@compiled
def write_present(t: float, g: float, run: SingleRun) -> None:
    """Add the present state to the history."""
    body = run.body
    if run.rows.shape[1] > 0:
        write_single_row(t, g, 0.0, body.v, g if body.rests_on != 0.0 else body.a, body.z, run)


@compiled_apart
def sample_single(
    t: float,
    t_end: float,
    order: int,
    piece: Piece,
    run: SingleRun,
) -> bool:
    """History at the output times of a step; False where the record has no room."""
    count, times, body = run.count, run.times, run.body
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        now = times[count[OUTPUT]]
        if now >= t:
            if count[ROWS] + 4 > run.rows.shape[0]:
                return False
            change, v, _ = motion(now - t, order, body)
            u = body.u + change
            z = spring_state(u, run.table, body)
            a = absolute_acceleration(u, v, z, body)
            g = ground_acceleration(piece, now)
            write_single_row(now, g, change, v, a, z, run)
        count[OUTPUT] += 1
    return True


@compiled
def exceeds(i: int, low: float, high: float, running: Running) -> bool:
    """Whether a quantity that may reach `low` and `high` may leave its extremes."""
    same = running.rounding[i]
    return high > running.maximum[i] + same or low < running.minimum[i] - same


@compiled
def place_of_acceleration(run: SingleRun) -> int:
    """Place of the absolute acceleration; base shear and contact forces follow it."""
    return 1 + run.links.springs + run.contacts.gap.size


@compiled
def force_exceeds(low: float, high: float, run: SingleRun) -> bool:
    """Whether the absolute acceleration (m/s²), or the base shear it makes, may leave its extremes.

    The two are apart once the body has rested on a barrier.
    """
    i, mass = place_of_acceleration(run), run.body.mass
    return exceeds(i, low, high, run.running) or exceeds(
        i + 1, -mass * high, -mass * low, run.running
    )


@compiled_apart
def take_turn(t: float, u: float, acceleration: float, run: SingleRun) -> None:
    """Take a turning point, or the end of a stretch, at t (s) into the extremes."""
    body, running, springs = run.body, run.running, run.links.springs
    near = body.flat_time
    update_turning_point(0, u, t, near, running)
    for a in range(springs):
        x = u if run.links.ends[a, 1] >= 0 else -u
        update_turning_point(1 + a, x, t, near, running)
    right, left = run.oscillator.right, run.oscillator.left
    if right >= 0:
        update_turning_point(1 + springs + right, body.right_gap - u, t, near, running)
    if left >= 0:
        update_turning_point(1 + springs + left, body.left_gap + u, t, near, running)
    i = place_of_acceleration(run)
    update_extreme(i, acceleration, t, running)
    update_extreme(i + 1, -body.mass * acceleration, t, running)


@compiled
def take_if_new(t: float, u: float, acceleration: float, run: SingleRun) -> None:
    """The same where it is beyond, or just at, the extremes so far."""
    running = run.running
    same = 2.0 * running.rounding[0]
    if (
        u > running.maximum[0] - same
        or u < running.minimum[0] + same
        or force_exceeds(acceleration, acceleration, run)
    ):
        take_turn(t, u, acceleration, run)


@compiled_apart
def take_settled(t: float, acceleration: float, run: SingleRun) -> None:
    """Take a settled instant: places just put on their constraints, and what jumps in it.

    `acceleration` is absolute (m/s²): that of the ground where the body rests.
    """
    body, running, springs = run.body, run.running, run.links.springs
    u = body.u
    _attain(0, u, t, running)
    for a in range(springs):
        _attain(1 + a, u if run.links.ends[a, 1] >= 0 else -u, t, running)
    right, left = run.oscillator.right, run.oscillator.left
    if right >= 0:
        _attain(1 + springs + right, body.right, t, running)
    if left >= 0:
        _attain(1 + springs + left, body.left, t, running)
    i = place_of_acceleration(run)
    update_extreme(i, acceleration, t, running)
    update_extreme(i + 1, -body.mass * body.a, t, running)
    if right >= 0:
        update_extreme(i + 2 + right, body.right_force, t, running)
    if left >= 0:
        update_extreme(i + 2 + left, body.left_force, t, running)


@compiled
def _attain(i: int, value: float, t: float, running: Running) -> None:
    update_beyond(i, value, t, SETTLED * running.rounding[i], running)


@compiled
def damped_acceleration(t: float, tau: float, order: int, run: SingleRun) -> None:
    """Turning points of acceleration and base shear within a step, and their values at its end."""
    body, d, spread = run.body, run.scratch.rate, 0.0
    for k in range(order - 2, 0, -1):
        term = (k + 1) * (k + 2) * body.x[k + 2] + body.ground[k] * (
            body.odd if k & 1 else body.even
        )
        d[k - 1] = k * term
        spread = (spread + abs(term)) * tau
    if force_exceeds(body.a - spread, body.a + spread, run):
        _take_acceleration(t, tau, order, run)


@compiled_deferred
def _take_acceleration(t: float, tau: float, order: int, run: SingleRun) -> None:
    body, running, i = run.body, run.running, place_of_acceleration(run)
    found = turning_times(run.scratch.rate, order - 2, tau, run.scratch.turns, run.scratch.work)
    for m in range(found + 1):
        after = run.scratch.turns[m] if m < found else tau
        change, v, _ = motion(after, order, body)
        u = body.u + change
        a = absolute_acceleration(u, v, spring_state(u, run.table, body), body)
        update_turning_point(i, a, t + after, body.flat_time, running)
        update_turning_point(i + 1, -body.mass * a, t + after, body.flat_time, running)
