"""Bodies that go apart: each by the steps of a run of its own, until two of them may meet.

Bodies on springs to the ground have nothing to do with each other but a ground motion, until a
contact closes. So each takes the steps of a single body (`eventpound.solvers.fast.single`) with a
clock of its own: one that passes the knee of its backbone in short steps keeps no other from long
ones. Whose step ends first is the next to take one.

Where a gap becomes small (`eventpound.solvers.fast.apart.between` tells when) all bodies are
brought to one instant, and `eventpound.solvers.fast.step` goes on, as everywhere else.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.contact.cascade import IN_A_ROW, SINCE_IMPACT, T, is_fleeting
from eventpound.mechanics.monitored import places_of, running_of
from eventpound.motion.base import Family
from eventpound.motion.forcing import GAUSSIAN_STEP, CurrentPiece
from eventpound.numerics.lending import lend
from eventpound.solvers.fast.apart.between import (
    A_HIGH,
    A_LOW,
    U_HIGH,
    U_LOW,
    take_gaps_of,
    take_shear,
    time_of_fall,
    write_rows,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.extremes import flat_time, followers
from eventpound.solvers.fast.links import CORE, gap_of
from eventpound.solvers.fast.run import (
    EXPANSIONS,
    GOING_ON,
    GUESS,
    PIECE,
    RESTING,
    STALLED,
    STEPS,
    Each,
    FastRun,
    Oscillator,
)
from eventpound.solvers.fast.single.body import (
    SingleBody,
    SingleRun,
    absolute_acceleration,
    forget,
    leave_curve,
    look,
    set_constants,
    spring_state,
)
from eventpound.solvers.fast.single.record import acceleration_coefficient, damped_acceleration
from eventpound.solvers.fast.single.series import know_piece, motion, pair_at
from eventpound.solvers.fast.single.step import FREE, arrive, look_at_ground, propose
from eventpound.tolerances import OWN_GAP

(SET_OUT, GO_ON, STAY) = range(3)
"""What a body is to do: take a first step, end the present one and take another, or end it only."""
_SAMPLES, _GAUSSIAN = int(Family.SAMPLES), int(Family.GAUSSIAN)


@compiled
def forget_each(each: Each) -> None:
    """Leave nothing of the run before."""
    for b in range(each.body.size):
        forget(each.body[b])


@compiled
def may_go_apart(piece: CurrentPiece, run: FastRun) -> bool:
    """Whether nothing rests or has a kink, no gap closes soon or is small, and it pays.

    It does once a link has left the core of its backbone: before, no body ends a step.
    """
    plan, state, count = run.plan, run.state, run.state.count
    if run.series.each.body.size == 0 or piece.family >= _SAMPLES or plan.links.kinked:
        return False
    if count[RESTING] > 0 or count[IN_A_ROW] > 0 or is_fleeting(0.0, state.clock, plan.limits.time):
        return False
    least, soon = OWN_GAP * plan.limits.length, state.clock[GUESS]
    for j in range(state.gap.size):
        if not min(state.gap[j], state.gap[j] + soon * state.gap_rate[j]) >= least:
            return False
    for h in range(state.part.size):
        if state.part[h] != CORE:
            return True
    return False


@compiled_deferred
def go_apart(budget: int, stop: float, piece: CurrentPiece, run: FastRun) -> None:
    """Steps of each body by itself, to `stop` (s) at most and `budget` in all; then one instant.

    Rows of the history are written on the way. Steps that are cut at that instant, as where the
    budget ends, are not counted; those that follow are others than without it, within the
    tolerance.
    """
    state, each, taken = run.state, run.series.each, 0
    start = now = state.clock[T]
    going, deadline = True, np.inf
    for b in range(each.body.size):
        going = _go(b, SET_OUT, now, stop, piece, run) and going
    for j in range(state.gap.size):
        each.since[j] = now
        deadline = min(deadline, time_of_fall(j, now, run))
    while going and now < min(stop, deadline) and taken < budget:
        who = _first_to_end(each)
        then = min(each.until[who], deadline)
        take_shear(now, then, piece, run)
        write_rows(now, then, piece, run)
        now = then
        if now < each.until[who]:
            break
        take_gaps_of(who, now, run)
        going = _go(who, GO_ON if now < stop else STAY, now, stop, piece, run)
        taken += 1
        if going and now < stop:
            for j in range(state.gap.size):
                if run.plan.contacts.left[j] == who or run.plan.contacts.right[j] == who:
                    deadline = min(deadline, time_of_fall(j, now, run))
    _meet(start, now, piece, run)
    state.count[STEPS] += taken


@compiled
def _first_to_end(each: Each) -> int:
    """The body whose step ends first."""
    who = 0
    for b in range(1, each.until.size):
        if each.until[b] < each.until[who]:
            who = b
    return who


@compiled
def _link_of(b: int, run: FastRun) -> int:
    """The hysteretic link of a body, -1 for none."""
    return int(run.plan.links.grounded[b])


@compiled_apart
def _go(b: int, what: int, now: float, stop: float, piece: CurrentPiece, run: FastRun) -> bool:
    """Let a body do something at a time (s); whether its step, to `stop` (s) at most, holds."""
    plan, each, h = run.plan, run.series.each, _link_of(b, run)
    tables, times = plan.hysteresis.tables, plan.output_times
    # Without output times, elongations and barriers: rows and what belongs to several bodies is
    # taken elsewhere.
    one = lend(
        SingleRun(
            each.body[b],
            each.clock[b],
            each.count[b],
            run.record.events,
            run.record.rows,
            running_of(each.extremes[b], places_of(1, 0, 0)),
            0,
            times[times.size :],
            tables[plan.hysteresis.at[h] if h >= 0 else 0 :],
            plan.links,
            plan.contacts,
            plan.ground,
            plan.limits,
            Oscillator(True, -1, -1),
            run.series.single,
        )
    )
    holds = True
    if what == SET_OUT:
        _set_out(b, piece, one, run)
    else:
        holds = _arrive(b, now, piece, one, each)
    if holds and what != STAY:
        holds = _begin(b, stop, piece, one, run)
    if h >= 0:
        leave_curve(h, one.body, run.state)
    return holds


@compiled
def _set_out(b: int, piece: CurrentPiece, one: SingleRun, run: FastRun) -> None:
    """Make the present state of a body that of its own run."""
    state, each, h = run.state, run.series.each, _link_of(b, run)
    body = one.body
    if not body.known:
        set_constants(b, run.plan, body)
    body.u, body.v = state.u[b], state.v[b]
    if h >= 0:
        body.sigma, body.part = body.side * state.sigma[h], state.part[h]
        body.u_r, body.xi_r = body.side * state.x_r[h], state.xi_r[h]
    body.z = spring_state(body.u, one)
    body.a = absolute_acceleration(body.u, body.v, body.z, body)
    t, present = state.clock[T], state.count[PIECE]
    one.clock[T] = t
    one.count[:] = 0
    if body.piece_known != present + 1:
        know_piece(present, piece, body)
    if body.pair:
        body.even, body.odd = pair_at(t, piece, body)
    own, at, extremes = one.running.at, run.running.at, run.record.extremes
    for row in range(extremes.shape[0]):
        each.extremes[b, row, own.displacement] = extremes[row, at.displacement + b]
        each.extremes[b, row, own.acceleration] = extremes[row, at.acceleration + b]


@compiled
def _arrive(b: int, now: float, piece: CurrentPiece, one: SingleRun, each: Each) -> bool:
    """Take a body to a time (s), the end of its step or within it; whether it may go on."""
    body, begun, order = one.body, one.clock[T], each.order[b]
    if now < each.until[b]:
        each.length[b], each.until[b] = now - begun, now
        each.event[b], each.turned[b] = FREE, False
        body.change, body.rate, body.bend = motion(now - begun, order, body)
        look_at_ground(now, piece, body)
        look(one)
    if body.damping > 0.0:
        damped_acceleration(begun, each.length[b], order, one)
    return arrive(each.length[b], now, each.turned[b], each.event[b], one) == GOING_ON


@compiled
def _begin(b: int, stop: float, piece: CurrentPiece, one: SingleRun, run: FastRun) -> bool:
    """A step of a body from where it is; whether one holds at its end."""
    each, t, wanted = run.series.each, one.clock[T], stop - one.clock[T]
    if piece.family == _GAUSSIAN:
        wanted = min(wanted, GAUSSIAN_STEP / math.sqrt(piece.coefficients[1]))
    order, tau, end, event, turned = propose(wanted, stop, piece, one)
    each.order[b], each.event[b], each.turned[b] = order, event, turned
    each.until[b], each.length[b] = (end, tau) if order > 0 else (t, 0.0)
    _set_box(b, tau, order, one.body, each)
    return order > 0


@compiled
def _set_box(b: int, tau: float, order: int, body: SingleBody, each: Each) -> None:
    """Bounds of displacement and acceleration of a body in its step, of length tau (s).

    It goes one way, but where it all but stands still, and so do the forces of springs. With
    dashpots the acceleration strays from the straight line between its values at both ends by
    τ²/8 times its largest second derivative, at most.
    """
    box, u, bend = each.box, body.u, 0.0
    if body.damping > 0.0:
        for k in range(order - 2, 1, -1):
            bend = bend * tau + k * (k - 1) * abs(acceleration_coefficient(k, body))
    beside, stray = body.standing, 0.125 * tau * tau * bend
    stray += beside * (body.stiffness + body.strength * body.per_scale)
    box[U_LOW, b] = u + min(body.change, 0.0) - beside
    box[U_HIGH, b] = u + max(body.change, 0.0) + beside
    box[A_LOW, b] = min(body.a, body.next_a) - stray
    box[A_HIGH, b] = max(body.a, body.next_a) + stray


@compiled
def _meet(start: float, now: float, piece: CurrentPiece, run: FastRun) -> None:
    """Bring all bodies, which went apart at `start` (s), to one instant."""
    plan, state, each, clock = run.plan, run.state, run.series.each, run.state.clock
    take_gaps_of(-1, now, run)
    shortest = np.inf
    for b in range(each.body.size):
        shortest = min(shortest, max(each.length[b], each.until[b] - now))
        if each.clock[b, T] < now:
            _go(b, STAY, now, now, piece, run)
        state.u[b], state.v[b] = each.body[b].u, each.body[b].v
        state.count[EXPANSIONS] += each.count[b, EXPANSIONS]
        _take_own(b, run)
    clock[T] = now
    if not now > start:
        return
    if shortest > 0.0:
        clock[GUESS] = shortest
    clock[SINCE_IMPACT] += now - start
    state.count[STALLED] = 0
    for j in range(state.gap.size):
        state.gap[j], state.gap_rate[j] = gap_of(j, plan.contacts, state.u, state.v)


@compiled
def _take_own(b: int, run: FastRun) -> None:
    """Put the extremes of a body's own run among those of all."""
    each, extremes, running = run.series.each, run.record.extremes, run.running
    own, at = running_of(each.extremes[b], places_of(1, 0, 0)), running.at
    i, i_own, near = at.displacement + b, own.at.displacement, flat_time(run.plan)
    for u, t in (
        (own.maximum[i_own], own.time_of_maximum[i_own]),
        (own.minimum[i_own], own.time_of_minimum[i_own]),
    ):
        if u > running.maximum[i] or u < running.minimum[i]:
            followers(b, u, t, near, run.plan, running)
    for row in range(extremes.shape[0]):
        extremes[row, i] = each.extremes[b, row, i_own]
        extremes[row, at.acceleration + b] = each.extremes[b, row, own.at.acceleration]
