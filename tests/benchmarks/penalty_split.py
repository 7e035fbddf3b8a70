"""What the error of a contact element is made of; prints the tables of docs/measured/steppers.md.

``python -m tests.benchmarks.penalty_split [--problems NAME ...]``

With y(h, k) the final state and the peaks of a run with step h and stiffness k, y* the true
ones for the ε of the case, and y*(e) for the ε that the element really gives an isolated
impact (tests/solvers/steppers/restitution.py):

    y(h, k) - y* = [y(h, k) - y(0, k)]        vanishes with the step
                 + [y(0, k) - y(0, ∞)]        vanishes with the stiffness
                 + [y(0, ∞) - y*(e)]          never: impacts that are not isolated
                 + [y*(e) - y*]               never: the formula that turns ε into damping

h and k are the defaults of the solver. y(0, k) is a run with `FINE` steps in a period
of the contact; y(0, ∞) is extrapolated from two stiffnesses `STIFFER` apart, the time in
contact and with it the error going as k^(-1/2), for Hertz contacts as k^(-2/5). y* is
`fast` at rtol 1e-12. Errors are root mean squares of all entries, in units of the largest
displacement and the largest speed of the true motion.
"""

import argparse
import math
from dataclasses import dataclass, replace

import numpy as np

from eventpound.mechanics.contact_elements import effective_masses
from eventpound.mechanics.model import assemble
from eventpound.scene import Body, Contact, Scene
from eventpound.scene.contact_law import Element
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.penalty.elements import contact_stiffness
from tests.benchmarks.orders import problems as order_problems
from tests.solvers.scenes import pounding_pair, with_springs
from tests.solvers.steppers.restitution import real_restitution

FINE = 6400
STIFFER = (64.0, 1024.0)
"""Multiples of the stiffness of the case, from which y(0, ∞) is extrapolated."""


@dataclass(frozen=True)
class Case:
    """A scene and the end of its run (s)."""

    scene: Scene
    end: float


@dataclass(frozen=True)
class Parts:
    """Parts of an error and the whole."""

    total: float
    step: float
    stiffness: float
    not_isolated: float
    formula: float


def cases() -> dict[str, Case]:
    """One impact of an oscillator; a body into a touching pair; two decks between barriers."""
    one = order_problems()[1]
    bodies = (Body("a", 1.0, 0.0, 1.0), Body("b", 1.0), Body("c", 1.0))
    contacts = (Contact("ab", "a", "b", 0.1, 0.6), Contact("bc", "b", "c", 0.0, 0.6))
    return {
        "one impact": Case(one.scene, one.end),
        "chain": Case(Scene(bodies, (), (), contacts), 1.0),
        "pair": Case(pounding_pair(), 3.0),
    }


@dataclass(frozen=True)
class Scale:
    """Largest displacement (m) and speed (m/s) of a motion."""

    length: float
    speed: float


def _scale(case: Case) -> Scale:
    times = np.linspace(0.0, case.end, 1001)
    history = (
        solver_named("fast")
        .solve(Task(case.scene, 0.0, case.end, 1e-9, output_times=times))
        .history
    )
    return Scale(float(np.abs(history.u).max()), float(np.abs(history.v).max()))


def _run(case: Case, scale: Scale, solver: str, **settings: object) -> np.ndarray:
    """Final displacements and velocities, largest and smallest displacements, scaled."""
    task = Task(case.scene, 0.0, case.end, 1e-12, settings=settings)
    recording = solver_named(solver).solve(task)
    peaks = recording.displacement
    lengths = np.concatenate((recording.u, peaks.maximum, peaks.minimum)) / scale.length
    return np.concatenate((lengths, recording.v / scale.speed))


def _distance(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.sqrt(np.mean((one - other) ** 2)))


def _with_restitution(case: Case, element: Element) -> Case:
    """The case with the ε that the element really gives."""
    contacts = tuple(
        replace(c, restitution=min(1.0, real_restitution(element, c.restitution)))
        for c in case.scene.contacts
    )
    return replace(case, scene=replace(case.scene, contacts=contacts))


def split(case: Case, element: Element) -> Parts:
    """The parts of the error of an element with the default step and stiffness."""
    model = assemble(case.scene)
    scales = scene_scales(case.scene, model, case.end)
    k = contact_stiffness(Task(case.scene, 0.0, case.end, 1e-9), model, scales)
    if element.hertzian:  # so stiff that it stores as much at the depth of the scene's speed
        mass = float(effective_masses(model.mass, model.left, model.right).max())
        k *= 1.25 / math.sqrt(scales.speed * math.sqrt(mass / k))
    scale = _scale(case)

    def sprung(stiffness: float, **settings: object) -> np.ndarray:
        scene = with_springs(case.scene, element, stiffness)
        return _run(replace(case, scene=scene), scale, "penalty", **settings)

    def limit(stiffness: float) -> np.ndarray:
        return sprung(stiffness, steps_per_period=FINE)

    true = _run(case, scale, "fast")
    real = _run(_with_restitution(case, element), scale, "fast")
    coarse = sprung(k)
    fine = limit(k)
    softer, stiffer = (limit(k * factor) for factor in STIFFER)
    ratio = (STIFFER[1] / STIFFER[0]) ** (0.4 if element.hertzian else 0.5)
    rigid = stiffer + (stiffer - softer) / (ratio - 1.0)
    return Parts(
        _distance(coarse, true),
        _distance(coarse, fine),
        _distance(fine, rigid),
        _distance(rigid, real),
        _distance(real, true),
    )


RESTITUTIONS = (0.1, 0.3, 0.5, 0.65, 0.8, 0.95)


def _print_restitutions() -> None:
    print("| element | " + " | ".join(f"ε = {eps:g}" for eps in RESTITUTIONS) + " |")
    print("| --- |" + " --- |" * len(RESTITUTIONS))
    for element in Element:
        row = " | ".join(f"{real_restitution(element, eps):.3f}" for eps in RESTITUTIONS)
        print(f"| {element.word} | {row} |")


def main(arguments: list[str] | None = None) -> None:
    """Print the parts for every element and problem, and the restitution of each element."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problems", nargs="*", choices=tuple(cases()), default=tuple(cases()))
    wanted = parser.parse_args(arguments).problems
    print("| problem | element | whole | step | stiffness | not isolated | formula |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in wanted:
        for element in Element:
            parts = split(cases()[name], element)
            cells = (parts.total, parts.step, parts.stiffness, parts.not_isolated, parts.formula)
            row = " | ".join(f"{cell:.1e}" for cell in cells)
            print(f"| {name} | {element.word} | {row} |", flush=True)
    print()
    _print_restitutions()


if __name__ == "__main__":
    main()
