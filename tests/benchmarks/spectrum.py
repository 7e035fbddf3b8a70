"""A spectrum in one call: ``python -m tests.benchmarks.spectrum [--variants 10000] [--repeats 5]``.

The strength Q of problem P1 (`tests.benchmarks.yardsticks`) runs from 0.05 to 2 at
rtol 1e-6. Warm wall times with one and with two workers stand next to what two
threads gain on a loop of plain arithmetic that holds neither the interpreter's lock
nor any memory, taken in turns with them: a machine that others use, or whose cores
share their units, gives no more to anyone.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
from numba import njit

from eventpound import simulate_many
from eventpound.scene.parameters import places_of, with_values
from eventpound.simulation import simulate
from tests.benchmarks import yardsticks

KEY = "spring.spring0.strength"
WEAKEST, STRONGEST = 0.05, 2.0
RTOL = 1e-6
ROUNDS = 100_000_000
"""Passes of the loop of plain arithmetic, some 0.3 s."""


@njit(nogil=True, cache=True)
def arithmetic(rounds: int) -> float:
    """A logistic map: each pass waits for the one before."""
    x = 0.3
    for _ in range(rounds):
        x = 3.9 * x * (1.0 - x)
    return x


def spin(workers: int) -> None:
    """The passes of `arithmetic`, shared out to threads."""
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(arithmetic, [ROUNDS // workers] * workers))


def cost(call: Callable[[], object]) -> tuple[float, float]:
    """Wall time and processor time of a call (s)."""
    began, used = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - began, time.process_time() - used


def table(costs: dict[tuple[str, int], list[tuple[float, float]]]) -> str:
    """Costs by name and number of workers as a table in Markdown."""
    lines = [
        "| | workers | wall, smallest (s) | median | processor | gain, smallest | medians |",
        "|" + " --- |" * 7,
    ]
    for (name, workers), found in costs.items():
        wall, used = np.array(found).T
        one = np.array(costs[name, 1])[:, 0]
        lines.append(
            f"| {name} | {workers} | {wall.min():.3f} | {np.median(wall):.3f} | "
            f"{np.median(used):.3f} | {one.min() / wall.min():.2f} | "
            f"{np.median(one) / np.median(wall):.2f} |"
        )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.spectrum")
    parser.add_argument("--variants", type=int, default=10_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args(arguments)
    task = yardsticks.load()["P1"].task
    strengths = np.linspace(WEAKEST, STRONGEST, options.variants)
    some = strengths[:: max(1, options.variants // 100)]

    def spectrum(workers: int) -> None:
        many = simulate_many(
            task.scene, {KEY: strengths}, rtol=RTOL, duration=task.end, workers=workers
        )
        assert many.success.all()

    def one_by_one() -> None:
        place = places_of(task.scene)[KEY]
        for strength in some:
            scene = with_values(task.scene, {place: strength})
            simulate(scene, "fast", RTOL, duration=task.end)

    spectrum(1)
    one_by_one()
    arithmetic(1)
    calls = {"spectrum": spectrum, "arithmetic": spin}
    costs: dict[tuple[str, int], list[tuple[float, float]]]
    costs = {(name, workers): [] for name in calls for workers in (1, 2)}
    for _ in range(options.repeats):
        for (name, workers), found in costs.items():
            found.append(cost(partial(calls[name], workers)))
    alone = cost(one_by_one)[0] / some.size
    print(
        f"{options.variants} variants of P1, rtol {RTOL:g}; {options.repeats} repeats; "
        f"one by one {1e6 * alone:.0f} µs each\n"
    )
    print(table(costs))


if __name__ == "__main__":
    main()
