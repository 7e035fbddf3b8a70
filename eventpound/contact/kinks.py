"""On which side of its kink a link is: at the start of a run, and after an impact."""

from __future__ import annotations

from eventpound.contact.state import Instant
from eventpound.mechanics.elements import has_branches, next_branch
from eventpound.mechanics.link_law import CLOSED, YIELDING
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import scalar_kernel
from eventpound.tolerances import DEPENDENT, LENGTH, SPEED, TOGETHER


@scalar_kernel
def still_rate(length: float, time: float) -> float:
    """Rate of an elongation (m/s) below which it has no direction, of a scene's own scales."""
    return SPEED * length / time


@scalar_kernel
def _beyond(a: int, at: Instant) -> float:
    """How far the elongation of a link is beyond its kink (m); zero where it is on it."""
    x = difference(at.u, at.ends[a, 0], at.ends[a, 1]) - at.offset[a]
    return x if abs(x) > LENGTH * at.length else 0.0


@scalar_kernel
def passes_kink(distance: float, approach: float, length: float, time: float) -> bool:
    """Whether a link that nears its kink at a speed (m/s) from a distance (m) is there at once.

    length, time: the scene's own, L (m) and T (s).
    """
    return approach > 0.0 and distance <= LENGTH * length + TOGETHER * time * approach


@scalar_kernel
def _has_kink(a: int, at: Instant) -> bool:
    """Whether a link has a kink, at which its elastic part or its memory has another formula."""
    return at.compression[a] != at.extension[a] or has_branches(a, at.law.memory)


@scalar_kernel
def lacks_branch(at: Instant) -> bool:
    """Whether a kinked link has no branch yet: at the start of a run."""
    lacks = False
    for a in range(at.branch.size):
        lacks = lacks or (at.branch[a] == 0 and _has_kink(a, at))
    return lacks


@scalar_kernel
def _first_branch(a: int, side: float, at: Instant) -> int:
    """Branch of a link on this side of its kink; what yields has not been unloaded yet."""
    if side > 0.0:
        return 1
    rate = difference(at.v, at.ends[a, 0], at.ends[a, 1])
    return CLOSED if rate > 0.0 or not has_branches(a, at.law.memory) else YIELDING


@scalar_kernel
def _with_ground(end: int, at: Instant) -> float:
    """By how much an end, -1 the ground's, goes with the ground as its bodies stay behind."""
    first, part = at.mass.size - at.weights.shape[0], 1.0 if end < 0 else 0.0
    if end >= first:
        part = 1.0
        for b in range(first):
            part -= at.weights[end - first, b]
    return part if abs(part) > DEPENDENT else 0.0


@scalar_kernel
def choose_branches(acceleration: Floats, ground: float, onset: float, at: Instant) -> None:
    """Side of the kink of every link that has none yet.

    By its elongation, and on its kink by the first of its rates that tells. Where it has none, it
    goes as the ground moves away from its body.

    Parameters
    ----------
    acceleration : ndarray, shape (N,)
        Of the bodies (m/s²).
    ground : float
        That of the ground in the same frame (m/s²).
    onset : float
        `eventpound.motion.forcing.ground_onset`.
    at : Instant
        The start of a run.
    """
    for a in range(at.branch.size):
        if at.branch[a] != 0 or not _has_kink(a, at):
            continue
        first, second = at.ends[a, 0], at.ends[a, 1]
        side = _beyond(a, at)
        if side == 0.0:
            side = difference(at.v, first, second)
        if side == 0.0:
            side = acceleration[second] if second >= 0 else ground
            side -= acceleration[first] if first >= 0 else ground
        if side == 0.0:
            side = onset * (_with_ground(second, at) - _with_ground(first, at))
        at.branch[a] = _first_branch(a, -1.0 if side < 0.0 else 1.0, at)
        at.now[0].stale = True


@scalar_kernel
def choose_clear_branches(at: Instant) -> None:
    """The same of links beyond their kinks only, without which there are no accelerations."""
    for a in range(at.branch.size):
        if at.branch[a] == 0 and _has_kink(a, at):
            side = _beyond(a, at)
            at.branch[a] = 0 if side == 0.0 else _first_branch(a, side, at)


@scalar_kernel
def turn_at_kinks(at: Instant) -> None:
    """Put every link that is on its kink on the side to which it moves after an impact.

    One that yields no longer does where it moves back. The ends of other branches of a memory are
    looked for as the motion goes on.
    """
    still = still_rate(at.length, at.time)
    for a in range(at.branch.size):
        of_memory = has_branches(a, at.law.memory)
        if at.branch[a] == 0 or (_beyond(a, at) != 0.0 and not of_memory):
            continue
        rate = difference(at.v, at.ends[a, 0], at.ends[a, 1])
        if abs(rate) > still:
            # On a kink the elongation is zero and tells no side.
            side = -1 if rate < 0.0 else 1
            if of_memory:
                side = CLOSED if at.branch[a] == YIELDING and rate > 0.0 else at.branch[a]
            at.now[0].stale |= side != at.branch[a]
            at.branch[a] = side


@scalar_kernel
def pass_kinks(passed: Bools, z: Floats, at: Instant) -> None:
    """Put links (L,) that have come to the end of their branch on the next; `z` (H,) is known."""
    for a in range(passed.size):
        if not passed[a]:
            continue
        x, own = difference(at.u, at.ends[a, 0], at.ends[a, 1]), 0.0
        for h in range(z.size):
            if at.hysteretic[h] == a:
                own = z[h]
        noise = LENGTH * at.length
        at.branch[a] = next_branch(a, at.law.memory, at.branch[a], at.offset[a], x, own, noise)
        at.now[0].stale = True
