"""OpenSees with a contact law and ever finer steps, against our solution with that law.

``python -m tests.benchmarks.opensees_laws``, in a Python that has openseespy

Two oscillators and a wall, every contact with the law (`tests.solvers.laws.test_scenes.pair`), for
1.2 s. The error is the largest of a displacement at the end, as a part of the largest of all times.
"""

from collections.abc import Callable

import numpy as np

from eventpound.scene.contact_law import BY_WORD
from eventpound.simulation import response_of
from tests.solvers.laws.test_scenes import pair

END = 1.2
STEPS = (4e-4, 1e-4, 2.5e-5, 6.25e-6)
RTOL = 1e-11


def errors(word: str) -> list[float]:
    """The error at each step."""
    scene = pair(word)
    true = response_of(scene, "cvode", RTOL, duration=END).recording
    x = true.displacement
    size = float(np.max(np.abs((x.maximum, x.minimum))))
    found = []
    for step in STEPS:
        run = response_of(scene, "opensees", settings={"time_step": step}, duration=END)
        found.append(float(np.abs(run.recording.u - true.u).max()) / size)
    return found


def main(report: Callable[[str], None] = print) -> None:
    """Print the table."""
    report("| law | " + " | ".join(f"step {step:g} s" for step in STEPS) + " |")
    report("| --- |" + " --- |" * len(STEPS))
    for word in BY_WORD:
        report(f"| `{word}` | " + " | ".join(f"{e:.1e}" for e in errors(word)) + " |")


if __name__ == "__main__":
    main()
