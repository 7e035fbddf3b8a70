"""Lines of the history of a single body."""

from __future__ import annotations

from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.run import OUTPUT, ROWS
from eventpound.solvers.fast.single import absolute_acceleration, spring_state
from eventpound.solvers.fast.single_places import (
    LEFT,
    LEFT_FORCE,
    RESTS_ON,
    RIGHT,
    RIGHT_FORCE,
    A,
    U,
    V,
    Z,
)
from eventpound.solvers.fast.single_run import SingleRun
from eventpound.solvers.fast.single_series import motion


@compiled_apart
def write_single_row(
    t: float, g: float, change: float, v: float, a: float, z: float, run: SingleRun
) -> None:
    """Add a line to the history: what `eventpound.solvers.fast.history.write_row` writes.

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
    family: int,
    coefficients: Floats,
    samples: Floats,
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
            g = ground_acceleration(family, coefficients, samples, now)
            write_single_row(now, g, change, v, a, z, run)
        count[OUTPUT] += 1
    return True
