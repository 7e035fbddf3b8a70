"""The loop of the compiled stepper: expand, choose a step, look for events, move.

One kind of step serves everything: smooth motion, the samples of a record,
and a cascade of impacts whose intervals shrink below the rounding of time.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, ground_taylor
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast.backbone_parts import (
    CORE,
    SATURATED,
    UP,
    cross_border,
    place,
    reverse,
    set_curve,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_with_arrays
from eventpound.solvers.fast.expansion import acceleration_at, expand, link_state
from eventpound.solvers.fast.extremes import inside_step, take_instant
from eventpound.solvers.fast.instant import (
    DONE,
    ENDLESS,
    NO_FORCES,
    NO_IMPACT,
    choose_branches,
    choose_directions,
    elongations,
    enter_mode,
    impacts,
    list_all,
    put_on_constraint,
    rest,
)
from eventpound.solvers.fast.ledger import add_work
from eventpound.solvers.fast.plan import (
    CLUSTERS,
    DUE,
    EVENTS,
    EXPANSIONS,
    GUESS,
    INTERVAL,
    ORDER,
    OUTPUT,
    PIECE,
    RESTING,
    ROWS,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Happened,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.search import (
    FORCE_NOISE,
    SPEED_NOISE,
    first_happening,
    set_travel,
)
from eventpound.solvers.fast.seen import Seen, look, spread_forces

FINISHED, GOING_ON, FULL, NOT_FINITE, PENETRATION, PULLS, STUCK = 0, 10, 11, 12, 13, 14, 15
"""How a call of `advance` ends, beside the ends of settling."""
MESSAGES = {
    FINISHED: "reached the end of the run",
    NO_IMPACT: "an impact problem has no solution",
    NO_FORCES: "the forces of resting contacts could not be found",
    ENDLESS: "impacts in one instant do not end",
    NOT_FINITE: "no step is short enough for the equations of motion; try a larger rtol",
    PENETRATION: "a contact penetrates and no impact was found; try a smaller rtol",
    PULLS: "a resting contact pulls and no detachment was found; try a smaller rtol",
    STUCK: "events follow each other without an end",
}
"""What each end of a run means."""
LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step."""
DEFECT_SHARE = 1.0
"""Part of a step's tolerance that its defect may use."""
SMALLEST_ORDER = 5
TOGETHER = 1e-12
"""Part of T within which closings belong to one instant, away from cascades."""
PENETRATED = 1e-12
"""Part of L by which a gap below zero is an error."""
CASCADE_OVER = 1e-6
"""Part of T without impacts after which a cascade has ended."""
MOST_STALLS = 100
"""Events in a row without progress of time after which a run gives up."""
GAUSSIAN_STEP = 0.5
"""Longest step under a Gaussian pulse, in its own time 1/sqrt(q)."""
SINUSOID_STEP = 1.5
"""Longest step under a sinusoid, in its radians."""
_SAMPLES, _GAUSSIAN, _SINUSOIDS = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.SINUSOIDS)


@compiled
def next_sample(coefficients: Floats, t: float, stop: float) -> float:
    """Next sample of a record after t (s), or `stop`."""
    origin, dt = coefficients[0], coefficients[1]
    i = math.floor((t - origin) / dt) + 1
    # A stretch that rounding makes of no length is left out.
    while origin + i * dt <= t + 1e-9 * dt:
        i += 1
    following = origin + i * dt
    return following if following < stop - 1e-9 * dt else stop


@compiled_apart
def start(plan: Plan, state: State, series: Series) -> None:
    """Put the hysteretic links on their curves at the beginning of a run."""
    elongations(plan, state, series)
    hysteresis = plan.hysteresis
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        y = state.xi_r[h]
        sigma = -1.0 if series.x_rate[a] < 0.0 else 1.0
        set_curve(h, series.x[a], sigma, sigma * y, hysteresis, state)


@compiled
def step_error(h: float, order: int, plan: Plan, state: State, series: Series) -> float:
    """Truncation error of a step of length h in units of its tolerance, from the last terms."""
    limits = plan.limits
    power = h
    base, k = h, order - 2
    power = 1.0
    while k > 0:
        if k & 1:
            power *= base
        base *= base
        k >>= 1
    worst = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c < 0:
            continue
        X = series.X[c]
        of_u = LOCAL_SHARE * (limits.atol_u + limits.rtol * abs(state.u[b]))
        of_v = LOCAL_SHARE * (limits.atol_v + limits.rtol * abs(state.v[b]))
        last = max(abs(X[order]) * h, abs(X[order - 1])) * power * h
        worst = max(worst, last / of_u, order * last / (of_v * h))
    return worst


