"""Events: what happens at contacts, as runs list it."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class EventKind(StrEnum):
    """What happened at a contact."""

    IMPACT = "impact"
    ACCUMULATION = "accumulation"
    """The limit of infinitely many impacts."""
    REST = "rest"
    DETACHMENT = "detachment"
    """A resting contact opened because its force vanished."""
    SEPARATION = "separation"
    """A resting contact was opened by an impulse elsewhere."""
    CUT = "cut-impact"
    """A contact with a law was closed, an impact that the end of the run cuts."""
    STICK = "stick"
    """A contact with friction rests without sliding from then on."""
    SLIP_FORWARD = "slip-forward"
    """It slides: its second body to the left, as one looks from the first to the second."""
    SLIP_BACKWARD = "slip-backward"
    """The other way."""


STRIKES = (EventKind.IMPACT, EventKind.ACCUMULATION)
"""What an approach ends in: an impact, or infinitely many."""
ENDS_OF_REST = (EventKind.DETACHMENT, EventKind.SEPARATION)
"""What ends a rest."""
FRICTION_KINDS = (EventKind.STICK, EventKind.SLIP_FORWARD, EventKind.SLIP_BACKWARD)
"""What friction does while a contact rests."""


class Event(NamedTuple):
    """One contact's part in one event; contacts of one problem share `group`.

    Parameters
    ----------
    t : float
        Time (s).
    kind : EventKind
        What happened.
    group : int
        Number of the problem it was solved in, from 0.
    contact : int
        Position in ``scene.contacts``.
    gap_velocity_before, gap_velocity_after : float
        Rate of the gap (m/s), negative when closing.
    impulse : float
        Impulse of the contact (N s), not negative.
    energy_lost : float
        Kinetic energy lost by the whole problem (J), given on its first row.
    count : int
        Impacts this row stands for.
    """

    t: float
    kind: EventKind
    group: int
    contact: int
    gap_velocity_before: float = 0.0
    gap_velocity_after: float = 0.0
    impulse: float = 0.0
    energy_lost: float = 0.0
    count: int = 1  # type: ignore[assignment]  # hides the method of tuples
