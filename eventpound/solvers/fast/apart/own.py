"""What a body does while bodies go apart: a run of its own, by the steps of a single body.

It is that of `eventpound.solvers.fast.sdof` without barriers, with a clock of its own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from eventpound.mechanics.monitored import Running, places_of, running_of
from eventpound.motion.base import Family
from eventpound.motion.forcing import GAUSSIAN_STEP, CurrentPiece
from eventpound.numerics.by_address import by_address
from eventpound.solvers.fast.apart.between import A_HIGH, A_LOW, U_HIGH, U_LOW
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.extremes import flat_time, take_turn
from eventpound.solvers.fast.links import turns_back
from eventpound.solvers.fast.run import GOING_ON, Each, FastRun
from eventpound.solvers.fast.sdof.body import (
    SdofBody,
    SdofRun,
    absolute_acceleration,
    leave_curve,
    observe_end,
    set_constants,
    spring_state,
    turn_round,
)
from eventpound.solvers.fast.sdof.exact import show_line
from eventpound.solvers.fast.sdof.record import (
    acceleration_coefficient,
    damped_acceleration,
    take_if_new,
)
from eventpound.solvers.fast.sdof.series import know_piece, pair_at
from eventpound.solvers.fast.sdof.step import FREE, arrive, observe_ground, propose
from eventpound.solvers.fast.search import motion

_GAUSSIAN = int(Family.GAUSSIAN)


class Window(NamedTuple):
    """A stretch of one piece of the ground motion, from `start` to `end` (s), by address.

    segment: under a record, within one step of which it stays, number of the sample before.
    """

    start: float
    end: float
    segment: int
    piece: CurrentPiece


(START, SHOW, TAKE_UP, REBOUND, GO_ON, STAY) = range(6)
"""What a body is to do: begin a run of its own; show the motion in an exact step by a series; take
a first step in a window, or after an impact; end the present step and take another, or only that.
"""


@compiled
def running_of_own(b: int, each: Each) -> Running:
    """Extremes of the run of a body, without elongations and gaps."""
    return running_of(each.extremes[b], places_of(1, 0, 0))


@compiled_noinline
def go(b: int, what: int, now: float, window: Window, run: FastRun) -> bool:
    """Let a body do something at a time (s); whether its step, within the window, holds."""
    plan, each, h = run.plan, run.series.each, run.plan.links.grounded[b]
    tables, piece, own = plan.hysteresis.tables, window.piece, running_of_own(b, each)
    # Rows and what belongs to several bodies is taken elsewhere.
    one = by_address(
        SdofRun(
            each.body[b],
            each.now[b],
            each.progress[b],
            run.record.events,
            run.record.rows,
            own,
            tables[plan.hysteresis.at[h] if h >= 0 else 0 :],
            plan,
            run.series.sdof,
        )
    )
    holds = True
    if what >= GO_ON:
        holds = _arrive(b, now, piece, one, each)
        if what == STAY:
            # An impact may stop it.
            take_if_new(now, one.body.u, one.body.a, one)
    elif what == START:
        _start(b, piece, one, run)
    else:
        _begin_step(b, what, now, window, one, run)
    if what == SHOW:
        _expand_exact(b, window, one, each)
    if holds and TAKE_UP <= what <= GO_ON:
        holds = _begin(b, window.end, piece, one, run)
    if h >= 0:
        leave_curve(h, one.body, run.state)
    return holds


@compiled_noinline
def _start(b: int, piece: CurrentPiece, one: SdofRun, run: FastRun) -> None:
    """Make the present state of a body that of its own run."""
    state, each, h, body = run.state, run.series.each, run.plan.links.grounded[b], one.body
    if not body.known:
        set_constants(b, run.plan, body)
    if h >= 0:
        body.sigma, body.part = body.side * state.sigma[h], state.part[h]
        body.u_r, body.xi_r = body.side * state.x_r[h], state.xi_r[h]
    body.u, body.v = state.u[b], state.v[b]
    body.z = spring_state(body.u, one)
    body.a = absolute_acceleration(body.u, body.v, body.z, body)
    one.progress.expansions = one.progress.stalled = 0
    present = state.progress[0].piece
    if body.piece_known != present + 1:
        know_piece(present, piece, body)
    own, at, extremes = one.running.at, run.running.at, run.record.extremes
    for row in range(extremes.shape[0]):
        each.extremes[b, row, own.displacement] = extremes[row, at.displacement + b]
        each.extremes[b, row, own.acceleration] = extremes[row, at.acceleration + b]


@compiled_noinline
def _begin_step(b: int, what: int, now: float, window: Window, one: SdofRun, run: FastRun) -> None:
    """Begin a step at a time (s) where the body is, whose velocity an impact may have changed."""
    body, state = one.body, run.state
    body.u, body.v, one.now.t = state.u[b], state.v[b], now
    body.z = spring_state(body.u, one)
    if what == REBOUND and turns_back(body.part, body.sigma, body.v, body.still):
        turn_round(body.u, one)
    body.a = absolute_acceleration(body.u, body.v, body.z, body)
    if what == REBOUND:
        take_if_new(now, body.u, body.a, one)
    body.segment = window.segment
    if body.pair:
        body.even, body.odd = pair_at(now, window.piece, body)


@compiled_noinline
def _expand_exact(b: int, window: Window, one: SdofRun, each: Each) -> None:
    """Series of a body in an exact step, which ends with the window."""
    body, dt, reach = one.body, window.end - window.start, 0.0
    order = show_line(body.v, body.a - body.even, dt, body)
    each.order[b], each.length[b], each.event[b], each.turned[b] = order, dt, FREE, False
    observe_ground(window.end, window.piece, body)
    body.next_z = spring_state(body.u + body.change, one)
    for k in range(order, 0, -1):
        reach = (reach + abs(body.x[k])) * dt
    each.box[U_LOW, b], each.box[U_HIGH, b] = body.u - reach, body.u + reach


@compiled
def _arrive(b: int, now: float, piece: CurrentPiece, one: SdofRun, each: Each) -> bool:
    """Take a body to a time (s), the end of its step or within it; whether it may go on."""
    body, begun, order = one.body, one.now.t, each.order[b]
    if now < each.until[b]:
        each.length[b], each.until[b] = now - begun, now
        each.event[b], each.turned[b] = FREE, False
        body.change, body.rate, body.bend = motion(now - begun, order, body.x[:])
        observe_ground(now, piece, body)
        observe_end(one)
    if body.damping > 0.0:
        damped_acceleration(begun, each.length[b], order, one)
    return arrive(each.length[b], now, each.turned[b], each.event[b], one) == GOING_ON


@compiled
def _begin(b: int, stop: float, piece: CurrentPiece, one: SdofRun, run: FastRun) -> bool:
    """A step of a body from where it is; whether one holds at its end."""
    each, t, wanted = run.series.each, one.now.t, stop - one.now.t
    if piece.family == _GAUSSIAN:
        wanted = min(wanted, GAUSSIAN_STEP / math.sqrt(piece.coefficients[1]))
    order, tau, end, event, turned = propose(wanted, stop, piece, one)
    each.order[b], each.event[b], each.turned[b] = order, event, turned
    each.until[b], each.length[b] = (end, tau) if order > 0 else (t, 0.0)
    _set_box(b, tau, order, one.body, each)
    return order > 0


@compiled
def _set_box(b: int, tau: float, order: int, body: SdofBody, each: Each) -> None:
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
def take_own(b: int, run: FastRun) -> None:
    """Put the extremes of a body's own run among those of all."""
    each, extremes, running = run.series.each, run.record.extremes, run.running
    own, at = running_of_own(b, each), running.at
    i, i_own, near = at.displacement + b, own.at.displacement, flat_time(run.plan)
    for u, t in (
        (own.maximum[i_own], own.time_of_maximum[i_own]),
        (own.minimum[i_own], own.time_of_minimum[i_own]),
    ):
        if u > running.maximum[i] or u < running.minimum[i]:
            take_turn(i, u, t, near, run.plan, running)
    for row in range(extremes.shape[0]):
        extremes[row, i] = each.extremes[b, row, i_own]
        extremes[row, at.acceleration + b] = each.extremes[b, row, own.at.acceleration]
