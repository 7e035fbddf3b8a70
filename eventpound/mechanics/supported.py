"""Supports and forces as the engine has them: bodies that move as they are told to, and loads.

A support is a body of inverse mass zero (`eventpound.mechanics.clusters.is_support`), so that
nothing moves it in impacts, at rest and between, whose motion is given
(`eventpound.motion.loads`). Supports come first, because the first body of a cluster is the root
from which contact forces are found. A support that moves with the reference ground is the ground.

In plan the ground of the engine stands still, and each body is given a load ``-m ι a`` for each
component a of the ground motion, ι being the cosine of the angle between that and the body's own
direction; none where it is zero, so that what is not pushed does not move, to the last bit.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from eventpound.mechanics.model import assemble
from eventpound.motion.base import GroundMotion, Scales
from eventpound.motion.constant import Constant
from eventpound.motion.delayed import Delayed, travelled
from eventpound.motion.free import NoMotion
from eventpound.motion.loaded import Load, LoadedMotion
from eventpound.motion.parametric import ZERO_OF_PHASE
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.scene.body import Body
from eventpound.scene.grounded import grounded
from eventpound.scene.plan_point import ACROSS, ALONG
from eventpound.scene.scene import Scene
from eventpound.scene.support import Support


def moving_supports(scene: Scene) -> tuple[Support, ...]:
    """The supports that do not move with the reference ground."""
    return tuple(support for support in scene.supports if support.moves_apart)


def lowered(scene: Scene, start: float) -> Scene:
    """A scene as the engine has it; one on a line without supports and forces is itself.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    start : float
        When the run starts (s).
    """
    if not scene.is_driven:
        return scene
    moving = moving_supports(scene)
    scene = grounded(scene, {s.name for s in scene.supports} - {s.name for s in moving})
    if not scene.is_driven:
        return scene
    reference: GroundMotion = NoMotion() if scene.in_plan else scene.motion
    ahead = []
    for support in scene.supports:
        s, rate = support_motion(support, reference, np.array(start))
        ahead.append(Body(support.name, math.inf, float(s), float(rate)))
    bare = replace(
        scene,
        bodies=(*ahead, *scene.bodies),
        motion=NoMotion(),
        supports=(),
        forces=(),
        across=NoMotion(),
        attack=0.0,
    )
    loads = [
        Load(i, support.moved_by(reference), driven=True)
        for i, support in enumerate(scene.supports)
    ]
    loads += _forces(scene, len(ahead))
    if scene.in_plan:
        loads += [
            Load(i, signal, -body.mass * part)
            for i, body in enumerate(scene.bodies)
            for signal, part in components(scene, body.direction)
        ]
        if not loads:
            return bare
    return replace(
        bare,
        motion=LoadedMotion(
            reference, tuple(loads), assemble(bare).links, _strongest(scene), _push(scene)
        ),
    )


def influence(scene: Scene, direction: str) -> tuple[float, float]:
    """Parts ι of the two components of the ground motion that move a body in its direction."""
    cosine, sine = (
        0.0 if abs(part) < ZERO_OF_PHASE else part
        for part in (math.cos(scene.attack), math.sin(scene.attack))
    )
    return {ALONG: (cosine, -sine), ACROSS: (sine, cosine)}.get(direction, (0.0, 0.0))


def components(scene: Scene, direction: str) -> list[tuple[GroundMotion, float]]:
    """Components of the ground motion that move a body in its direction, and by which part ι."""
    parts, signals = influence(scene, direction), (scene.motion, scene.across)
    return [
        (signal, part)
        for signal, part in zip(signals, parts, strict=True)
        if part != 0.0 and not isinstance(signal, NoMotion)
    ]


def support_motion(support: Support, reference: GroundMotion, t: Floats) -> tuple[Floats, Floats]:
    """Displacement (m) and velocity (m/s) of a support relative to the ground, shape of `t` (s)."""
    (d, v), (d_0, v_0) = (travelled(m, t) for m in (support.moved_by(reference), reference))
    return d - d_0, v - v_0


def _forces(scene: Scene, supports: int) -> list[Load]:
    """A load for each force."""
    place = {body.name: (i, body.mass) for i, body in enumerate(scene.bodies, supports)}
    return [
        Load(place[f.body][0], f.history, place[f.body][1] if f.per_mass else 1.0)
        for f in scene.forces
    ]


def _strongest(scene: Scene) -> Scales | None:
    """Scales of the ground motion, or of what is strongest beside it where it stands still."""
    known = scene.motion.scales()
    if known is not None:
        return known
    others = [motion.scales() for motion in scene.motions]
    return max((s for s in others if s is not None), key=lambda s: s.a_g, default=None)


def _push(scene: Scene) -> float:
    """Largest acceleration that the ground, a support or a force alone gives a body (m/s²)."""
    mass = {body.name: body.mass for body in scene.bodies}
    pushes = [peak_of(f.history) / (1.0 if f.per_mass else mass[f.body]) for f in scene.forces]
    return max([*pushes, *map(peak_of, scene.motions)])


def peak_of(history: GroundMotion) -> float:
    """Largest size of the numbers of a motion or force (m/s², N)."""
    if isinstance(history, Delayed):
        return peak_of(history.motion)
    if isinstance(history, Constant):
        return abs(history.value)
    if isinstance(history, Record):
        return history.peak
    scales = history.scales()
    return 0.0 if scales is None else scales.a_g
