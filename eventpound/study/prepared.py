"""One scene, made ready once and run again and again with other numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eventpound.basics.given import checked
from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions, Way, refuse_options
from eventpound.case.solver_options import SolverOptions
from eventpound.errors import InputError
from eventpound.response import Response
from eventpound.scene.check import motion_problems
from eventpound.scene.parameters import motion_with, number_places
from eventpound.scene.scene import Scene
from eventpound.simulation import ReadyScene, check_case, made_ready, options_of
from eventpound.solvers.base import Solver, Task
from eventpound.study.axes import given_axes
from eventpound.study.base import Base, base_of
from eventpound.study.checked_numbers import CheckedRanges
from eventpound.study.variants import (
    complete,
    kinds_that_set_lengths,
    kinds_that_set_periods,
    rows_with,
    unknown_axes,
)


@checked
def prepare(
    case: Case | Scene,
    solver: str | Solver | None = None,
    rtol: float | str | None = None,
    *,
    duration: float | str | None = None,
    output_step: float | str | None = None,
    energy: bool | None = None,
    settings: Mapping[str, object] | None = None,
) -> Prepared:
    """Make a scene ready to be run again and again with other numbers.

    Parameters
    ----------
    case : Case or Scene
        What moves, with the numbers that a run does not change. A record with
        ``psa_period = "T1"`` is scaled at the period that the numbers of each run make.
    solver : str or Solver, optional
        As of `simulate`.
    rtol : float, optional
        As of `simulate`.
    duration : float, optional
        Length of the runs (s); by default as of `simulate`, of each motion.
    output_step : float, optional
        Distance of the rows of the history (s); without it there are rows at both ends and at
        events only.
    energy : bool, optional
        Keep the energy ledger.
    settings : mapping, optional
        As of `simulate`.

    Returns
    -------
    Prepared
        Whose `run` computes.

    Raises
    ------
    InputError
        Where the scene or an option cannot be run.

    Examples
    --------
    >>> ball = Body("ball", "1 kg", velocity="1 m/s")
    >>> wall = Contact("wall", "ball", "barrier", gap="1 m", restitution=0.5)
    >>> ready = prepare(Scene([ball], contacts=[wall]), "fast", duration="2 s")
    >>> response = ready.run({"contact.wall.gap": "50 cm"})
    >>> round(float(response.peaks.loc["ball", "max"]), 9)
    0.5
    """
    check_case(case)
    run, options = options_of(case, duration=duration, output_step=output_step, energy=energy)
    length = float("nan") if duration is None else run.duration
    step = float("nan") if output_step is None else run.output_step
    ready = made_ready(case, run.lasting(run.duration, step), options, solver, rtol, settings)
    base = base_of(case, (), (), SolverOptions(), length)
    return Prepared(base, ready, replace(run, output_step=step))


class Prepared:
    """A scene that is ready to be run with other numbers; `prepare` makes it.

    It stays what it was when it was prepared.
    """

    def __init__(self, base: Base, ready: ReadyScene, options: RunOptions) -> None:
        self._base, self._ready, self._run = base, ready, options
        self._places = number_places(self.scene)
        self._ranges = CheckedRanges(self.scene, options.start_time)
        lengths = () if base.own_duration else kinds_that_set_lengths(self.scene)
        kinds = {*lengths, *kinds_that_set_periods(self.scene)}
        # Numbers by these keys change nothing but themselves.
        self._simple = {
            key: place
            for key, place in self._places.items()
            if base.case.pi is None and place.kind not in kinds
        }

    @property
    def scene(self) -> Scene:
        """What was prepared."""
        return self._ready.task.scene

    @checked
    def run(self, values: Mapping[str, float | str] | None = None) -> Response:
        """Compute how the scene moves with other numbers.

        The response is, to the last bit, that of `simulate` for a scene with these numbers, but
        without an estimate of its errors.

        Parameters
        ----------
        values : mapping of str to float, optional
            Numbers (SI, or texts with units) by the keys of `simulate_many`, as
            ``"contact.joint.gap"``; the others are those of the scene.

        Returns
        -------
        Response
            Peaks, events and final state.

        Raises
        ------
        InputError
            Where there is no such number, or the scene cannot be computed with it.
        ComputationError
            Where the computation failed; what was computed is in its `recording`.
        """
        numbers, length = self._numbers(values or {})
        placed = {self._places[key]: value for key, value in numbers.items()}
        still = {place: value for place, value in placed.items() if place.kind != "excitation"}
        task = self._ready.task
        if len(still) < len(placed):
            motion = motion_with(task.scene.motion, placed)
            if problems := [str(problem) for problem in motion_problems(motion)]:
                raise InputError(problems)
            task = replace(task, scene=replace(task.scene, motion=motion))
        self._ranges.check(still)
        if length is not None:
            task = self._of_length(task, length)
        return self._ready.run(still, task)

    def _numbers(self, values: Mapping[str, float | str]) -> tuple[dict[str, float], float | None]:
        """Numbers by dotted keys, and the length of the run (s) where it may be another."""
        found: dict[str, float] = {}
        for key, value in values.items():
            if not isinstance(value, float) or key not in self._simple:
                break
            found[key] = float(value)
        else:
            return found, None
        if values and self._base.case.run.in_equilibrium:
            refuse_options(self._base.case.run, Way.MANY, values)
        base = replace(self._base, axes=given_axes("values", {k: [v] for k, v in values.items()}))
        if unknown := [f"values: {key}: {text}" for key, text in unknown_axes(base)]:
            raise InputError(unknown)
        columns = {axis.key: axis.values for axis in base.axes}
        rows = complete(rows_with(base, columns, range(1)))
        assert rows.lengths is not None
        numbers = {key: float(column[0]) for key, column in rows.numbers.items()}
        return numbers, float(rows.lengths[0])

    def _of_length(self, task: Task, length: float) -> Task:
        """The task with another length (s)."""
        if length == task.end - task.start:
            return task
        run = self._run.lasting(length, self._run.output_step)
        return replace(task, end=task.start + length, output_times=run.output_times)
