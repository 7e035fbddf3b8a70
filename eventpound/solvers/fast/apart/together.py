"""Bodies in a window: step after step in the order of their ends, and impacts of two of them.

Whose step ends first is the next to take one. A body that goes by an exact step
(`eventpound.solvers.fast.apart.windows`) takes no part, unless it becomes of interest at some time:
then it does from there on.

An impact that closes one contact only, which opens again at once, concerns none but its two bodies:
it is settled between them, by the rules of every instant (`eventpound.contact.instant`), and the
others go on. Any other (rests, a last impact, a third body beside them, two closings at once) ends
the window, all bodies are brought to that instant, and it is due.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import TIRED
from eventpound.contact.impacts import DONE
from eventpound.contact.instant import settle_impacts
from eventpound.contact.kinks import still_rate
from eventpound.mechanics.monitored import update_extreme
from eventpound.numerics.arrays import Floats
from eventpound.numerics.by_address import by_address
from eventpound.solvers.fast.apart.between import (
    A_HIGH,
    A_LOW,
    AFTER,
    BEFORE,
    COUNT,
    STRAY,
    distance_at,
    set_distance,
    shear_stays,
    take_distances_of,
    take_shear,
    take_shear_at,
    takes_part,
    time_of_closing,
    write_row_at,
    write_rows,
)
from eventpound.solvers.fast.apart.own import GO_ON, REBOUND, SHOW, STAY, TAKE_UP, Window, go
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.instant import instant_of
from eventpound.solvers.fast.links import gap_of
from eventpound.solvers.fast.record import end_if_over, has_room, is_due, pass_time, takes_rows
from eventpound.solvers.fast.run import FastRun
from eventpound.tolerances import LISTED_SPEED, OWN_GAP, TOGETHER


@compiled_noinline
def go_together(budget: int, window: Window, run: FastRun) -> int:
    """Take all bodies through a window, or as far as it goes; steps taken, at most `budget`.

    Those take part whose `Each.until` is not infinite. Rows of the history are written on the way.
    Steps that are cut at the end, as where the budget ends, are not counted; those that follow are
    others than without it, within the tolerance.
    """
    each = run.series.each
    now, taken, closed, going = window.start, 0, -1, True
    for b in range(each.until.size):
        if each.until[b] < np.inf:
            going = go(b, TAKE_UP, now, window, run) and going
    for k in range(each.since.size):
        _watch(k, now, run)
    while going and now < window.end and taken < budget:
        who, j = _first(each.until), _first(each.closing)
        tau = each.closing[j] if j >= 0 else np.inf
        then = min(window.end, each.until[who], tau)
        if then > now and not shear_stays(run):
            if _show_all(window, run):
                continue
            take_shear(now, then, window.piece, run)
        if is_due(then, run.plan.output_times, run.state.progress[0]):
            if _show_all(window, run):
                continue
            write_rows(now, then, window.piece, run)
        now = then
        if now == tau:
            if not _impact(j, now, window, run):
                closed = j
                break
        elif now == each.until[who]:
            take_distances_of(who, now, run)
            going = go(who, GO_ON if now < window.end else STAY, now, window, run)
            taken += 1
            if going and now < window.end:
                _watch_all_of(who, now, run)
    _bring_together(closed, now, window, run)
    return taken


@compiled
def _first(times: Floats) -> int:
    """Whose time is the earliest; -1 for none."""
    first = 0
    for i in range(1, times.size):
        if times[i] < times[first]:
            first = i
    return first if times.size > 0 else -1


@compiled
def _watch(k: int, now: float, run: FastRun) -> None:
    """Look from a time (s) on for the extremes of a distance, and when it closes, if it can."""
    each = run.series.each
    each.since[k] = now
    if k < each.closing.size:
        each.closing[k] = time_of_closing(k, now, run) if takes_part(k, run) else np.inf


@compiled
def _watch_all_of(who: int, now: float, run: FastRun) -> None:
    """Look when the gaps of a body close that has begun another step."""
    each = run.series.each
    for j in range(each.closing.size):
        if _is_of(who, j, run) and takes_part(j, run):
            each.closing[j] = time_of_closing(j, now, run)


@compiled_noinline
def _show_all(window: Window, run: FastRun) -> bool:
    """Show the motion of all bodies; whether one was not before."""
    each = run.series.each
    if each.outside[COUNT] == 0.0:
        return False
    for b in range(each.until.size):
        if each.order[b] == 0:
            _expand_exact(b, window, run)
    return True


@compiled
def _expand_exact(b: int, window: Window, run: FastRun) -> None:
    """Show the motion of a body in an exact step by a series."""
    go(b, SHOW, window.start, window, run)
    each, mass = run.series.each, run.plan.mass[b]
    body, outside, box = each.body[b], each.outside, each.box
    now, then, stray = body.a, body.next_a, body.stray
    outside[COUNT] -= 1.0
    outside[BEFORE], outside[AFTER] = outside[BEFORE] + mass * now, outside[AFTER] + mass * then
    outside[STRAY] = max(0.0, outside[STRAY] - mass * stray)
    if outside[COUNT] == 0.0:
        outside[:] = 0.0
    box[A_LOW, b], box[A_HIGH, b] = min(now, then) - stray, max(now, then) + stray


@compiled_noinline
def _join(b: int, now: float, window: Window, run: FastRun) -> None:
    """Let a body that goes by an exact step take part from a time (s) on.

    Before, its distances had no extremes but where they are then: bounds say so.
    """
    each, first = run.series.each, run.running.at.gap
    if each.order[b] == 0:
        _expand_exact(b, window, run)
    each.until[b] = window.end
    for k in range(each.since.size):
        if _is_of(b, k, run) and takes_part(k, run):
            update_extreme(first + k, distance_at(k, now, run)[0], now, run.running)
            _watch(k, now, run)


@compiled_noinline
def _impact(j: int, tau: float, window: Window, run: FastRun) -> bool:
    """An impact at contact j at a time (s); whether it is one of two bodies only, which part.

    If not, only what comes before it has been done.
    """
    plan, state, each, limits = run.plan, run.state, run.series.each, run.plan.limits
    contacts, now = plan.contacts, state.now[0]
    row = takes_rows(run.record.rows)
    if row:
        _show_all(window, run)
    rate = distance_at(j, tau, run)[1]
    still = still_rate(limits.length, limits.time)
    slowest = max(still, LISTED_SPEED * now.fastest)
    simple = -contacts.restitution[j] * rate > slowest and now.in_a_row <= TIRED
    simple = _is_of_two(j, tau, window, run) and simple and has_room(run)
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            take_distances_of(b, tau, run)
    for i in range(state.gap.size):
        if row or takes_part(i, run):
            gap, state.gap_rate[i] = distance_at(i, tau, run)
            state.gap[i] = max(gap, 0.0)
    state.gap[j] = 0.0
    update_extreme(run.running.at.gap + j, 0.0, tau, run.running)
    _pass_time(tau, run)
    if row:
        write_row_at(tau, window.piece, run)
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            go(b, STAY, tau, window, run)
            state.u[b], state.v[b] = each.body[b].u, each.body[b].v
    if not simple or settle_impacts(by_address(instant_of(run))) != DONE:
        return False
    parts = state.gap_rate[j] > still
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            parts = go(b, REBOUND, tau, window, run) and parts
    opened = _time_of_opening(j, tau, state.gap_rate[j], run) if parts else np.inf
    if opened == np.inf:
        return False
    if row:
        write_row_at(tau, window.piece, run)
    if not shear_stays(run):
        _show_all(window, run)
        take_shear_at(tau, run)
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            _watch_all_of(b, tau, run)
    each.closing[j] = time_of_closing(j, opened, run)
    return True


@compiled
def _is_of_two(j: int, tau: float, window: Window, run: FastRun) -> bool:
    """Whether no other contact closes at once with contact j, or is nearly closed beside it.

    All beside it take part from then on.
    """
    contacts, each, limits, alone = run.plan.contacts, run.series.each, run.plan.limits, True
    for i in range(contacts.gap.size):
        left, right = contacts.left[i], contacts.right[i]
        if i == j:
            continue
        if each.closing[i] < tau + TOGETHER * limits.time:
            alone = False
        if not (_is_of(left, j, run) or _is_of(right, j, run)):
            continue
        for b in (left, right):
            if b >= 0 and each.until[b] == np.inf:
                _join(b, tau, window, run)
        alone = alone and distance_at(i, tau, run)[0] >= OWN_GAP * limits.length
    return alone


@compiled
def _is_of(b: int, j: int, run: FastRun) -> bool:
    """Whether contact, or distance, j has body b, which may be none."""
    return b >= 0 and b in (run.plan.distances.first[j], run.plan.distances.second[j])


@compiled
def _time_of_opening(j: int, tau: float, rate: float, run: FastRun) -> float:
    """When the gap of a contact that opens at a time (s) is one of displacements again, or inf.

    Until then it does nothing but open, which is only sure within the steps of both bodies.
    """
    contacts, each, c = run.plan.contacts, run.series.each, run.series.c
    wait, end = 2.0 * OWN_GAP * run.plan.limits.length / rate, np.inf
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            end = min(end, each.until[b])
    if not tau + wait < end:
        return np.inf
    bend = 0.0
    for k in range(set_distance(j, tau, run), 1, -1):
        bend = (bend + k * abs(c[k])) * wait
    return tau + wait if bend <= 0.5 * rate else np.inf


@compiled
def _pass_time(t: float, run: FastRun) -> None:
    """Let the time be t (s)."""
    now = run.state.now[0]
    pass_time(t - now.t, t, 0, now, run.state.progress[0])
    end_if_over(run)


@compiled
def _bring_together(closed: int, now: float, window: Window, run: FastRun) -> None:
    """Bring all bodies to one instant, which is due where contact `closed`, -1 for none, closes."""
    plan, state, each, shortest = run.plan, run.state, run.series.each, np.inf
    for b in range(each.until.size):
        if now < window.end and each.until[b] == np.inf:
            _join(b, now, window, run)
    take_distances_of(-1, now, run)
    for b in range(each.until.size):
        body = each.body[b]
        if each.until[b] == np.inf:
            body.u, body.v, body.a = body.u + body.change, body.rate, body.next_a
        else:
            shortest = min(shortest, max(each.length[b], each.until[b] - now))
            if each.now[b].t < now:
                go(b, STAY, now, window, run)
        if closed < 0 or not _is_of(b, closed, run):
            state.u[b], state.v[b] = body.u, body.v
    if 0.0 < shortest < np.inf:
        state.progress[0].trial = shortest
    _pass_time(now, run)
    for j in range(state.gap.size):
        if j == closed:
            state.progress[0].due = 1
        else:
            state.gap[j], state.gap_rate[j] = gap_of(j, plan.contacts, state.u, state.v)
