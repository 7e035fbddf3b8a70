"""Orders of convergence of every solver, measured; prints the table of docs/steppers.md.

``python -m tests.benchmarks.orders [--solvers NAME ...]``

Three problems: one without contact, one with a single impact, one whose contact closes
plastically, rests and opens again. For the fixed-step methods the order is the slope of
log error over log step, the error the root mean square over `PHASES` steps of nearly the
same length (where an impact falls within its step decides over a single run), by the
final state. A contact element converges to a motion of its own, by itself at a sixteenth
of the smallest step; the true one is for docs/steppers.md's other table. For solvers
with a tolerance it is the slope of log error over log rtol.
"""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.contact_law import Element
from eventpound.solvers import available, solver_named
from eventpound.solvers.base import Task
from tests.solvers.scenes import with_springs

PHASES = 8
STEPS = (250, 500, 1000, 2000, 4000)
FINER = 16
"""How much finer than the last of `STEPS` an element's own limit is computed."""
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
STIFFNESS, HERTZ_STIFFNESS = 2e3, 1e4
"""Of the contact elements (N/m, N/m^1.5): a contact lasts 35 of the longest steps and more."""


@dataclass(frozen=True)
class Problem:
    """A scene and the end of its run (s)."""

    name: str
    scene: Scene
    end: float


@dataclass(frozen=True)
class Method:
    """A fixed-step method; with an element, contacts are that and it has a limit of its own."""

    label: str
    solver: str
    settings: Mapping[str, object]
    element: Element | None = None


def problems() -> tuple[Problem, ...]:
    """Smooth, one impact, a resting contact."""
    body, spring = Body("m", 1.0), Spring("k", (GROUND, "m"), Linear(4.0))
    yielding = Spring("k", (GROUND, "m"), BoucWen(2.0, 1.5, 0.15, 2.0))
    dashpot = Dashpot((GROUND, "m"), 0.2)
    return (
        Problem("smooth", Scene((body,), (yielding,), (dashpot,), (), Sine(3.0, 2.0)), 5.0),
        Problem(
            "one impact",
            Scene(
                (Body("m", 1.0, 0.0, 1.0),), (spring,), (), (Contact("c", "m", BARRIER, 0.3, 0.6),)
            ),
            1.5,
        ),
        Problem(
            "rest",
            Scene((body,), (spring,), (), (Contact("c", BARRIER, "m", 0.1, 0.0),), Sine(3.0, 4.0)),
            3.5,
        ),
    )


def methods() -> tuple[Method, ...]:
    """Every fixed-step method."""
    rules = tuple(
        Method(f"moreau, θ = {theta}", "moreau", {"theta": theta}) for theta in (0.5, 1.0)
    )
    elements = tuple(
        Method(f"penalty, {element.word}", "penalty", {}, element) for element in Element
    )
    return rules + elements


def final_state(
    problem: Problem,
    solver: str,
    rtol: float,
    settings: Mapping[str, object],
    element: Element | None = None,
) -> np.ndarray:
    """Final displacements and velocities, each in units of its largest size in the run."""
    scene = problem.scene
    if element is not None:
        stiffness = HERTZ_STIFFNESS if element.hertzian else STIFFNESS
        scene = with_springs(scene, element, stiffness)
    task = Task(scene, 0.0, problem.end, rtol, settings=settings)
    recording = solver_named(solver).solve(task)
    length, speed = _scales(problem)
    return np.concatenate((recording.u / length, recording.v / speed))


@cache
def _scales(problem: Problem) -> tuple[float, float]:
    times = np.linspace(0.0, problem.end, 201)
    history = solver_named("fast").solve(
        Task(problem.scene, 0.0, problem.end, 1e-9, output_times=times)
    )
    return float(np.abs(history.history.u).max()), float(np.abs(history.history.v).max())


def _with_steps(problem: Problem, method: Method, steps: float) -> np.ndarray:
    settings = {**method.settings, "time_step": problem.end / steps}
    return final_state(problem, method.solver, 1e-9, settings, method.element)


def applies(problem: Problem, method: Method) -> bool:
    """Whether a method can be run on a problem: Jankowski's formula has no ε = 0."""
    plastic = any(contact.restitution == 0.0 for contact in problem.scene.contacts)
    return not (plastic and method.element is Element.JANKOWSKI)


def errors_by_step(problem: Problem, method: Method, steps: tuple[int, ...]) -> np.ndarray:
    """Root mean square errors for some numbers of steps."""
    if method.element is not None:
        true = _with_steps(problem, method, FINER * steps[-1])
    else:
        true = final_state(problem, "fast", 1e-13, {})
    result = []
    for count in steps:
        phases = [
            _with_steps(problem, method, count * (1.0 + 0.2 * i / PHASES)) - true
            for i in range(PHASES)
        ]
        result.append(float(np.sqrt(np.mean(np.square(phases)))))
    return np.array(result)


def order(sizes: tuple[float, ...], errors: np.ndarray) -> float:
    """Slope of log error over log size, by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def errors_by_tolerance(problem: Problem, solver: str) -> np.ndarray:
    """Errors of a solver that has a tolerance, for `TOLERANCES`, by `fast` at 1e-13."""
    true = final_state(problem, "fast", 1e-13, {})
    return np.array(
        [
            float(np.sqrt(np.mean((final_state(problem, solver, rtol, {}) - true) ** 2)))
            for rtol in TOLERANCES
        ]
    )


Measure = Callable[[Problem], str]


def _cell(sizes: tuple[float, ...], errors: np.ndarray) -> str:
    if not errors.all():
        return "exact"
    slope = abs(order(sizes, errors))
    return f"{slope:.2f} ({errors[0]:.0e} … {errors[-1]:.0e})"


def _table(title: str, rows: Mapping[str, Measure]) -> None:
    print(f"{title}\n")
    print("| method | " + " | ".join(p.name for p in problems()) + " |")
    print("| --- |" + " --- |" * len(problems()))
    for label, measure in rows.items():
        print(f"| {label} | " + " | ".join(map(measure, problems())) + " |", flush=True)
    print()


def _by_step(method: Method) -> Measure:
    def measure(problem: Problem) -> str:
        if not applies(problem, method):
            return "–"
        errors = errors_by_step(problem, method, STEPS)
        return _cell(STEPS, errors)

    return measure


def _by_tolerance(solver: str) -> Measure:
    def measure(problem: Problem) -> str:
        errors = errors_by_tolerance(problem, solver)
        return _cell(TOLERANCES, errors)

    return measure


def main(arguments: list[str] | None = None) -> None:
    """Print the orders of all methods on all problems."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--solvers", nargs="*", help="only these (default: all)")
    wanted = parser.parse_args(arguments).solvers
    stepping = [m for m in methods() if not wanted or m.solver in wanted]
    if stepping:
        _table(
            f"order in the step (error at {STEPS[0]} … {STEPS[-1]} steps)",
            {method.label: _by_step(method) for method in stepping},
        )
    fixed = {method.solver for method in methods()}
    adaptive = [s for s in available() if s not in fixed and (not wanted or s in wanted)]
    if adaptive:
        _table(
            f"exponent of rtol (error at rtol {TOLERANCES[0]:g} … {TOLERANCES[-1]:g})",
            {solver: _by_tolerance(solver) for solver in adaptive},
        )


if __name__ == "__main__":
    main()
