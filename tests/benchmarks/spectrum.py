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

from eventpound import simulate, simulate_many
from eventpound.scene.parameters import places_of, with_values
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


def seconds(call: Callable[[], object]) -> float:
    """Wall time of a call (s)."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.spectrum")
    parser.add_argument("--variants", type=int, default=10_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args(arguments)
    task = yardsticks.load()["P1"].task
    strengths = np.linspace(WEAKEST, STRONGEST, options.variants)

    def spectrum(workers: int) -> None:
        many = simulate_many(
            task.scene, {KEY: strengths}, rtol=RTOL, duration=task.end, workers=workers
        )
        assert many.success.all()

    def one_by_one() -> None:
        place = places_of(task.scene)[KEY]
        for strength in strengths[:: max(1, options.variants // 100)]:
            scene = with_values(task.scene, {place: strength})
            simulate(scene, "fast", RTOL, duration=task.end)

    spectrum(1)
    arithmetic(1)
    calls = {"spectrum": spectrum, "arithmetic": spin}
    times: dict[str, list[float]] = {f"{name} {w}": [] for name in calls for w in (1, 2)}
    for _ in range(options.repeats):
        for workers in (1, 2):
            for name, call in calls.items():
                times[f"{name} {workers}"].append(seconds(partial(call, workers)))
    alone = seconds(one_by_one) / len(strengths[:: max(1, options.variants // 100)])
    print(
        f"{options.variants} variants of P1, rtol {RTOL:g}; smallest and median of "
        f"{options.repeats}; one by one {1e6 * alone:.0f} µs each\n"
    )
    print("| | 1 worker (s) | 2 workers (s) | gain of the smallest | of the medians |")
    print("| --- | --- | --- | --- | --- |")
    for name in calls:
        one, two = times[f"{name} 1"], times[f"{name} 2"]
        print(
            f"| {name} | {min(one):.3f}, {np.median(one):.3f} | {min(two):.3f}, "
            f"{np.median(two):.3f} | {min(one) / min(two):.2f} | "
            f"{np.median(one) / np.median(two):.2f} |"
        )


if __name__ == "__main__":
    main()
