"""What an instant demands: what closes together, impacts, kinks, and who rests after them.

`eventpound.contact.modes` tabulates it, `eventpound.contact.cascade` says when a cascade of such
instants is over. Whichever integrator comes to an instant calls `settle_impacts`, then
`decide_rests` where `any_may_rest`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eventpound.contact.cascade import end_flight
from eventpound.contact.event_rows import write_changes
from eventpound.contact.impacts import DONE, MEANING, NO_FORCES, end_impacts, settle_closed
from eventpound.contact.kinks import turn_at_kinks
from eventpound.contact.modes import ACCELERATION, duty
from eventpound.contact.rest import rest_contacts, touching_of
from eventpound.contact.state import Instant, between_now
from eventpound.mechanics.followers import on_body
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import deferred_kernel, scalar_kernel
from eventpound.tolerances import OF_A_FLIGHT, TOGETHER


@scalar_kernel
def begin_instant(at: Instant) -> None:
    """Close what closes in this instant, and remember what impacts are about to change."""
    end_flight(at.now[0])
    close_together(at)
    # Before impacts: `_struck` asks for whom they have changed.
    copy_numbers(at.v, at.before)


@scalar_kernel
def close_together(at: Instant) -> None:
    """Close every gap that would close within the present instant.

    That is a part of the scene's own time, and in a cascade, whose intervals may be shorter than
    any such part, a part of the time since the last impact. A gap that stands still and that
    rounding has put below zero is closed, too: bodies that fill the space between two walls.
    """
    instant = min(TOGETHER * at.time, OF_A_FLIGHT * at.now[0].since_impact)
    for j in range(at.gap.size):
        closes = at.gap_rate[j] <= 0.0 and not at.resting[j]
        if closes and at.gap[j] <= -instant * at.gap_rate[j]:
            at.gap[j] = 0.0


@scalar_kernel
def settle_impacts(at: Instant) -> int:
    """Impacts of an instant and the kinks after them; ends as `settle_closed`."""
    begin_instant(at)
    return end_instant(settle_closed(at), at)


@scalar_kernel
def end_instant(ended: int, at: Instant) -> int:
    """What follows impacts that have `ended` in such a way, which is returned."""
    _keep_released(at)
    # It goes on where it stopped once there is more room.
    if ended == DONE:
        end_impacts(at.now[0])
        turn_at_kinks(at)
    return ended


@scalar_kernel
def _keep_released(at: Instant) -> None:
    """Let contacts be released whose force has vanished in this instant, and no others.

    Not those of bodies whose velocities an impact has changed since.
    """
    released, vanished, now = at.released, at.vanished, at.now[0]
    for j in range(released.size):
        if now.settled_at != now.t:
            vanished[j] = False
        released[j] = released[j] or vanished[j]
        for end in (at.left[j], at.right[j]):
            if end >= 0 and _struck(end, at):
                released[j] = False
        # Kept for another event at the same time, at which it is still let go.
        vanished[j] = released[j]
    now.settled_at = now.t


@scalar_kernel
def _struck(end: int, at: Instant) -> bool:
    """Whether an impact has changed the velocity of a body, or of one that a point is on."""
    struck = at.v[end] != at.before[end]
    for b in range(at.mass.size if at.weights.shape[0] > 0 else 0):
        struck |= on_body(end, b, at.weights) and at.v[b] != at.before[b]
    return struck


@scalar_kernel
def any_may_rest(at: Instant) -> bool:
    """Whether a contact rests, or is closed and still."""
    for j in range(at.gap.size):
        if at.resting[j] or duty(at.gap[j], at.gap_rate[j]) == ACCELERATION:
            return True
    return False


@deferred_kernel
def decide_rests(z: Floats, forcing: Forcing, at: Instant) -> int:
    """The acceleration problem of an instant; DONE, or NO_FORCES where it has no solution.

    Who came to rest or opened is written down. The contacts of a problem without a solution are
    marked as resting.

    Parameters
    ----------
    z : ndarray, shape (H,)
        Hysteretic variables.
    forcing : Forcing
        The ground motion from now on.
    at : Instant
        The instant, its impacts over.
    """
    resting, pressed, solved = rest_contacts(touching_of(between_now(at), z, forcing, at))
    return take_rests(resting, pressed, solved, at)


@scalar_kernel
def take_rests(resting: Bools, pressed: Bools, solved: bool, at: Instant) -> int:
    """Make contacts (K,) the resting ones; records who came to rest or opened.

    DONE, or NO_FORCES where the problem is not solved.
    """
    if not solved:
        copy_numbers(resting, at.resting)
        return NO_FORCES
    write_changes(at.resting, resting, at.gap_rate, at.now[0], at.events)
    for j in range(resting.size):
        # Of redundant contacts those that are pressed carry: with others it is another mode.
        changed = at.resting[j] != resting[j] or at.pressed[j] != pressed[j]
        at.now[0].stale |= changed
        at.resting[j], at.pressed[j] = resting[j], pressed[j]
        if resting[j]:
            at.gap_rate[j] = 0.0
    return DONE


def no_forces_message(resting: Bools, names: Sequence[str], supports: int) -> str:
    """What to say where no forces keep the `resting` contacts (K,) closed."""
    unsolved = ", ".join(repr(names[j]) for j in np.flatnonzero(resting).tolist())
    message = f"{MEANING[NO_FORCES]}: {unsolved}"
    if supports:
        message += "; something between ground and supports has to give way where these meet"
    return message
