"""Whether the time at which a body is first farthest out is one time.

Two turning points that are higher than the other by less than either may be wrong
cannot be told apart: the true first attainment may be at any of them, however well
each is located. Its time is then uncertain by their distance, while the peak itself
is not. A body held back by a barrier, directly or through a row of closed contacts,
cannot go farther than the gaps add up to; later touches of that limit do not count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.sampled import Turn, largest_turns
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes, History
from eventpound.tolerances import ATTAINED_ANEW

INTERPOLATION = 1e-11
"""Part of its range by which a peak between two samples may be misjudged."""
ULPS = 64.0
"""Roundings by which a body at a limit may be off it."""


@dataclass(frozen=True)
class Reach:
    """How far bodies can go, and what holds them there.

    Parameters
    ----------
    reach : ndarray, shape (N,)
        Displacement that no body can exceed (m); inf where nothing holds it.
    chain : tuple of list
        For every body the contacts that are all closed when it is there.
    """

    reach: Floats
    chain: tuple[list[int], ...]


def limits_of(scene: Scene, sign: float) -> Reach:
    """Reach of the displacements to one side.

    Parameters
    ----------
    scene : Scene
        With its gaps.
    sign : float
        1 to the right, -1 to the left; then displacements are those to the left.
    """
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    # A support that moves is no limit.
    moving = {support.name for support in scene.supports}
    reach = np.full(len(scene.bodies), np.inf)
    chain: list[list[int]] = [[] for _ in scene.bodies]
    for _ in scene.bodies:
        for j, contact in enumerate(scene.contacts):
            if contact.at_point:
                # It holds no body by itself.
                continue
            ends = contact.ends if sign > 0.0 else contact.ends[::-1]
            if ends[0] == BARRIER or moving & {*ends}:
                continue
            held, holder = index[ends[0]], index.get(ends[1])
            beyond = 0.0 if holder is None else reach[holder]
            if contact.gap + beyond < reach[held]:
                reach[held] = contact.gap + beyond
                chain[held] = [j, *([] if holder is None else chain[holder])]
    return Reach(reach, tuple(chain))


def ambiguities(
    scene: Scene, history: History, extremes: Extremes, bounds: Floats, length: float
) -> Floats:
    """How far from the stated time the first attainment of each peak may be.

    Parameters
    ----------
    scene : Scene
        What moved.
    history : History
        Samples, dense enough that a turning point lies between two.
    extremes : Extremes
        Of the displacements.
    bounds : ndarray, shape (2, N)
        Error bounds of the largest and the smallest displacement (m).
    length : float
        L of the scene (m), for the rounding by which an extreme counts as exceeded.

    Returns
    -------
    ndarray, shape (2, N)
        Times (s); zero where no other turning point comes near.
    """
    apart = np.zeros((2, len(scene.bodies)))
    for side, sign in enumerate((1.0, -1.0)):
        limits = limits_of(scene, sign)
        peaks = sign * (extremes.minimum if side else extremes.maximum)
        times = extremes.time_of_minimum if side else extremes.time_of_maximum
        for i in range(len(scene.bodies)):
            x = sign * history.u[:, i]
            near = 2.0 * (bounds[side, i] + ATTAINED_ANEW * length)
            near += INTERPOLATION * float(np.ptp(x))
            turns = largest_turns(
                history.t,
                x,
                sign * history.v[:, i],
                sign * (history.a[:, i] - history.ground),
                peaks[i] - near,
            )
            rivals = _until_held(_others(turns, history, times[i]), history, limits, i, x)
            apart[side, i] = max((abs(turn.t - times[i]) for turn in rivals), default=0.0)
    return apart


def _others(turns: list[Turn], history: History, t: float) -> list[Turn]:
    """Turning points but the one between the two samples that hold the time of the peak."""
    times = history.t
    return [
        turn
        for turn in turns
        if not (turn.between and times[turn.sample] <= t <= times[turn.sample + 1])
    ]


def _until_held(
    turns: list[Turn], history: History, limits: Reach, body: int, x: Floats
) -> list[Turn]:
    """Turning points up to the first at which the body is held at its limit, that one included.

    A row of bodies comes to its limit by ever smaller impacts; it is there only when all
    the gaps are closed at once.
    """
    reach, chain = limits.reach[body], limits.chain[body]
    if not np.isfinite(reach):
        return turns
    rounding = ULPS * np.finfo(float).eps * (abs(reach) + float(np.ptp(x)))
    kept = []
    for turn in turns:
        kept.append(turn)
        closed = not turn.between and not np.any(history.gap[turn.sample, chain])
        if closed and turn.value >= reach - rounding:
            break
    return kept
