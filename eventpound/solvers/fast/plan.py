"""What the compiled stepper works on: constants of a run, its state, and its scratch arrays.

N bodies, L links, H hysteretic links, K contacts, P pieces of ground motion.
Nothing here is a Python object inside the loop: groups of arrays only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.backbone import backbone_inverse, backbone_table
from eventpound.mechanics.model import LinkLaw, Model
from eventpound.motion.base import Piece
from eventpound.numerics.arrays import Bools, Floats, Ints
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

    `springs`: the first of them; `kinked`: whether one has a kink. `grounded` (N,): the z of a
    link from the ground to the body, -1 for none.
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
    track: bool


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
    count: Ints


class Series(NamedTuple):
    """Taylor coefficients in local time and what belongs to them.

    X (N, p + 3): clusters' displacement, `X[:, 0]` unused. F (L, p + 3): link
    forces. z, power, dx (H, p + 3). ground (p + 3,). x, x_rate (L,): elongations
    at the start. stiffness (L,): tangent for the orders above zero. ends (L, 2):
    clusters of the ends. of_body (N,), inverse_mass (N,) by cluster, active
    (L,): links that move. travel, swing, reach (N,): bounds of the motion over a step.
    c, d (p + 3,), work: a polynomial in work; turns: its roots. force (N,).
    Where contacts rest: contact_force (K, p + 3), rests (K,), elimination (K, 4) and
    least_norm (K, N) as in `eventpound.mechanics.clusters`, the first rows. single:
    what `eventpound.solvers.fast.single_ground` places there; single_rate: the rate of
    its acceleration.
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


T, GUESS, FASTEST, INTERVAL, SINCE_IMPACT, LONGEST = 0, 1, 2, 3, 4, 5
"""Places in `State.clock`: time (s), next step tried (s), fastest approach so far (m/s),
length of the last flight (s), time since the last impact (s), longest step allowed (s)."""
CLOCK_SIZE = 6
(PIECE, STEPS, EXPANSIONS, GROUPS, EVENTS, ROWS, OUTPUT, ORDER) = range(8)
"""Places in `State.count`: piece of the ground motion, steps, expansions, groups of events,
rows of events and of the history, next output time, order of the series."""
(DUE, ACTIVE, CLUSTERS, STALLED, RESTING, EDGES, LEAST_NORM) = range(8, 15)
"""Whether an instant has duties, active links, clusters, events without progress of time,
resting contacts, rows of the elimination, size of the least-norm map."""
COUNT_SIZE = 15
MORE_TERMS = 4
"""By how much the order of a single linear body may exceed that of the others."""
SINGLE_SIZE = 512
"""Room for the series of a single body."""


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


def hysteresis_of(model: Model, small: float) -> Hysteresis:
    """Backbones of an assembled scene; `small` is the difference that does not count."""
    law = model.law
    h = model.hysteretic
    tables, at = [np.empty(0)], []
    known: dict[tuple[float, float, float], int] = {}
    for link in h:
        key = (float(law.exponent[link]), float(law.beta[link]), float(law.gamma[link]))
        if key not in known:
            known[key] = sum(table.size for table in tables)
            tables.append(backbone_table(*key))
        at.append(known[key])
    table, places = np.concatenate(tables), np.array(at, np.int64)
    n = law.exponent[h]
    rho = (law.beta[h] - law.gamma[h]) / (law.beta[h] + law.gamma[h])
    up = ((n + 1.0) * small) ** (1.0 / (n + 1.0))
    with np.errstate(divide="ignore"):
        down = ((n + 1.0) * small / np.abs(rho)) ** (1.0 / (n + 1.0))
    bound = (law.beta[h] + law.gamma[h]) ** (-1.0 / n)
    return Hysteresis(
        h,
        table,
        places,
        np.minimum(up, down),
        -down,
        np.array([backbone_inverse(table, int(i), 1.0 - small) for i in places]),
        law.yield_displacement[h] * bound,
        bound,
    )


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


def plan_of(task: Task, model: Model, scales: SceneScales, *, track: bool = True) -> Plan:
    """Constants of a run.

    Parameters
    ----------
    task : Task
        The run.
    model : Model
        Its scene, assembled.
    scales : SceneScales
        The scene's own.
    track : bool
        Whether the extremes of accelerations and forces are wanted too.
    """
    atol = tolerances(task, scales)
    # A strong spring turns a small error of z into a large acceleration.
    strongest = float((model.law.strength / model.mass.min()).max(initial=0.0))
    weak = min(1.0, scales.acceleration / strongest) if strongest > 0.0 else 1.0
    small = max(HYSTERESIS_SHARE * task.rtol * weak, SMALLEST_HYSTERESIS)
    return Plan(
        model.mass,
        links_of(model),
        hysteresis_of(model, small),
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
            track,
        ),
        task.output_times,
        oscillator_of(model, energy=task.energy),
    )


def order_for(rtol: float) -> int:
    """Order of the series: a radius of convergence divided by about e² a step."""
    return int(np.clip(round(2.0 - 0.6 * np.log(rtol)), 8, 24))


def blank_state(plan: Plan, model: Model, start: float) -> State:
    """State arrays at the start of a run."""
    links, contacts = plan.links.offset.size, plan.contacts.gap.size
    count = plan.hysteresis.link.size
    gap = model.gaps(model.u0)
    gap[np.abs(gap) <= 64.0 * np.finfo(float).eps * plan.limits.length] = 0.0
    clock = np.zeros(CLOCK_SIZE)
    clock[T], clock[GUESS], clock[LONGEST] = start, plan.limits.time, np.inf
    clock[INTERVAL] = plan.limits.time
    counts = np.zeros(COUNT_SIZE, np.int64)
    counts[ORDER] = plan.limits.order
    counts[DUE] = 1
    return State(
        model.u0.copy(),
        model.v0.copy(),
        np.zeros(count),
        np.zeros(count),
        model.z0 / plan.hysteresis.bound,
        np.zeros(count, np.int64),
        gap,
        model.rates(model.v0),
        np.zeros(contacts, np.bool_),
        np.zeros(contacts, np.bool_),
        np.zeros(contacts, np.bool_),
        np.zeros(links, np.int64),
        np.zeros(3),
        clock,
        counts,
    )


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
        root_work(size + MORE_TERMS),
        np.zeros(MOST_TURNS),
        np.zeros(bodies),
        np.zeros((contacts, size)),
        np.zeros(contacts, np.int64),
        np.zeros((contacts, 4), np.int64),
        np.zeros((contacts, bodies)),
        np.zeros(SINGLE_SIZE),
        np.zeros(size + MORE_TERMS),
    )
