"""What the compiled part of the event loop works on: constants, state, record, mode.

N bodies, L links, S springs, H hysteretic links, K contacts, M monitored quantities.
Python makes the arrays and hands them over by address, so that a cascade of
thousands of impacts needs no Python.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.contact.state import Instant
from eventpound.mechanics.monitored import Running
from eventpound.mechanics.observables import Bodies, Observed
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Bools, Floats, Ints, Records
from eventpound.numerics.records import NamedNumbers
from eventpound.solvers.events.event_bounds import Guards, Marks
from eventpound.solvers.events.recorder import Journal


class LoopProgress(NamedNumbers):
    """What the event loop counts itself."""

    steps: int  # steps so far
    reversals: int  # reversals followed without an event
    short_steps: int  # short steps of this cascade
    phase: int  # where an instant goes on, as of `eventpound.solvers.events.instant`
    finder: int  # who finds events in a step, as of `eventpound.solvers.events.step_search`


class Rules(NamedTuple):
    """Constants of a run.

    atol_u (m), atol_v (m/s), shape (N,), atol_z (H,), atol_energy (J), rtol:
    tolerances. length (m), time (s): the scene's own. near: time about a flat peak within
    which two attainments are one (s). length_noise: lengths without a sign (m).
    """

    atol_u: Floats
    atol_v: Floats
    atol_z: Floats
    atol_energy: float
    rtol: float
    length: float
    time: float
    near: float
    length_noise: float


class State(NamedTuple):
    """The moving parts of a run at one instant.

    Gaps and their rates are kept beside the displacements, exact zeros
    included, because close to the limit of many impacts they are far smaller
    than the rounding of the displacements.
    """

    u: Floats  # (N,): displacement (m)
    v: Floats  # (N,): velocity (m/s)
    z: Floats  # (H,): hysteretic variables
    gap: Floats  # (K,): exactly zero where closed (m)
    gap_rate: Floats  # (K,) (m/s)
    resting: Bools  # (K,)
    pressed: Bools  # (K,): at rest, and pressed by the last acceleration problem
    branch: Ints  # (L,): side of the kink, -1, +1, or 0 where a link has none
    ledger: Floats  # (E,): work so far (J), see `Model.ledger_entries`
    now: Records  # (1,): a `Now`
    progress: Records  # (1,): a `LoopProgress`


class RunRecord(NamedTuple):
    """What a run leaves: history, event rows, extremes (5, M) and the same row by row.

    saved_extremes (5, M), saved_cursor (2,): as they were before a mode that may be none.
    """

    journal: Journal
    events: Floats
    extremes: Floats
    running: Running
    saved_extremes: Floats
    saved_cursor: Ints


class Located(NamedTuple):
    """The events located at the end of a step.

    closing, released (K,): contacts that close, and whose force vanishes. kinked (L,): links
    that pass their kink. vanished (K,): see `Instant`.
    """

    closing: Bools
    released: Bools
    vanished: Bools
    kinked: Bools


class Laws(NamedTuple):
    """Contacts with a law (P,), whose elements are the last P links.

    contact, kind: which, and which `Element`. damping: of `Elements`. touch (7, P): of the
    present time in contact, see `eventpound.solvers.events.law_contacts`.
    """

    contact: Ints
    kind: Ints
    damping: Floats
    touch: Floats


class Run(NamedTuple):
    """All of it, as compiled functions hand it to each other, by address.

    instant: what the rules of an instant work on, arrays of the others; by address, as record and
    marks are. observations: three, as scratch. y, rate, atol: state vector, its
    rate and its absolute tolerances, as an integrator begins with them; long enough for any mode.
    """

    rules: Rules
    state: State
    instant: Instant
    record: RunRecord
    located: Located
    marks: Marks
    observations: tuple[Observed, ...]
    y: Floats
    rate: Floats
    atol: Floats
    laws: Laws


class Dynamics(NamedTuple):
    """The equations of motion of a mode and its bodies, both by address, and what to watch."""

    system: Reduced
    bodies: Bodies
    guards: Guards
