"""What the compiled stepper works on: constants of a run, its state, and its scratch arrays.

N coordinates, L links, H hysteretic links, K contacts, P pieces of ground motion.
Nothing here is a Python object inside the loop: groups of arrays only. Beside them, how runs
end, and when they give up.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from eventpound.contact.impacts import ENDLESS, MEANING
from eventpound.mechanics.backbone import Hysteresis
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.monitored import Distances, Running
from eventpound.motion.forcing import CurrentPiece
from eventpound.numerics.arrays import Bools, Bytes, Floats, Ints, Records
from eventpound.numerics.records import NamedNumbers
from eventpound.solvers.fast.compiled import compiled

FINISHED, GOING_ON = 0, 10
NOT_FINITE, PENETRATION, STUCK, NO_STEP, DRIFT, PULL = range(30, 36)
"""How a call of `advance` ends, beside the ends of settling."""
CROWDED = 36
"""How a run ends, though no call of `advance`, that has too many events."""
SETTLED = 2
"""In `FastProgress.due`: the duties of an instant are done, and it is to be written down."""
MESSAGES = {
    FINISHED: "reached the end of the run",
    **MEANING,
    ENDLESS: "impacts in one instant do not end",
    NOT_FINITE: "the motion is no longer finite",
    PENETRATION: "a contact penetrates and no impact was found; try a smaller rtol",
    PULL: "a resting contact pulls and no detachment was found, or what sticks does with more than "
    "friction can; try a smaller rtol",
    DRIFT: "a gap no longer agrees with the displacements of its bodies; try another rtol",
    STUCK: "events follow each other without an end",
    NO_STEP: "no step is short enough for the equations of motion; try a larger rtol",
}
"""What each end of a run means."""
LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step."""
MOST_STALLS = 100
"""Events in a row without progress of time after which a run gives up."""
MOST_HALVINGS = 60
"""Times a step is shortened before a run gives up."""


class Links(NamedTuple):
    """Links: ends (L, 2), laws, elastic branches (L,), and which z (L,), -1 for none.

    `on_ground` (L,): what of their forces counts in the base shear. `springs`: the first of them;
    `kinked`: whether one has a kink. `grounded` (N,): the z of a link from the ground to the
    coordinate, -1 for none. `sliders` (J,): those that slide, whose contacts are the last J.
    """

    ends: Ints
    on_ground: Floats
    law: LinkLaw
    compression: Floats
    extension: Floats
    offset: Floats
    z_of_link: Ints
    springs: int
    kinked: bool
    grounded: Ints
    sliders: Ints


class Contacts(NamedTuple):
    """Contacts (K,), and the weights (D, N) of points, the last coordinates, that they are at.

    rubbing (F,): those with `friction` (K,), along which the last F links and contacts are.
    """

    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats
    weights: Floats
    rubbing: Ints
    friction: Floats


class Ground(NamedTuple):
    """Pieces of the ground motion: ends and families (P,), numbers one after the other."""

    ends: Floats
    family: Ints
    coefficients: Floats
    first: Ints
    samples: Floats
    first_sample: Ints


class Limits(NamedTuple):
    """Of a run: times (s), tolerances, those of bodies (N,), scales (SI), highest order.

    atol_z (H,): used where a z is followed. hysteresis: what of z does not count.
    """

    end: float
    rtol: float
    atol_u: Floats
    atol_v: Floats
    length: float
    time: float
    mass: float
    order: int
    hysteresis: float
    ledger: bool
    atol_z: Floats


class Oscillator(NamedTuple):
    """A single body between barriers.

    alone: whether the scene is one. right, left: contacts with the barriers on either side, -1 for
    none.
    """

    alone: bool
    right: int
    left: int


class FastPlan(NamedTuple):
    """Constants of a run."""

    mass: Floats
    links: Links
    hysteresis: Hysteresis
    contacts: Contacts
    ground: Ground
    limits: Limits
    output_times: Floats
    oscillator: Oscillator
    distances: Distances


