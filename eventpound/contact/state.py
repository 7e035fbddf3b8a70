"""What the rules of an instant work on, whichever integrator has come to it."""

from __future__ import annotations

from typing import NamedTuple

from eventpound.mechanics.link_law import LinkLaw
from eventpound.numerics.arrays import Bools, Floats, Ints


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
    (m/s). clock, count: the places of `eventpound.contact.cascade`. events: rows.
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
    clock: Floats
    count: Ints  # type: ignore[assignment]  # hides the method of tuples
    events: Floats
