"""A scene with the ground in the place of its supports: what stands, whatever moves it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from eventpound.scene.contact import BARRIER
from eventpound.scene.ends import End, renamed
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


def on_ground(end: End, fixed: Collection[str]) -> End:
    """An end with the ground in the place of what stands still."""
    return renamed(end, dict.fromkeys(fixed, GROUND))


def ends_on_ground(between: tuple[End, End], fixed: Collection[str]) -> tuple[End, End]:
    """Ends of a spring or dashpot with the ground in the place of what stands still."""
    return on_ground(between[0], fixed), on_ground(between[1], fixed)


def _at_barrier(end: End, supports: Collection[str]) -> End:
    """An end of a contact with a barrier, of a point with the ground, in the place of supports."""
    if isinstance(end, str):
        return BARRIER if end in supports else end
    return on_ground(end, supports)
