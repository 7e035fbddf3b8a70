"""Cost of a row of N bodies: ``python -m tests.benchmarks.rows [--bodies N ...] [--record]``.

Bilinear oscillators of the frequencies omega_i = 3 + 2 sin(i) times that of a
cosine pulse stand side by side with small gaps between them and a barrier at the
right end, which the pulse drives them against; so there are as many contacts as
bodies. With ``--record`` they yield under El Centro 1940, in SI, their periods 0.3 to 1 s.

Every number of bodies runs in a process of its own: processor time, counts of work, and the most
memory that the process took. Steps end at impacts, so it is the cost of a step that should grow
like N: an exponent of one.
"""

import argparse
import math
import resource
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from multiprocessing import get_context

import numpy as np

from eventpound.motion.pulses import Cosine
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from tests.benchmarks.problem import case_problem

PERIOD = 2.0 * math.pi
"""T_p (s); with a_p = 1 the scales L_e and omega_g are one."""
STRENGTH, YIELD, GAP, RESTITUTION = 0.2, 0.05, 0.05, 0.6
SHAKEN_YIELD, SHAKEN_GAP = 0.005, 0.02
"""Of the row under a record (m)."""
KIB, MIB = 1024, 1024.0**2


@dataclass(frozen=True)
class Cost:
    """What a row of bodies cost.

    Parameters
    ----------
    bodies, impacts : int
        Bodies, and impacts in the run.
    rhs, steps, restarts : int
        Counts of work.
    seconds : float
        Processor time (s).
    resident : float
        Most memory of the process (MiB).
    """

    bodies: int
    impacts: int
    rhs: int
    steps: int
    restarts: int
    seconds: float
    resident: float

    @property
    def milliseconds_a_step(self) -> float:
        """Processor time of one accepted step, events and restarts included (ms)."""
        return 1e3 * self.seconds / self.steps


def row(count: int) -> Scene:
    """A row of `count` bilinear oscillators against a barrier on its right."""
    names = [f"body{i}" for i in range(count)]
    laws = [BoucWen((3.0 + 2.0 * math.sin(i)) ** 2, STRENGTH, YIELD) for i in range(1, count + 1)]
    return Scene(
        tuple(Body(name, 1.0) for name in names),
        tuple(
            Spring(f"spring{i}", (GROUND, name), law)
            for i, (name, law) in enumerate(zip(names, laws, strict=True))
        ),
        (),
        tuple(
            Contact(f"contact{i}", left, right, GAP, RESTITUTION)
            for i, (left, right) in enumerate(pairwise([*names, BARRIER]))
        ),
        Cosine(1.0, PERIOD, reverse=True),
    )


def shaken(count: int) -> Scene:
    """As `row`, under a record, the frequencies 2 + sin(i) Hz."""
    still = row(count)
    springs = []
    for i, spring in enumerate(still.springs):
        k = (2.0 * math.pi * (2.0 + math.sin(i))) ** 2
        springs.append(replace(spring, law=BoucWen(0.1 * k, 0.9 * k * SHAKEN_YIELD, SHAKEN_YIELD)))
    contacts = tuple(replace(contact, gap=SHAKEN_GAP) for contact in still.contacts)
    motion = case_problem("bridge-el-centro").task.scene.motion
    return replace(still, springs=tuple(springs), contacts=contacts, motion=motion)


def measure(count: int, end: float, rtol: float, solver: str, record: bool) -> Cost:
    """Run a row of `count` bodies to `end` (s), after another one; the best of three."""
    task = Task(shaken(count) if record else row(count), 0.0, end, rtol)
    solver_named(solver).solve(replace(task, scene=(shaken if record else row)(min(count, 2))))
    seconds = math.inf
    for _ in range(3):
        began = time.process_time()
        recording = solver_named(solver).solve(task)
        seconds = min(seconds, time.process_time() - began)
    # Linux counts in KiB.
    resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KIB / MIB
    work = recording.work
    impacts = sum(event.count for event in recording.events if event.kind is EventKind.IMPACT)
    return Cost(count, impacts, work.rhs, work.steps, work.restarts, seconds, resident)


def slope(costs: Sequence[Cost], of: Callable[[Cost], float]) -> float:
    """Exponent p of a fit c N^p by least squares."""
    n = np.log([cost.bodies for cost in costs])
    return float(np.polyfit(n, np.log([of(cost) for cost in costs]), 1)[0])


def table(costs: Sequence[Cost]) -> str:
    """Costs as a table in Markdown, and the exponents fitted to them."""
    heads = ("N", "impacts", "rhs", "steps", "restarts", "s", "ms a step", "resident MiB")
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    for cost in costs:
        lines.append(
            f"| {cost.bodies} | {cost.impacts} | {cost.rhs} | {cost.steps} | {cost.restarts} | "
            f"{cost.seconds:.3g} | {cost.milliseconds_a_step:.3g} | {cost.resident:.0f} |"
        )
    quantities: tuple[tuple[str, Callable[[Cost], float]], ...] = (
        ("time of the run", lambda cost: cost.seconds),
        ("time of a step", lambda cost: cost.milliseconds_a_step),
    )
    for name, of in quantities if len(costs) > 1 else ():
        local = [f"{a.bodies}-{b.bodies}: {slope([a, b], of):.2f}" for a, b in pairwise(costs)]
        lines.append(f"\n{name}: exponent {slope(costs, of):.2f} ({', '.join(local)})")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.rows")
    parser.add_argument("--bodies", nargs="+", type=int, default=[1, 10, 100, 1000])
    parser.add_argument("--end", type=float, default=0.8, help="length of the run (s)")
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--solver", default="cvode")
    parser.add_argument("--record", action="store_true", help="under El Centro 1940")
    options = parser.parse_args(arguments)
    costs = []
    with ProcessPoolExecutor(1, get_context("spawn"), max_tasks_per_child=1) as pool:
        for count in options.bodies:
            print(f"N = {count}", file=sys.stderr, flush=True)
            run = (count, options.end, options.rtol, options.solver, options.record)
            costs.append(pool.submit(measure, *run).result())
    print(table(costs))


if __name__ == "__main__":
    main()
