"""A single body: the places of its numbers, the forces on it, the parts of its backbone.

All its numbers are in one record (`Series.single`): a function that is given one address, not a
hundred numbers, costs next to nothing to call. The hysteretic link is seen along u: with σ the
direction of u and ``ξ = ξ_r + σ (u - u_r) / scale``, its force is ``q σ y`` for each unit of
mass. It changes from one part of the backbone to another by the rules of
`eventpound.solvers.fast.links`. `run_of` makes what the kernel works on of the general
arrays, `leave` puts it back.
"""

from __future__ import annotations

from typing import Any, NamedTuple

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
from eventpound.solvers.fast.run import (
    Contacts,
    Ground,
    Limits,
    Links,
    Oscillator,
    Plan,
    Single,
    State,
)

ROOM = 48
"""Coefficients there is room for in a series."""


class Body(np.record):  # type: ignore[misc]  # final to type checkers only
    """All numbers of a single body: one address to hand on."""

    known: bool  # whether the rest is filled in

    # What moves.
    u: float  # displacement (m)
    v: float  # velocity (m/s)
    right: float  # gap to the barrier on the right, inf where there is none (m)
    left: float  # the same on the left (m)
    z: float  # σ y
    a: float  # absolute acceleration that the links give (m/s²)
    sigma: float  # direction in which the hysteretic link is seen, σ
    u_r: float  # displacement at its last reversal (m)
    xi_r: float  # ξ there
    part: int  # part of the backbone, as of `eventpound.solvers.fast.links`
    rests_on: float  # side of the barrier that the body rests on, 0 for none
    released: bool  # whether the contact force has just passed zero
    held_back: bool  # whether impacts are held back from the list
    right_force: float  # contact force on the right (N)
    left_force: float  # the same on the left (N)

    # Constants, those of the links for each unit of mass.
    stiffness: float  # K (1/s²)
    damping: float  # C (1/s)
    pull: float  # p (m/s²)
    strength: float  # q (m/s²), 0 without a hysteretic link
    scale: float  # ``u_y b`` (m)
    per_scale: float  # its inverse (1/m)
    core_end: float  # borders of the backbone's parts, in ξ: of the part CORE
    down_end: float  # of DOWN
    saturation: float  # of SATURATED
    exponent: float  # n of the backbone
    whole: float  # z for a σ y of one, 0 without a hysteretic link
    kappa_down: float  # κ on the part DOWN
    mass: float  # (kg)
    right_gap: float  # gap on the right at u = 0 (m)
    left_gap: float  # the same on the left (m)
    atol_u: float  # what a step is given of the tolerances: of displacement (m)
    atol_v: float  # of velocity (m/s)
    rtol: float  # of either, as part of it

    # What is rounding.
    still: float  # speed (m/s)
    no_acceleration: float  # acceleration (m/s²)
    no_force: float  # contact force for each unit of mass (m/s²)
    standing: float  # change of u, of a body on a hysteretic link (m)
    flat_time: float  # time within which a peak is flat (s)
    own_speed: float  # the scene's own speed (m/s)
    own_gap: float  # gap below which it is a variable of its own (m)
    least_gap: float  # the one that is penetration (m)

    # The ground: its series is ``ground[k]`` times `even` or `odd`.
    even: float  # acceleration (m/s²), or 1 where `ground` is that of this instant
    odd: float  # its rate (m/s³), or 1
    segment: int  # sample of a record that they follow, -1 where they are not known
    piece_known: int  # one more than the piece that `ground` is of, 0 for none
    cosine: float  # of the phase of a sinusoid
    sine: float  # the same

    # The step, and what stands at its end.
    of_u: float  # error allowed in u (m)
    of_v: float  # error allowed in v (m/s)
    step: float  # length (s)
    reach: float  # ``h^k``, k the order so far (s^k)
    term: float  # last term of the series of u (m)
    change: float  # change of u (m)
    rate: float  # velocity (m/s)
    bend: float  # relative acceleration (m/s²)
    next_z: float  # σ y
    next_a: float  # absolute acceleration that the links give (m/s²)
    next_even: float  # what `even` becomes (m/s²)
    next_odd: float  # what `odd` becomes (m/s³)
    next_g: float  # acceleration of the ground (m/s²)

    # Coefficients of τ^k, the first of u left out.
    x: Floats  # u (m/s^k)
    z_terms: Floats  # σ y (s^-k)
    power: Floats  # ``|y|^n`` (s^-k)
    speed: Floats  # rate of ξ (s^-k-1)
    weighted: Floats  # ``(n + 1) k (σ y)_k`` (s^-k)
    ground: Floats  # acceleration of the ground (m/s^(2+k)), or what `even` and `odd` multiply
    work: Floats  # polynomial in work

    # Steps from sample to sample; see `eventpound.solvers.fast.single.exact`.
    on_line: Floats  # where the link is on a line, or there is none
    saturated: Floats  # where it is saturated


_KINDS: dict[str, Any] = {"float": float, "int": int, "bool": bool, "Floats": (float, ROOM)}
_FIELDS = np.dtype(
    [(name, _KINDS[kind]) for name, kind in Body.__annotations__.items()], align=True
)
BODY = np.dtype((Body, _FIELDS))
"""Layout of a `Body`, of which an array holds one."""


@compiled
def place_of(u: float, body: Body) -> float:
    """ξ of the hysteretic link at the displacement u (m)."""
    return body.xi_r + body.sigma * (u - body.u_r) * body.per_scale


@compiled
def spring_state(u: float, table: Floats, body: Body) -> float:
    """``σ y`` at the displacement u (m), reached without reversal; 0 without hysteresis."""
    if body.strength == 0.0:
        return 0.0
    if body.part == SATURATED:
        return body.sigma
    xi = place_of(u, body)
    if body.part <= UNLOADING:
        return body.sigma * xi
    return body.sigma * backbone(table, 0, xi)


