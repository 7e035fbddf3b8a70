"""Variants of one scene, run by one solver: what studies, suites and `simulate_many` share.

A variant differs from the scene in numbers (a column for each), in its ground motion and in how
long it runs. The fast solver carries a chunk of them in one compiled call; any other, or what
needs all of a run, takes them one by one. Either way a variant gives, to the last bit, what
`simulate` gives for it.
"""

from __future__ import annotations

import os
import time
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
from eventpound.case.case import DEFAULTS, Case
from eventpound.case.defaults import default_duration, default_output_step
from eventpound.case.options import FAST as FAST
from eventpound.errors import ComputationError, InputError
from eventpound.motion.base import GroundMotion
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.quantities.lookup import (
    needs_energy,
    needs_free,
    needs_impacts,
    needs_one,
    values_of,
)
from eventpound.response import Response
from eventpound.scene.check import check_scene, motion_problems
from eventpound.scene.parameters import Place, motion_with, places_of, with_values
from eventpound.scene.pi_columns import ScaleColumns
from eventpound.scene.scene import Scene
from eventpound.scene.worst_variants import worst_variants
from eventpound.simulation import options_of, simulate, task_with

if TYPE_CHECKING:
    from eventpound.solvers.base import Task
    from eventpound.solvers.fast.columns import Variants

MOST_IN_CHUNK = 2048
"""Variants that a thread takes at once, at most."""
CHUNKS_A_WORKER = 8
"""Chunks for each thread, at least, so that all end at about the same time."""


@dataclass(frozen=True)
class Columns:
    """Variants of a scene.

    Parameters
    ----------
    case : Case or Scene
        What they have in common.
    numbers : mapping of str to ndarray, shape (n,)
        Numbers that differ, by their dotted keys.
    lengths : ndarray, shape (n,), optional
        Lengths of the runs (s); those that the motions set, by default.
    motions : sequence of GroundMotion
        Ground motions instead of the scene's, where they differ by more than numbers.
    motion_of : ndarray of int, shape (n,), optional
        Which of them each variant has.
    scales : ScaleColumns, optional
        Scales of the ground motions, where they are wanted.
    """

    case: Case | Scene
    numbers: Mapping[str, Floats]
    lengths: Floats | None = None
    motions: Sequence[GroundMotion] = ()
    motion_of: Ints | None = None
    scales: ScaleColumns | None = None

    @property
    def count(self) -> int:
        """How many."""
        columns = self.numbers.values() if self.lengths is None else [self.lengths]
        return len(next(iter(columns)))

    @property
    def scene(self) -> Scene:
        """What they have in common."""
        return self.case.scene if isinstance(self.case, Case) else self.case


@dataclass(frozen=True)
class Wanted:
    """What is kept of each run, and how it is computed.

    Parameters
    ----------
    solver : str
        Name of the solver.
    rtol : float
        Relative tolerance.
    accelerations, impacts : bool
        Whether to keep the extremes of absolute accelerations and base shear, and the numbers
        of contacts that impacts tell.
    quantities : sequence of str
        Names of quantities to keep beside them.
    keep : callable, optional
        Given the number of each variant and its response with all rows of the history.
    """

    solver: str
    rtol: float
    accelerations: bool = False
    impacts: bool = False
    quantities: Sequence[str] = ()
    keep: Callable[[int, Response], None] | None = None

    def in_one_call(self, scene: Scene) -> bool:
        """Whether a chunk of variants can be one compiled call."""
        driven = scene.supports or scene.forces
        return (
            self.solver == FAST and self.keep is None and not driven and not self.one_by_one(scene)
        )

    def one_by_one(self, scene: Scene) -> list[str]:
        """Quantities for which variants must be run one by one."""
        return [q for q in self.quantities if needs_one(scene, q) or needs_free(scene, q)]


