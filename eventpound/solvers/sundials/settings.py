"""Settings of `[solver]` that are words, for both integrators of SUNDIALS."""

from __future__ import annotations

from eventpound.errors import InputError
from eventpound.solvers.events.roots import EVENTS
from eventpound.solvers.settings import Settings, word

FINDERS = (
    f'who finds events: "{EVENTS[0]}" (default), on the polynomial of each step with bounds, '
    f'or "{EVENTS[1]}", the root finder of the library'
)
"""What `events` means, for ``eventpound solvers``."""


def root_finder_in_reach() -> bool:
    """Whether compiled code can call the library, its root finder with it."""
    from eventpound.solvers.sundials.library import ida_library

    return ida_library() is not None


def finder(settings: Settings) -> str:
    """Who finds events, one of `EVENTS`.

    Raises
    ------
    InputError
        For a word that is none, or a root finder that is out of reach.
    """
    chosen = word(settings, "events", EVENTS, EVENTS[0])
    if chosen == EVENTS[1] and not root_finder_in_reach():
        raise out_of_reach()
    return chosen


def out_of_reach() -> InputError:
    """What is said where the library's root finder cannot be had."""
    return InputError(
        f"[solver]: events = {EVENTS[1]!r}: the SUNDIALS of this installation cannot be called "
        f"from compiled code; accepted here: {EVENTS[0]}"
    )
