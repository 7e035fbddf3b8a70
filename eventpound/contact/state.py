"""What the rules of an instant work on, whichever integrator has come to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import ContactEnds
from eventpound.mechanics.link_law import LinkLaw
from eventpound.numerics.arrays import Bools, Floats, Ints, Records
from eventpound.numerics.compiled import kernel
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
    listed: int  # rows of events before the first that may be held back
    in_a_row: int  # impact problems of this cascade
    here: int  # impact problems of this instant
    stale: bool  # whether the mode is another by now


def begin(now: Records, start: float, time: Floats | float) -> None:
    """Fill in records of zeros, of runs that start at a time (s); `time`: the scenes' own (s)."""
    now["t"], now["interval"], now["since_impact"] = start, time, time
    now["rested_at"] = now["settled_at"] = -np.inf


class Instant(NamedTuple):
    """A scene at one instant: arrays of a run, which the rules change in place; by address.

    N coordinates, L links, H of them hysteretic, K contacts.
    """

    # Constants.
    mass: Floats  # (N,) (kg)
    weights: Floats  # (D, N): of points, the last coordinates
    compliance: Floats  # (N, N): of all coordinates, nothing at rest; empty without points
    ends: Ints  # (L, 2): bodies of a link
    law: LinkLaw  # of the links
    compression: Floats  # (L,): stiffness below the kink (N/m)
    extension: Floats  # (L,): stiffness above it (N/m)
    offset: Floats  # (L,): where it is (m)
    hysteretic: Ints  # (H,): links
    left: Ints  # (K,): body on the left of a contact
    right: Ints  # (K,): that on the right
    opening: Floats  # (K,): gap where nothing is displaced (m)
    restitution: Floats  # (K,)
    length: float  # the scene's own (m)
    time: float  # the scene's own (s)
    last_speed: float  # closing speed up to which an impact is the last (m/s)

    # What moves.
    u: Floats  # (N,): displacement (m)
    v: Floats  # (N,): velocity (m/s)
    gap: Floats  # (K,): exactly zero where closed (m)
    gap_rate: Floats  # (K,) (m/s)
    resting: Bools  # (K,)
    pressed: Bools  # (K,): at rest, and pressed by the last acceleration problem
    branch: Ints  # (L,): side of the kink, -1, +1, or 0 where a link has none
    released: Bools  # (K,): whether the force has just passed zero
    vanished: Bools  # (K,): the same in this instant, by this event or one before it
    before: Floats  # (N,): velocity before the impacts (m/s)
    now: Records  # (1,): a `Now`
    events: Floats  # (e, EVENT_WIDTH): rows


@kernel
def between_now(at: Instant) -> ContactEnds:
    """What the contacts of an instant are between."""
    return ContactEnds(at.left, at.right, at.opening, at.mass, at.weights, at.gap.size)
