"""A body on springs and dashpots to the ground: an oscillator of one degree of freedom (SDOF).

All its links together are ``u'' = p - K u - C v - q σ y - a_g`` with ``y = Φ(ξ)`` of the one
hysteretic link, or none. That is seen along u: σ is the direction of u, and
``ξ = ξ_r + σ (u - u_r) / scale``. It changes from one part of the backbone to another by the
rules of `eventpound.solvers.fast.links`.

All numbers are in one record, an `SdofBody` (`FastSeries.sdof`): a function given one address,
not a hundred numbers, costs next to nothing to call. `load_body` fills it in from the general
arrays, `store_body` puts back what moves.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.contact.kinks import still_rate
from eventpound.contact.rounding import acceleration_noise
from eventpound.contact.state import Now
from eventpound.mechanics.backbone import backbone_inverse, shape_of
from eventpound.mechanics.elements import pull_per_z
from eventpound.mechanics.link_law import has_backbone
from eventpound.mechanics.model import Model
from eventpound.mechanics.monitored import Running
from eventpound.numerics.arrays import Floats
from eventpound.numerics.records import NamedNumbers
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.links import (
    CORE,
    UNLOADING,
    across_border,
    on_part,
    open_gaps,
    part_at,
)
from eventpound.solvers.fast.run import (
    LOCAL_SHARE,
    FastPlan,
    FastProgress,
    FastState,
    Limits,
    Links,
    Oscillator,
    Sdof,
)
from eventpound.tolerances import ACCELERATION, FLAT_WITHIN, FORCE, LEAST_PLAY, OWN_GAP, PENETRATED

ROOM = 48
"""Coefficients there is room for in a series."""


class SdofBody(NamedNumbers, room=ROOM):
    """All numbers of a single body: one address to hand on."""

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
    right_force: float  # contact force on the right (N)
    left_force: float  # the same on the left (N)

    # Constants, those of the links for each unit of mass.
    stiffness: float  # K (1/s²)
    damping: float  # C (1/s)
    pull: float  # p (m/s²)
    strength: float  # q (m/s²)
    hysteretic: bool  # whether a link is
    scale: float  # ``u_y b`` (m)
    per_scale: float  # its inverse (1/m)
    core_end: float  # borders of the backbone's parts, in ξ: of the part CORE
    down_end: float  # of DOWN
    saturation: float  # of SATURATED
    exponent: float  # n of the backbone
    side: float  # elongation of the hysteretic link for a displacement of one
    whole: float  # z for a σ y of one
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
    own_gap: float  # gap below which it is a variable of its own (m)
    least_gap: float  # the one that is penetration (m)

    # The ground: its series is ``ground[k]`` times `even` or `odd`.
    even: float  # acceleration (m/s²), or 1 where `ground` is that of this instant
    odd: float  # its rate (m/s³), or 1
    pair: bool  # whether acceleration and rate tell the whole series
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
    next_odd: float  # what `odd` becomes (m/s³)
    next_g: float  # acceleration of the ground, which `even` becomes (m/s²)

    # Coefficients of τ^k, the first of u left out.
    x: Floats  # u (m/s^k)
    z_terms: Floats  # σ y (s^-k)
    power: Floats  # ``|y|^n`` (s^-k)
    speed: Floats  # rate of ξ (s^-k-1)
    weighted: Floats  # ``(n + 1) k (σ y)_k`` (s^-k)
    ground: Floats  # acceleration of the ground (m/s^(2+k)), or what `even` and `odd` multiply
    work: Floats  # polynomial in work

    # Steps from sample to sample; see `eventpound.solvers.fast.sdof.exact`.
    on_line: Floats  # where the link is on a line, or there is none
    saturated: Floats  # where it is saturated
    line_pull: float  # absolute acceleration at u = v = 0, of the line that the body is on (m/s²)
    low: float  # displacement at which a step along it ends (m)
    high: float  # the same above (m); below `low` where it is on none
    steepest: float  # largest tangent stiffness (1/s²)
    inverse: float  # of what divides the bound of the acceleration


class SdofRun(NamedTuple):
    """A run of a single body, by address (`eventpound.numerics.by_address`): parts of a `FastRun`.

    now, progress: those of `FastState`. table: of its backbone.
    """

    body: SdofBody
    now: Now
    progress: FastProgress
    events: Floats
    rows: Floats
    running: Running
    table: Floats
    plan: FastPlan
    scratch: Sdof


@compiled
def place_of(u: float, body: SdofBody) -> float:
    """ξ of the hysteretic link at the displacement u (m)."""
    return body.xi_r + body.sigma * (u - body.u_r) * body.per_scale


@compiled
def spring_state(u: float, solo: SdofRun) -> float:
    """``σ y`` at the displacement u (m), reached without reversal; 0 without hysteresis."""
    body = solo.body
    if not body.hysteretic:
        return 0.0
    return body.sigma * on_part(body.part, place_of(u, body), solo.table, 0)


@compiled
def tangent(body: SdofBody) -> float:
    """Tangent stiffness for each unit of mass (1/s²), where the link is on a line."""
    on_line = body.hysteretic and body.part <= UNLOADING
    return body.stiffness + (body.strength * body.per_scale if on_line else 0.0)


@compiled
def steepest(body: SdofBody) -> float:
    """Largest tangent stiffness for each unit of mass (1/s²)."""
    # On the way down Φ' = 1 - ρ |Φ|^n is above one where ρ < 0, by -ρ at most.
    return body.stiffness + body.strength * body.per_scale * (1.0 + max(0.0, -body.kappa_down))


@compiled
def gap_to(way: float, body: SdofBody) -> float:
    """Gap to the barrier in one direction (m)."""
    return body.right if way > 0.0 else body.left


@compiled
def set_tolerance(body: SdofBody) -> None:
    """Errors that the step from here may leave."""
    body.of_u = body.atol_u + body.rtol * abs(body.u)
    body.of_v = body.atol_v + body.rtol * abs(body.v)


@compiled
def observe_end(solo: SdofRun) -> None:
    """What the forces are at the end of the step."""
    body, u = solo.body, solo.body.u + solo.body.change
    body.next_z = spring_state(u, solo)
    body.next_a = absolute_acceleration(u, body.rate, body.next_z, body)


@compiled
def absolute_acceleration(u: float, v: float, z: float, body: SdofBody) -> float:
    """Acceleration that the links give the body (m/s²)."""
    return body.pull - body.stiffness * u - body.damping * v - body.strength * z


@compiled_noinline
def turn_round(u: float, solo: SdofRun) -> None:
    """Put the link on the curve for the other direction at u (m); ``σ y`` stays."""
    body = solo.body
    sigma = -body.sigma
    # Beyond one it is so by rounding.
    y = min(max(sigma * body.z, -1.0), 1.0)
    body.sigma, body.u_r = sigma, u
    body.xi_r = backbone_inverse(solo.table, 0, y)
    body.part = part_at(body.xi_r, body.core_end, body.down_end, body.saturation)


@compiled_noinline
def pass_border(u: float, body: SdofBody) -> None:
    """Move a link that has reached the border of its part to the next."""
    xi = place_of(u, body)
    side, begin, part = across_border(body.part, xi, body.core_end, body.down_end)
    body.part = part
    body.sigma *= side
    if begin < np.inf:
        body.xi_r, body.u_r = begin, u


@compiled
def load_body(plan: FastPlan, state: FastState, solo: SdofRun) -> None:
    """Fill in the constants of a run and what moves, once: from then on it moves here."""
    body, o, contacts = solo.body, plan.oscillator, plan.contacts
    # Nothing is left of the run before.
    body.piece_known = 0
    body.on_line[0] = body.saturated[0] = 0.0
    _set_constants(plan, body)
    open_gaps(plan, state)
    body.u, body.v = state.u[0], state.v[0]
    if o.right >= 0:
        body.right, body.right_gap = state.gap[o.right], contacts.gap[o.right]
    if o.left >= 0:
        body.left, body.left_gap = state.gap[o.left], contacts.gap[o.left]
    if body.hysteretic:
        # The first curve, as `eventpound.solvers.fast.instant.start`. z / b stands there before
        # the start; the link is about to be turned round to it.
        body.z = body.side * state.xi_r[0]
        body.sigma = body.side if body.side * body.v < 0.0 else -body.side
        turn_round(body.u, solo)


@compiled
def _set_constants(plan: FastPlan, body: SdofBody) -> None:
    """Constants of the body, without barriers."""
    links, m, h = plan.links, plan.mass[0], -1
    stiffness, damping, pull = 0.0, 0.0, 0.0
    body.side, body.scale = 1.0, np.inf
    for a in range(links.offset.size):
        # A link from the body to the ground is stretched by -u.
        side = 1.0 if links.ends[a, 1] == 0 else -1.0
        stiffness += links.extension[a]
        damping += links.law.damping[a]
        pull += side * links.extension[a] * links.offset[a]
        if links.z_of_link[a] >= 0:
            h, body.side = links.z_of_link[a], side
    body.mass, body.stiffness, body.damping, body.pull = m, stiffness / m, damping / m, pull / m
    body.right = body.right_gap = body.left = body.left_gap = np.inf
    body.sigma, body.part = 1.0, CORE
    body.released = False
    body.rests_on = body.right_force = body.left_force = 0.0
    body.u_r = body.xi_r = body.standing = body.whole = body.strength = 0.0
    _set_limits(plan.limits, body)
    body.hysteretic = h >= 0
    if body.hysteretic:
        _set_backbone(h, plan, body)
    body.per_scale = 1.0 / body.scale


@compiled
def _set_backbone(h: int, plan: FastPlan, body: SdofBody) -> None:
    """What of the hysteretic link h a body wants to know."""
    hysteresis = plan.hysteresis
    force = pull_per_z(hysteresis.link[h], plan.links.law.memory)
    body.strength = force * hysteresis.bound[h] / body.mass
    body.scale, body.whole = hysteresis.scale[h], body.side * hysteresis.bound[h]
    body.standing = plan.limits.hysteresis * body.scale
    body.core_end, body.down_end = hysteresis.core[h], hysteresis.down[h]
    body.saturation = hysteresis.saturated[h]
    body.exponent, body.kappa_down = shape_of(hysteresis.tables, hysteresis.at[h])


@compiled
def _set_limits(limits: Limits, body: SdofBody) -> None:
    """Tolerances of a step, and what is rounding."""
    body.atol_u, body.atol_v = LOCAL_SHARE * limits.atol_u[0], LOCAL_SHARE * limits.atol_v[0]
    body.rtol = LOCAL_SHARE * limits.rtol
    body.still = still_rate(limits.length, limits.time)
    body.no_acceleration = ACCELERATION * limits.length / limits.time**2
    body.no_force = FORCE * limits.length / limits.time**2
    body.flat_time = FLAT_WITHIN * limits.time
    body.own_gap, body.least_gap = OWN_GAP * limits.length, -PENETRATED * limits.length


@compiled
def store_body(o: Oscillator, body: SdofBody, state: FastState) -> None:
    """What moves back to where everyone looks for it."""
    state.u[0], state.v[0] = body.u, body.v
    if o.right >= 0:
        state.gap[o.right], state.gap_rate[o.right] = body.right, -body.v
        state.resting[o.right] = body.rests_on > 0.0
    if o.left >= 0:
        state.gap[o.left], state.gap_rate[o.left] = body.left, body.v
        state.resting[o.left] = body.rests_on < 0.0
    if body.hysteretic:
        # From u back to the elongation of the link.
        state.sigma[0], state.part[0] = body.side * body.sigma, body.part
        state.x_r[0], state.xi_r[0] = body.side * body.u_r, body.xi_r


@compiled
def side_closed(body: SdofBody) -> float:
    """1 for the barrier on the right, -1 for that on the left, 0 where both are open."""
    if body.right == 0.0:
        return 1.0
    return -1.0 if body.left == 0.0 else 0.0


@compiled
def acceleration_level(body: SdofBody) -> float:
    """Rounding of the relative acceleration (m/s²), as the acceleration problem has it."""
    return acceleration_noise(body.a, body.no_acceleration)


@compiled
def set_force(g: float, body: SdofBody) -> None:
    """Contact forces (N) under the acceleration g of the ground (m/s²)."""
    side = body.rests_on
    # At rest m a_g = m A - λ at a barrier on the right, m A + λ on the left.
    body.right_force = body.mass * (body.a - g) if side > 0.0 else 0.0
    body.left_force = body.mass * (g - body.a) if side < 0.0 else 0.0


def has_play(gap: Floats, length: Floats | float) -> Any:
    """Whether a body has room between two barriers with such gaps (..., K) (m)."""
    return gap.sum(axis=-1) > LEAST_PLAY * np.asarray(length)


def oscillators_of(
    model: Model, gap: Floats, length: Floats | float, links: Links, *, energy: bool
) -> Any:
    """Scenes of one body, `alone` where the scalar kernel serves them.

    Parameters
    ----------
    model : Model
        Who is joined to whom.
    gap : ndarray, shape (..., K)
        Gaps (m).
    length : float or ndarray, shape (...)
        The scene's own, L (m).
    links : Links
        Of the plan, with the same leading axes.
    energy : bool
        Whether the ledger is kept, which the scalar kernel does not.

    Returns
    -------
    Oscillator
        `alone` is an array of the leading shape.
    """
    bodies = model.right.tolist(), model.left.tolist()
    to_right, to_left = ([j for j, b in enumerate(ends) if b < 0] for ends in bodies)
    fits = (
        model.bodies == 1
        and model.loads == 0
        and model.weights.size == 0
        and not energy
        and model.hysteretic.size <= 1
        and has_backbone(model.law.memory[model.hysteretic]).all()
        and max(len(to_right), len(to_left)) <= 1
    )
    alone: Any = np.logical_not(links.kinked) & fits
    if links.extension.min(initial=0.0) < 0.0:
        # Its bounds and closed forms are of a body that its elastic parts do not push away.
        alone &= links.extension.sum(axis=-1) >= 0.0
    if fits and to_right and to_left:
        alone &= has_play(gap, length)
    right, left = (found[0] if found else -1 for found in (to_right, to_left))
    return Oscillator(alone, right, left)


def oscillator_of(model: Model, length: float, links: Links, *, energy: bool) -> Oscillator:
    """The same for one scene."""
    one = oscillators_of(model, model.gap, length, links, energy=energy)
    return Oscillator(bool(one.alone), one.right, one.left)
