"""What the compiled part of the event loop works on: constants, state, record, mode.

N bodies, L links, S springs, H hysteretic links, K contacts, M monitored quantities.
Everything is a number in one of a few flat arrays, so that a cascade of thousands of impacts
needs no Python. Whoever needs a part of it takes it as views: handing some sixty arrays from
function to function costs several times what is then done with them, above all to compile.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.mechanics.model import LinkLaw, Model
from eventpound.mechanics.observables import Bodies, Observed
from eventpound.mechanics.packing import unpack_bodies, unpack_observed, unpack_system
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.borrowing import borrow, part_in
from eventpound.numerics.compiled import kernel
from eventpound.solvers.events.cascade import CLOCK_PLACES, COUNT_PLACES
from eventpound.solvers.events.event_bounds import (
    Found,
    Running,
    Watched,
    unpack_marks,
)
from eventpound.solvers.events.journal import Journal

TAKEN_AT = CLOCK_PLACES
"""Behind the places of `eventpound.solvers.events.cascade` in `State.clock`: when a state vector
is taken (s)."""
CLOCK_SIZE = CLOCK_PLACES + 1
(STEPS, KNOTS, SHORT_STEPS, PHASE, STALE, FINDER, POINTS) = range(COUNT_PLACES, COUNT_PLACES + 7)
"""Behind those in `State.count`: steps, reversals followed without an event, short steps of this
cascade, what is to be done next, whether the mode is another by now, who finds events in a
step of an integrator, and how many contacts are at points."""
COUNT_SIZE = COUNT_PLACES + 7


class Rules(NamedTuple):
    """Constants of a run.

    mass (N,) (kg). link_ends (L, 2), law, hysteretic (H,): of the `Model`. compression,
    extension (N/m), offset (m), shape (L,): elastic branches. left, right, gap (m),
    restitution (K,). atol_u (m), atol_v (m/s), shape (N,), atol_z (H,), atol_energy (J), rtol:
    tolerances. length (m), time (s): the scene's own. near: time about a flat peak within
    which two attainments are one (s). length_noise (m), force_noise (N): without a sign.
    instant: time within which what happens does so together (s).
    """

    mass: Floats
    link_ends: Ints
    law: LinkLaw
    hysteretic: Ints
    compression: Floats
    extension: Floats
    offset: Floats
    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats
    atol_u: Floats
    atol_v: Floats
    atol_z: Floats
    atol_energy: float
    rtol: float
    length: float
    time: float
    near: float
    length_noise: float
    force_noise: float
    instant: float


class State(NamedTuple):
    """The moving parts of a run at one instant.

    Gaps and their rates are kept beside the displacements, exact zeros
    included, because close to the limit of many impacts they are far smaller
    than the rounding of the displacements.

    u (m), v (m/s), shape (N,). z (H,). gap (m, exactly zero where closed), gap_rate
    (m/s), resting, pressed (K,): resting contacts that the last acceleration problem
    found pressed. branch (L,): side of the kink each link is on, -1, +1, or 0 where it has
    none. ledger (E,): work so far (J), see `Model.ledger_entries`. clock, count: numbers.
    """

    u: Floats
    v: Floats
    z: Floats
    gap: Floats
    gap_rate: Floats
    resting: Bools
    pressed: Bools
    branch: Ints
    ledger: Floats
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples


class Record(NamedTuple):
    """What a run leaves: history, event rows, extremes (5, M) and the same row by row.

    held (5, M), held_rows (1,): extremes and lines written before a mode that may be none.
    """

    journal: Journal
    events: Floats
    extremes: Floats
    running: Running
    held: Floats
    held_rows: Ints


class Happened(NamedTuple):
    """What happens at the end of a step.

    closing, released (K,): contacts that close, and whose force vanishes. kinked (L,): links
    that pass their kink.
    """

    closing: Bools
    released: Bools
    kinked: Bools


class ModeArrays(NamedTuple):
    """A mode: `eventpound.mechanics.packing`, and what it watches.

    contacts (3, K): open, resting ones that may detach, and closed elements. kinks (2, L):
    elongations at which a link changes its branch (m).
    """

    ints: Ints
    floats: Floats
    contacts: Bools
    kinks: Floats


class Laws(NamedTuple):
    """Contacts with a law (P,), whose elements are the last P links.

    contact, kind: which, and which `Element`. damping: of `Elements`. touch (8, P): of the
    present time in contact, see `eventpound.solvers.events.law_contacts`.
    """

    contact: Ints
    kind: Ints
    damping: Floats
    touch: Floats


class Piece(NamedTuple):
    """A piece of the ground motion, as compiled code takes it, and where a run leaves it (s)."""

    family: int
    coefficients: Floats
    samples: Floats
    stop: float


class RunArrays(NamedTuple):
    """All of it, as Python hands it over; `opened` takes it apart.

    ints, floats, bools: constants, state, extremes and marks one after the other. times (n,), rows,
    events: of the record. looks (3, k): flat `Observed`, as scratch. y, rate, atol: state
    vector, its rate and its absolute tolerances, as an integrator begins with them. laws: see
    `Laws`.
    """

    ints: Ints
    floats: Floats
    bools: Bools
    times: Floats
    rows: Floats
    events: Floats
    looks: Floats
    y: Floats
    rate: Floats
    atol: Floats
    laws: Laws


class Run(NamedTuple):
    """All of it, as compiled functions hand it to each other, lent; see `RunArrays`."""

    rules: Rules
    state: State
    record: Record
    happened: Happened
    marks: Found
    looks: Floats
    y: Floats
    rate: Floats
    atol: Floats
    laws: Laws


class Dynamics(NamedTuple):
    """The equations of motion of a mode, its bodies, and what it has to watch."""

    system: Reduced
    bodies: Bodies
    watched: Watched


SIZES = 7
"""Integers that lead: N, L, K, H, S, M, E."""
NUMBERS = 8
"""Numbers of `Rules` that are no arrays."""


class Layout(NamedTuple):
    """Lengths of the flat arrays of a run."""

    ints: int
    floats: int
    bools: int


def layout_of(model: Model, monitored: int) -> Layout:
    """Lengths for a scene; `monitored` is M."""
    N, L, K, H = model.bodies, model.links, model.contacts, model.hysteretic.size
    return Layout(
        SIZES + 2 * L + H + 2 * K + L + COUNT_SIZE + 3,
        3 * N + 9 * L + 2 * K + H + NUMBERS + 2 * N + H + 2 * K + model.ledger_entries
        + CLOCK_SIZE + model.springs + 10 * monitored,
        4 * K + L + 2 * K + L + monitored,
    )  # fmt: skip


def numbers_in(ints: Ints, floats: Floats) -> Floats:
    """The numbers of `Rules` that are no arrays, as a view."""
    f = 3 * ints[0] + 9 * ints[1] + 2 * ints[2] + ints[3]
    return floats[f : f + NUMBERS]


@kernel
def rules_in(ints: Ints, floats: Floats) -> Rules:
    """The constants, as views."""
    N, L, K, H = ints[0], ints[1], ints[2], ints[3]
    i = SIZES + 2 * L
    f = N
    law = part_in(floats, f, (6, L))
    f += 6 * L
    branches = part_in(floats, f, (3, L))
    f += 3 * L
    contacts = part_in(floats, f, (2, K))
    f += 2 * K
    bodies = part_in(floats, f, (2, N))
    f += 2 * N
    z = part_in(floats, f, H)
    f = 3 * N + 9 * L + 2 * K + H
    numbers = part_in(floats, f, NUMBERS)
    return Rules(
        part_in(floats, 0, N),
        part_in(ints, SIZES, (L, 2)),
        LinkLaw(law[0], law[1], law[2], law[3], law[4], law[5]),
        part_in(ints, i, H),
        branches[0],
        branches[1],
        branches[2],
        part_in(ints, i + H, K),
        part_in(ints, i + H + K, K),
        contacts[0],
        contacts[1],
        bodies[0],
        bodies[1],
        z,
        numbers[0],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
        numbers[5],
        numbers[6],
        numbers[7],
    )


@kernel
def state_in(ints: Ints, floats: Floats, bools: Bools) -> State:
    """The moving parts, as views."""
    N, L, K, H = ints[0], ints[1], ints[2], ints[3]
    i = SIZES + 2 * L + H + 2 * K
    f = 3 * N + 9 * L + 2 * K + H + NUMBERS
    motion = part_in(floats, f, (2, N))
    f += 2 * N
    z = part_in(floats, f, H)
    f += H
    gaps = part_in(floats, f, (2, K))
    f += 2 * K
    return State(
        motion[0],
        motion[1],
        z,
        gaps[0],
        gaps[1],
        part_in(bools, 0, K),
        part_in(bools, K, K),
        part_in(ints, i, L),
        part_in(floats, f, ints[6]),
        part_in(floats, f + ints[6], CLOCK_SIZE),
        part_in(ints, i + L, COUNT_SIZE),
    )


@kernel
def record_in(ints: Ints, floats: Floats, times: Floats, rows: Floats, events: Floats) -> Record:
    """What the run leaves, as views."""
    N, L, K, H, S, M = ints[0], ints[1], ints[2], ints[3], ints[4], ints[5]
    i = SIZES + 2 * L + H + 2 * K + L + COUNT_SIZE
    f = 5 * N + 9 * L + 4 * K + 2 * H + NUMBERS + ints[6] + CLOCK_SIZE
    damping = part_in(floats, f, S)
    f += S
    table = part_in(floats, f, (5, M))
    f += 5 * M
    return Record(
        Journal(times, rows, part_in(ints, i, 2), damping),
        events,
        table,
        Running(table[0], table[1], table[2], table[3], table[4]),
        part_in(floats, f, (5, M)),
        part_in(ints, i + 2, 1),
    )


@kernel
def happened_in(ints: Ints, bools: Bools) -> Happened:
    """What happens at the end of a step, as views."""
    L, K = ints[1], ints[2]
    return Happened(part_in(bools, 2 * K, K), part_in(bools, 3 * K, K), part_in(bools, 4 * K, L))


@kernel
def marks_in(ints: Ints, bools: Bools) -> Bools:
    """Marks of an inspection, as a view."""
    return bools[4 * ints[2] + ints[1] :]


@kernel
def opened(arrays: RunArrays) -> Run:
    """A run as views that are not counted."""
    ints, floats, bools = borrow(arrays.ints), borrow(arrays.floats), borrow(arrays.bools)
    times, rows, events = borrow(arrays.times), borrow(arrays.rows), borrow(arrays.events)
    return Run(
        rules_in(ints, floats),
        state_in(ints, floats, bools),
        record_in(ints, floats, times, rows, events),
        happened_in(ints, bools),
        unpack_marks(marks_in(ints, bools), ints[2], ints[1]),
        borrow(arrays.looks),
        borrow(arrays.y),
        borrow(arrays.rate),
        borrow(arrays.atol),
        Laws(
            borrow(arrays.laws.contact),
            borrow(arrays.laws.kind),
            borrow(arrays.laws.damping),
            borrow(arrays.laws.touch),
        ),
    )


@kernel
def dynamics_of(mode: ModeArrays, force_noise: float, springs: int) -> Dynamics:
    """A mode as views that are not counted."""
    ints, floats = borrow(mode.ints), borrow(mode.floats)
    system = unpack_system(ints, floats)
    contacts, kinks = borrow(mode.contacts), borrow(mode.kinks)
    follows = False
    for j in range(contacts.shape[1]):
        follows = follows or contacts[2, j]
    watched = Watched(contacts[0], contacts[1], follows, kinks[0], kinks[1], force_noise, springs)
    return Dynamics(system, unpack_bodies(ints, floats, system), watched)


@kernel
def observed_in(flat: Floats, mode: Dynamics) -> Observed:
    """An `Observed` of a mode as views of a flat array."""
    bodies = mode.bodies
    links, contacts = bodies.stiffness.size, bodies.gap.size
    return unpack_observed(borrow(flat), bodies.mass.size, links, contacts, bodies.z_of.size)