@compiled
def absolute_acceleration(u: float, v: float, z: float, body: Body) -> float:
    """Acceleration that the links give the body (m/s²)."""
    return body.pull - body.stiffness * u - body.damping * v - body.strength * z


@compiled
def part_at(xi: float, body: Body) -> int:
    """Part of the backbone that ξ lies on."""
    if xi >= body.saturation:
        return SATURATED
    if xi > body.core_end:
        return UP
    if xi >= -body.core_end:
        return CORE
    return UNLOADING if xi >= body.down_end else DOWN


@compiled_apart
def turn_round(u: float, table: Floats, body: Body) -> None:
    """Put the link on the curve for the other direction at u (m); ``σ y`` stays."""
    sigma = -body.sigma
    y = min(max(sigma * body.z, -1.0), 1.0)
    body.sigma, body.u_r = sigma, u
    body.xi_r = backbone_inverse(table, 0, y)
    body.part = part_at(body.xi_r, body)


@compiled_apart
def pass_border(u: float, body: Body) -> None:
    """Move a link that has reached the border of its part to the next."""
    part = body.part
    if part == CORE and place_of(u, body) < 0.0:
        body.sigma, body.u_r, body.xi_r, body.part = -body.sigma, u, body.core_end, UP
    elif part <= UNLOADING:
        body.part = UP
    elif part == DOWN:
        body.u_r, body.xi_r = u, body.down_end
        body.part = UNLOADING if body.down_end < -body.core_end else CORE


class SingleRun(NamedTuple):
    """A run of a single body, lent (`eventpound.numerics.lending`): parts of all that a `Run` is.

    clock, count: those of `State`. times: of output. table: of its backbone. links, contacts,
    ground, limits, oscillator: those of `Plan`.
    """

    body: Body
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples
    events: Floats
    rows: Floats
    running: Running
    times: Floats
    table: Floats
    links: Links
    contacts: Contacts
    ground: Ground
    limits: Limits
    oscillator: Oscillator
    scratch: Single


@compiled
def forget(body: Body) -> None:
    """Leave nothing of the run before."""
    body.known, body.piece_known = False, 0
    body.on_line[0] = body.saturated[0] = 0.0


@compiled
def enter(plan: Plan, state: State, table: Floats, body: Body) -> None:
    """Fill in the constants of a run and what moves, once: from then on it moves here."""
    o, contacts = plan.oscillator, plan.contacts
    body.known = True
    body.u, body.v = state.u[0], state.v[0]
    body.right = body.right_gap = body.left = body.left_gap = np.inf
    if o.right >= 0:
        body.right, body.right_gap = state.gap[o.right], contacts.gap[o.right]
    if o.left >= 0:
        body.left, body.left_gap = state.gap[o.left], contacts.gap[o.left]
    body.mass, body.stiffness, body.damping = plan.mass[0], o.stiffness, o.damping
    body.pull, body.strength, body.scale, body.per_scale = (
        o.pull,
        o.strength,
        o.scale,
        1.0 / o.scale,
    )
    body.sigma, body.part = 1.0, CORE
    body.released = body.held_back = False
    body.rests_on = body.right_force = body.left_force = 0.0
    body.u_r = body.xi_r = body.standing = body.whole = 0.0
    _enter_limits(plan.limits, body)
    if o.strength > 0.0:
        _enter_hysteresis(plan, state, table, body)


@compiled
def _enter_hysteresis(plan: Plan, state: State, table: Floats, body: Body) -> None:
    """The backbone and the first curve; as `eventpound.solvers.fast.instant.start`."""
    hysteresis, law, o = plan.hysteresis, plan.links.law, plan.oscillator
    link = hysteresis.link[0]
    body.whole = o.side * hysteresis.bound[0]
    body.standing = plan.limits.hysteresis * o.scale
    body.core_end, body.down_end = hysteresis.core[0], hysteresis.down[0]
    body.saturation, body.exponent = hysteresis.saturated[0], law.exponent[link]
    beta, gamma = law.beta[link], law.gamma[link]
    body.kappa_down = (beta - gamma) / (beta + gamma)
    # z / b stands there before the start; the link is about to be turned round to it.
    body.z = o.side * state.xi_r[0]
    body.sigma = o.side if o.side * body.v < 0.0 else -o.side
    turn_round(body.u, table, body)


@compiled
def _enter_limits(limits: Limits, body: Body) -> None:
    """Tolerances of a step, and what is rounding."""
    body.atol_u, body.atol_v = LOCAL_SHARE * limits.atol_u[0], LOCAL_SHARE * limits.atol_v[0]
    body.rtol = LOCAL_SHARE * limits.rtol
    body.own_speed = limits.length / limits.time
    body.still = noise.SPEED * body.own_speed
    body.no_acceleration = noise.ACCELERATION * limits.length / limits.time**2
    body.no_force = noise.FORCE * limits.length / limits.time**2
    body.flat_time = FLAT * limits.time
    body.own_gap, body.least_gap = OWN_GAP * limits.length, -noise.PENETRATED * limits.length


@compiled
def leave(o: Oscillator, body: Body, state: State) -> None:
    """What moves back to where everyone looks for it."""
    state.u[0], state.v[0] = body.u, body.v
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = body.right, -body.v
        state.resting[o.right] = body.rests_on > 0.0
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = body.left, body.v
        state.resting[o.left] = body.rests_on < 0.0
    if o.strength > 0.0:
        state.sigma[0], state.part[0] = o.side * body.sigma, body.part
        state.x_r[0], state.xi_r[0] = o.side * body.u_r, body.xi_r
