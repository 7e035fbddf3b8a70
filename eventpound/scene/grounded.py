"""A scene with the ground in the place of its supports: what stands, whatever moves it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from eventpound.scene.contact import BARRIER, End
from eventpound.scene.point import Point
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND


def grounded(scene: Scene, names: Collection[str] | None = None) -> Scene:
    """The scene with the ground, or barriers, in the place of supports.

    Parameters
    ----------
    scene : Scene
        Stays as it is.
    names : collection of str, optional
        Of the supports; all where none are given.
    """
    gone = {support.name for support in scene.supports} if names is None else set(names)
    if not gone:
        return scene
    return replace(
        scene,
        supports=tuple(support for support in scene.supports if support.name not in gone),
        springs=tuple(replace(s, between=ends_on_ground(s.between, gone)) for s in scene.springs),
        dashpots=tuple(replace(d, between=ends_on_ground(d.between, gone)) for d in scene.dashpots),
        contacts=tuple(
            replace(c, left=_at_barrier(c.left, gone), right=_at_barrier(c.right, gone))
            for c in scene.contacts
        ),
    )


def _at_barrier(end: End, supports: Collection[str]) -> End:
    """An end of a contact with a barrier, of a point with the ground, in the place of supports."""
    if isinstance(end, str):
        return BARRIER if end in supports else end
    return Point(tuple((GROUND if b in supports else b, weight) for b, weight in end.weights))


def ends_on_ground(between: tuple[str, str], supports: Collection[str]) -> tuple[str, str]:
    """Ends of a spring or dashpot with the ground in the place of supports."""
    first, second = (GROUND if end in supports else end for end in between)
    return first, second
