"""Runs of rows by one solver: the only place where many runs are made.

A row differs from its scene in numbers (a column for each), in its ground motion and in how long
it runs. The fast solver carries a chunk of rows in one compiled call; any other, or what needs all
of a run, takes them one by one. Either way a row is, to the last bit, what `simulate` gives for it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from eventpound.basics.told import Counted
from eventpound.case.case import Case
from eventpound.case.solver_options import FAST
from eventpound.errors import ComputationError, InputError
from eventpound.motion.base import GroundMotion
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.quantities.batch_response import (
    BatchResponse,
    blank_many,
    keep_named,
    keep_recording,
    keep_rows,
    mark_failed,
)
from eventpound.quantities.lookup import needs_energy, needs_one
from eventpound.response import Response
from eventpound.scene.check import check_scene, motion_problems
from eventpound.scene.parameters import Place, motion_with, number_places, with_values
from eventpound.scene.spring import LawName
from eventpound.simulation import ReadyScene, options_of, task_with
from eventpound.solvers import solver_named
from eventpound.study.checked_numbers import variants_to_check
from eventpound.study.variants import Rows, complete

if TYPE_CHECKING:
    from eventpound.solvers.base import Task
    from eventpound.solvers.fast.columns import Variants

MOST_IN_CHUNK = 2048
"""Rows that a thread takes at once, at most."""
CHUNKS_A_WORKER = 8
"""Chunks for each thread, at least, so that all end at about the same time."""


@dataclass(frozen=True)
class WantedRuns:
    """What is kept of each run, and how it is computed.

    Parameters
    ----------
    solver : str
        Name of the solver.
    rtol : float
        Relative tolerance.
    quantities : sequence of str
        Names of quantities to keep.
    accelerations : bool
        Whether to keep the extremes of absolute accelerations and base shear, named or not.
    impacts : bool
        Whether to keep the numbers of contacts that impacts tell, named or not.
    keep : callable, optional
        Given the number of each row and its response with all rows of the history.
    """

    solver: str
    rtol: float
    quantities: Sequence[str] = ()
    accelerations: bool = False
    impacts: bool = False
    keep: Callable[[int, Response], None] | None = None


class Sweep:
    """Runs of rows; threads may fill different rows of `result`.

    Parameters
    ----------
    rows : Rows
        What is run.
    wanted : WantedRuns
        What is kept of it.

    Raises
    ------
    InputError
        Where a row or an option cannot be run; then nothing is run.
    """

    def __init__(self, rows: Rows, wanted: WantedRuns) -> None:
        self.rows, self.variants = variants_of(rows, wanted)
        scene = rows.scene
        one_by_one = [q for q in wanted.quantities if needs_one(scene, q, rows.numbers)]
        self.wanted = replace(wanted, quantities=one_by_one)
        self.result = replace(
            blank_many(
                scene,
                rows.numbers,
                wanted.accelerations,
                one_by_one,
                count=rows.count,
                impacts=wanted.impacts,
            ),
            stated=rows.case.run.stated,
            scales=self.rows.scales,
        )
        self.seconds = np.full(rows.count, np.nan)
        driven = scene.is_driven
        # The arrays of many runs are without the contacts that hold sliders.
        slides = LawName.SLIDER in scene.branched_springs.values()
        several = wanted.keep is None and not (driven or slides or one_by_one)
        self._in_one_call = wanted.solver == FAST and several

    def run(self, workers: int = 1, progress: Counted | None = None) -> BatchResponse:
        """Run all rows.

        Parameters
        ----------
        workers : int
            Number of threads.
        progress : callable, optional
            Called with the numbers of rows done and of all.

        Returns
        -------
        BatchResponse
            A run that failed is marked, with NaN in the place of its numbers.
        """
        count, done = self.rows.count, 0
        # One worker has none to wait for.
        shares = CHUNKS_A_WORKER * workers if workers > 1 else 1
        size = max(1, min(MOST_IN_CHUNK, -(-count // shares)))
        chunks = [(low, min(low + size, count)) for low in range(0, count, size)]
        pool = ThreadPoolExecutor(workers) if workers > 1 else None
        try:
            if pool is None:
                runs: Iterator[int] = (self.chunk(*chunk) for chunk in chunks)
            else:
                futures = [pool.submit(self.chunk, *chunk) for chunk in chunks]
                runs = (future.result() for future in as_completed(futures))
            for new in runs:
                done += new
                if progress is not None:
                    progress(done, count)
        finally:
            if pool is not None:
                pool.shutdown(cancel_futures=True)
        return self.result

    def chunk(self, low: int, high: int) -> int:
        """Run the rows `low` to `high`; returns how many."""
        again = np.arange(low, high)
        if self._in_one_call:
            again = low + self._call(low, high)
        for i in again.tolist():
            self.alone(i)
        return high - low

    def _call(self, low: int, high: int) -> Ints:
        """Run rows in one compiled call; those that have to be run by themselves."""
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

    @cached_property
    def _ready(self) -> ReadyScene:
        task, stated = self.variants.task, self.rows.case.run.stated
        return ReadyScene(solver_named(self.wanted.solver), task, stated)

    def alone(self, i: int) -> None:
        """Run one row the ordinary way."""
        values = {p: float(v[i]) for p, v in self.variants.values.items() if p.kind != "excitation"}
        wanted, task = self.wanted, self._task_of(i)
        try:
            response = self._ready.run(values, task)
            keep_named(self.result, i, response.runs)
            keep_recording(self.result, i, response.recording)
        except ComputationError as error:
            mark_failed(self.result, i, error)
            if wanted.keep is not None and error.recording is not None:
                task = replace(task, scene=with_values(task.scene, values))
                wanted.keep(i, Response(task, wanted.solver, error.recording))
        except OverflowError:
            beyond = ComputationError("its scales are beyond all doubles", task.start)
            mark_failed(self.result, i, beyond)
        else:
            self.seconds[i] = response.work.seconds
            if wanted.keep is not None:
                wanted.keep(i, response)

    def _task_of(self, i: int) -> Task:
        """The task of the scene with the motion, the length and the rows of one row."""
        task, run, lengths = self.variants.task, self.rows.case.run, self.rows.lengths
        assert lengths is not None
        scene = replace(task.scene, motion=self.variants.motions[self.variants.motion_of[i]])
        length = float(lengths[i])
        all_rows = self.wanted.keep is not None
        run = replace(run, duration=length).completed(scene) if all_rows else run.lasting(length)
        return replace(task, scene=scene, end=task.start + length, output_times=run.output_times)


def variants_of(rows: Rows, wanted: WantedRuns) -> tuple[Rows, Variants]:
    """Rows with all that their motions decide, ready to run, every one of them checked.

    Raises
    ------
    InputError
        Saying which row has what problem.
    """
    from eventpound.solvers.fast.columns import Variants

    scene, start = rows.scene, rows.case.run.start_time
    places = number_places(scene)
    values = {places[key]: column for key, column in rows.numbers.items()}
    still = {place: column for place, column in values.items() if place.kind != "excitation"}
    shaking = {place: column for place, column in values.items() if place.kind == "excitation"}
    motions, motion_of = _motions_of(rows, shaking)
    for i in variants_to_check(scene, still, rows.count).tolist():
        try:
            variant = with_values(scene, {place: float(v[i]) for place, v in still.items()})
            check_scene(replace(variant, motion=motions[motion_of[i]]), start)
        except InputError as error:
            raise _in_variant(i, rows.numbers, error) from None
    rows = complete(rows)
    assert rows.lengths is not None
    task = _task(rows.case, wanted, float(rows.lengths.max()))
    return rows, Variants(task, values, start + rows.lengths, motions, motion_of)


def _motions_of(rows: Rows, shaking: Mapping[Place, Floats]) -> tuple[list[GroundMotion], Ints]:
    """Ground motions that differ, each of them checked, and which one each row has."""
    numbers = list(shaking.values())
    if rows.motion_of is not None:
        numbers = [rows.motion_of.astype(float), *numbers]
    first, motion_of = distinct(numbers, rows.count)
    motions: list[GroundMotion] = []
    for i in first.tolist():
        own = rows.scene.motion
        if rows.motion_of is not None:
            own = rows.motions[rows.motion_of[i]]
        try:
            motion = motion_with(own, {place: column[i] for place, column in shaking.items()})
            problems = [str(problem) for problem in motion_problems(motion)]
            if motions and np.isfinite(motion.end) != np.isfinite(motions[0].end):
                problems.append("excitation: found a motion without end among others that end")
            if problems:
                raise InputError(problems)
        except InputError as error:
            raise _in_variant(i, rows.numbers, error) from None
        motions.append(motion)
    return motions, motion_of


def _task(case: Case, wanted: WantedRuns, length: float) -> Task:
    energy = needs_energy(wanted.quantities) or None
    case = replace(case, run=case.run.lasting(length))
    run, options = options_of(case, energy=energy)
    options = replace(options, name=wanted.solver, rtol=wanted.rtol)
    return task_with(case.scene, run, options, None)


def _in_variant(i: int, values: Mapping[str, Floats], error: InputError) -> InputError:
    """The same error, saying in which row."""
    if not values:
        return error
    shown = [f"{key} = {float(column[i])!r}" for key, column in values.items()]
    return InputError([f"variant {i} ({', '.join(shown)}): {line}" for line in error.problems])
