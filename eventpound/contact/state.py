"""What the rules of an instant work on, whichever integrator has come to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.link_law import LinkLaw
from eventpound.numerics.arrays import Bools, Floats, Ints, Records
from eventpound.numerics.records import NamedNumbers


class Now(NamedNumbers):
    """Where a run is, whichever integrator carries it."""

    t: float  # time (s)
    fastest: float  # closing speed, the fastest so far (m/s)
    interval: float  # length of the last flight (s)
    since_impact: float  # time since the last impact (s)
    fastest_here: float  # closing speed, the fastest of this instant (m/s)
    lost_here: float  # what the last impacts of this instant lost (J)
    passed_on: float  # what they passed on (J)
    rested_at: float  # when a contact last came to rest (s)
    settled_at: float  # when an instant was last settled (s)
    groups: int  # groups of events
    events: int  # rows of events
    in_a_row: int  # impact problems of this cascade
    here: int  # impact problems of this instant
    stale: bool  # whether the mode is another by now


def begin(now: Records, start: float, time: Floats | float) -> None:
    """Fill in records of zeros, of runs that start at a time (s); `time`: the scenes' own (s)."""
    now["t"], now["interval"], now["since_impact"] = start, time, time
    now["rested_at"] = now["settled_at"] = -np.inf


class Instant(NamedTuple):
    """A scene at one instant: arrays of a run, which the rules change in place; lent.

    N bodies, L links, H of them hysteretic, K contacts.

    Constants: mass (N,) (kg); ends (L, 2), law, compression, extension (N/m), offset (m), shape
    (L,), of the links; hysteretic (H,); left, right, opening (m), restitution (K,) of the contacts;
    the scene's own length (m) and time (s).

    What moves: u (m), v (m/s), shape (N,). gap (m, exactly zero where closed), gap_rate (m/s),
    resting, pressed (K,): resting contacts that the last acceleration problem found pressed.
    branch (L,): side of the kink each link is on, -1, +1, or 0 where it has none.

    released (K,): contacts whose force has just passed zero; vanished (K,): those of which it has
    in this instant, by this event or one before it. before (N,): velocities before the impacts
    (m/s). now (1,): a `Now`. events: rows.
    """

    mass: Floats
    ends: Ints
    law: LinkLaw
    compression: Floats
    extension: Floats
    offset: Floats
    hysteretic: Ints
    left: Ints
    right: Ints
    opening: Floats
    restitution: Floats
    length: float
    time: float
    u: Floats
    v: Floats
    gap: Floats
    gap_rate: Floats
    resting: Bools
    pressed: Bools
    branch: Ints
    released: Bools
    vanished: Bools
    before: Floats
    now: Records
    events: Floats
