"""What a single body leaves in its record: lines of the history, and extremes.

Displacement, spring elongations and gaps have their extremes where the body turns and
where a stretch ends; without dashpots so have acceleration and base shear, for
the spring forces grow with the displacement. Only with dashpots the acceleration is
looked at within each step.
"""

from __future__ import annotations

from eventpound.mechanics.elements import pull_per_z
from eventpound.mechanics.monitored import update_extreme, update_settled, update_turning_point
from eventpound.motion.forcing import CurrentPiece, ground_acceleration
from eventpound.solvers.events.recorder import line_of
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.extremes import stays_within, take_turn, turning_times
from eventpound.solvers.fast.record import is_due, takes_rows
from eventpound.solvers.fast.sdof.body import (
    SdofRun,
    absolute_acceleration,
    set_force,
    spring_state,
)
from eventpound.solvers.fast.sdof.series import swing
from eventpound.solvers.fast.search import motion


@compiled_noinline
def write_sdof_row(
    t: float, g: float, change: float, v: float, a: float, z: float, solo: SdofRun
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
    solo : SdofRun
        The run, with the present gaps and contact forces.
    """
    body, springs = solo.body, solo.plan.links.springs
    at = line_of(1, 1 if body.hysteretic else 0, springs, solo.plan.contacts.gap.size)
    row, u = solo.rows[solo.progress.rows], body.u + change
    row[at.t], row[at.ground], row[at.u], row[at.v], row[at.a] = t, g, u, v, a
    if body.hysteretic:
        row[at.z] = body.whole * z
    for s in range(springs):
        # A spring from the body to the ground is stretched by -u.
        x = u if solo.plan.links.ends[s, 1] >= 0 else -u
        row[at.force + s] = solo.plan.links.extension[s] * (x - solo.plan.links.offset[s])
        if solo.plan.links.z_of_link[s] >= 0:
            row[at.force + s] += pull_per_z(s, solo.plan.links.law.memory) * row[at.z]
    right, left = solo.plan.oscillator.right, solo.plan.oscillator.left
    if right >= 0:
        row[at.gap + right] = body.right - change
        row[at.contact_force + right] = body.right_force
    if left >= 0:
        row[at.gap + left] = body.left + change
        row[at.contact_force + left] = body.left_force
    solo.progress.rows += 1


@compiled
def write_present(t: float, g: float, solo: SdofRun) -> None:
    """Add the present state to the history."""
    body = solo.body
    if takes_rows(solo.rows):
        write_sdof_row(t, g, 0.0, body.v, g if body.rests_on != 0.0 else body.a, body.z, solo)


@compiled_noinline
def sample_sdof(t: float, t_end: float, order: int, piece: CurrentPiece, solo: SdofRun) -> bool:
    """History at the output times of a step; False where the record has no room.

    `order` is that of the step's series, 0 for a free swing and a rest.
    """
    body, progress, x = solo.body, solo.progress, solo.body.x[:]
    while is_due(t_end, solo.plan.output_times, progress):
        now = solo.plan.output_times[progress.output]
        if now >= t:
            if progress.rows + 4 > solo.rows.shape[0]:
                return False
            g = ground_acceleration(piece, now)
            if body.rests_on != 0.0:
                set_force(g, body)
                write_sdof_row(now, g, 0.0, 0.0, g, body.z, solo)
            else:
                change, v = motion(now - t, order, x)[:2] if order > 0 else swing(now - t, body)
                u = body.u + change
                z = spring_state(u, solo)
                a = absolute_acceleration(u, v, z, body)
                write_sdof_row(now, g, change, v, a, z, solo)
        progress.output += 1
    return True


@compiled
def force_exceeds(low: float, high: float, solo: SdofRun) -> bool:
    """Whether the absolute acceleration (m/s²), or the base shear it makes, may leave its extremes.

    The two are apart once the body has rested on a barrier.
    """
    running, at, mass = solo.running, solo.running.at, solo.body.mass
    inside = stays_within(at.acceleration, low, high, running)
    return not (inside and stays_within(at.base_shear, -mass * high, -mass * low, running))


@compiled
def _take_forces(t: float, a: float, shear: float, solo: SdofRun) -> None:
    """Take an acceleration (m/s²) and a base shear (N) into the extremes."""
    update_extreme(solo.running.at.acceleration, a, t, solo.running)
    update_extreme(solo.running.at.base_shear, shear, t, solo.running)


@compiled_noinline
def _take_turn(t: float, u: float, a: float, solo: SdofRun) -> None:
    """Take a turning point, or the end of a stretch, at t (s) into the extremes."""
    running, near = solo.running, solo.body.flat_time
    take_turn(running.at.displacement, u, t, near, solo.plan, running)
    _take_forces(t, a, -solo.body.mass * a, solo)


@compiled
def take_if_new(t: float, u: float, a: float, solo: SdofRun) -> None:
    """The same where it is beyond, or just at, the extremes so far."""
    running = solo.running
    i = running.at.displacement
    same = 2.0 * running.rounding[i]
    new = u > running.maximum[i] - same or u < running.minimum[i] + same
    if new or force_exceeds(a, a, solo):
        _take_turn(t, u, a, solo)


@compiled_noinline
def take_settled(t: float, a: float, solo: SdofRun) -> None:
    """Take a settled instant: places just put on their constraints, and what jumps in it.

    `a` is the absolute acceleration (m/s²): that of the ground where the body rests.
    """
    body, at, o, distances = solo.body, solo.running.at, solo.plan.oscillator, solo.plan.distances
    for i in range(at.displacement, at.acceleration):
        there = body.u if distances.second[i - at.gap] >= 0 else -body.u
        update_settled(i, there, t, solo.running)
    if o.right >= 0:
        update_settled(at.gap + o.right, body.right, t, solo.running)
    if o.left >= 0:
        update_settled(at.gap + o.left, body.left, t, solo.running)
    # Base shear is what the links pull: at rest that is not m times the acceleration of the ground.
    _take_forces(t, a, -body.mass * body.a, solo)
    take_contact_forces(t, solo)


@compiled
def take_contact_forces(t: float, solo: SdofRun) -> None:
    """Take the present contact forces into the extremes."""
    i, o = solo.running.at.contact_force, solo.plan.oscillator
    if o.right >= 0:
        update_extreme(i + o.right, solo.body.right_force, t, solo.running)
    if o.left >= 0:
        update_extreme(i + o.left, solo.body.left_force, t, solo.running)


@compiled
def damped_acceleration(t: float, tau: float, order: int, solo: SdofRun) -> None:
    """Turning points of acceleration and base shear within a step, and their values at its end."""
    body, d, spread = solo.body, solo.scratch.rate, 0.0
    for k in range(order - 2, 0, -1):
        # The absolute acceleration: that of u and of the ground.
        ground = body.ground[k] * (body.odd if k & 1 else body.even)
        term = (k + 1) * (k + 2) * body.x[k + 2] + ground
        d[k - 1] = k * term
        spread = (spread + abs(term)) * tau
    if force_exceeds(body.a - spread, body.a + spread, solo):
        _take_acceleration(t, tau, order, solo)


@compiled_deferred
def _take_acceleration(t: float, tau: float, order: int, solo: SdofRun) -> None:
    body, running, at = solo.body, solo.running, solo.running.at
    found = turning_times(solo.scratch.rate, order - 2, tau, solo.scratch.turns, solo.scratch.work)
    for m in range(found + 1):
        after = solo.scratch.turns[m] if m < found else tau
        change, v, _ = motion(after, order, body.x[:])
        u = body.u + change
        a = absolute_acceleration(u, v, spring_state(u, solo), body)
        update_turning_point(at.acceleration, a, t + after, body.flat_time, running)
        update_turning_point(at.base_shear, -body.mass * a, t + after, body.flat_time, running)
