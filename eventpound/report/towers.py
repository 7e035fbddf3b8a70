"""Structures whose bodies stand on one another, as figures find them in results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.report.view import DrawnSpring, View
from eventpound.scene.spring import GROUND

_FEWEST = 2
"""Storeys of such a structure."""


@dataclass(frozen=True)
class Tower:
    """A structure whose bodies stand on one another.

    Parameters
    ----------
    bodies : tuple of str
        From below.
    storeys : tuple of DrawnSpring
        What carries each.
    levels : tuple of float
        Of the ground and of the bodies: heights (m), or whole numbers.
    heights : tuple of float
        Of the storeys (m), zero of isolators; empty where one is not given.
    """

    bodies: tuple[str, ...]
    storeys: tuple[DrawnSpring, ...]
    levels: tuple[float, ...]
    heights: tuple[float, ...]


def towers_of(view: View) -> list[Tower]:
    """Structures with one spring below each body, the lowest of them on the ground."""
    entries = view.results.summary["scene"]["springs"]
    given = {entry["name"]: entry.get("height") for entry in entries}
    found = []
    for group in view.structures:
        below = _below(group, view.springs)
        if len(group) < _FEWEST or below is None:
            continue
        heights = storey_heights([given[spring.name] for spring in below])
        steps = heights or (1.0,) * len(below)
        levels = tuple(float(x) for x in np.concatenate([[0.0], np.cumsum(steps)]))
        found.append(Tower(tuple(group), below, levels, heights))
    return found


def storey_heights(given: Sequence[float | None]) -> tuple[float, ...]:
    """Heights of storeys, the lowest first; isolators below them have none."""
    above = [float(height) for height in given[1:] if height is not None]
    if len(above) < len(given) - 1 or not above:
        return ()
    return (float(given[0] or 0.0), *above)


def _below(group: Sequence[str], springs: Sequence[DrawnSpring]) -> tuple[DrawnSpring, ...] | None:
    """The spring below each body; None where they do not stand on one another."""
    own = [spring for spring in springs if set(spring.sides) & set(group)]
    wanted = [{low, high} for low, high in zip([GROUND, *group], group, strict=False)]
    if len(own) != len(group):
        return None
    found = [[spring for spring in own if set(spring.sides) == ends] for ends in wanted]
    return tuple(one[0] for one in found) if all(len(one) == 1 for one in found) else None


def storeys_of(view: View) -> list[DrawnSpring]:
    """Storeys between two bodies, and those on the ground that have a height: no isolators."""
    return [
        spring
        for tower in towers_of(view)
        for spring in tower.storeys[0 if tower.heights and tower.heights[0] > 0.0 else 1 :]
    ]
