"""When a cascade of impacts (Zeno) is over: rules that the event loop and the fast stepper share.

Impacts may follow each other at intervals that shrink below any number (bodies that
come to rest, a light body between heavy ones) or, where contacts leave their bodies
no play, without any interval: several impact problems in one instant. Either goes on
without an end while it loses energy, and has a limit; without a loss it has none.

    what                                                   then
    closing speed below `LAST_SPEED` L/T                   plastic: the contacts rest
    or `LAST_SPEED_OF_SLIDERS`, where there are sliders    the same
    below `LISTED_SPEED` of the fastest, `TIRED` problems  plastic; n times after n as many
    below `FADED` of the fastest of the same instant       rounding: no speed at all
    interval below `LAST_INTERVAL` T                       gaps are zero, plastic
    mode that ends within `FLEETING` T of a rest           not seen in extremes and history
    no impact for `CASCADE_OVER` T                         over: what was held back is listed
    `WINDOW` problems in one instant lose nothing          an error
    `MOST_PROBLEMS` in one instant                         plastic
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from eventpound.contact.event import Event, EventKind
from eventpound.contact.state import Now
from eventpound.numerics.compiled import scalar_kernel
from eventpound.scene.contact import Contact
from eventpound.scene.spring import Spring
from eventpound.tolerances import (
    CASCADE_OVER,
    FLEETING,
    LAST_SPEED,
    LAST_SPEED_OF_SLIDERS,
    LISTED_SPEED,
    LOSSLESS,
)

TIRED = 10_000
"""Impact problems of one cascade after which those too slow to be listed are taken as plastic:
an elastic contact pressed shut bounces for ever with next to no energy."""
WINDOW = 1000
"""Impact problems of one instant that must lose some energy between them."""
UNDEFINED = "leave no play and lose no energy"
"""What is said of contacts whose impacts of one instant have no end."""
LONGEST_CASCADE = 200_000
"""Short steps, or impacts in no time, of one cascade after which a run gives up."""
MOST_PROBLEMS = 10_000
"""Impact problems of one instant after which the rest of its energy is lost at once."""


@scalar_kernel
def last_speed(speed: float, slides: bool) -> float:
    """Closing speed (m/s) up to which an impact is the last, of a scene's own L/T (m/s).

    `slides`: whether the scene has sliders.
    """
    return (LAST_SPEED_OF_SLIDERS if slides else LAST_SPEED) * speed


@scalar_kernel
def is_plastic(approach: float, fastest: float, last: float, in_a_row: int, here: int) -> bool:
    """Whether an impact is the last of a cascade, after which its contacts rest.

    Parameters
    ----------
    approach, fastest, last : float
        Closing speed, the fastest of the run so far, and `last_speed` (m/s).
    in_a_row, here : int
        Impact problems of the cascade and of this instant so far.
    """
    if in_a_row > TIRED:
        last = max(last, LISTED_SPEED * (in_a_row / TIRED) * fastest)
    return here > MOST_PROBLEMS or approach <= last


@scalar_kernel
def is_endless(here: int, lost: float, passed_on: float) -> bool:
    """Whether the impacts of one instant lose nothing, and so have no limit.

    Parameters
    ----------
    here : int
        Impact problems of this instant so far.
    lost, passed_on : float
        What the last `WINDOW` of them lost, and the sum of their ``Λ |γ⁻|`` (J).
    """
    if here > 2 * MOST_PROBLEMS:
        return True
    return here > 0 and here % WINDOW == 0 and lost <= LOSSLESS * passed_on


@scalar_kernel
def end_flight(now: Now) -> None:
    """The last flight is over, unless it was none: what happens at once is no interval."""
    if now.since_impact > 0.0:
        now.interval = now.since_impact


@scalar_kernel
def is_fleeting(tau: float, now: Now, time: float) -> bool:
    """Whether a mode that ends after tau (s) is none: a contact has only just come to rest.

    `time`: the scene's own (s).
    """
    return now.t - now.rested_at + tau < FLEETING * time


@scalar_kernel
def is_over(now: Now, time: float) -> bool:
    """Whether a cascade was under way that is over, its last impact long ago.

    `time`: the scene's own (s).
    """
    return now.in_a_row > 0 and now.since_impact > CASCADE_OVER * time


def crowded_message(events: Sequence[Event], contacts: Sequence[Contact | Spring]) -> str:
    """What to say of a run that gives up since it has too many events."""
    j, count = Counter(event.contact for event in events).most_common(1)[0]
    return (
        f"{len(events)} events, {count} of them at contact {contacts[j].name!r}, and no end: where "
        "a contact loses nothing and is pressed, its bodies bounce the more often the slower they "
        "meet; give it a restitution below 1, or end the run before"
    )


def endless_message(events: Sequence[Event], contacts: Sequence[Contact | Spring]) -> str:
    """What to say of impacts in one instant that do not end, the last of `events` among them."""
    names, _ = _last_impacts(events, contacts)
    return (
        f"impacts in one instant do not end: {names} {UNDEFINED}; "
        "give one of them a gap or a restitution below 1"
    )


def long_message(events: Sequence[Event], contacts: Sequence[Contact | Spring]) -> str:
    """What to say of a cascade that is followed no further, the last of `events` in it."""
    names, speed = _last_impacts(events, contacts)
    return (
        f"more than {LONGEST_CASCADE} impacts follow each other without an end: {names} still meet "
        f"with {speed:.1e} m/s, and lose hardly any of it each time; another restitution there, "
        "mostly a somewhat higher one, needs far fewer"
    )


def _last_impacts(
    events: Sequence[Event], contacts: Sequence[Contact | Spring]
) -> tuple[str, float]:
    """Contacts of the last impacts listed, as words, and the fastest closing speed (m/s)."""
    last = [event for event in events if event.kind is EventKind.IMPACT][-WINDOW:]
    names = [contacts[j].name for j in sorted({event.contact for event in last})]
    speed = max((-event.gap_velocity_before for event in last), default=0.0)
    return ", ".join(map(repr, names)) or "contacts", speed
