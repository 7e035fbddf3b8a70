"""Thousands of variants of one scene in one call, on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eventpound.batch_response import (
    BatchResponse,
    blank_many,
    keep_named,
    keep_recording,
    keep_rows,
    mark_failed,
)
from eventpound.case.case import Case
from eventpound.case.defaults import default_duration
from eventpound.case.table import suggestion
from eventpound.errors import ComputationError, InputError
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.numerics.distinct import distinct
from eventpound.quantities import chosen, needs_energy, needs_free, needs_one
from eventpound.scene.check import check_scene, motion_problems
from eventpound.scene.doubt import doubtful
from eventpound.scene.parameters import Place, motion_with, places_of, with_values
from eventpound.scene.scene import Scene
from eventpound.simulation import options_of, simulate, task_with

if TYPE_CHECKING:
    from eventpound.solvers.fast.columns import Motion, Variants

MOST_IN_CHUNK = 2048
"""Variants that a thread takes at once, at most."""
CHUNKS_A_WORKER = 8
"""Chunks for each thread, at least, so that all end at about the same time."""
MOST_SHOWN = 12
"""Keys that a message lists, at most."""
_Values = Mapping[str, Floats]


def simulate_many(
    case: Case | Scene,
    parameters: Mapping[str, Sequence[float] | Floats],
    *,
    rtol: float = 1e-6,
    duration: float | Floats | None = None,
    accelerations: bool = False,
    quantities: Sequence[str] = (),
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> BatchResponse:
    """Compute how variants of one scene move.

    Every variant is computed exactly as ``simulate(variant, solver="fast")``
    would, to the last bit, whatever the number of workers.

    Parameters
    ----------
    case : Case or Scene
        What the variants have in common; a case brings its own run options
        and absolute tolerances.
    parameters : mapping of str to array_like, shape (n,)
        Numbers (SI) that differ, one value a variant, by keys as a case has
        them: ``"body.deck.mass"``, ``"spring.frame.strength"``,
        ``"dashpot.ground-deck.coefficient"``, ``"contact.joint.gap"``,
        ``"excitation.amplitude"``; see ``docs/many.md``.
    rtol : float, optional
        Relative tolerance, 1e-14 to 1e-2.
    duration : float or ndarray, shape (n,), optional
        Length of the runs (s), or of each; for a scene that of each variant's
        motion and four periods.
    accelerations : bool, optional
        Whether to give the extremes of absolute accelerations and base shear, too.
    quantities : sequence of str
        Names of further ones to tabulate (docs/quantities.md), which need all of each run:
        then variants run one by one, some hundred times slower.
    workers : int, optional
        Number of threads; as many as there are cores to use.
    progress : callable, optional
        Called with the number of variants done as the work goes on.

    Returns
    -------
    BatchResponse
        Peaks, impacts and final states; a variant that failed is marked, with
        NaN in the place of its numbers.

    Raises
    ------
    InputError
        Where a key, a value or an option cannot be used; then nothing is run.
    """
    scene = case.scene if isinstance(case, Case) else case
    places = places_of(scene)
    values = _checked_columns(parameters, places)
    count = len(next(iter(values.values())))
    lengths = None if duration is None else _lengths(duration, count)
    variants = _variants(case, values, places, rtol, lengths)
    named = _named(scene, quantities)
    sweep = _Sweep(case, lengths, variants, blank_many(scene, values, accelerations, named))
    workers = workers or cores()
    # One worker has none to wait for.
    shares = CHUNKS_A_WORKER * workers if workers > 1 else 1
    size = max(1, min(MOST_IN_CHUNK, -(-count // shares)))
    chunks = [(low, min(low + size, count)) for low in range(0, count, size)]
    done = 0
    pool = ThreadPoolExecutor(workers)
    try:
        for future in as_completed([pool.submit(sweep.chunk, *chunk) for chunk in chunks]):
            done += future.result()
            if progress is not None:
                progress(done)
    finally:
        pool.shutdown(cancel_futures=True)
    return sweep.result


@dataclass(frozen=True)
class _Sweep:
    """Runs of variants; threads fill different rows of `result`."""

    case: Case | Scene
    duration: Floats | None
    variants: Variants
    result: BatchResponse

    def chunk(self, low: int, high: int) -> int:
        """Run the variants `low` to `high`; returns how many."""
        from eventpound.solvers.events.impacts import FULL
        from eventpound.solvers.fast.columns import rows_of
        from eventpound.solvers.fast.many import run

        numbers = np.arange(low, high)
        if self.result.further:
            for i in numbers.tolist():
                self.alone(i)
            return numbers.size
        try:
            rows = rows_of(self.variants, low, high)
        except OverflowError:
            again = numbers
        else:
            kept = run(rows)
            keep_rows(self.result, low, rows, kept)
            # These had more events than there was room for.
            again = numbers[kept.ended == FULL]
        for i in again.tolist():
            self.alone(i)
        return numbers.size

    def alone(self, i: int) -> None:
        """Run one variant the ordinary way."""
        task = self.variants.task
        values = {place: float(column[i]) for place, column in self.variants.values.items()}
        scene = with_values(task.scene, values)
        whole = replace(self.case, scene=scene) if isinstance(self.case, Case) else scene
        duration = None if self.duration is None else float(self.duration[i])
        try:
            energy = needs_energy(list(self.result.further)) or None
            response = simulate(whole, "fast", task.rtol, duration=duration, energy=energy)
        except ComputationError as error:
            mark_failed(self.result, i, error)
        except OverflowError:
            beyond = ComputationError("its scales are beyond all doubles", task.start)
            mark_failed(self.result, i, beyond)
        else:
            keep_recording(self.result, i, response.recording)
            keep_named(self.result, i, response.runs)


def _named(scene: Scene, quantities: Sequence[str]) -> list[str]:
    """Quantities that the extremes of a run do not give; one that there is not is refused."""
    return [
        name
        for name in chosen(scene, quantities)
        if needs_one(scene, name) or needs_free(scene, name)
    ]


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _checked_columns(
    parameters: Mapping[str, Sequence[float] | Floats], places: Mapping[str, Place]
) -> dict[str, Floats]:
    """Columns of one length, of finite numbers, by keys that the scene has."""
    problems, columns = [], {}
    for key, given in parameters.items():
        if key not in places:
            shown = [*list(places)[:MOST_SHOWN], *(["..."] if len(places) > MOST_SHOWN else [])]
            meant = suggestion(key, list(places)) or f"; accepted: {', '.join(shown)}"
            problems.append(f"parameters: {key}: unknown key{meant}")
            continue
        try:
            column = np.array(given, dtype=np.float64)
        except (TypeError, ValueError):
            problems.append(f"parameters: {key}: found {given!r}; accepted: an array of numbers")
            continue
        bad = np.flatnonzero(~np.isfinite(column))
        if column.ndim != 1 or column.size == 0:
            problems.append(
                f"parameters: {key}: found shape {column.shape}; accepted: (n,), a value a variant"
            )
        elif bad.size:
            problems.append(
                f"parameters: {key}: found {column[bad[0]]} in variant {bad[0]}; "
                "accepted: finite numbers"
            )
        else:
            columns[key] = column
    sizes = {key: column.size for key, column in columns.items()}
    if len(set(sizes.values())) > 1:
        found = ", ".join(f"{key} has {size}" for key, size in sizes.items())
        problems.append(f"parameters: found different lengths: {found}; accepted: one length")
    if not parameters:
        problems.append("parameters: found none; accepted: at least one key with its values")
    if problems:
        raise InputError(problems)
    return columns


def _lengths(duration: float | Floats, count: int) -> Floats:
    """Length of each run (s)."""
    lengths = np.array(duration, dtype=np.float64)
    if lengths.shape not in ((), (count,)):
        raise InputError(f"duration: found shape {lengths.shape}; accepted: one, or ({count},)")
    if not (np.isfinite(lengths) & (lengths > 0.0)).all():
        raise InputError("duration: found one that is not positive; accepted: positive times (s)")
    return np.broadcast_to(lengths, (count,)).copy()


def _variants(
    case: Case | Scene,
    values: _Values,
    places: Mapping[str, Place],
    rtol: float,
    lengths: Floats | None,
) -> Variants:
    """Variants ready to run, every one of them checked."""
    from eventpound.solvers.fast.columns import Variants, motion_numbers

    longest = None if lengths is None else float(lengths.max())
    run, options = options_of(case, longest, None, None)
    scene = case.scene if isinstance(case, Case) else case
    task = task_with(scene, run, replace(options, name="fast", rtol=rtol), None)
    columns = {places[key]: column for key, column in values.items()}
    count = len(next(iter(values.values())))
    _check(scene, values, columns, count)
    defaults = lengths is None and not isinstance(case, Case)
    shaking = [place for place in columns if place.kind == "excitation"]
    first, motion_of = distinct([columns[place] for place in shaking], count)
    motions: list[Motion] = []
    ends = np.full(count, task.end) if lengths is None else task.start + lengths
    for m, i in enumerate(first.tolist()):
        try:
            motion = motion_with(scene.motion, {p: columns[p][i] for p in shaking})
            problems = [str(problem) for problem in motion_problems(motion)]
            if problems:
                raise InputError(problems)
            numbers = motion_numbers(motion)
            if motions and numbers.ground.ends.size != motions[0].ground.ends.size:
                raise InputError("excitation: found a motion without end among others that end")
            if defaults and shaking:
                ends[motion_of == m] = default_duration(replace(scene, motion=motion), 0.0)
        except InputError as error:
            raise _in_variant(i, values, error) from None
        motions.append(numbers)
    if defaults and isinstance(scene.motion, Record):
        ends = _ends_of_records(scene, values, columns, ends)
    return Variants(task, columns, ends, motions, motion_of)


def _check(scene: Scene, values: _Values, columns: Mapping[Place, Floats], count: int) -> None:
    """Refuse the first variant that has a problem, as `check_scene` would."""
    still = {place: column for place, column in columns.items() if place.kind != "excitation"}
    for i in np.flatnonzero(doubtful(scene, still, count)).tolist():
        try:
            check_scene(with_values(scene, {place: float(v[i]) for place, v in still.items()}))
        except InputError as error:
            raise _in_variant(i, values, error) from None


def _in_variant(i: int, values: _Values, error: InputError) -> InputError:
    """The same error, saying in which variant."""
    shown = [f"{key} = {float(column[i])!r}" for key, column in values.items()]
    return InputError([f"variant {i} ({', '.join(shown)}): {line}" for line in error.problems])


def _ends_of_records(
    scene: Scene, values: _Values, columns: Mapping[Place, Floats], ends: Floats
) -> Floats:
    """Ends of runs under a record, which go on for periods of the variant's own."""
    deciding = [place for place in columns if place.kind in ("body", "spring", "excitation")]
    if not deciding:
        return ends
    first, which = distinct([columns[place] for place in deciding], ends.size)
    durations = [
        default_duration(with_values(scene, {p: float(columns[p][i]) for p in deciding}), 0.0)
        for i in first.tolist()
    ]
    return np.array(durations)[which]