class Sweep:
    """Runs of variants; threads may fill different rows of `result`.

    Parameters
    ----------
    columns : Columns
        The variants.
    wanted : Wanted
        What is kept of them.

    Raises
    ------
    InputError
        Where a variant or an option cannot be run; then nothing is run.
    """

    def __init__(self, columns: Columns, wanted: Wanted) -> None:
        self.columns, self.wanted = columns, wanted
        self.variants, self.lengths = variants_of(columns, wanted)
        scene = columns.scene
        self.result = replace(
            blank_many(
                scene,
                columns.numbers,
                wanted.accelerations,
                wanted.one_by_one(scene),
                count=columns.count,
                impacts=wanted.impacts or needs_impacts(scene, wanted.quantities),
            ),
            stated=columns.case.run.stated if isinstance(columns.case, Case) else DEFAULTS,
            scales=columns.scales,
        )
        self.seconds = np.full(columns.count, np.nan)
        """What each run took (s); its share by steps, where several were one call."""
        self._in_one_call = wanted.in_one_call(scene)

    def run(self, workers: int = 1, progress: Callable[[int], None] | None = None) -> BatchResponse:
        """Run all variants.

        Parameters
        ----------
        workers : int
            Number of threads.
        progress : callable, optional
            Called with the number of variants done as the work goes on.

        Returns
        -------
        BatchResponse
            A variant that failed is marked, with NaN in the place of its numbers.
        """
        count, done = self.columns.count, 0
        # One worker has none to wait for.
        shares = CHUNKS_A_WORKER * workers if workers > 1 else 1
        size = max(1, min(MOST_IN_CHUNK, -(-count // shares)))
        chunks = [(low, min(low + size, count)) for low in range(0, count, size)]
        if workers == 1:
            for low, high in chunks:
                done += self.chunk(low, high)
                if progress is not None:
                    progress(done)
        else:
            pool = ThreadPoolExecutor(workers)
            try:
                for future in as_completed([pool.submit(self.chunk, *chunk) for chunk in chunks]):
                    done += future.result()
                    if progress is not None:
                        progress(done)
            finally:
                pool.shutdown(cancel_futures=True)
        found = {name: values_of(self.result, name) for name in self.wanted.quantities}
        named = {name: values for name, values in found.items() if values is not None}
        return replace(self.result, further=named)

    def chunk(self, low: int, high: int) -> int:
        """Run the variants `low` to `high`; returns how many."""
        again = np.arange(low, high)
        if self._in_one_call:
            again = low + self._call(low, high)
        for i in again.tolist():
            self.alone(i)
        return high - low

    def _call(self, low: int, high: int) -> Ints:
        """Run variants in one compiled call; those that have to be run by themselves."""
        from eventpound.contact.impacts import FULL
        from eventpound.solvers.fast.columns import rows_of
        from eventpound.solvers.fast.many import run

        began = time.perf_counter()
        try:
            rows = rows_of(self.variants, low, high)
        except OverflowError:
            return np.arange(high - low)
        kept = run(rows, self.result.struck is not None)
        keep_rows(self.result, low, rows, kept)
        steps = np.maximum(self.result.steps[low:high], 1)
        self.seconds[low:high] = (time.perf_counter() - began) * steps / steps.sum()
        # These had more events than there was room for.
        return np.flatnonzero(kept.ended == FULL)

    def variant(self, i: int) -> Case | Scene:
        """One variant as a case, or a scene, of its own."""
        variants, case = self.variants, self.columns.case
        values = {p: float(v[i]) for p, v in variants.values.items() if p.kind != "excitation"}
        scene = replace(
            with_values(self.columns.scene, values), motion=variants.motions[variants.motion_of[i]]
        )
        return replace(case, scene=scene) if isinstance(case, Case) else scene

    def alone(self, i: int) -> None:
        """Run one variant the ordinary way."""
        wanted, length = self.wanted, float(self.lengths[i])
        whole = self.variant(i)
        step = length
        if wanted.keep is not None and isinstance(whole, Case):
            step = whole.run.output_step
            if np.isnan(step):
                step = default_output_step(whole.scene.motion, length)
        energy = needs_energy(wanted.quantities) or None
        try:
            response = simulate(
                whole, wanted.solver, wanted.rtol, duration=length, output_step=step, energy=energy
            )
            keep_named(self.result, i, response.runs)
            keep_recording(self.result, i, response.recording)
        except ComputationError as error:
            self._fail(i, error, whole)
        except OverflowError:
            start = self.variants.task.start
            mark_failed(
                self.result, i, ComputationError("its scales are beyond all doubles", start)
            )
        else:
            self.seconds[i] = response.work.seconds
            if wanted.keep is not None:
                wanted.keep(i, response)

    def _fail(self, i: int, error: ComputationError, whole: Case | Scene) -> None:
        """Mark a variant that failed, and hand on what there is of it."""
        mark_failed(self.result, i, error)
        if self.wanted.keep is not None and error.recording is not None:
            length = float(self.lengths[i])
            task = _task(whole, self.wanted, length)
            self.wanted.keep(i, Response(task, self.wanted.solver, error.recording))


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def variants_of(columns: Columns, wanted: Wanted) -> tuple[Variants, Floats]:
    """Variants ready to run, every one of them checked, and the lengths of their runs (s).

    Raises
    ------
    InputError
        Saying which variant has what problem.
    """
    from eventpound.solvers.fast.columns import Variants

    scene, count = columns.scene, columns.count
    lengths = columns.lengths
    task = _task(columns.case, wanted, None if lengths is None else float(lengths.max()))
    places = places_of(scene)
    values = {places[key]: column for key, column in columns.numbers.items()}
    still = {place: column for place, column in values.items() if place.kind != "excitation"}
    shaking = {place: column for place, column in values.items() if place.kind == "excitation"}
    motions, motion_of = _motions_of(columns, shaking)
    for i in worst_variants(scene, still, count).tolist():
        try:
            variant = with_values(scene, {place: float(v[i]) for place, v in still.items()})
            check_scene(replace(variant, motion=motions[motion_of[i]]), task.start)
        except InputError as error:
            raise _in_variant(i, columns.numbers, error) from None
    if lengths is None:
        own_length = np.full(count, task.end - task.start)
        lengths = default_lengths(scene, task.start, columns.numbers, own_length)
    return Variants(task, values, task.start + lengths, motions, motion_of), lengths


def _motions_of(
    columns: Columns, shaking: Mapping[Place, Floats]
) -> tuple[list[GroundMotion], Ints]:
    """Ground motions that differ, each of them checked, and which one each variant has."""
    numbers = list(shaking.values())
    if columns.motion_of is not None:
        numbers = [columns.motion_of.astype(float), *numbers]
    first, motion_of = distinct(numbers, columns.count)
    motions: list[GroundMotion] = []
    for i in first.tolist():
        own = columns.scene.motion
        if columns.motion_of is not None:
            own = columns.motions[columns.motion_of[i]]
        try:
            motion = motion_with(own, {place: column[i] for place, column in shaking.items()})
            problems = [str(problem) for problem in motion_problems(motion)]
            if motions and np.isfinite(motion.end) != np.isfinite(motions[0].end):
                problems.append("excitation: found a motion without end among others that end")
            if problems:
                raise InputError(problems)
        except InputError as error:
            raise _in_variant(i, columns.numbers, error) from None
        motions.append(motion)
    return motions, motion_of


def _task(case: Case | Scene, wanted: Wanted, length: float | None) -> Task:
    run, options = options_of(case, length, length, needs_energy(wanted.quantities) or None)
    options = replace(options, name=wanted.solver, rtol=wanted.rtol)
    return task_with(case.scene if isinstance(case, Case) else case, run, options, None)


def _in_variant(i: int, values: Mapping[str, Floats], error: InputError) -> InputError:
    """The same error, saying in which variant."""
    if not values:
        return error
    shown = [f"{key} = {float(column[i])!r}" for key, column in values.items()]
    return InputError([f"variant {i} ({', '.join(shown)}): {line}" for line in error.problems])


def default_lengths(
    scene: Scene, start: float, numbers: Mapping[str, Floats], otherwise: Floats
) -> Floats:
    """Lengths of the runs of variants that do not say them (s).

    Parameters
    ----------
    scene : Scene
        What they have in common.
    start : float
        When they begin (s).
    numbers : mapping of str to ndarray, shape (n,)
        Numbers that differ, by their dotted keys.
    otherwise : ndarray, shape (n,)
        Lengths where none of the numbers decides them (s).

    Raises
    ------
    InputError
        Where a motion refuses its numbers or sets no length.
    """
    kinds: tuple[str, ...] = ("excitation", "support")
    if isinstance(scene.motion, Record):
        kinds = (*kinds, "body", "spring")
    places = places_of(scene) if numbers else {}
    deciding = {places[key]: v for key, v in numbers.items() if places[key].kind in kinds}
    if not deciding:
        return otherwise
    first, which = distinct(list(deciding.values()), otherwise.size)
    lengths = [
        default_duration(
            with_values(scene, {place: float(v[i]) for place, v in deciding.items()}), start
        )
        for i in first.tolist()
    ]
    return np.array(lengths)[which]
