"""What the compiled stepper works on: constants of a run, its state, and its scratch arrays.

N bodies, L links, H hysteretic links, K contacts, P pieces of ground motion.
Nothing here is a Python object inside the loop: groups of arrays only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.backbone import backbone_inverse, backbone_table
from eventpound.mechanics.model import LinkLaw, Model, without_rounding
from eventpound.motion.base import Piece
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel
from eventpound.numerics.polynomial import root_work
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import SceneScales, tolerances
from eventpound.solvers.fast.single_model import Oscillator, oscillator_of

HYSTERESIS_SHARE = 0.01
"""Part of the tolerance by which Φ may differ from a line, or from saturation, unseen."""
SMALLEST_HYSTERESIS = 1e-15
"""The same, at least: rounding of Φ."""
MOST_TURNS = 40
"""Turning points looked for in one step."""
EVENT_WIDTH = 9
"""Columns of an event: t, kind, group, contact, rates before and after, impulse, loss, count."""


class Links(NamedTuple):
    """Links: ends (L, 2), laws, elastic branches (L,), and which z (L,), -1 for none.

    `springs`: the first of them; `kinked`: whether one has a kink. `grounded` (N,):
    the z of a link from the ground to the body, -1 for none.
    """

    ends: Ints
    law: LinkLaw
    compression: Floats
    extension: Floats
    offset: Floats
    z_of_link: Ints
    springs: int
    kinked: bool
    grounded: Ints


class Hysteresis(NamedTuple):
    """Hysteretic links (H,): their backbones and the borders between its parts, in ξ.

    `core`: |ξ| up to which Φ is a line both ways. `down`: ξ < 0 down to which
    it is a line. `saturated`: ξ from which Φ is 1. `scale`: ``u_y b`` (m).
    """

    link: Ints
    tables: Floats
    at: Ints
    core: Floats
    down: Floats
    saturated: Floats
    scale: Floats
    bound: Floats


class Contacts(NamedTuple):
    """Contacts (K,)."""

    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats


class Ground(NamedTuple):
    """Pieces of the ground motion: ends and families (P,), numbers one after the other."""

    ends: Floats
    family: Ints
    coefficients: Floats
    first: Ints
    samples: Floats
    first_sample: Ints


class Limits(NamedTuple):
    """Scalars of a run: times (s), tolerances, scales (SI), highest order."""

    end: float
    rtol: float
    atol_u: float
    atol_v: float
    length: float
    time: float
    mass: float
    order: int
    hysteresis: float
    ledger: bool


class Plan(NamedTuple):
    """Constants of a run."""

    mass: Floats
    links: Links
    hysteresis: Hysteresis
    contacts: Contacts
    ground: Ground
    limits: Limits
    output_times: Floats
    oscillator: Oscillator


class State(NamedTuple):
    """What moves.

    u, v (N,). A hysteretic link (H,): ``σ z / b = Φ(ξ_r + σ (x - x_r) / (u_y b))``
    with `sigma`, `x_r`, `xi_r`, and the `part` of the backbone it is on. gap,
    gap_rate, resting, pressed (K,), unlocked (K,): resting contacts that may detach,
    branch (L,), ledger (3,). `clock` and
    `count` hold the scalars named in `Clock` and `Count`.
    """

    u: Floats
    v: Floats
    sigma: Floats
    x_r: Floats
    xi_r: Floats
    part: Ints
    gap: Floats
    gap_rate: Floats
    resting: Bools
    pressed: Bools
    unlocked: Bools
    branch: Ints
    ledger: Floats
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples


class Series(NamedTuple):
    """Taylor coefficients in local time and what belongs to them.

    X (N, p + 3): clusters' displacement, `X[:, 0]` unused. F (L, p + 3): link
    forces. z, power, dx (H, p + 3). ground (p + 3,). x, x_rate (L,): elongations
    at the start. stiffness (L,): tangent for the orders above zero. ends (L, 2):
    clusters of the ends. of_body (N,), inverse_mass (N,) by cluster, active
    (L,): links that move. travel, swing, reach (N,): bounds of the motion over a
    step. c, d (p + 3,), work: a polynomial in work; turns: its roots. force (N,).
    Where contacts rest: contact_force (K, p + 3), rests (K,), elimination (K, 4) and
    least_norm (K, N) as in `eventpound.mechanics.clusters`, the first rows. single: the
    numbers of a single body (`eventpound.solvers.fast.single_places`); single_rate: the
    rate of its acceleration.
    """

    X: Floats
    F: Floats
    z: Floats
    power: Floats
    dx: Floats
    ground: Floats
    x: Floats
    x_rate: Floats
    stiffness: Floats
    ends: Ints
    of_body: Ints
    inverse_mass: Floats
    active: Ints
    travel: Floats
    swing: Floats
    reach: Floats
    c: Floats
    d: Floats
    work: Floats
    turns: Floats
    force: Floats
    contact_force: Floats
    rests: Ints
    elimination: Ints
    least_norm: Floats
    single: Floats
    single_rate: Floats


class Happened(NamedTuple):
    """Marks of what happens at the end of a step: closing, released (K,), kinked (L,).

    turned, crossed (H,): hysteretic links that reverse or pass a border.
    """

    closing: Bools
    released: Bools
    kinked: Bools
    turned: Bools
    crossed: Bools


class Record(NamedTuple):
    """What a run leaves: events, rows, extremes (5, M), uniqueness of forces (K,)."""

    events: Floats
    rows: Floats
    extremes: Floats
    unique: Bools


T, GUESS, FASTEST, INTERVAL, SINCE_IMPACT, FASTEST_HERE, LOST_HERE, PASSED_ON = range(8)
"""Places in `State.clock`: time (s), next step tried (s), fastest approach so far (m/s),
length of the last flight (s), time since the last impact (s), fastest approach of this
instant (m/s), what its last impacts lost and passed on (J)."""
CLOCK_SIZE = 8
(PIECE, STEPS, EXPANSIONS, GROUPS, EVENTS, ROWS, OUTPUT, ORDER) = range(8)
"""Places in `State.count`: piece of the ground motion, steps, expansions, groups of events,
rows of events and of the history, next output time, order of the series."""
(DUE, ACTIVE, CLUSTERS, STALLED, RESTING, EDGES, LEAST_NORM, IN_A_ROW, HERE) = range(8, 17)
"""Whether an instant has duties, active links, clusters, events without progress of time,
resting contacts, rows of the elimination, size of the least-norm map, impacts of a cascade,
impact problems of this instant."""
COUNT_SIZE = 17
MORE_TERMS = 4
"""By how much the order of a single linear body may exceed that of the others."""
REST_TERMS = 16
"""Coefficients of the ground motion under a single body at rest."""
SINGLE_SIZE = 512
"""Room for the numbers of a single body (`eventpound.solvers.fast.single_places`)."""


def links_of(model: Model) -> Links:
    """Links of an assembled scene."""
    z_of_link = np.full(model.links, -1, np.int64)
    z_of_link[model.hysteretic] = np.arange(model.hysteretic.size)
    grounded = np.full(model.bodies, -1, np.int64)
    for h, link in enumerate(model.hysteretic):
        if model.link_ends[link].min() < 0:
            grounded[model.link_ends[link].max()] = h
    return Links(
        model.link_ends,
        model.law,
        np.array([law.compression for law in model.elastic], float),
        np.array([law.extension for law in model.elastic], float),
        np.array([law.offset for law in model.elastic], float),
        z_of_link,
        model.springs,
        any(law.compression != law.extension for law in model.elastic),
        grounded,
    )


def hysteresis_of(law: LinkLaw, link: Ints, small: Floats | float) -> Hysteresis:
    """Backbones of the hysteretic links of a scene, or with a leading axis of many.

    Parameters
    ----------
    law : LinkLaw
        Arrays of shape (..., L).
    link : ndarray of int, shape (H,)
        The hysteretic links.
    small : float or ndarray, shape (...)
        The difference of Φ that does not count.
    """
    n, beta, gamma, yielding = (
        np.take(column, link, axis=-1)
        for column in (law.exponent, law.beta, law.gamma, law.yield_displacement)
    )
    rows = np.column_stack((n.ravel(), beta.ravel(), gamma.ravel()))
    laws, which = rows[:1], np.zeros(rows.shape[0], np.int64)
    if not (rows == laws).all():
        laws, which = np.unique(rows, axis=0, return_inverse=True)
    tables = [backbone_table(*law) for law in laws.tolist()]
    table = np.concatenate((*tables, np.empty(0)))
    starts = np.cumsum([0, *(each.size for each in tables)])
    places = starts[which.reshape(n.shape)].astype(np.int64)
    share = np.broadcast_to(np.asarray(small)[..., None], n.shape)
    core, down, bound = backbone_borders(n, beta, gamma, share)
    saturated = np.empty(n.shape)
    _saturations(table, places.ravel(), share.ravel(), saturated.ravel())
    return Hysteresis(
        link,
        table,
        places,
        core,
        down,
        saturated,
        yielding * bound,
        bound,
    )


@kernel
def _saturations(table: Floats, at: Ints, small: Floats, out: Floats) -> None:
    """Where Φ comes within a small difference of 1, into `out`."""
    for i in range(out.size):
        out[i] = backbone_inverse(table, at[i], 1.0 - small[i])


def backbone_borders(
    exponent: Floats, beta: Floats, gamma: Floats, small: Floats
) -> tuple[Floats, Floats, Floats]:
    """Borders of the parts of backbones, and bounds of z.

    Parameters
    ----------
    exponent, beta, gamma, small : ndarray
        Constants of the laws and the difference from a line that does not count, of one shape.

    Returns
    -------
    tuple of ndarray
        `core`, `down` and `bound` as in `Hysteresis`.
    """
    rho = (beta - gamma) / (beta + gamma)
    up = ((exponent + 1.0) * small) ** (1.0 / (exponent + 1.0))
    with np.errstate(divide="ignore"):
        down = ((exponent + 1.0) * small / np.abs(rho)) ** (1.0 / (exponent + 1.0))
    bound: Floats = (beta + gamma) ** (-1.0 / exponent)
    return np.minimum(up, down), -down, bound


def small_difference(
    rtol: float, strength: Floats, mass: Floats, acceleration: Floats | float
) -> Floats:
    """Difference of Φ from a line, or from saturation, that does not count.

    Parameters
    ----------
    rtol : float
        Relative tolerance.
    strength, mass : ndarray, shape (..., L) and (..., N)
        Of the links (N) and the bodies (kg); with leading axes, of many variants.
    acceleration : float or ndarray
        The scene's own, L/T² (m/s²).
    """
    # A strong spring turns a small error of z into a large acceleration.
    strongest = (strength / mass.min(axis=-1, keepdims=True)).max(axis=-1, initial=0.0)
    with np.errstate(divide="ignore"):
        weak = np.minimum(1.0, acceleration / strongest)
    return np.maximum(HYSTERESIS_SHARE * rtol * weak, SMALLEST_HYSTERESIS)


def ground_of(pieces: list[Piece]) -> Ground:
    """Pieces of a ground motion as flat arrays."""
    return Ground(
        np.array([piece.end for piece in pieces]),
        np.array([int(piece.family) for piece in pieces], np.int64),
        np.concatenate([piece.coefficients for piece in pieces]),
        np.cumsum([0] + [piece.coefficients.size for piece in pieces]),
        np.concatenate([piece.samples for piece in pieces]),
        np.cumsum([0] + [piece.samples.size for piece in pieces]),
    )


def plan_of(task: Task, model: Model, scales: SceneScales) -> Plan:
    """Constants of a run.

    Parameters
    ----------
    task : Task
        The run.
    model : Model
        Its scene, assembled.
    scales : SceneScales
        The scene's own.
    """
    atol = tolerances(task, scales)
    small = float(small_difference(task.rtol, model.law.strength, model.mass, scales.acceleration))
    links, hysteresis = links_of(model), hysteresis_of(model.law, model.hysteretic, small)
    return Plan(
        model.mass,
        links,
        hysteresis,
        Contacts(model.left, model.right, model.gap, model.restitution),
        ground_of(task.scene.motion.pieces()),
        Limits(
            task.end,
            task.rtol,
            float(atol["displacement"]),
            float(atol["velocity"]),
            scales.length,
            scales.time,
            scales.mass,
            order_for(task.rtol),
            small,
            task.energy,
        ),
        task.output_times,
        oscillator_of(model, scales.length, links, hysteresis, energy=task.energy),
    )


def order_for(rtol: float) -> int:
    """Order of the series: a radius of convergence divided by about e² a step."""
    return int(np.clip(round(2.0 - 0.6 * np.log(rtol)), 8, 24))


def blank_state(plan: Plan, u0: Floats, v0: Floats, z0: Floats, start: float) -> State:
    """State arrays at the start of a run, or with a leading axis of many.

    Parameters
    ----------
    plan : Plan
        Constants of the run; with a leading axis where the others have one.
    u0, v0 : ndarray, shape (..., N)
        Displacements (m) and velocities (m/s).
    z0 : ndarray, shape (..., H)
        Hysteretic variables.
    start : float
        Time (s).
    """
    contacts, limits, runs = plan.contacts, plan.limits, u0.shape[:-1]
    gap = without_rounding(contacts.gap + _rates(contacts, u0), contacts.gap, u0, limits.length)
    clock = np.zeros((*runs, CLOCK_SIZE))
    clock[..., T], clock[..., GUESS] = start, limits.time
    clock[..., INTERVAL] = limits.time
    clock[..., SINCE_IMPACT] = limits.time
    counts = np.zeros((*runs, COUNT_SIZE), np.int64)
    counts[..., ORDER] = limits.order
    counts[..., DUE] = 1
    return State(
        u0.copy(),
        v0.copy(),
        np.zeros(z0.shape),
        np.zeros(z0.shape),
        z0 / plan.hysteresis.bound,
        np.zeros(z0.shape, np.int64),
        gap,
        _rates(contacts, v0),
        np.zeros(gap.shape, np.bool_),
        np.zeros(gap.shape, np.bool_),
        np.zeros(gap.shape, np.bool_),
        np.zeros((*runs, plan.links.ends.shape[0]), np.int64),
        np.zeros((*runs, 3)),
        clock,
        counts,
    )


def _rates(contacts: Contacts, v: Floats) -> Floats:
    """Rates of the gaps, shape (..., K), for velocities of shape (..., N)."""
    extended = np.concatenate((v, np.zeros((*v.shape[:-1], 1))), axis=-1)
    right, left = (np.take(extended, ends, axis=-1) for ends in (contacts.right, contacts.left))
    return np.asarray(right - left)


def blank_series(bodies: int, links: int, hysteretic: int, contacts: int, order: int) -> Series:
    """Scratch arrays of a run."""
    size = order + 3
    return Series(
        np.zeros((bodies, size)),
        np.zeros((links, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, size)),
        np.zeros(size),
        np.zeros(links),
        np.zeros(links),
        np.zeros(links),
        np.zeros((links, 2), np.int64),
        np.zeros(bodies, np.int64),
        np.zeros(bodies),
        np.zeros(links, np.int64),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(size),
        np.zeros(size),
        root_work(max(size + MORE_TERMS, REST_TERMS)),
        np.zeros(MOST_TURNS),
        np.zeros(bodies),
        np.zeros((contacts, size)),
        np.zeros(contacts, np.int64),
        np.zeros((contacts, 4), np.int64),
        np.zeros((contacts, bodies)),
        np.zeros(SINGLE_SIZE),
        np.zeros(max(size + MORE_TERMS, REST_TERMS)),
    )
