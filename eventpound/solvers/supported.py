"""Supports and forces around a solver: a scene as the engine has it in, a recording out.

`eventpound.mechanics.supported` says how a scene is lowered; here the bodies that stand for
supports are taken out of what a solver returns.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.supported import components, lowered, moving_supports, support_motion
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.ends import Joining, opening
from eventpound.scene.plan_point import ALONG, TURN, coordinate_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.solvers.base import Energy, History, Recording, SupportHistory, Task
from eventpound.tolerances import OF_ROWS, OF_SUPPORT, SOON, TURNED_TOO_FAR

LINES = 5
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
    if not scene.is_driven:
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
    turned = first_turned_too_far(recording, scene)
    if turned is not None:
        deck, t = turned
        text = (
            f"deck {deck!r} has turned by more than {TURNED_TOO_FAR} rad, which is not small; hold "
            "it by springs, or end the run before"
        )
        until = own_part(solve(replace(task, scene=lowered(scene, task.start), end=t)), scene)
        raise ComputationError(text, t, replace(until, success=False, message=text))
    return own_part(recording, scene)


def first_turned_too_far(recording: Recording, scene: Scene) -> tuple[str, float] | None:
    """The deck that has turned too far for the geometry of rest, and a time at which it has (s)."""
    found = list[tuple[float, str]]()
    names, h, peaks = (
        [body.name for body in scene.bodies],
        recording.history,
        recording.displacement,
    )
    for deck in scene.decks:
        b, far = names.index(coordinate_of(deck.name, TURN)), TURNED_TOO_FAR * deck.radius
        found += [(float(t), deck.name) for t in h.t[np.abs(h.u[:, b]) > far][:1]]
        found += [
            (float(times[b]), deck.name)
            for values, times in (
                (peaks.maximum, peaks.time_of_maximum),
                (-peaks.minimum, peaks.time_of_minimum),
            )
            if values[b] > far
        ]
    # What is so from the start has no run before it.
    later = [(t, name) for t, name in found if t > h.t[0]]
    return None if not later else (min(later)[1], min(later)[0])


def own_part(recording: Recording, scene: Scene) -> Recording:
    """A recording without the bodies that stand for supports in the lowered `scene`."""
    recording = recording.of_bodies(np.s_[len(moving_supports(scene)) :])
    history = recording.history
    if scene.in_plan:
        recording = replace(recording, history=_on_moving_ground(history, scene))
    motions = [support_motion(s, scene.motion, history.t) for s in scene.supports]
    shape = history.t.size, len(motions)
    s, sv = (np.reshape([m[i] for m in motions], shape[::-1]).T.copy() for i in range(2))
    return replace(
        recording,
        supports=SupportHistory(s, sv, forces_on_supports(scene, history, sv)) if motions else None,
        energy=_of_all_supports(recording.energy, scene),
    )


def _on_moving_ground(history: History, scene: Scene) -> History:
    """The history in plan with the ground motion, which the engine has as loads."""
    along = ground_accelerations(scene, ALONG, history)
    own = [ground_accelerations(scene, body.direction, history) for body in scene.bodies]
    return replace(history, a=history.a + np.column_stack(own), ground=along)


def ground_accelerations(scene: Scene, direction: str, history: History) -> Floats:
    """The ground's in a direction of bodies (m/s²) at the rows, shape (n,)."""
    if not scene.in_plan:
        return history.ground
    return of_ground(scene, direction, "acceleration", history.t)


def of_ground(scene: Scene, direction: str, what: str, t: Floats) -> Floats:
    """The displacement, velocity or acceleration of the ground in a direction of bodies, (n,).

    Parameters
    ----------
    scene : Scene
        Whose ground it is.
    direction : str
        As a body has it.
    what : str
        ``"displacement"`` (m), ``"velocity"`` (m/s) or ``"acceleration"`` (m/s²).
    t : ndarray, shape (n,)
        Times (s).
    """
    found = np.zeros(t.size)
    for signal, part in components(scene, direction):
        found += part * getattr(signal, what)(t)
    return found


