"""What a contact law costs in error and time against the rigid law, by its stiffness.

``python -m tests.benchmarks.contact_laws``

The pair of `cases/pair` with each law in the place of Newton's, at multiples of the stiffness of
its stiffest spring, on `cvode`. A Hertz stiffness stores the same energy in an impact at the
scene's speed. Times are of the processor, the shortest of a few.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from eventpound import Contact, ContactLaw, load_case
from eventpound.scene.contact_law import BY_WORD, Element
from eventpound.simulation import task_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from tests.models import CASES

CASE = CASES / "pair"
MULTIPLES = (1e1, 1e3, 1e5)
RTOL = 1e-9
REPEATS = 5


def with_law(task: Task, element: Element, multiple: float) -> Task:
    """The task with this law at its contacts."""
    scene = task.scene
    stiffest = max(
        spring.law.stiffness + spring.law.strength / spring.law.yield_displacement
        for spring in scene.springs
    )
    masses = {body.name: body.mass for body in scene.bodies}
    ends = (scene.contacts[0].left, scene.contacts[0].right)
    k, mass = multiple * stiffest, 1.0 / sum(1.0 / masses[e] for e in ends if e in masses)
    if element.hertzian:
        # As deep as the spring k at the speed L/T: k d²/2 = (2/5) k_h d^2.5.
        scales = scene.motion.scales()
        depth = scales.length * scales.omega_g * math.sqrt(mass / k)
        k *= 1.25 / math.sqrt(depth)

    def changed(contact: Contact) -> Contact:
        e = contact.restitution if element.damped else None
        return replace(contact, restitution=e, law=ContactLaw(element.word, k))

    contacts = tuple(map(changed, scene.contacts))
    return replace(task, scene=replace(scene, contacts=contacts))


def measured(task: Task) -> tuple[Recording, float]:
    """A run and its shortest time (s)."""
    best = math.inf
    recording = solver_named("cvode").solve(task)
    for _ in range(REPEATS):
        began = time.process_time()
        recording = solver_named("cvode").solve(task)
        best = min(best, time.process_time() - began)
    return recording, best


def main(report: Callable[[str], None] = print) -> None:
    """Print the table: the pair with each law at each stiffness."""
    task = replace(task_of(load_case(CASE)), rtol=RTOL)
    rigid, seconds = measured(task)
    times = task.output_times
    true = _displacements(rigid, times)
    size = float(np.abs(true).max())
    report(
        "| law | k / stiffest spring | longest contact (ms) | largest force (MN) | "
        "largest error of u (%) | peak of u (%) | impacts | time / rigid |"
    )
    report("| --- | --- | --- | --- | --- | --- | --- | --- |")
    count = sum(e.count for e in rigid.events)
    report(f"| `newton` | | | | | | {count} | 1 |")
    for element in BY_WORD.values():
        for multiple in MULTIPLES:
            found, took = measured(with_law(task, element, multiple))
            u = _displacements(found, times)
            error = 100.0 * float(np.abs(u - true).max()) / size
            peak = 100.0 * abs(float(np.abs(u).max()) / size - 1.0)
            longest = 1e3 * float(found.laws.longest_contact.max())
            force = float(found.max_force.max()) / 1e6
            report(
                f"| `{element.word}` | {multiple:g} | {longest:.3g} | {force:.3g} | "
                f"{error:.2g} | {peak:.2g} | {len(found.events)} | {took / seconds:.2g} |"
            )


def _displacements(recording: Recording, times: np.ndarray) -> np.ndarray:
    """Displacements at the output times, without the second rows of events."""
    t = recording.history.t
    return recording.history.u[np.searchsorted(t, times)]


if __name__ == "__main__":
    main()