@compiled
def defect_error(
    tau: float, order: int, ground: float, plan: Plan, state: State, series: Series, seen: Seen
) -> float:
    """Error of a step in units of its tolerance, from the defect of the equations at its end.

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    limits = plan.limits
    worst = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c < 0:
            continue
        of_u = LOCAL_SHARE * (limits.atol_u + limits.rtol * abs(state.u[b]))
        of_v = LOCAL_SHARE * (limits.atol_v + limits.rtol * abs(state.v[b]))
        defect = abs(seen.a[b] - ground - acceleration_at(c, tau, order, series)) * tau / order
        worst = max(worst, defect / of_v, defect * tau / (order * of_u))
    return worst


@compiled_apart
def contact_force_series(order: int, plan: Plan, state: State, series: Series) -> None:
    """Taylor coefficients of the forces of resting contacts."""
    mass, ends, residual = plan.mass, plan.links.ends, series.force
    for k in range(order - 1):
        for b in range(mass.size):
            c = series.of_body[b]
            residual[b] = mass[b] * series.ground[k]
            if c >= 0:
                residual[b] += mass[b] * (k + 1) * (k + 2) * series.X[c, k + 2]
        for a in range(ends.shape[0]):
            if k > 0 and series.ends[a, 0] == series.ends[a, 1]:
                continue
            if ends[a, 0] >= 0:
                residual[ends[a, 0]] -= series.F[a, k]
            if ends[a, 1] >= 0:
                residual[ends[a, 1]] += series.F[a, k]
        spread_forces(state, series, series.contact_force[:, k])


@compiled
def wrong_way(plan: Plan, state: State, series: Series, order: int) -> bool:
    """Turn round links whose elongation rate has vanished and grows against their direction."""
    hysteresis = plan.hysteresis
    noise = SPEED_NOISE * plan.limits.length / plan.limits.time
    turned = False
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if state.part[h] == CORE or head == tail or abs(series.x_rate[a]) > noise:
            continue
        for k in range(2, order + 1):
            x_k = series.X[tail, k] if tail >= 0 else 0.0
            x_k -= series.X[head, k] if head >= 0 else 0.0
            if abs(x_k) > (noise / plan.limits.time if k == 2 else 0.0):
                if state.sigma[h] * x_k < 0.0:
                    reverse(h, series.x[a], hysteresis, state)
                    turned = True
                break
    return turned


@compiled_apart
def write_row(t: float, plan: Plan, seen: Seen, state: State, record: Record) -> None:
    """Add a line to the history."""
    row = record.rows[state.count[ROWS]]
    state.count[ROWS] += 1
    row[0], row[1] = t, seen.base[0]
    at = 2
    at = _put(seen.u, seen.u.size, row, at)
    at = _put(seen.v, seen.v.size, row, at)
    at = _put(seen.a, seen.a.size, row, at)
    at = _put(seen.z, seen.z.size, row, at)
    at = _put(seen.force, plan.links.springs, row, at)
    at = _put(seen.gap, seen.gap.size, row, at)
    _put(seen.contact_force, seen.gap.size, row, at)


@compiled
def _put(source: Floats, count: int, target: Floats, at: int) -> int:
    """Copy numbers into a row; returns the place behind them."""
    for i in range(count):
        target[at + i] = source[i]
    return at + count


@compiled_apart
def mark_together(tau: float, plan: Plan, state: State) -> None:
    """Close the gaps that close in the same instant, to rounding."""
    instant = min(TOGETHER * plan.limits.time, 1e-9 * state.clock[SINCE_IMPACT])
    instant = max(instant, 1e-11 * tau)
    for j in range(state.gap.size):
        if not state.resting[j] and state.gap_rate[j] < 0.0:
            if state.gap[j] <= -instant * state.gap_rate[j]:
                state.gap[j] = 0.0


@compiled_with_arrays
def settle(
    forcing: Forcing,
    happened: Happened,
    plan: Plan,
    state: State,
    series: Series,
    record: Record,
) -> int:
    """Do the duties of the present instant."""
    put_on_constraint(plan, state)
    events = state.count[EVENTS]
    ended = impacts(plan, state, record)
    if ended != DONE:
        return ended
    if state.count[EVENTS] > events:
        choose_directions(plan, state, series)
    if not rest(forcing, happened.released, plan, state, series, record):
        return NO_FORCES
    return DONE


@compiled_apart
def advance(
    budget: int,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
    record: Record,
    seen: Seen,
) -> int:
    """Carry a run on by at most `budget` steps.

    Returns
    -------
    int
        How it ended: FINISHED, GOING_ON, FULL (the record needs more room), or
        an error; the state says when and where.
    """
    limits, ground, contacts, hysteresis = plan.limits, plan.ground, plan.contacts, plan.hysteresis
    clock, count = state.clock, state.count
    table = record.extremes
    running = Running(table[0], table[1], table[2], table[3], table[4])
    enter_mode(plan, state, series, record)
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    highest = limits.order
    for _ in range(budget):
        room = 2 * contacts.gap.size + 4
        if count[ROWS] + 4 > record.rows.shape[0]:
            return FULL
        if count[EVENTS] + room > record.events.shape[0]:
            return FULL
        t = clock[T]
        if count[DUE] == 1:
            while ground.ends[count[PIECE]] <= t:
                count[PIECE] += 1
            i = count[PIECE]
            family = ground.family[i]
            coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
            samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
            forcing = Forcing(family, coefficients, samples, t)
            ended = settle(forcing, happened, plan, state, series, record)
            if ended != DONE:
                return ended
            enter_mode(plan, state, series, record)
            g = ground_acceleration(family, coefficients, samples, t)
            look(0.0, highest, g, plan, state, series, seen)
            choose_branches(plan, state, series, seen.a, g)
            look(0.0, highest, g, plan, state, series, seen)
            write_row(t, plan, seen, state, record)
            take_instant(t, plan, seen, running)
            count[DUE] = 0
            happened.released[:] = False
            if t >= limits.end:
                return FINISHED
        elif t >= limits.end:
            g = ground_acceleration(family, coefficients, samples, t)
            look(0.0, highest, g, plan, state, series, seen)
            write_row(t, plan, seen, state, record)
            return FINISHED
        piece_end = min(ground.ends[count[PIECE]], limits.end)
        stop = piece_end
        if family == _SAMPLES:
            stop = next_sample(coefficients, t, piece_end)
        limit = stop - t
        order = count[ORDER]
        _expand_all(t, order, family, coefficients, samples, plan, state, series)
        for _again in range(4):
            if not wrong_way(plan, state, series, order):
                break
            _expand_all(t, order, family, coefficients, samples, plan, state, series)
        h = _choose_length(order, limit, family, coefficients, plan, state, series)
        if count[RESTING] > 0:
            contact_force_series(order, plan, state, series)
        set_travel(order, h, count[CLUSTERS], series)
        first = first_happening(order, h, plan, state, series, happened)
        tau = min(h, first)
        t_end = stop if tau == limit else t + tau
        g_end = ground_acceleration(family, coefficients, samples, t_end)
        for _again in range(60):
            look(tau, order, g_end, plan, state, series, seen)
            error = defect_error(tau, order, g_end, plan, state, series, seen)
            if error <= DEFECT_SHARE:
                break
            tau *= 0.5 if not error < 1e6 else max(0.5, 0.9 * error ** (-1.0 / order))
            first = np.inf
            t_end = t + tau
            g_end = ground_acceleration(family, coefficients, samples, t_end)
        else:
            return NOT_FINITE
        is_event = first <= tau
        if not is_event:
            clock[GUESS] = tau
        ended = _audit(plan, state, series, seen)
        if ended != DONE:
            return ended
        inside_step(tau, order, plan, state, series, seen, running)
        if limits.ledger:
            add_work(tau, order, family, coefficients, samples, plan, state, series, seen)
        look(tau, order, g_end, plan, state, series, seen)
        take_instant(t_end, plan, seen, running)
        count[STEPS] += 1
        ended = _sample(
            t, t_end, tau, order, family, coefficients, samples, plan, state, series, seen, record
        )
        if ended != DONE:
            return ended
        _move(t_end, tau, plan, state, seen)
        if is_event:
            _apply(tau, plan, state, series, happened, seen, record)
        else:
            clock[INTERVAL] = tau
            count[STALLED] = 0
            if clock[SINCE_IMPACT] > CASCADE_OVER * limits.time:
                list_all(state, record)
        if count[STALLED] > MOST_STALLS:
            return STUCK
        if t_end >= ground.ends[count[PIECE]] and t_end < limits.end:
            count[DUE] = 1
    return GOING_ON


@compiled
def _expand_all(
    t: float,
    order: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
) -> None:
    """Taylor series of everything at the present instant."""
    ground_taylor(family, coefficients, samples, t, order, series.ground)
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0:
            series.X[c, 1] = state.v[b]
    hysteresis = plan.hysteresis
    link_state(plan.links, hysteresis, state, series)
    for h in range(hysteresis.link.size):
        if state.part[h] == UP:
            xi = place(h, series.x[hysteresis.link[h]], hysteresis, state)
            if xi >= hysteresis.saturated[h]:
                state.part[h] = SATURATED
    expand(order, plan.links, hysteresis, state, series)
    state.count[EXPANSIONS] += 1


@compiled
def _choose_length(
    order: int,
    limit: float,
    family: int,
    coefficients: Floats,
    plan: Plan,
    state: State,
    series: Series,
) -> float:
    """Length of the next step (s), and for a record the order of the one after it."""
    clock, count = state.clock, state.count
    longest = limit
    if family == _GAUSSIAN:
        longest = min(longest, GAUSSIAN_STEP / math.sqrt(coefficients[1]))
    if family == _SINUSOIDS:
        for k in range(1, coefficients.size, 3):
            if coefficients[k + 1] > 0.0:
                longest = min(longest, SINUSOID_STEP / coefficients[k + 1])
    if not longest < np.inf:
        longest = plan.limits.time * 1e3
    guess = min(longest, 2.0 * clock[GUESS])
    if family == _SAMPLES:
        guess = longest
    error = step_error(guess, order, plan, state, series)
    if state.count[RESTING] > 0:
        # Forces of resting contacts follow the ground motion itself.
        share = LOCAL_SHARE * plan.limits.rtol * plan.limits.length / plan.limits.time**2
        error = max(error, abs(series.ground[order - 1]) * guess ** (order - 1) / share)
        error = max(error, abs(series.ground[order - 2]) * guess ** (order - 2) / share)
    if family == _SAMPLES:
        highest = plan.limits.order
        if error > 1.0 and order < highest:
            count[ORDER] = order + 1
        elif error < 1e-3 and order > SMALLEST_ORDER:
            count[ORDER] = order - 1
    else:
        count[ORDER] = plan.limits.order
    if error <= 1.0:
        if guess < longest and error < 0.5:
            grown = guess * min(10.0, (0.5 / max(error, 1e-30)) ** (1.0 / (order - 1)))
            return min(longest, grown)
        return guess
    return guess * (0.5 / error) ** (1.0 / (order - 1)) if error < np.inf else 1e-3 * guess


@compiled
def _audit(plan: Plan, state: State, series: Series, seen: Seen) -> int:
    """Invariants after every step: finite numbers, no penetration."""
    limits = plan.limits
    for b in range(plan.mass.size):
        if not (abs(seen.u[b]) < np.inf and abs(seen.v[b]) < np.inf):
            return NOT_FINITE
    for j in range(seen.gap.size):
        if not state.resting[j] and seen.gap[j] < -PENETRATED * limits.length:
            return PENETRATION
    return DONE


@compiled_apart
def _sample(
    t: float,
    t_end: float,
    tau: float,
    order: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
) -> int:
    """History at the output times of the step."""
    count, times = state.count, plan.output_times
    if not (count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end):
        return DONE
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        at = times[count[OUTPUT]]
        if at >= t:
            if count[ROWS] + 4 > record.rows.shape[0]:
                return FULL
            g = ground_acceleration(family, coefficients, samples, at)
            look(at - t, order, g, plan, state, series, seen)
            write_row(at, plan, seen, state, record)
        count[OUTPUT] += 1
    g = ground_acceleration(family, coefficients, samples, t_end)
    look(tau, order, g, plan, state, series, seen)
    return DONE


@compiled
def _move(t_end: float, tau: float, plan: Plan, state: State, seen: Seen) -> None:
    """Make the end of the step the present state."""
    _put(seen.u, seen.u.size, state.u, 0)
    _put(seen.v, seen.v.size, state.v, 0)
    _put(seen.gap, seen.gap.size, state.gap, 0)
    _put(seen.gap_rate, seen.gap.size, state.gap_rate, 0)
    state.clock[T] = t_end
    state.clock[SINCE_IMPACT] += tau


@compiled_apart
def _apply(
    tau: float,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
    seen: Seen,
    record: Record,
) -> None:
    """Do what happened at the end of a step; an event of contacts is settled next."""
    hysteresis = plan.hysteresis
    elongations(plan, state, series)
    for h in range(hysteresis.link.size):
        x = series.x[hysteresis.link[h]]
        if happened.turned[h]:
            reverse(h, x, hysteresis, state)
        elif happened.crossed[h]:
            cross_border(h, x, hysteresis, state)
    state.count[STALLED] = state.count[STALLED] + 1 if tau == 0.0 else 0
    due = False
    for j in range(state.gap.size):
        if happened.closing[j]:
            state.gap[j] = 0.0
            due = True
        due = due or happened.released[j]
    for a in range(state.branch.size):
        if happened.kinked[a]:
            state.branch[a] = -state.branch[a]
            due = True
    if not due:
        return
    noise = FORCE_NOISE * plan.limits.mass * plan.limits.length / plan.limits.time**2
    if happened.released.any():
        for j in range(state.gap.size):
            if state.unlocked[j] and abs(seen.contact_force[j]) <= noise:
                happened.released[j] = True
    if happened.closing.any():
        mark_together(tau, plan, state)
    state.clock[INTERVAL] = tau
    write_row(state.clock[T], plan, seen, state, record)
    state.count[DUE] = 1
