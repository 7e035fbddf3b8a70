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
    EVEN,
    FLAT_TIME,
    LEFT,
    LEFT_FORCE,
    LEFT_GAP,
    MASS,
    ODD,
    OF_G,
    OF_X,
    RESTS_ON,
    RIGHT,
    RIGHT_FORCE,
    RIGHT_GAP,
    A,
    SingleRun,
    U,
    V,
    Z,
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
    w, contacts = run.w, run.contacts
    row, u = run.rows[run.count[ROWS]], w[U] + change
    row[0], row[1], row[2], row[3], row[4] = t, g, u, v, a
    at = 5
    if run.hysteretic != 0.0:
        row[at] = run.hysteretic * z
        at += 1
    for s in range(run.springs):
        x = u if run.ends[s, 1] >= 0 else -u
        row[at] = run.stiffness[s] * (x - run.offset[s])
        if run.z_of_link[s] >= 0:
            row[at] += run.strength[s] * row[5]
        at += 1
    if run.right >= 0:
        row[at + run.right] = w[RIGHT] - change
        row[at + contacts + run.right] = w[RIGHT_FORCE]
    if run.left >= 0:
        row[at + run.left] = w[LEFT] + change
        row[at + contacts + run.left] = w[LEFT_FORCE]
    run.count[ROWS] += 1


@compiled
def write_present(t: float, g: float, run: SingleRun) -> None:
    """Add the present state to the history."""
    w = run.w
    if run.rows.shape[1] > 0:
        write_single_row(t, g, 0.0, w[V], g if w[RESTS_ON] != 0.0 else w[A], w[Z], run)


@compiled_apart
def sample_single(
    t: float,
    t_end: float,
    order: int,
    piece: Piece,
    run: SingleRun,
) -> bool:
    """History at the output times of a step; False where the record has no room."""
    count, times, w = run.count, run.times, run.w
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        now = times[count[OUTPUT]]
        if now >= t:
            if count[ROWS] + 4 > run.rows.shape[0]:
                return False
            change, v, _ = motion(now - t, order, w)
            u = w[U] + change
            z = spring_state(u, run.table, w)
            a = absolute_acceleration(u, v, z, w)
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
    return 1 + run.springs + run.contacts


@compiled
def force_exceeds(low: float, high: float, run: SingleRun) -> bool:
    """Whether the absolute acceleration (m/s²), or the base shear it makes, may leave its extremes.

    The two are apart once the body has rested on a barrier.
    """
    i, mass = place_of_acceleration(run), run.w[MASS]
    return exceeds(i, low, high, run.running) or exceeds(
        i + 1, -mass * high, -mass * low, run.running
    )


@compiled_apart
def take_turn(t: float, u: float, acceleration: float, run: SingleRun) -> None:
    """Take a turning point, or the end of a stretch, at t (s) into the extremes."""
    w, running, springs = run.w, run.running, run.springs
    near = w[FLAT_TIME]
    update_turning_point(0, u, t, near, running)
    for a in range(springs):
        x = u if run.ends[a, 1] >= 0 else -u
        update_turning_point(1 + a, x, t, near, running)
    if run.right >= 0:
        update_turning_point(1 + springs + run.right, w[RIGHT_GAP] - u, t, near, running)
    if run.left >= 0:
        update_turning_point(1 + springs + run.left, w[LEFT_GAP] + u, t, near, running)
    i = place_of_acceleration(run)
    update_extreme(i, acceleration, t, running)
    update_extreme(i + 1, -w[MASS] * acceleration, t, running)


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
    w, running, springs = run.w, run.running, run.springs
    u = w[U]
    _attain(0, u, t, running)
    for a in range(springs):
        _attain(1 + a, u if run.ends[a, 1] >= 0 else -u, t, running)
    if run.right >= 0:
        _attain(1 + springs + run.right, w[RIGHT], t, running)
    if run.left >= 0:
        _attain(1 + springs + run.left, w[LEFT], t, running)
    i = place_of_acceleration(run)
    update_extreme(i, acceleration, t, running)
    update_extreme(i + 1, -w[MASS] * w[A], t, running)
    if run.right >= 0:
        update_extreme(i + 2 + run.right, w[RIGHT_FORCE], t, running)
    if run.left >= 0:
        update_extreme(i + 2 + run.left, w[LEFT_FORCE], t, running)


@compiled
def _attain(i: int, value: float, t: float, running: Running) -> None:
    update_beyond(i, value, t, SETTLED * running.rounding[i], running)


@compiled
def damped_acceleration(t: float, tau: float, order: int, run: SingleRun) -> None:
    """Turning points of acceleration and base shear within a step, and their values at its end."""
    w, d, spread = run.w, run.rate, 0.0
    for k in range(order - 2, 0, -1):
        term = (k + 1) * (k + 2) * w[OF_X + k + 2] + w[OF_G + k] * (w[ODD] if k & 1 else w[EVEN])
        d[k - 1] = k * term
        spread = (spread + abs(term)) * tau
    if force_exceeds(w[A] - spread, w[A] + spread, run):
        _take_acceleration(t, tau, order, run)


@compiled_deferred
def _take_acceleration(t: float, tau: float, order: int, run: SingleRun) -> None:
    w, running, i = run.w, run.running, place_of_acceleration(run)
    found = turning_times(run.rate, order - 2, tau, run.turns, run.work)
    for m in range(found + 1):
        after = run.turns[m] if m < found else tau
        change, v, _ = motion(after, order, w)
        u = w[U] + change
        a = absolute_acceleration(u, v, spring_state(u, run.table, w), w)
        update_turning_point(i, a, t + after, w[FLAT_TIME], running)
        update_turning_point(i + 1, -w[MASS] * a, t + after, w[FLAT_TIME], running)