def relative_accelerations(scene: Scene, history: History) -> Floats:
    """Accelerations of the bodies relative to the ground (m/s²), shape (n, b)."""
    own = [ground_accelerations(scene, body.direction, history) for body in scene.bodies]
    return history.a - np.column_stack(own)


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

    def part(link: Joining) -> float:
        # What pulls the first end to the right pulls the second to the left.
        counts = others is None or {*link.ends} <= {*ends, *others}
        return counts * -sum(weight for end, weight in link.direction if end in ends)

    for i, spring in enumerate(scene.springs):
        if own := part(spring):
            total += own * force[:, i]
    for dashpot in scene.dashpots:
        if own := part(dashpot):
            total += own * (dashpot.coefficient * opening(dashpot, 0.0, rate))
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
    if len(supports) == 0 or not scene.contacts:
        return None
    # The last state, too: a run that fails at its start has no history.
    t, u, v = (
        np.append(history.t, recording.t),
        *(
            np.vstack((rows.reshape(-1, last.size), last))
            for rows, last in ((history.u, recording.u), (history.v, recording.v))
        ),
    )
    said = np.column_stack([support_motion(s, scene.motion, t)[1] for s in supports])
    apart = np.abs(v[:, : len(supports)] - said).max(axis=1)
    where = np.flatnonzero(~(apart <= OF_SUPPORT * max(np.abs(v).max(), np.finfo(float).tiny)))
    if where.size == 0 and recording.success:
        return None
    first = int(where[0]) if where.size else t.size - 1
    # What begins to move at an instant has no speed there yet.
    soon = t[first] + np.array([0.0, SOON * (task.end - task.start)])
    speed = {s.name: support_motion(s, scene.motion, soon)[1] for s in scene.supports}
    fastest = max(np.abs(v).max() for v in (said[: first + 1], *speed.values()))
    shut = _shut(u[max(0, first - LINES) : first + 1], scene, np.abs(u).max())
    given = {name: v / (fastest or 1.0) for name, v in speed.items()}
    held = _squeezed(shut, given, recording.success)
    if not held:
        return None
    return ComputationError(
        f"supports close in on what contacts hold between them ({', '.join(held)}) and "
        "leave it no motion; give the contacts wider gaps, or put springs in their place",
        float(t[first]),
        own_part(recording, scene),
    )


def _shut(u: Floats, scene: Scene, largest: float) -> list[Contact]:
    """Contacts that are closed at one of these displacements (n, N), the largest of all known."""
    names = [end.name for ends in (moving_supports(scene), scene.bodies) for end in ends]
    moving = dict(zip(names, u.T, strict=True))
    near = OF_SUPPORT * max(largest, np.finfo(float).tiny)
    return [
        c
        for c in scene.contacts
        if np.abs(c.gap + sum(w * moving[name] for name, w in c.direction if name in moving)).min()
        <= near
    ]


def _squeezed(shut: list[Contact], speed: Mapping[str, Floats], moved: bool) -> list[str]:
    """Contacts that supports close in on; none where bodies have a way out.

    There is none just where some pressures x >= 0, in balance on all bodies, are worked against:
    ``Σ x_j W_j = 0`` on these, and of the speeds that are given, parts of the largest at some
    instants, ``Σ x_j W_j v < 0`` (Farkas). Where a support was `moved` off its way pressures in
    balance are enough: rounding may have hidden the speed.
    """
    from scipy.optimize import nnls

    bodies = sorted({name for c in shut for name in c.ends} - {BARRIER, GROUND, *speed})
    rows = np.zeros((len(bodies) + 1, len(shut)))
    for instant in range(2 + moved if shut else 0):
        rows[:], rows[-1] = 0.0, -1.0 if instant == 2 else 0.0
        for j, contact in enumerate(shut):
            for name, weight in contact.direction:
                if name in bodies:
                    rows[bodies.index(name), j] += weight
                elif name in speed and instant < 2:
                    rows[-1, j] += weight * speed[name][instant]
        x, missed = nnls(rows, np.append(np.zeros(len(bodies)), -1.0))
        # What cannot be worked against is missed whole; what is not found has no digits.
        if missed < 0.5 and x.max() < 1.0 / OF_ROWS:
            return [c.name for c, part in zip(shut, x / x.max(), strict=True) if part > OF_ROWS]
    return []
