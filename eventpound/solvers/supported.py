"""Supports and forces around a solver: a scene as the engine has it in, a recording out.

`eventpound.mechanics.supported` says how a scene is lowered; here the bodies that stand for
supports are taken out of what a solver returns.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.supported import lowered, moving_supports, support_motion
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER, Contact, weights_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.solvers.base import Energy, History, Recording, SupportHistory, Task
from eventpound.tolerances import OF_ROWS, OF_SUPPORT, SOON

LINES = 4
"""Lines of the history before that instant at which contacts are looked at."""


def with_supports(task: Task, solve: Callable[[Task], Recording]) -> Recording:
    """What a solver makes of a task whose scene may have supports and forces.

    Parameters
    ----------
    task : Task
        Its scene is as a user has it.
    solve : callable
        What carries a scene as the engine has it.

    Raises
    ------
    ComputationError
        As of the solver; where supports close in on a body between them.
    """
    scene = task.scene
    if not (scene.supports or scene.forces):
        return solve(task)
    try:
        recording = solve(replace(task, scene=lowered(scene, task.start)))
    except ComputationError as error:
        if error.recording is None:
            raise
        closed = _closed_in(error.recording, task)
        error.recording = own_part(error.recording, scene)
        if closed is None:
            raise
        raise closed from error
    closed = _closed_in(recording, task)
    if closed is not None:
        raise closed
    return own_part(recording, scene)


def own_part(recording: Recording, scene: Scene) -> Recording:
    """A recording without the bodies that stand for supports in the lowered `scene`."""
    recording = recording.of_bodies(np.s_[len(moving_supports(scene)) :])
    history = recording.history
    motions = [support_motion(s, scene.motion, history.t) for s in scene.supports]
    shape = history.t.size, len(motions)
    s, sv = (np.reshape([m[i] for m in motions], shape[::-1]).T.copy() for i in range(2))
    return replace(
        recording,
        supports=SupportHistory(s, sv, forces_on_supports(scene, history, sv)) if motions else None,
        energy=_of_all_supports(recording.energy, scene),
    )


def forces_on_supports(scene: Scene, history: History, rates: Floats) -> Floats:
    """Sum of what springs, dashpots and contacts put on each support, shape (n, supports) (N).

    Parameters
    ----------
    scene : Scene
        As a user has it.
    history : History
        Of its bodies.
    rates : ndarray, shape (n, number of supports)
        Velocities of the supports (m/s).
    """
    rate = {GROUND: np.zeros(history.t.size)}
    rate |= {body.name: history.v[:, i] for i, body in enumerate(scene.bodies)}
    rate |= {support.name: rates[:, k] for k, support in enumerate(scene.supports)}
    total = np.zeros((history.t.size, len(scene.supports)))
    for k, support in enumerate(scene.supports):
        total[:, k] = link_force_on({support.name}, scene, history.force, rate)
        for j, contact in enumerate(scene.contacts):
            side = sum(part for end, part in contact.direction if end == support.name)
            total[:, k] += side * history.contact_force[:, j]
    return total


def link_force_on(
    ends: Collection[str],
    scene: Scene,
    force: Floats,
    rate: Mapping[str, Floats],
    others: Collection[str] | None = None,
) -> Floats:
    """Sum of what springs and dashpots put on some ends, shape (n,), positive to the right (N).

    Parameters
    ----------
    ends : collection of str
        Names of bodies or supports, or the ground's.
    scene : Scene
        Whose they are.
    force : ndarray, shape (n, S)
        Of the springs (N).
    rate : mapping of str to ndarray, shape (n,)
        Velocities of all ends (m/s).
    others : collection of str, optional
        What the other ends have to be among.
    """
    total = np.zeros(force.shape[0])

    def sign(between: tuple[str, str]) -> int:
        # What pulls the first end to the right pulls the second to the left.
        counts = others is None or {*between} <= {*ends, *others}
        return ((between[0] in ends) - (between[1] in ends)) * counts

    for i, spring in enumerate(scene.springs):
        if way := sign(spring.between):
            total += way * force[:, i]
    for dashpot in scene.dashpots:
        if way := sign(dashpot.between):
            first, second = dashpot.between
            total += way * (dashpot.coefficient * (rate[second] - rate[first]))
    return total


def _of_all_supports(energy: Energy | None, scene: Scene) -> Energy | None:
    """The ledger with a work of every support, none of those that move with the ground."""
    if energy is None:
        return None
    moving = iter(energy.supports)
    works = tuple(next(moving) if s.moves_apart else 0.0 for s in scene.supports)
    return replace(energy, supports=works)


def _closed_in(recording: Recording, task: Task) -> ComputationError | None:
    """An error where a body between supports was left no motion, which moves what cannot be moved.

    A support is then not where it should be, or an impact had no solution. A run that failed while
    none approach each other has failed by something else.
    """
    scene, history = task.scene, recording.history
    supports = moving_supports(scene)
    if len(supports) == 0 or not scene.contacts or history.t.size == 0:
        return None
    said = np.column_stack([support_motion(s, scene.motion, history.t)[1] for s in supports])
    apart = np.abs(history.v[:, : len(supports)] - said).max(axis=1)
    largest = max(np.abs(history.v).max(), np.finfo(float).tiny)
    where = np.flatnonzero(~(apart <= OF_SUPPORT * largest))
    if where.size == 0 and recording.success:
        return None
    first = int(where[0]) if where.size else history.t.size - 1
    t = float(history.t[first]) if where.size else recording.t
    # What begins to move at an instant has no speed there yet.
    soon = t + np.array([0.0, SOON * (task.end - task.start)])
    speed = {s.name: support_motion(s, scene.motion, soon)[1] for s in scene.supports}
    speed[BARRIER] = np.zeros(soon.size)
    fastest = max(np.abs(v).max() for v in (said[: first + 1], *speed.values()))
    shut = _shut(recording, scene, slice(max(0, first - LINES), first + 1))
    for left, right in permutations(speed, 2):
        row = _row(left, right, shut, speed)
        approach = (speed[left] - speed[right]).max() > OF_ROWS * fastest
        if row and (approach or recording.success):
            return ComputationError(
                f"supports close in on what contacts hold between them ({', '.join(row)}) and "
                "leave it no motion; give the contacts wider gaps, or put springs in their place",
                t,
                own_part(recording, scene),
            )
    return None


def _shut(recording: Recording, scene: Scene, rows: slice) -> list[Contact]:
    """Contacts that are closed at one of these lines of the history."""
    gap = np.abs(recording.history.gap[rows]).min(axis=0)
    near = OF_SUPPORT * max(np.abs(recording.history.u).max(), np.finfo(float).tiny)
    return [c for c, g in zip(scene.contacts, gap, strict=True) if g <= near]


def _row(left: str, right: str, shut: list[Contact], fixed: Collection[str]) -> list[str]:
    """Contacts by which bodies are in a row from a support, or the barrier, to one on its right."""
    ends = [tuple({name for name, _ in weights_of(end)} for end in (c.left, c.right)) for c in shut]
    pairs = {pair for of_left, of_right in ends for pair in product(of_left, of_right)}
    onward = _reached(left, pairs, {GROUND, *fixed})
    back = _reached(right, {(b, a) for a, b in pairs}, {GROUND, *fixed})
    return [c.name for c, (a, b) in zip(shut, ends, strict=True) if a & onward and b & back]


def _reached(start: str, pairs: Collection[tuple[str, str]], fixed: Collection[str]) -> set[str]:
    """What pairs lead to from one end, over bodies alone, and that end."""
    reached = {start}
    for _ in pairs:
        reached |= {b for a, b in pairs if a in reached and b not in fixed}
    return reached
