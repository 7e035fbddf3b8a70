"""Runs made again with rows close together, for what no solver locates.

Rows stand at every corner of what moves a scene, on either side of its jumps, and between. They
are doubled until no number changes by more than `AGREEMENT`.

The shocks of a sequence are runs of their own. Each begins in the state in which the whole run has
it begin and ends where the next begins, so that extremes, impacts and what is left are its own.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from eventpound.basics.told import warn_caller
from eventpound.errors import AccuracyWarning, InputError
from eventpound.motion.base import Family, GroundMotion
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.at_rest import stiffest
from eventpound.scene.continuation import FinalState, state_of
from eventpound.scene.periods import local_periods
from eventpound.scene.structures import of_frames
from eventpound.solvers.base import Recording, Task

Key = TypeVar("Key", bound=Hashable)
Rerun = Callable[[Task], Recording]

AGREEMENT = 1e-7
"""Part of its own size by which a number may still change when rows are doubled."""
SIDES = "after", "before"
"""Of an event, or of a jump of the ground: its row, and that of the last double before it."""
ROWS_A_PERIOD = 80.0
"""Rows in the shortest period, at first."""
_FEWER = 10.0
"""Times fewer for floors of frames, which swing in their highest modes while others are held."""
FEWEST_ROWS, MOST_ROWS = 1000, 2_000_000
_DOUBLINGS = 4
_MOST_PIECES = 100_000


def rows_at(task: Task, rerun: Rerun, t: Floats, side: str) -> tuple[Recording, Ints]:
    """A run of a task with rows at some times, and which row of its history each time has.

    Output times change no step of a solver, so that it is the same run.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task.
    t : ndarray, shape (n,)
        Times (s).
    side : str
        ``"after"`` or ``"before"``: which row of an event, or of a jump of the ground.

    Raises
    ------
    InputError
        Where a time is not one of the run, or its solver has no row before an event.
    """
    if side not in SIDES:
        raise InputError(f"side: found {side!r}; accepted: {' or '.join(map(repr, SIDES))}")
    outside = t[(t < task.start) | (t > task.end)]
    if outside.size or not t.size:
        found = f"{outside[0]:.6g} s" if outside.size else "none"
        within = f"times of the run, {task.start:.6g} to {task.end:.6g} s"
        raise InputError(f"t: found {found}; accepted: {within}")
    after = side == SIDES[0]
    shown = t if after else np.maximum(np.nextafter(t, -np.inf), task.start)
    run = rerun(replace(task, output_times=np.unique(np.concatenate([shown, t]))))
    first, end = (np.searchsorted(run.history.t, t, way) for way in ("left", "right"))
    inside = (end - first == 1) & np.isin(t, [event.t for event in run.events]) & (t > task.start)
    if not after and inside.any():
        at = f"'before' at {t[inside][0]:.6g} s, an event inside a step of the solver"
        raise InputError(f"side: found {at}; accepted: 'after'")
    return run, np.searchsorted(run.history.t, shown, "right" if after else "left") - int(after)


def settled(
    task: Task, rerun: Rerun, numbers: Callable[[Recording], Mapping[Key, tuple[Floats, Floats]]]
) -> tuple[Mapping[Key, tuple[Floats, Floats]], Mapping[Key, float]]:
    """Numbers of a task from rows that are doubled until they agree, and by how much they do not.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task.
    numbers : callable
        What is computed of a run: values, and their sizes.

    Returns
    -------
    tuple of mapping
        The numbers, and by which part of their sizes they still changed; inf where rows could not
        be doubled.
    """
    found: Mapping[Key, tuple[Floats, Floats]] = {}
    apart: dict[Key, float] = {}
    step, _ = first_step(task)
    for _ in range(_DOUBLINGS + 1):
        times = close_times(task, step)
        if found and times.size > MOST_ROWS:
            break
        before, found = found, numbers(rerun(replace(task, energy=False, output_times=times)))
        apart = {key: _change(before.get(key), *found[key]) for key in found}
        if max(apart.values(), default=0.0) <= AGREEMENT:
            break
        step *= 0.5
    return found, apart


def _change(before: tuple[Floats, Floats] | None, values: Floats, sizes: Floats) -> float:
    """Largest part of their sizes by which values differ from those before."""
    if before is None:
        return np.inf
    parts = np.abs(values - before[0]) / np.maximum(sizes, np.finfo(float).tiny)
    return float(parts.max(initial=0.0))


def warn_unsettled(name: str, part: float, aim: float = AGREEMENT) -> None:
    """Say of a number that it is known to no more than a part of its size, where that is so."""
    text = (
        f"known to some {part:.2e} of its size, not to {aim:g}; a smaller rtol helps, with fixed "
        "steps a smaller time_step"
    )
    if part == np.inf:
        text = f"not checked: closer rows would be more than {MOST_ROWS}; a shorter duration helps"
    # What the words cannot tell from the aim is no more than it.
    if float(f"{part:.2e}") > aim:
        warn_caller(f"{name}: {text}", AccuracyWarning)


def first_step(task: Task) -> tuple[float, bool]:
    """Distance of the rows that are tried first (s), and whether it shows all of a motion."""
    frames, each = of_frames(task.scene), local_periods(stiffest(task.scene))
    fewer = {name: p * (_FEWER if name in frames else 1.0) for name, p in each.items()}
    periods = [p for p in fewer.values() if np.isfinite(p)]
    scales = task.scene.motion.scales()
    if scales is not None:
        periods.append(scales.period)
    length = task.end - task.start
    wanted = min(min(periods, default=length) / ROWS_A_PERIOD, length / FEWEST_ROWS)
    least = length / MOST_ROWS * 4.0
    return max(wanted, least), wanted >= least


def close_times(task: Task, step: float) -> Floats:
    """Times of the rows: corners of the ground motion, either side of its jumps, steps between."""
    scene = task.scene
    moving: list[GroundMotion] = [*scene.motions, *(force.history for force in scene.forces)]
    corners, jumps = (np.concatenate(x) for x in zip(*map(_corners, moving), strict=True))
    jumps = jumps[(jumps > task.start) & (jumps < task.end)]
    inside = corners[(corners > task.start) & (corners < task.end)]
    base = np.unique(np.concatenate([[task.start, task.end], inside]))
    parts = [
        np.linspace(low, high, max(1, int(np.ceil((high - low) / step))), endpoint=False)
        for low, high in pairwise(base)
    ]
    # Both one-sided values at a jump: the row at its time has the one after it.
    before = np.nextafter(jumps, -np.inf)
    return np.unique(np.concatenate([*parts, before, [task.end]]))


def _corners(motion: GroundMotion) -> tuple[Floats, Floats]:
    """Times where a ground motion is not smooth, and where it may jump."""
    corners: list[Floats] = []
    borders: list[float] = []
    for piece in motion.pieces()[:_MOST_PIECES]:
        borders += [x for x in (piece.start, piece.end) if np.isfinite(x)]
        if piece.family is Family.SAMPLES:
            first, dt = piece.coefficients[:2]
            corners.append(first + dt * np.arange(piece.samples.size))
    jumps = np.unique(borders)
    return np.concatenate([jumps, *corners]), jumps


def shocks_of(task: Task, rerun: Rerun) -> list[tuple[Task, FinalState | None]]:
    """A task for each shock that begins within one, and the state that it goes on from.

    None where there is one record only; the first goes on from nothing.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task; a failure is a ComputationError.
    """
    scene, motion = task.scene, task.scene.motion
    begins = motion.begins[1:] if isinstance(motion, Record) else np.empty(0)
    begins = begins[(begins > task.start) & (begins < task.end)]
    if not begins.size:
        return []
    run, places = rows_at(task, rerun, begins, SIDES[0])
    h = run.history
    states = [None, *(state_of(scene, h.u[i], h.v[i], h.z[i]) for i in places)]
    ends = pairwise([task.start, *begins.tolist(), task.end])
    parts = [replace(task, start=a, end=b, output_times=np.empty(0)) for a, b in ends]
    return list(zip(parts, states, strict=True))


def shock_at(motion: GroundMotion, t: float) -> dict[str, object]:
    """Name and factor of the record of a sequence that is going on at a time (s)."""
    if not isinstance(motion, Record) or not motion.shocks:
        return {}
    number = max(int(np.searchsorted(motion.begins, t, "right")) - 1, 0)
    name, factor = motion.shocks[number]
    return {"record": name, "scale": factor}
