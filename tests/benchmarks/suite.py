"""What a record of a suite costs: ``python -m tests.benchmarks.suite [FILES]``.

The two-segment bridge (frozen as it was when first measured) under every record that FILES
matches, a pattern or a list as for ``--suite``; without it, the records beside the
checkout. A table of medians and worst cases: reading, scales, the run, and the
run in units of problem P7, scaled by the number of samples. Times are those of
the processor, the least of several.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from eventpound import Case, EventpoundError, Record, load_case
from eventpound.case.case import member_case
from eventpound.case.suite import Member
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from tests.benchmarks import yardsticks
from tests.benchmarks.problem import folder_of
from tests.benchmarks.real_records import INDEX, write_list

REPEATS = 3


def least(run: Callable[[], object]) -> float:
    """Least processor time of several (ms)."""
    times = []
    for _ in range(REPEATS):
        began = time.thread_time()
        run()
        times.append(time.thread_time() - began)
    return 1e3 * min(times)


def least_of_two(first: Callable[[], object], second: Callable[[], object]) -> tuple[float, float]:
    """Least processor time of two things done in turn (ms), so that a slow spell meets both."""
    times = [(least(first), least(second)) for _ in range(REPEATS)]
    return min(t[0] for t in times), min(t[1] for t in times)


def measure(case: Case, member: Member) -> dict[str, float | str]:
    """Times of one record."""
    task = replace(yardsticks.load()["P7"].task, rtol=case.solver.rtol)
    fast = solver_named("fast")
    data = member.read()
    one = member_case(case, member, data)
    motion = one.scene.motion
    assert isinstance(motion, Record)
    unit, solve = least_of_two(lambda: fast.solve(task), lambda: response_of(one))
    return {
        "record": member.name,
        "samples": motion.samples.size,
        "read": least(member.read),
        "scales": least(lambda: Record(data.acceleration, data.time_step).scales()),
        "solve": solve,
        "in P7": solve / unit * yardsticks.RECORD_SAMPLES / motion.samples.size,
    }


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.suite")
    parser.add_argument("files", nargs="?")
    parser.add_argument("--index", type=Path, default=INDEX, help="of the real records")
    options = parser.parse_args(arguments)
    with TemporaryDirectory() as folder:
        files = options.files
        if files is None:
            files, left_out = write_list(Path(folder), options.index)
            print("\n".join(f"left out {reason[:120]}" for reason in left_out))
        report(load_case(folder_of("bridge-record"), str(files)))


def report(case: Case) -> None:
    """Print the table of a suite."""
    rows = []
    for member in case.suite.members(case.directory):
        try:
            rows.append(measure(case, member))
        except EventpoundError as error:
            print(f"left out {member.name}: {str(error).splitlines()[0][:100]}")
    table = pd.DataFrame(rows)
    print(f"\n{len(table)} records, rtol {case.solver.rtol:g}")
    print("\n| ms | median | worst | a 4000-sample record |\n| --- | --- | --- | --- |")
    for key in ("read", "scales", "solve", "in P7"):
        share = table[key] if key == "in P7" else table[key] / table["samples"] * 4000
        worst = Path(str(table["record"][table[key].idxmax()])).name
        print(f"| {key} | {table[key].median():.2f} | {table[key].max():.2f} ({worst}) | "
              f"{share.median():.2f} |")  # fmt: skip


if __name__ == "__main__":
    main()
