"""One call from a scene or a case to its response."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from eventpound.basics.told import Reached
from eventpound.case.case import Case, case_of
from eventpound.case.run_options import RunOptions, Stated, with_given
from eventpound.case.solver_options import LARGEST_RTOL as LARGEST_RTOL
from eventpound.case.solver_options import SMALLEST_RTOL as SMALLEST_RTOL
from eventpound.case.solver_options import (
    SolverOptions,
    rtol_problems,
    settings_in_si,
    solver_given,
)
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.quantities.lookup import asked, needs_energy
from eventpound.response import Response
from eventpound.scene.check import check_scene
from eventpound.scene.contact_law import NEWTON
from eventpound.scene.parameters import Place, with_values
from eventpound.scene.scene import Scene
from eventpound.solvers import (
    available,
    knows_laws,
    knows_springs,
    lists_springs,
    name_of,
    solver_named,
    takes_friction,
    takes_loads,
    takes_points,
    unknown_springs,
)
from eventpound.solvers.base import ReadyTask, Recording, Solver, Task


def response_of(
    case: Case | Scene,
    solver: str | Solver | None = None,
    rtol: float | str | None = None,
    *,
    settings: Mapping[str, object] | None = None,
    progress: Reached | None = None,
    max_steps: int | None = None,
    **given: object,
) -> Response:
    """`eventpound.simulate` without an estimate of the errors; `given` are keys of ``[run]``."""
    check_case(case)
    run, options = options_of(case, **given)
    ready = made_ready(case, run, options, solver, rtol, settings, progress, max_steps)
    return ready.run({}, ready.task)


def made_ready(
    case: Case | Scene,
    run_options: RunOptions,
    options: SolverOptions,
    solver: str | Solver | None,
    rtol: float | str | None,
    settings: Mapping[str, object] | None,
    progress: Reached | None = None,
    max_steps: int | None = None,
) -> ReadyScene:
    """A checked scene with its options of a run (`options_of`) and of `simulate`."""
    options = solver_given(options, None if solver is None else name_of(solver), rtol)
    if settings is not None:
        if isinstance(solver, str) and ":" in solver:
            raise InputError(f"settings: found beside solver = {solver!r}; accepted: one of them")
        options = replace(options, settings=settings_in_si(settings))
    scene = case_of(case).scene
    task = task_with(scene, run_options, options, progress)
    asked([(scene, run_options.stated)])
    if max_steps is not None:
        task = replace(task, max_steps=_accepted_steps(max_steps, options.name))
    return ReadyScene(
        solver_named(options.name), task, run_options.stated, run_options.in_equilibrium
    )


class ReadyScene:
    """A task whose scene may be given other numbers, run after run.

    Parameters
    ----------
    solver : Solver
        What runs it.
    task : Task
        The run of the scene as it is, checked.
    stated : Stated
        Of the responses.
    in_equilibrium : bool
        Whether the scene was put where its forces hold it.
    """

    def __init__(
        self, solver: Solver, task: Task, stated: Stated, in_equilibrium: bool = False
    ) -> None:
        make: Callable[[Task], ReadyTask | None] | None = getattr(solver, "ready", None)
        self._ready = None if make is None else make(task)
        self.solver, self.task = solver, task
        self._said: dict[str, Any] = {"stated": stated, "in_equilibrium": in_equilibrium}

    def run(self, values: Mapping[Place, float], task: Task) -> Response:
        """Run it.

        Parameters
        ----------
        values : mapping
            Numbers instead of those of the scene (SI), checked; none of the motion.
        task : Task
            The task with times and the motion of this run.

        Raises
        ------
        ComputationError
            Where it fails.
        """
        name, whole = self.solver.name, partial(_with_values, task, values)
        if self._ready is None:
            task = whole()
            return Response(task, name, solved(self.solver, task), **self._said)
        # Both are made when they are asked for.
        asked: Any = whole if values else task
        recording: Any = self._ready.run(values, task)
        return Response(asked, name, recording, **self._said)


def _with_values(task: Task, values: Mapping[Place, float]) -> Task:
    return replace(task, scene=with_values(task.scene, values))


def solved(solver: Solver, task: Task) -> Recording:
    """What a solver makes of a task.

    Raises
    ------
    InputError
        Where it cannot take the task; a setting that it misses is named.
    ComputationError
        Where it fails.
    """
    try:
        return solver.solve(task)
    except KeyError as error:
        (key,) = error.args or (None,)
        if key not in solver.settings or key in task.settings:
            raise
        raise InputError(
            f"[solver]: {key}: missing, and the solver {solver.name!r} has no default for it; "
            f"accepted: {solver.settings[key]}"
        ) from error


def _accepted_steps(max_steps: int, solver: str) -> int:
    """A limit of steps that a solver heeds."""
    if max_steps < 1:
        raise InputError(f"max_steps = {max_steps}; accepted: a whole number from 1")
    if not getattr(solver_named(solver), "counts_steps", False):
        raise InputError(
            f"max_steps: the solver {solver!r} does not count its steps; a time limit bounds it"
        )
    return max_steps


def task_of(case: Case, rtol: float | None = None) -> Task:
    """The task a case sets, with its own tolerance or another."""
    options = replace(case.solver, rtol=rtol or case.solver.rtol)
    return task_with(case.scene, case.run, options, None)


def check_case(case: Case | Scene) -> None:
    """Refuse a scene that cannot be computed, also of a case that was changed since it was read."""
    case = case_of(case)
    check_scene(case.scene, case.run.start_time)


def options_of(case: Case | Scene, **given: object) -> tuple[RunOptions, SolverOptions]:
    """Options of a checked case, or defaults for a scene, with what a call gives instead."""
    case = case_of(case)
    case.refuse_suite()
    return with_given(case.run, given, case.scene), case.solver


_AT_LEAST = 1.0
"""Length of a run whose motion sets it (s): none is shorter."""


def check_solver(
    options: SolverOptions, scene: Scene | None = None, run_options: RunOptions | None = None
) -> None:
    """Refuse a solver, a setting or a tolerance that there is not, or cannot serve a scene.

    A solver that can tell wrong values of its settings before it runs has a function
    ``check_settings(settings)``, one that can tell what else of a scene or of its run it cannot
    take ``check_task(task)``. Both raise an InputError.

    Parameters
    ----------
    options : SolverOptions
        What a case, the command line or a call asks for.
    scene : Scene, optional
        What it is to carry.
    run_options : RunOptions, optional
        How: for how long, and whether it is to tell the events of its springs, too.

    Raises
    ------
    InputError
        With one line for every problem.
    """
    problems: list[str] = []
    try:
        solver = solver_named(options.name)
        problems += _setting_problems(solver, options.settings)
        if scene is not None:
            problems += _scene_problems(
                solver, scene, bool(run_options and run_options.stated.events)
            )
            start = run_options.start_time if run_options else 0.0
            length = (
                run_options.duration
                if run_options and run_options.duration < math.inf
                else _AT_LEAST
            )
            task = Task(scene, start, start + length, options.rtol, settings=options.settings)
            problems = problems or _own_problems(solver, "check_task", task)
    except InputError as error:
        problems += [f"[solver]: {problem}" for problem in error.problems]
    problems += [f"[solver]: {problem}" for problem in rtol_problems(options.rtol)]
    if problems:
        raise InputError(problems)


def _setting_problems(solver: Solver, settings: Mapping[str, object]) -> list[str]:
    """Settings that a solver does not have, else what is wrong with their values."""
    known = list(solver.settings)
    problems = [
        f"[solver]: {key} is not a setting of {solver.name}"
        + (suggestion(key, known) or f"; accepted: {', '.join(known) or 'none'}")
        for key in settings
        if key not in known
    ]
    return problems or _own_problems(solver, "check_settings", settings)


def _own_problems(solver: Solver, check: str, of: object) -> list[str]:
    """What a solver refuses by a function of its own, where it has that."""
    try:
        getattr(solver, check, lambda of: None)(of)
    except InputError as error:
        return list(error.problems)
    return []


def _scene_problems(solver: Solver, scene: Scene, events: bool) -> list[str]:
    """What of a scene a solver cannot take, with the solvers that take all of it."""
    wanted = [knows_laws, knows_springs, takes_points, takes_friction, takes_loads]
    if events:
        wanted.append(lists_springs)
    if all(can(solver, scene) for can in wanted):
        return []
    laws = ", ".join(f"{c.name!r} ({c.law.kind})" for c in scene.contacts if c.law is not None)
    unknown = unknown_springs(solver, scene).items()
    springs = ", ".join(f"{spring!r} ({law})" for spring, law in unknown)
    points = ", ".join(scene.at_points)
    rubbing = ", ".join(map(repr, scene.rubbing))
    law = "" if scene.impact_law == NEWTON else f" by {scene.impact_law}'s law"
    kinds = (
        ("supports", scene.supports),
        ("forces", scene.forces),
        ("decks in plan", scene.in_plan),
    )
    loads = " and ".join(word for word, given in kinds if given)
    name = solver.name
    problems = {
        knows_laws: f"{name} does not know the laws of contacts {laws}",
        knows_springs: f"{name} does not know the laws of springs {springs}",
        takes_points: f"{name} does not take ends at a point between bodies ({points})",
        takes_friction: f"{name} does not take contacts with friction{law} ({rubbing})",
        takes_loads: f"name: the solver {name!r} cannot take {loads}",
        lists_springs: f"{name} does not list events of springs",
    }
    able = (key for key, other in available().items() if all(can(other, scene) for can in wanted))
    accepted = ", ".join(able)
    return [
        f"[solver]: {problems[can]}; accepted: {accepted}"
        for can in wanted
        if not can(solver, scene)
    ]


def task_with(
    scene: Scene, run_options: RunOptions, options: SolverOptions, progress: Reached | None
) -> Task:
    """The task of a scene with these options, which are checked."""
    check_solver(options, scene, run_options)
    return Task(
        scene,
        run_options.start_time,
        run_options.start_time + run_options.duration,
        options.rtol,
        options.atol,
        run_options.output_times,
        run_options.energy or needs_energy(run_options.stated.quantities),
        options.settings,
        progress,
    )
