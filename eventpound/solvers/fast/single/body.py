"""A single body: the places of its numbers, the forces on it, the parts of its backbone.

All its numbers are in one array `w` (`Series.single`): a function that is given one array, not
a hundred, costs next to nothing to call. The hysteretic link is seen along u: with σ the
direction of u and ``ξ = ξ_r + σ (u - u_r) / scale``, its force is ``q σ y`` for each unit of
mass. It changes from one part of the backbone to another by the rules of
`eventpound.solvers.fast.links`. `run_of` makes what the kernel works on of the general
arrays, `leave` puts it back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.backbone import backbone, backbone_inverse
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events import noise
from eventpound.solvers.events.event_bounds import Running
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.evaluate import OWN_GAP
from eventpound.solvers.fast.expansion import LOCAL_SHARE
from eventpound.solvers.fast.extremes import FLAT
from eventpound.solvers.fast.links import CORE, DOWN, SATURATED, UNLOADING, UP
from eventpound.solvers.fast.run import Ground, Limits, Oscillator, Plan, Record, Single, State

(KNOWN, U, V, RIGHT, LEFT, SIGMA, U_R, XI_R, PART, Z, A) = range(11)
"""What moves: whether `w` is filled in, u (m), v (m/s), gaps to the barriers on either
side (m, inf where there is none), σ, u_r (m), ξ_r, part of the backbone, σ y, and the
absolute acceleration that the links give (m/s²)."""
(STIFFNESS, DAMPING, PULL, STRENGTH, SCALE, PER_SCALE) = range(11, 17)
"""Constants of `eventpound.solvers.fast.single.model.Oscillator`."""
(CORE_END, DOWN_END, SATURATION, EXPONENT, KAPPA_DOWN) = range(17, 22)
"""Borders of the backbone's parts in ξ, its exponent n, and κ on the part DOWN."""
(MASS, RIGHT_GAP, LEFT_GAP, ATOL_U, ATOL_V, RTOL) = range(22, 28)
"""Mass (kg), gaps at u = 0 (m), and what a step is given of the tolerances."""
(STILL, NO_ACCELERATION, NO_FORCE, STANDING, OWN, LEAST_GAP) = range(28, 34)
"""Speed (m/s), acceleration, contact force for each unit of mass (m/s²) and change of u (m)
that are rounding; the gap below which it is a variable of its own, and the one that is
penetration (m)."""
(EVEN, ODD, OF_U, OF_V, STEP, REACH, TERM) = range(34, 41)
"""Coefficients of the ground (`eventpound.solvers.fast.single.series`); errors allowed
(m, m/s) and length (s) of the step; ``h^k`` and the last term of its series (m)."""
(CHANGE, RATE, BEND, NEXT_Z, NEXT_A, NEXT_EVEN, NEXT_ODD, NEXT_G) = range(41, 49)
"""At the end of the step: change of u (m), velocity, relative acceleration, and what Z, A,
EVEN and ODD become there, and the acceleration of the ground."""
(PIECE_KNOWN, SEGMENT, COSINE, SINE, FLAT_TIME) = range(49, 54)
"""One more than the piece that the ground's series is of, the sample of a record that EVEN
and ODD follow, -1 where they are not known, the phase of a sinusoid; and the time within
which a peak is flat to rounding (s)."""
(RESTS_ON, RELEASED, HELD_BACK, RIGHT_FORCE, LEFT_FORCE, OWN_SPEED) = range(54, 60)
"""Side of the barrier that the body rests on, 0 for none; whether its force has just passed
zero; whether impacts are held back from the list; contact forces (N); the scene's own speed
(m/s)."""
_SERIES = 64
ROOM = 48
"""Coefficients there is room for in a series."""
OF_X, OF_Z, OF_POWER, OF_SPEED, OF_NZ, OF_G, OF_W = (_SERIES + ROOM * i for i in range(7))
"""Where series start: u, ``σ y``, ``|y|^n``, the rate of ξ, ``(n + 1) k (σ y)_k``, the
ground, and a polynomial in work."""
TABLES = _SERIES + 7 * ROOM
"""Where the steps from sample to sample start (`eventpound.solvers.fast.single.exact`)."""
TABLE_SIZE = 8
"""Numbers of one of the two."""


@compiled
def place_of(u: float, w: Floats) -> float:
    """ξ of the hysteretic link at the displacement u (m)."""
    return w[XI_R] + w[SIGMA] * (u - w[U_R]) * w[PER_SCALE]


@compiled
def spring_state(u: float, table: Floats, w: Floats) -> float:
    """``σ y`` at the displacement u (m), reached without reversal; 0 without hysteresis."""
    if w[STRENGTH] == 0.0:
        return 0.0
    if w[PART] == SATURATED:
        return w[SIGMA]
    xi = place_of(u, w)
    if w[PART] <= UNLOADING:
        return w[SIGMA] * xi
    return w[SIGMA] * backbone(table, 0, xi)


@compiled
def absolute_acceleration(u: float, v: float, z: float, w: Floats) -> float:
    """Acceleration that the links give the body (m/s²)."""
    return w[PULL] - w[STIFFNESS] * u - w[DAMPING] * v - w[STRENGTH] * z


@compiled
def part_at(xi: float, w: Floats) -> int:
    """Part of the backbone that ξ lies on."""
    if xi >= w[SATURATION]:
        return SATURATED
    if xi > w[CORE_END]:
        return UP
    if xi >= -w[CORE_END]:
        return CORE
    return UNLOADING if xi >= w[DOWN_END] else DOWN


@compiled_apart
def turn_round(u: float, table: Floats, w: Floats) -> None:
    """Put the link on the curve for the other direction at u (m); ``σ y`` stays."""
    sigma = -w[SIGMA]
    y = min(max(sigma * w[Z], -1.0), 1.0)
    w[SIGMA], w[U_R] = sigma, u
    w[XI_R] = backbone_inverse(table, 0, y)
    w[PART] = part_at(w[XI_R], w)


@compiled_apart
def pass_border(u: float, w: Floats) -> None:
    """Move a link that has reached the border of its part to the next."""
    part = w[PART]
    if part == CORE and place_of(u, w) < 0.0:
        w[SIGMA], w[U_R], w[XI_R], w[PART] = -w[SIGMA], u, w[CORE_END], UP
    elif part <= UNLOADING:
        w[PART] = UP
    elif part == DOWN:
        w[U_R], w[XI_R] = u, w[DOWN_END]
        w[PART] = UNLOADING if w[DOWN_END] < -w[CORE_END] else CORE


class SingleRun(NamedTuple):
    """A run of a single body: far fewer arrays than `Plan`, `State` and `Series` hold.

    w: the numbers named in `eventpound.solvers.fast.single.body`. clock, count: those of
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
def leave(o: Oscillator, w: Floats, state: State) -> None:
    """What moves back to where everyone looks for it."""
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
