"""Which bodies belong together: those that springs and dashpots join, whatever may touch."""

from __future__ import annotations

from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND


def structures_of(scene: Scene) -> list[list[str]]:
    """Names of the bodies of each structure, in the order of the scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.

    Returns
    -------
    list of list of str
        A structure is called after its first body.
    """
    neighbours: dict[str, list[str]] = {body.name: [] for body in scene.bodies}
    joints = [spring.between for spring in scene.springs]
    joints += [dashpot.between for dashpot in scene.dashpots]
    for first, second in joints:
        if GROUND not in (first, second):
            neighbours[first].append(second)
            neighbours[second].append(first)
    position = {name: i for i, name in enumerate(neighbours)}
    found: list[list[str]] = []
    placed: set[str] = set()
    for start in neighbours:
        if start in placed:
            continue
        group, waiting = {start}, [start]
        while waiting:
            new = set(neighbours[waiting.pop()]) - group
            group |= new
            waiting += new
        placed |= group
        found.append(sorted(group, key=position.__getitem__))
    return found
