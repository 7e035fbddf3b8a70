"""Motion in smooth pieces by SciPy: DOP853 to the next event, what then happens, and on.

Of the package this takes the numbers of a scene, and the motions of ground and supports.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

import numpy as np
from scipy.integrate import solve_ivp

Floats = np.ndarray
Event = tuple[Any, Callable[[float, Floats], float]]
MOST_EVENTS = 400


class Model(Protocol):
    """What moves between events, y = (displacements, velocities)."""

    def rate(self, t: float, y: Floats) -> Floats:
        """y'."""

    def events(self) -> list[Event]:
        """Owners, and functions of theirs that fall through zero where the piece ends."""

    def happened(self, t: float, y: Floats, owners: list[Any]) -> Floats:
        """y after the events of some owners; of none at a stop."""


def march(
    model: Model,
    y: Floats,
    stops: Sequence[float],
    first_step: float | None = None,
    **settings: float,
) -> list[Floats]:
    """States at stops (s), of which the first is the start.

    The first step is that of a piece after an event; further settings are those of `solve_ivp`.
    """
    rows, t, seen, happened = [y], stops[0], 0, [None]
    for stop in stops[1:]:
        while t < stop:
            owners, functions = _watched(model.events())
            first = min(first_step, stop - t) if first_step and happened else None
            found = solve_ivp(
                model.rate, (t, stop), y, "DOP853", events=functions, first_step=first, **settings
            )
            t, y = float(found.t[-1]), found.y[:, -1].copy()
            happened = [o for o, at in zip(owners, found.t_events or (), strict=True) if at.size]
            y, seen = model.happened(t, y, happened), seen + len(happened)
            if seen > MOST_EVENTS:
                raise ArithmeticError("events accumulate")
        rows.append(y)
    return rows


def _watched(events: list[Event]) -> tuple[list[Any], list[Any]]:
    def watched(value: Callable[[float, Floats], float]) -> Any:
        def event(t: float, y: Floats) -> float:
            return float(value(t, y))

        event.terminal, event.direction = True, -1.0
        return event

    return [owner for owner, _ in events], [watched(value) for _, value in events]


def stops_of(end: float, corners: Iterable[float]) -> list[float]:
    """Zero, the corners of a motion within a run (s), and its end."""
    return [0.0, *(c for c in corners if 0.0 < c < end), end]
