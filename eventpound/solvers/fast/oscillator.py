"""The steps of a single body, in scalars, until something is to be settled.

Each step is one that `eventpound.solvers.fast.advance` could have taken, and
leaves the same state: series, length from the last terms, first event, defect
at the end, extremes and history.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import sample_time
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import cross_border, reverse
from eventpound.solvers.fast.compiled import compiled_apart
from eventpound.solvers.fast.history import write_row
from eventpound.solvers.fast.instant import DONE, FULL, list_all
from eventpound.solvers.fast.length import GAUSSIAN_STEP, LOCAL_SHARE
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
from eventpound.solvers.fast.seen import Seen, look_apart
from eventpound.solvers.fast.single import absolute_acceleration, spring_state
from eventpound.solvers.fast.single_extremes import damped_acceleration, take_if_new
from eventpound.solvers.fast.single_ground import (
    OF_G,
    OF_X,
    PIECE_KNOWN,
    expand_ground,
    is_pair,
    know_piece,
    other_acceleration,
    pair_at,
    sample_after,
)
from eventpound.solvers.fast.single_history import agree_at_barrier, move_gaps, sample_single
from eventpound.solvers.fast.single_record import sample_steps
from eventpound.solvers.fast.single_series import ROOM, motion
from eventpound.solvers.fast.single_step import (
    CLOSED_RIGHT,
    CROSSED,
    FREE,
    TURNED,
    expand_step,
    first_event,
)

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
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    piece_end = min(ground.ends[i], limits.end)
    if single[PIECE_KNOWN] != i + 1.0:
        know_piece(i, family, coefficients, single)
    pair = is_pair(family, coefficients)
    longest = GAUSSIAN_STEP / math.sqrt(coefficients[1]) if family == _GAUSSIAN else np.inf
    agree_at_barrier(plan, state)
    stop, segment = piece_end, 0
    even, odd = 0.0, 0.0
    if family == _SAMPLES:
        stop, segment = sample_after(coefficients, samples, clock[T], piece_end)
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
                stop, segment = sample_after(coefficients, samples, t, piece_end)
                even, odd = pair_at(t, family, coefficients, samples, segment, single)
            if t == sample_time(coefficients[0], dt, segment):
                before = segment
                segment, z, acceleration = sample_steps(
                    last_step - count[STEPS],
                    segment,
                    piece_end,
                    z,
                    acceleration,
                    family,
                    coefficients,
                    samples,
                    plan,
                    state,
                    series,
                    seen,
                    record,
                    running,
                )
                if segment > before:
                    t = clock[T]
                    stop, segment = sample_after(coefficients, samples, t, piece_end)
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
        order, first, h, part, sigma, z = expand_step(
            wanted, of_u, of_v, z, acceleration - a_g, even, odd, plan, state, series
        )
        tau, event, turn = first_event(
            h, order, first, part, sigma, acceleration, plan, state, series, running
        )
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
        if o.damping > 0.0:
            damped_acceleration(
                t, tau, order, acceleration, even, odd, g, x, plan, state, series, running
            )
        times = plan.output_times
        if (
            count[OUTPUT] < times.size
            and times[count[OUTPUT]] < t_end
            and not sample_single(
                t, t_end, order, family, coefficients, samples, plan, state, series, seen, record
            )
        ):
            code = FULL
            break
        # There.
        if event == TURNED or (turn <= tau and event == FREE):
            rate = 0.0
            take_if_new(t_end, u_end, a_end, plan, running)
        if move_gaps(change, u_end, rate, plan, state) < -noise.PENETRATED * limits.length:
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
