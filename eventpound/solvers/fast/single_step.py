"""A step of a single body: its series and the first event within it.

What is special is the motion between two reversals: it goes one way, so a gap
has closed, or a border of the backbone was passed, if it is behind at the end.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import CORE, DOWN, SATURATED, UNLOADING, UP, reverse
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.plan import EXPANSIONS, MORE_TERMS, Plan, Series, State
from eventpound.solvers.fast.single import part_and_direction, place_of
from eventpound.solvers.fast.single_extremes import exceeds, force_exceeds
from eventpound.solvers.fast.single_ground import OF_G, OF_POWER, OF_SPEED, OF_W, OF_X, OF_Z
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
MOST_REVERSALS = 4
"""Times a body that all but stands still is turned round at the start of a step."""


@compiled
def expand_step(
    wanted: float,
    of_u: float,
    of_v: float,
    z: float,
    a_0: float,
    even: float,
    odd: float,
    plan: Plan,
    state: State,
    series: Series,
) -> tuple[int, int, float, int, float, float]:
    """Series of a step, in the direction in which the body moves.

    Parameters
    ----------
    wanted : float
        Longest step (s).
    of_u, of_v : float
        Errors allowed (m, m/s).
    z, a_0 : float
        ``σ y``, and the relative acceleration (m/s²), at the start.
    even, odd
        Of the ground motion (`eventpound.solvers.fast.single_ground`).
    plan, state, series
        See `eventpound.solvers.fast.plan`.

    Returns
    -------
    order, first, h, part, sigma, z
        Highest power, lowest that differs from zero, length (s), part of the
        backbone, direction on it, and ``σ y``.
    """
    limits, o, hysteresis, single = plan.limits, plan.oscillator, plan.hysteresis, series.single
    x, g = single[OF_X : OF_X + ROOM], single[OF_G : OF_G + ROOM]
    z_series = single[OF_Z : OF_Z + ROOM]
    power, speed = single[OF_POWER : OF_POWER + ROOM], single[OF_SPEED : OF_SPEED + ROOM]
    u, v = state.u[0], state.v[0]
    still = noise.SPEED * limits.length / limits.time
    order, first, good, part, sigma = 0, 1, False, CORE, 1.0
    for _ in range(MOST_REVERSALS):
        part, sigma = part_and_direction(o, state)
        if part == UP and place_of(u, o, state) >= hysteresis.saturated[0]:
            part = state.part[0] = SATURATED
            z = sigma
        x[1], x[2] = v, 0.5 * a_0
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
            law, a = plan.links.law, hysteresis.link[0]
            kappa = 1.0
            if part == DOWN:
                kappa = (law.beta[a] - law.gamma[a]) / (law.beta[a] + law.gamma[a])
            order, good = curved_series(
                o.stiffness,
                o.damping,
                o.strength,
                1.0 / o.scale,
                law.exponent[a],
                kappa,
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
        state.count[EXPANSIONS] += 1
        first = 1
        if abs(v) <= still:
            first = _leading(order, still / limits.time, plan, state, x)
        if part == CORE or sigma * x[first] >= 0.0:
            break
        reverse(0, o.side * u, hysteresis, state)
    h = wanted if good else shorter(wanted, order, of_u, of_v, x)
    return order, first, h, part, sigma, z


@compiled
def first_event(
    h: float,
    order: int,
    first: int,
    part: int,
    sigma: float,
    acceleration: float,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> tuple[float, int, float]:
    """Length of a step of at most h (s), how it ends, and when the body turns (s), or inf.

    In the core of the backbone it may turn without an event; the step ends
    there if that may be an extreme.
    """
    limits, o, hysteresis, single = plan.limits, plan.oscillator, plan.hysteresis, series.single
    x, w = single[OF_X : OF_X + ROOM], single[OF_W : OF_W + ROOM]
    u, v = state.u[0], state.v[0]
    core, standing = np.inf, 0.0
    if o.strength > 0.0:
        core = hysteresis.core[0]
        # A link that all but stands still reverses at the level of rounding.
        standing = limits.hysteresis * o.scale
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
        tau, event = _first_unordered(h, order, core, part, sigma, x, w, plan, state)
        spread = reach * (o.stiffness + o.strength / o.scale)
        if exceeds(0, u - reach, u + reach, running) or force_exceeds(
            acceleration - spread, acceleration + spread, plan, running
        ):
            turn = first_turn(x, order, first, tau, w)
            if turn < tau:
                tau, event = turn, FREE
    else:
        turn = first_turn(x, order, first, h, w)
        if turn <= h:
            tau, event = turn, TURNED
    if not free:
        change, _, _ = motion(tau, order, x)
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
    return tau, event, turn


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
    core: float,
    part: int,
    sigma: float,
    x: Floats,
    w: Floats,
    plan: Plan,
    state: State,
) -> tuple[float, int]:
    """First closing or border within h (s) of a body that may turn without an event."""
    o, u = plan.oscillator, state.u[0]
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
