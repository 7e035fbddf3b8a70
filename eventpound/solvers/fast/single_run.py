"""What the kernel of a single body works on, made of the general arrays, and back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events import noise
from eventpound.solvers.events.event_bounds import Running
from eventpound.solvers.fast.backbone_parts import CORE
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.evaluate import OWN_GAP
from eventpound.solvers.fast.expansion import LOCAL_SHARE
from eventpound.solvers.fast.extremes import FLAT
from eventpound.solvers.fast.run import Ground, Limits, Plan, Record, Single, State
from eventpound.solvers.fast.single_parts import turn_round
from eventpound.solvers.fast.single_places import (
    ATOL_U,
    ATOL_V,
    CORE_END,
    DAMPING,
    DOWN_END,
    EXPONENT,
    FLAT_TIME,
    HELD_BACK,
    KAPPA_DOWN,
    KNOWN,
    LEAST_GAP,
    LEFT,
    LEFT_FORCE,
    LEFT_GAP,
    MASS,
    NO_ACCELERATION,
    NO_FORCE,
    OWN,
    OWN_SPEED,
    PART,
    PER_SCALE,
    PIECE_KNOWN,
    PULL,
    RELEASED,
    RESTS_ON,
    RIGHT,
    RIGHT_FORCE,
    RIGHT_GAP,
    RTOL,
    SATURATION,
    SCALE,
    SIGMA,
    STANDING,
    STIFFNESS,
    STILL,
    STRENGTH,
    TABLE_SIZE,
    TABLES,
    U_R,
    XI_R,
    U,
    V,
    Z,
)


class SingleRun(NamedTuple):
    """A run of a single body: far fewer arrays than `Plan`, `State` and `Series` hold.

    w: the numbers named in `eventpound.solvers.fast.single_places`. clock, count: those of
    `State`. table: the backbone. times: of output. ends (L, 2), stiffness, offset,
    strength, z_of_link (L,): the links, the first S of them springs. restitution (K,).
    rate, turns, work: scratch for roots. right, left: contacts with either barrier, -1
    for none. hysteretic: z for a ``σ y`` of one. time, end: the scene's own, and that of
    the run (s).
    """

    w: Floats
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples
    table: Floats
    ground: Ground
    times: Floats
    events: Floats
    rows: Floats
    running: Running
    restitution: Floats
    ends: Ints
    stiffness: Floats
    offset: Floats
    strength: Floats
    z_of_link: Ints
    rate: Floats
    turns: Floats
    work: Floats
    springs: int
    contacts: int
    right: int
    left: int
    order: int
    hysteretic: float
    time: float
    end: float


@compiled
def run_of(plan: Plan, state: State, single: Single, record: Record) -> SingleRun:
    """What the kernel needs of a run."""
    links, limits, o, table = plan.links, plan.limits, plan.oscillator, record.extremes
    start, whole = 0, 0.0
    if plan.hysteresis.at.size > 0:
        start, whole = plan.hysteresis.at[0], o.side * plan.hysteresis.bound[0]
    return SingleRun(
        single.w,
        state.clock,
        state.count,
        plan.hysteresis.tables[start:],
        plan.ground,
        plan.output_times,
        record.events,
        record.rows,
        Running(table[0], table[1], table[2], table[3], table[4]),
        plan.contacts.restitution,
        links.ends,
        links.extension,
        links.offset,
        links.law.strength,
        links.z_of_link,
        single.rate,
        single.turns,
        single.work,
        links.springs,
        plan.contacts.gap.size,
        o.right,
        o.left,
        limits.order,
        whole,
        limits.time,
        limits.end,
    )


@compiled
def forget(w: Floats) -> None:
    """Leave nothing of the run before."""
    w[KNOWN] = w[PIECE_KNOWN] = 0.0
    w[TABLES] = w[TABLES + TABLE_SIZE] = 0.0


@compiled
def enter(plan: Plan, state: State, table: Floats, w: Floats) -> None:
    """Fill in the constants of a run and what moves, once: from then on it moves in `w`."""
    o, contacts = plan.oscillator, plan.contacts
    w[KNOWN] = 1.0
    w[U], w[V] = state.u[0], state.v[0]
    w[RIGHT] = w[RIGHT_GAP] = w[LEFT] = w[LEFT_GAP] = np.inf
    if o.right >= 0:
        w[RIGHT], w[RIGHT_GAP] = state.gap[o.right], contacts.gap[o.right]
    if o.left >= 0:
        w[LEFT], w[LEFT_GAP] = state.gap[o.left], contacts.gap[o.left]
    w[MASS], w[STIFFNESS], w[DAMPING] = plan.mass[0], o.stiffness, o.damping
    w[PULL], w[STRENGTH], w[SCALE], w[PER_SCALE] = o.pull, o.strength, o.scale, 1.0 / o.scale
    w[SIGMA], w[PART] = 1.0, CORE
    w[RESTS_ON] = w[RELEASED] = w[HELD_BACK] = w[RIGHT_FORCE] = w[LEFT_FORCE] = 0.0
    w[U_R] = w[XI_R] = w[STANDING] = 0.0
    _enter_limits(plan.limits, w)
    if o.strength > 0.0:
        _enter_hysteresis(plan, state, table, w)


@compiled
def _enter_hysteresis(plan: Plan, state: State, table: Floats, w: Floats) -> None:
    """The backbone and the first curve; as `eventpound.solvers.fast.instant.start`."""
    hysteresis, law, o = plan.hysteresis, plan.links.law, plan.oscillator
    link = hysteresis.link[0]
    w[STANDING] = plan.limits.hysteresis * o.scale
    w[CORE_END], w[DOWN_END] = hysteresis.core[0], hysteresis.down[0]
    w[SATURATION], w[EXPONENT] = hysteresis.saturated[0], law.exponent[link]
    beta, gamma = law.beta[link], law.gamma[link]
    w[KAPPA_DOWN] = (beta - gamma) / (beta + gamma)
    # z / b stands there before the start; the link is about to be turned round to it.
    w[Z] = o.side * state.xi_r[0]
    w[SIGMA] = o.side if o.side * w[V] < 0.0 else -o.side
    turn_round(w[U], table, w)


@compiled
def _enter_limits(limits: Limits, w: Floats) -> None:
    """Tolerances of a step, and what is rounding."""
    w[ATOL_U], w[ATOL_V] = LOCAL_SHARE * limits.atol_u[0], LOCAL_SHARE * limits.atol_v[0]
    w[RTOL] = LOCAL_SHARE * limits.rtol
    w[OWN_SPEED] = limits.length / limits.time
    w[STILL] = noise.SPEED * w[OWN_SPEED]
    w[NO_ACCELERATION] = noise.ACCELERATION * limits.length / limits.time**2
    w[NO_FORCE] = noise.FORCE * limits.length / limits.time**2
    w[FLAT_TIME] = FLAT * limits.time
    w[OWN], w[LEAST_GAP] = OWN_GAP * limits.length, -noise.PENETRATED * limits.length


@compiled
def leave(plan: Plan, w: Floats, state: State) -> None:
    """What moves back to where everyone looks for it."""
    o = plan.oscillator
    state.u[0], state.v[0] = w[U], w[V]
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = w[RIGHT], -w[V]
        state.resting[o.right] = w[RESTS_ON] > 0.0
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = w[LEFT], w[V]
        state.resting[o.left] = w[RESTS_ON] < 0.0
    if o.strength > 0.0:
        state.sigma[0], state.part[0] = o.side * w[SIGMA], int(w[PART])
        state.x_r[0], state.xi_r[0] = o.side * w[U_R], w[XI_R]
