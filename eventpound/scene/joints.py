"""Which contacts are one joint: those between the same two parts, on the same side.

Floors of two buildings, the corners of a skew deck, the wall on one side of a moat: a joint is
built with one gap. Two contacts are of one joint where their left ends hang together without the
right ones, and the right ends without the left ones; so piers below two decks, a podium below two
towers or a damper between them do not make one part of both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.scene.structures import joined_groups

_Sides = tuple[frozenset[str], frozenset[str]]
"""What is left and what is right of a contact."""
_Links = tuple[tuple[str, ...], ...]


def joints_of(scene: Scene) -> Sequence[Sequence[int]]:
    """Numbers of the contacts of each joint.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    sides = tuple(
        (
            frozenset(n for n, opens in contact.direction if opens < 0.0 and n != GROUND),
            frozenset(n for n, opens in contact.direction if opens > 0.0 and n != GROUND),
        )
        for contact in scene.contacts
    )
    links = *(s.ends for s in scene.springs), *(d.ends for d in scene.dashpots)
    return _joints(tuple(body.name for body in scene.bodies), links, sides)


@lru_cache(64)
def _joints(bodies: tuple[str, ...], links: _Links, sides: tuple[_Sides, ...]) -> list[list[int]]:
    found: list[list[int]] = []
    for i, own in enumerate(sides):
        for joint in found:
            if any(_is_one(bodies, links, own, sides[k]) for k in joint):
                joint.append(i)
                break
        else:
            found.append([i])
    return found


def _is_one(bodies: Sequence[str], links: _Links, one: _Sides, other: _Sides) -> bool:
    """Whether two contacts are of one joint."""
    left, right = one[0] | other[0], one[1] | other[1]
    if left & right:
        return False
    return _hang_together(bodies, links, one[0], other[0], right) and _hang_together(
        bodies, links, one[1], other[1], left
    )


def _hang_together(
    bodies: Sequence[str],
    links: _Links,
    one: frozenset[str],
    other: frozenset[str],
    without: frozenset[str],
) -> bool:
    """Whether two ends are joined by what is left without some bodies, or are the same."""
    kept = [name for name in bodies if name not in without]
    groups = joined_groups(kept, links)
    return bool(one & other) or any(
        not one.isdisjoint(group) and not other.isdisjoint(group) for group in groups
    )
