"""The steps of a single body, in scalars, until something is to be settled.

Each step is one that `eventpound.solvers.fast.advance` could have taken, and
leaves the same state: series, length from the last terms, first event, defect
at the end, extremes and history. What is special is the motion between two reversals: it
goes one way, so gaps and borders of the backbone are passed exactly where they
are behind at the end.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import (
    CORE,
    DOWN,
    SATURATED,
    UNLOADING,
    UP,
    cross_border,
    reverse,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.history import write_row
from eventpound.solvers.fast.instant import DONE, FULL, list_all
from eventpound.solvers.fast.length import (
    GAUSSIAN_STEP,
    LOCAL_SHARE,
    next_sample,
)
from eventpound.solvers.fast.outcome import (
    CASCADE_OVER,
    MOST_HALVINGS,
    MOST_STALLS,
    NO_STEP,
    NOT_FINITE,
    PENETRATION,
    STUCK,
)
from eventpound.solvers.fast.plan import (
    DUE,
    EXPANSIONS,
    GUESS,
    IN_A_ROW,
    INTERVAL,
    MORE_TERMS,
    OUTPUT,
    PIECE,
    ROWS,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.seen import OWN_GAP, Seen, look_apart
from eventpound.solvers.fast.single import (
    absolute_acceleration,
    part_and_direction,
    place_of,
    spring_state,
)
from eventpound.solvers.fast.single_extremes import (
    damped_acceleration,
    exceeds,
    take_if_new,
)
from eventpound.solvers.fast.single_ground import (
    OF_G,
    OF_POWER,
    OF_SPEED,
    OF_W,
    OF_X,
    OF_Z,
    PIECE_KNOWN,
    expand_ground,
    is_pair,
    know_piece,
    other_acceleration,
    pair_at,
)
from eventpound.solvers.fast.single_record import sample_steps
from eventpound.solvers.fast.single_search import crossing, first_reached, first_turn
from eventpound.solvers.fast.single_series import (
    ROOM,
    curved_series,
    linear_series,
    motion,
    shorter,
)

FREE, TURNED, CROSSED, CLOSED_RIGHT, CLOSED_LEFT = 0, 1, 2, 3, 4
"""How a step ends."""
_SAMPLES, _GAUSSIAN = int(Family.SAMPLES), int(Family.GAUSSIAN)


@compiled_apart
def oscillate(
    last_step: int, plan: Plan, state: State, series: Series, record: Record, seen: Seen
) -> int:
    """Carry a single body on to the next instant with duties, or as far as steps and room reach.

    Parameters
    ----------
    last_step : int
        Number of steps of the run at which to stop.
    plan, state, series, record, seen
        See `eventpound.solvers.fast.plan` and `seen`.

    Returns
    -------
    int
        DONE, FULL or how the run failed.
    """
    limits, o, clock, count = plan.limits, plan.oscillator, state.clock, state.count
    hysteresis, single, ground = plan.hysteresis, series.single, plan.ground
    extremes = record.extremes
    running = Running(extremes[0], extremes[1], extremes[2], extremes[3], extremes[4])
    x, g = single[OF_X : OF_X + ROOM], single[OF_G : OF_G + ROOM]
    z_series, w = single[OF_Z : OF_Z + ROOM], single[OF_W : OF_W + ROOM]
    power, speed = single[OF_POWER : OF_POWER + ROOM], single[OF_SPEED : OF_SPEED + ROOM]
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    piece_end = min(ground.ends[i], limits.end)
    if single[PIECE_KNOWN] != i + 1.0:
        know_piece(i, family, coefficients, single)
    pair = is_pair(family, coefficients)
    longest = GAUSSIAN_STEP / math.sqrt(coefficients[1]) if family == _GAUSSIAN else np.inf
    still = noise.SPEED * limits.length / limits.time
    own = OWN_GAP * limits.length
    exponent, rho, core, standing = 1.0, 0.0, np.inf, 0.0
    if o.strength > 0.0:
        law, a = plan.links.law, hysteresis.link[0]
        exponent = law.exponent[a]
        rho = (law.beta[a] - law.gamma[a]) / (law.beta[a] + law.gamma[a])
        core = hysteresis.core[0]
        # A link that all but stands still reverses at the level of rounding.
        standing = limits.hysteresis * o.scale
    _agree_at_barrier(plan, state)
    stop, segment = piece_end, 0
    even, odd = 0.0, 0.0
    if family == _SAMPLES:
        stop, segment = _sample_after(coefficients, samples, clock[T], piece_end)
    if pair:
        even, odd = pair_at(clock[T], family, coefficients, samples, segment, single)
    z = spring_state(state.u[0], o, hysteresis, state)
    acceleration = absolute_acceleration(state.u[0], state.v[0], z, o)
    held_back = True
    code = DONE
    while count[STEPS] < last_step and count[ROWS] + 4 <= record.rows.shape[0]:
        t = clock[T]
        if family == _SAMPLES:
            dt = coefficients[1]
            if stop <= t + 1e-9 * dt and stop < piece_end:
                stop, segment = _sample_after(coefficients, samples, t, piece_end)
                even, odd = pair_at(t, family, coefficients, samples, segment, single)
            if t == coefficients[0] + segment * dt:
                before = segment
                segment, z, acceleration = sample_steps(
                    last_step - count[STEPS],
                    segment,
                    piece_end,
                    z,
                    acceleration,
                    coefficients,
                    samples,
                    plan,
                    state,
                    single,
                    running,
                )
                if segment > before:
                    t = clock[T]
                    stop, segment = _sample_after(coefficients, samples, t, piece_end)
                    even, odd = pair_at(t, family, coefficients, samples, segment, single)
                    if count[STEPS] >= last_step:
                        break
        elif not pair:
            even = odd = 1.0
            a_g = expand_ground(t, limits.order + MORE_TERMS, family, coefficients, samples, g)
        u, v = state.u[0], state.v[0]
        wanted = min(stop - t, longest)
        of_u = LOCAL_SHARE * (limits.atol_u + limits.rtol * abs(u))
        of_v = LOCAL_SHARE * (limits.atol_v + limits.rtol * abs(v))
        if pair:
            a_g = even
        # The series, in the direction in which the body moves.
        order, first, good, part, sigma = 0, 1, False, CORE, 1.0
        for _ in range(4):
            part, sigma = part_and_direction(o, state)
            if part == UP and place_of(u, o, state) >= hysteresis.saturated[0]:
                part = state.part[0] = SATURATED
                z = sigma
            x[1], x[2] = v, 0.5 * (acceleration - a_g)
            if part != UP and part != DOWN:
                stiffness = o.stiffness
                if part <= UNLOADING and o.strength > 0.0:
                    stiffness += o.strength / o.scale
                order, good = linear_series(
                    stiffness,
                    o.damping,
                    even,
                    odd,
                    g,
                    limits.order + MORE_TERMS,
                    wanted,
                    of_u,
                    of_v,
                    x,
                )
            else:
                order, good = curved_series(
                    o.stiffness,
                    o.damping,
                    o.strength,
                    1.0 / o.scale,
                    exponent,
                    1.0 if part == UP else rho,
                    even,
                    odd,
                    g,
                    limits.order,
                    wanted,
                    of_u,
                    of_v,
                    z,
                    x,
                    z_series,
                    power,
                    speed,
                )
            count[EXPANSIONS] += 1
            first = 1
            if abs(v) <= still:
                first = _leading(order, still / limits.time, plan, state, x)
            if part == CORE or sigma * x[first] >= 0.0:
                break
            reverse(0, o.side * u, hysteresis, state)
        h = wanted if good else shorter(wanted, order, of_u, of_v, x)
        # The first event.
        event, tau = FREE, h
        free = part == CORE
        reach = h * (abs(v) + h * abs(x[2]))
        if free or reach <= standing:
            reach = 0.0
            for k in range(order, 0, -1):
                reach = (reach + abs(x[k])) * h
            free = free or reach <= standing
        turn = np.inf
        if free:
            tau, event = _first_unordered(h, order, u, core, part, sigma, x, w, plan, state)
            at_a = running.maximum.size - 2 - plan.contacts.gap.size
            spread = reach * (o.stiffness + o.strength / o.scale)
            if exceeds(0, u - reach, u + reach, running) or (
                limits.track
                and exceeds(at_a, acceleration - spread, acceleration + spread, running)
            ):
                turn = first_turn(x, order, first, tau, w)
                if turn < tau:
                    tau, event = turn, FREE
        else:
            turn = first_turn(x, order, first, h, w)
            if turn <= h:
                tau, event = turn, TURNED
        change, rate, bend = motion(tau, order, x)
        if not free:
            one_way = tau
            barrier = o.right if sigma > 0.0 else o.left
            if barrier >= 0 and state.gap[barrier] - sigma * change <= 0.0 and tau > 0.0:
                tau = crossing(state.gap[barrier], sigma, x, order, tau)
                event = CLOSED_RIGHT if sigma > 0.0 else CLOSED_LEFT
            if part < UP:
                border = core if part <= UNLOADING else hysteresis.down[0]
                distance = (border - place_of(u, o, state)) * o.scale
                if distance <= 1e-15 * o.scale:
                    tau, event = 0.0, CROSSED
                elif distance - sigma * change <= 0.0:
                    at = crossing(distance, sigma, x, order, one_way)
                    if at < tau:
                        tau, event = at, CROSSED
            if event >= CROSSED:
                change, rate, bend = motion(tau, order, x)
        # Its end, where the equations of motion must hold.
        t_end, u_end, z_end, a_end, g_end = t, u, z, acceleration, 0.0
        next_even, next_odd = even, odd
        fits = False
        for _ in range(MOST_HALVINGS):
            t_end = stop if tau == stop - t else t + tau
            u_end = u + change
            if pair:
                next_even, next_odd = pair_at(t_end, family, coefficients, samples, segment, single)
                g_end = next_even
            else:
                g_end = other_acceleration(t_end, family, coefficients, samples)
            z_end = spring_state(u_end, o, hysteresis, state)
            a_end = absolute_acceleration(u_end, rate, z_end, o)
            defect = abs(a_end - g_end - bend) * tau
            if defect <= of_v * order and defect * tau <= of_u * order:
                fits = True
                break
            error = max(defect / (of_v * order), defect * tau / (of_u * order))
            event = FREE
            tau *= max(0.1, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.1
            change, rate, bend = motion(tau, order, x)
        if not fits:
            code = NO_STEP
            break
        if not (abs(u_end) < np.inf and abs(rate) < np.inf):
            code = NOT_FINITE
            break
        if limits.track and o.damping > 0.0:
            damped_acceleration(
                t, tau, order, acceleration, even, odd, g, x, plan, state, series, running
            )
        times = plan.output_times
        if (
            count[OUTPUT] < times.size
            and times[count[OUTPUT]] < t_end
            and not _sample(
                t, t_end, order, family, coefficients, samples, plan, state, series, seen, record
            )
        ):
            code = FULL
            break
        # There.
        if event == TURNED or (turn <= tau and event == FREE):
            rate = 0.0
            take_if_new(t_end, u_end, a_end, plan, running)
        deepest = 0.0
        if o.right >= 0:
            near = state.gap[o.right] - change
            far = plan.contacts.gap[o.right] - u_end
            state.gap[o.right] = far if far >= own else near
            state.gap_rate[o.right] = -rate
            deepest = min(deepest, state.gap[o.right])
        if o.left >= 0:
            near = state.gap[o.left] + change
            far = plan.contacts.gap[o.left] + u_end
            state.gap[o.left] = far if far >= own else near
            state.gap_rate[o.left] = rate
            deepest = min(deepest, state.gap[o.left])
        if deepest < -noise.PENETRATED * limits.length:
            code = PENETRATION
            break
        state.u[0], state.v[0] = u_end, rate
        clock[T] = t_end
        clock[SINCE_IMPACT] += tau
        count[STEPS] += 1
        even, odd, z, acceleration = next_even, next_odd, z_end, a_end
        if event == FREE:
            clock[GUESS] = tau
            count[STALLED] = 0
            if held_back and clock[SINCE_IMPACT] > CASCADE_OVER * limits.time:
                list_all(state, record)
                count[IN_A_ROW] = 0
                held_back = False
        else:
            count[STALLED] = count[STALLED] + 1 if tau == 0.0 else 0
            if event == TURNED:
                reverse(0, o.side * u_end, hysteresis, state)
            elif event == CROSSED:
                cross_border(0, o.side * u_end, hysteresis, state)
            else:
                clock[INTERVAL] = clock[SINCE_IMPACT]
                state.gap[o.right if event == CLOSED_RIGHT else o.left] = 0.0
                look_apart(0.0, order, g_end, plan, state, series, seen)
                write_row(t_end, plan, seen, state, record)
                count[DUE] = 1
            if count[STALLED] > MOST_STALLS:
                code = STUCK
                break
        if t_end >= piece_end:
            if t_end >= ground.ends[i]:
                count[DUE] = 1
            break
        if count[DUE] == 1:
            break
    take_if_new(clock[T], state.u[0], acceleration, plan, running)
    return code


@compiled
def _agree_at_barrier(plan: Plan, state: State) -> None:
    """Take the velocity of a body at a barrier from the rate of its gap, and the other gap's too.

    After an impact that rate keeps its relative accuracy.
    """
    o, v = plan.oscillator, state.v[0]
    if o.right >= 0 and state.gap[o.right] == 0.0:
        v = -state.gap_rate[o.right]
    elif o.left >= 0 and state.gap[o.left] == 0.0:
        v = state.gap_rate[o.left]
    state.v[0] = v
    if o.right >= 0:
        state.gap_rate[o.right] = -v
    if o.left >= 0:
        state.gap_rate[o.left] = v


@compiled
def _sample_after(
    coefficients: Floats, samples: Floats, t: float, piece_end: float
) -> tuple[float, int]:
    """Next sample of a record after t (s), or the end of the piece; the sample before."""
    stop = next_sample(coefficients, t, piece_end)
    origin, dt = coefficients[0], coefficients[1]
    segment = math.floor((stop - origin) / dt - 0.5)
    if stop == piece_end:
        segment = math.floor((t - origin) / dt + 1e-9)
    return stop, min(max(segment, 0), samples.size - 2)


@compiled
def _leading(order: int, level: float, plan: Plan, state: State, x: Floats) -> int:
    """First coefficient that differs from rounding, of a body that all but stands still.

    One that leaves a barrier from rest has those before made zero.
    """
    o, limits = plan.oscillator, plan.limits
    if x[1] == 0.0:
        away = 0.0
        if o.right >= 0 and state.gap[o.right] == 0.0:
            away = -1.0
        elif o.left >= 0 and state.gap[o.left] == 0.0:
            away = 1.0
        if away != 0.0:
            for k in range(2, order + 1):
                least = noise.ROUNDING * abs(x[k])
                if k == 2:
                    least += noise.ACCELERATION * limits.length / limits.time**2
                if away * x[k] > least:
                    break
                x[k] = 0.0
    for k in range(2, order + 1):
        if abs(x[k]) > (level if k == 2 else 0.0):
            return k
    return 1


@compiled
def _first_unordered(
    h: float,
    order: int,
    u: float,
    core: float,
    part: int,
    sigma: float,
    x: Floats,
    w: Floats,
    plan: Plan,
    state: State,
) -> tuple[float, int]:
    """First closing or border within h (s) of a body that may turn without an event."""
    o = plan.oscillator
    tau, event = h, FREE
    if o.right >= 0:
        at = first_reached(state.gap[o.right], 1.0, x, order, tau, w)
        if at <= tau:
            tau, event = at, CLOSED_RIGHT
    if o.left >= 0:
        at = first_reached(state.gap[o.left], -1.0, x, order, tau, w)
        if at <= tau:
            tau, event = at, CLOSED_LEFT
    if o.strength > 0.0 and part <= DOWN:
        xi = place_of(u, o, state)
        border = core if part <= UNLOADING else plan.hysteresis.down[0]
        for side in (1.0, -1.0):
            if side < 0.0 and part != CORE:
                continue
            distance = (border - side * xi) * o.scale
            if distance <= 1e-15 * o.scale:
                distance = 0.0
            at = first_reached(distance, side * sigma, x, order, tau, w)
            if at < tau:
                tau, event = at, CROSSED
    return tau, event


@compiled_apart
def _sample(
    t: float,
    t_end: float,
    order: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
) -> bool:
    """History at the output times of a step; False where the record has no room."""
    o, count, times = plan.oscillator, state.count, plan.output_times
    x = series.single[OF_X : OF_X + ROOM]
    u, v = state.u[0], state.v[0]
    right = state.gap[o.right] if o.right >= 0 else 0.0
    left = state.gap[o.left] if o.left >= 0 else 0.0
    room = True
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        at = times[count[OUTPUT]]
        if at >= t:
            if count[ROWS] + 4 > record.rows.shape[0]:
                room = False
                break
            change, rate, _ = motion(at - t, order, x)
            state.u[0], state.v[0] = u + change, rate
            if o.right >= 0:
                state.gap[o.right], state.gap_rate[o.right] = right - change, -rate
            if o.left >= 0:
                state.gap[o.left], state.gap_rate[o.left] = left + change, rate
            g = other_acceleration(at, family, coefficients, samples)
            look_apart(0.0, order, g, plan, state, series, seen)
            write_row(at, plan, seen, state, record)
        count[OUTPUT] += 1
    state.u[0], state.v[0] = u, v
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = right, -v
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = left, v
    return room