class FastProgress(NamedNumbers):
    """What the stepper counts and remembers itself."""

    trial: float  # step size that is tried next (s)
    saved_at: float  # when a mode that may be none began (s)
    saved_rows: int  # rows of the history before it
    piece: int  # of the ground motion
    steps: int  # steps so far
    expansions: int  # series so far
    rows: int  # rows of the history
    output: int  # next output time
    due: int  # whether an instant has duties: 0, 1 or `SETTLED`
    stalled: int  # events without progress of time
    active: int  # links that move
    clusters: int  # bodies, of which those that touch are one
    resting: int  # contacts at rest
    edges: int  # rows of the elimination
    started: bool  # whether the run has begun
    known: bool  # whether the links' forces `observed` are those of the present state


class FastState(NamedTuple):
    """What moves; a hysteretic link goes by ``σ z / b = Φ(ξ_r + σ (x - x_r) / (u_y b))``."""

    u: Floats  # (N,): displacement (m)
    v: Floats  # (N,): velocity (m/s)
    sigma: Floats  # (H,): σ
    x_r: Floats  # (H,): elongation at the last reversal (m)
    xi_r: Floats  # (H,): ξ there; z of one that is followed, and z/b of any before the start
    part: Ints  # (H,): part of the backbone that a link is on
    gap: Floats  # (K,): exactly zero where closed (m)
    gap_rate: Floats  # (K,) (m/s)
    resting: Bools  # (K,)
    pressed: Bools  # (K,): at rest, and pressed by the last acceleration problem
    unlocked: Bools  # (K,): at rest, and may detach
    branch: Ints  # (L,): side of the kink, -1, +1, or 0 where a link has none
    ledger: Floats  # (E,): work so far (J), see `Model.ledger_entries`
    rubbed: Floats  # (5, F): what `eventpound.contact.friction` keeps
    now: Records  # (1,): a `Now`
    progress: Records  # (1,): a `FastProgress`


class Sdof(NamedTuple):
    """What a single body works with: its numbers and scratch for roots.

    body (1,): an `SdofBody` of `eventpound.solvers.fast.sdof.body`. rate: of its acceleration.
    turns, work: those of `FastSeries`.
    """

    body: Any
    rate: Floats
    turns: Floats
    work: Floats


class MovingLink(NamedNumbers):
    """A link that moves, in a step: all that its force is expanded by, in one place."""

    number: int
    head: int  # cluster of each end, N for the ground
    tail: int
    stiffness: float  # tangent (N/m)
    damping: float  # (N s/m)
    curved: int  # its z where that is on a curved part of its backbone, else -1
    pull: float  # of that z (N)


class FollowedMemories(NamedTuple):
    """Of z that go by series of their own (F,), `eventpound.solvers.fast.followed`.

    sigma: sign of x' just after the start of the step, 0 where it is not known yet. weight: what
    errors of z are multiplied by. defect (1,): the largest error of z of a step, in units of its
    tolerance, from where it has been looked at last.
    """

    sigma: Floats
    weight: Floats
    defect: Floats


