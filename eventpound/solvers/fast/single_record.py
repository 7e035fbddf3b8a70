"""A single body from sample to sample of a record, where it is linear: an exact step.

Between samples the ground acceleration is a straight line, so with stiffness
K_t and damping C the motion after dt is linear in the velocity v, the
relative acceleration a and the slope of the record (N. C. Nigam and P. C.
Jennings, Bull. Seism. Soc. Am. 59 (1969) 909-922):

    u += α_1 v + α_2 a - α_3 slope,    v = β_1 v + β_2 a - β_3 slope.

The six numbers are Taylor series summed to rounding, once for each stiffness.
A step is taken this way only where bounds exclude every event.
"""

from __future__ import annotations

from eventpound.motion.forcing import sample_time
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast.backbone_parts import CORE, SATURATED, UNLOADING
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import (
    GUESS,
    OUTPUT,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.seen import OWN_GAP, Seen
from eventpound.solvers.fast.single import part_and_direction, place_of, spring_state
from eventpound.solvers.fast.single_extremes import force_exceeds
from eventpound.solvers.fast.single_ground import OF_X, TABLES
from eventpound.solvers.fast.single_history import sample_single
from eventpound.solvers.fast.single_series import INVERSE_PAIRS, ROOM

TABLE_SIZE = 8
MOST_TERMS = 30
ROW_ORDER = 16
"""Order of the series that gives rows between samples: 0.5^8 / 16! is far below rounding."""
MOST_TURN = 0.5
"""Largest ``C dt + K_t dt²`` for which the bounds of a step are good."""


@compiled_apart
def _fill_table(stiffness: float, damping: float, dt: float, table: Floats) -> None:
    """Numbers of a step of length dt (s): dt, α, β, and 1 / (1 - C dt - K_t dt²), 0 if unfit."""
    table[0] = dt
    stretch = damping * dt + stiffness * dt * dt
    table[7] = 1.0 / (1.0 - stretch) if stretch <= MOST_TURN else 0.0
    for column in range(3):
        first, second = 1.0 if column == 0 else 0.0, 0.5 if column == 1 else 0.0
        power = dt * dt
        change, rate = first * dt + second * power, first + 2.0 * second * dt
        for k in range(1, MOST_TERMS):
            third = (
                -stiffness * first
                - damping * (k + 1) * second
                + (1.0 if column == 2 and k == 1 else 0.0)
            ) * INVERSE_PAIRS[k]
            rate += (k + 2) * third * power
            power *= dt
            change += third * power
            first, second = second, third
        table[1 + column], table[4 + column] = change, rate


@compiled
def next_output(plan: Plan, state: State) -> float:
    """Time of the next row of the history (s), 1e300 where there is none."""
    i = state.count[OUTPUT]
    return plan.output_times[i] if i < plan.output_times.size else 1e300


@compiled_apart
def _line_series(
    v: float, a: float, slope: float, stiffness: float, damping: float, x: Floats
) -> None:
    """Taylor coefficients 1 ... `ROW_ORDER` of the displacement over a straight line."""
    x[1], x[2] = v, 0.5 * a
    for k in range(1, ROW_ORDER - 1):
        force = stiffness * x[k] + damping * (k + 1) * x[k + 1]
        if k == 1:
            force += slope
        x[k + 2] = -force / ((k + 1) * (k + 2))


@compiled
def sample_steps(
    budget: int,
    segment: int,
    piece_end: float,
    z: float,
    acceleration: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
    running: Running,
) -> tuple[int, float, float]:
    """Steps from the sample `segment`, where the body is, as far as nothing can happen.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them.

    Returns
    -------
    segment, z, acceleration
        Where the body is then, with ``σ y`` and its absolute acceleration (m/s²).
    """
    o, limits, gap = plan.oscillator, plan.limits, plan.contacts.gap
    single = series.single
    part, sigma = part_and_direction(o, state)
    if UNLOADING < part < SATURATED:
        return segment, z, acceleration
    linear = part <= UNLOADING and o.strength > 0.0
    stiffness = o.stiffness + (o.strength / o.scale if linear else 0.0)
    origin, dt = coefficients[0], coefficients[1]
    at = TABLES + (TABLE_SIZE if part == SATURATED else 0)
    table = single[at : at + TABLE_SIZE]
    if table[0] != dt:
        _fill_table(stiffness, o.damping, dt, table)
    if table[7] == 0.0:
        return segment, z, acceleration
    of_v, of_a, of_slope = table[1], table[2], table[3]
    v_of_v, v_of_a, v_of_slope = table[4], table[5], table[6]
    inverse, over = table[7], 1.0 / dt
    own = OWN_GAP * limits.length
    highest = gap[o.right] - own if o.right >= 0 else 1e300
    lowest = own - gap[o.left] if o.left >= 0 else -1e300
    until = piece_end - 1e-9 * dt
    output = next_output(plan, state)
    core = plan.hysteresis.core[0] if linear else 0.0
    u, v, t = state.u[0], state.v[0], state.clock[T]
    xi = place_of(u, o, state) if linear else 0.0
    pace = sigma / o.scale
    first, started = segment, segment
    while segment - first < budget and segment + 2 < samples.size:
        following = sample_time(origin, dt, segment + 1)
        if not following < until:
            break
        slope = (samples[segment + 1] - samples[segment]) * over
        a = acceleration - samples[segment]
        fastest = (abs(a) + dt * (stiffness * abs(v) + abs(slope))) * inverse
        reach = dt * (abs(v) + dt * fastest)
        one_way = abs(v) > dt * fastest
        u_1 = u + of_v * v + of_a * a - of_slope * slope
        low, high = u_1, u_1
        if not one_way:
            low, high = u - reach, u + reach
            if (
                part != CORE
                or low < running.minimum[0] - running.rounding[0]
                or high > running.maximum[0] + running.rounding[0]
            ):
                break
        if not (lowest < low and high < highest):
            break
        if o.damping > 0.0 or not one_way:
            spread = stiffness * reach + o.damping * dt * fastest
            if force_exceeds(acceleration - spread, acceleration + spread, plan, running):
                break
        v_1 = v_of_v * v + v_of_a * a - v_of_slope * slope
        if linear:
            ahead = xi + pace * (u_1 - u)
            if one_way:
                if ahead > core or (part == CORE and ahead < -core):
                    break
            elif abs(xi) + reach / o.scale > core:
                break
            xi = ahead
            z = sigma * ahead
        if output < following:
            if segment > started:
                _arrive(u, v, t, segment - started, dt, plan, state)
                started = segment
            _line_series(v, a, slope, stiffness, o.damping, single[OF_X : OF_X + ROOM])
            if not sample_single(
                t,
                following,
                ROW_ORDER,
                family,
                coefficients,
                samples,
                plan,
                state,
                series,
                seen,
                record,
            ):
                break
            output = next_output(plan, state)
        u, v, t = u_1, v_1, following
        acceleration = o.pull - o.stiffness * u - o.damping * v - o.strength * z
        segment += 1
    if segment > started:
        _arrive(u, v, t, segment - started, dt, plan, state)
    if segment > first:
        z = spring_state(u, o, plan.hysteresis, state)
    return segment, z, acceleration


@compiled
def _arrive(u: float, v: float, t: float, steps: int, dt: float, plan: Plan, state: State) -> None:
    clock, count, o = state.clock, state.count, plan.oscillator
    state.u[0], state.v[0], clock[T] = u, v, t
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = plan.contacts.gap[o.right] - u, -v
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = plan.contacts.gap[o.left] + u, v
    clock[SINCE_IMPACT] += steps * dt
    clock[GUESS] = dt
    count[STEPS] += steps
    count[STALLED] = 0
