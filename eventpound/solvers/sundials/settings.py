"""Settings of `[solver]` that are words, for both integrators of SUNDIALS."""

from __future__ import annotations

from collections.abc import Mapping

from eventpound.errors import InputError
from eventpound.solvers.events.roots import EVENTS

FINDERS = (
    f'who finds events: "{EVENTS[0]}" (default), on the polynomial of each step with bounds, '
    f'or "{EVENTS[1]}", the root finder of the library'
)
"""What `events` means, for ``eventpound solvers``."""


def word(settings: Mapping[str, object], key: str, accepted: tuple[str, ...]) -> str:
    """A setting that is one of some words, the first where it is not given.

    Raises
    ------
    InputError
        For any other.
    """
    value = settings.get(key, accepted[0])
    if value not in accepted:
        raise InputError(f"[solver]: {key} = {value!r}; accepted: {' or '.join(accepted)}")
    return str(value)


def root_finder_in_reach() -> bool:
    """Whether compiled code can call the library, its root finder with it."""
    from eventpound.solvers.sundials.ida_library import ida_library

    return ida_library() is not None


def check_events(settings: Mapping[str, object]) -> None:
    """Refuse another finder of events than there is.

    Raises
    ------
    InputError
        For a word that is none, or a root finder that is out of reach.
    """
    if word(settings, "events", EVENTS) == EVENTS[1] and not root_finder_in_reach():
        raise out_of_reach()


def out_of_reach() -> InputError:
    """What is said where the library's root finder cannot be had."""
    return InputError(
        f"[solver]: events = {EVENTS[1]!r}: the SUNDIALS of this installation cannot be called "
        f"from compiled code; accepted here: {EVENTS[0]}"
    )