class FastSeries(NamedTuple):
    """Taylor coefficients in local time, p the order, and what belongs to them.

    The arrays before `block` are parts of it, which is blank before a run.
    """

    # Clusters, rows as many as bodies; bodies that do not touch are one each. Last the ground.
    X: Floats  # (N + 1, p + 3): displacement (m/s^k), ``X[:, 0]`` unused
    ground: Floats  # (p + 3,): acceleration of the ground (m/s^(2+k))
    load: Floats  # (p + 3, N): loads on bodies (N/s^k), no rows without any
    of_body: Ints  # (N,): cluster of each body
    inverse_mass: Floats  # (N,): 1/m (1/kg)
    force: Floats  # (N + 1,): sum of the forces for one coefficient (N/s^k)
    weights: Floats  # (2, N): what errors of u and v are multiplied by
    expected: Floats  # (N,): relative acceleration by the series, looked at last (m/s²)
    travel: Floats  # (N,): bound of what the quadratic leaves of the displacement in a step (m)
    swing: Floats  # (N,): the same of the velocity (m/s)
    reach: Floats  # (N,): bound of the change of displacement in a step (m)
    bend: Floats  # (N,): that of the rate of the absolute acceleration (m/s³)
    end: Floats  # (N,): absolute accelerations of the bodies at the end of a step (m/s²)

    # Links, and those with hysteresis.
    F: Floats  # (L, p + 3): forces (N/s^k)
    x: Floats  # (L,): elongation at the start (m)
    x_rate: Floats  # (L,): its rate (m/s)
    stiffness: Floats  # (L,): tangent for the orders above zero (N/m)
    memory: Floats  # (L, constants): those of the laws on the present branches
    ends: Ints  # (L, 2): clusters of the ends
    active: Ints  # (L,): those that move, the first ones
    moving: Records  # (L,): a `MovingLink` of each of these
    z: Floats  # (H, p + 3): z
    power: Floats  # (H, p + 3): ``|z|^n``
    speed: Floats  # (H, p + 3): rate of x/u_y, of a z with a series of its own x'
    weighted: Floats  # (H, p + 3): ``(n + 1) k z_k``
    curve: Floats  # (H, CURVE_PLACES): constants of a curved part

    # Contacts at rest, the first rows; see `eventpound.mechanics.clusters`.
    contact_force: Floats  # (K, p + 3): forces of all contacts (N/s^k)
    elimination: Ints  # (K, 4)
    # Of a scene with points; see `eventpound.mechanics.followers`.
    resting: Ints  # (K,): contacts at rest, the first ones
    force_map: Floats  # (K, N): row by row, of these
    compliance: Floats  # (N, N): of the clusters, the first rows and columns (1/kg)
    carried: Floats  # (N,): by how much the ground takes each along
    free: Floats  # (N, N): compliance of the coordinates, nothing at rest (1/kg)
    may_stop: Bools  # (F,): contacts that slip, unless others keep them from sliding

    # Whatever is looked for.
    c: Floats  # (p + 3,): a polynomial
    d: Floats  # (p + 3,): its rate
    work: Floats  # a polynomial in work
    turns: Floats  # its roots
    block: Bytes  # all of the above

    sdof: Sdof  # of a single body
    followed: FollowedMemories  # z that have series of their own
    saved: Floats  # (4, M): extremes before a mode that may be none


class FastLocated(NamedTuple):
    """The events located at the end of a step: closing, released (K,), kinked (L,).

    turned, crossed (H,): hysteretic links that reverse or pass a border. block: all of these.
    vanished (K,): contacts whose force has passed zero in this instant, by this event or one
    before it.
    """

    closing: Bools
    released: Bools
    kinked: Bools
    turned: Bools
    crossed: Bools
    block: Bytes
    vanished: Bools


class FastRecord(NamedTuple):
    """What a run leaves: events, rows, extremes (5, M), uniqueness of forces (K,)."""

    events: Floats
    rows: Floats
    extremes: Floats
    unique: Bools


class FastObserved(NamedTuple):
    """u, v (N,), absolute acceleration a (N,), z (H,), force (L,) without dashpots.

    body_force (N,): what the links put on a body. gap, gap_rate, contact_force
    (K,). base (2,): ground acceleration and base shear.
    """

    u: Floats
    v: Floats
    a: Floats
    z: Floats
    force: Floats
    body_force: Floats
    gap: Floats
    gap_rate: Floats
    contact_force: Floats
    base: Floats


class FastRun(NamedTuple):
    """A run: the one argument of most functions, by address (`eventpound.numerics.by_address`).

    running: `record.extremes`, row by row.
    """

    plan: FastPlan
    state: FastState
    series: FastSeries
    located: FastLocated
    record: FastRecord
    observed: FastObserved
    running: Running


@compiled
def piece_of(i: int, ground: Ground) -> CurrentPiece:
    """A piece of the ground motion."""
    return CurrentPiece(
        ground.family[i],
        ground.coefficients[ground.first[i] : ground.first[i + 1]],
        ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]],
        ground.ends[i],
    )


MORE_TERMS = 4
"""By how much the order of a single linear body may exceed that of the others."""
REST_TERMS = 16
"""Coefficients of the ground motion under a single body at rest."""
