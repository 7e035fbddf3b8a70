"""What a record of a suite costs: ``python -m tests.benchmarks.suite [FILES]``.

The two-segment bridge (frozen as it was when first measured) under every record that FILES
matches, a pattern or a list as for ``--suite``; without it, the records beside the
checkout. A table of medians and worst cases: from file to row, its parts, and the
solver's share in units of problem P7, scaled by the number of samples. Then CVODE
on every tenth record, and how far the peaks of both are apart. Times are those of
the processor, the least of several.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from eventpound import load_case
from eventpound.case import Case
from eventpound.case.member import member_case
from eventpound.case.suite import Member
from eventpound.errors import EventpoundError
from eventpound.motion import Record
from eventpound.simulation import simulate
from eventpound.solvers import solver_named
from eventpound.study.plan import MOST_RECORDS
from eventpound.study.suite import Runner
from tests.benchmarks import yardsticks
from tests.benchmarks.problem import folder_of
from tests.benchmarks.real_records import INDEX, write_list

EVERY = 10
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
    unit, solve = least_of_two(lambda: fast.solve(task), lambda: simulate(one))
    return {
        "record": member.name,
        "samples": motion.samples.size,
        "read": least(member.read),
        "scales": least(lambda: Record(data.acceleration, data.time_step).scales()),
        "solve": solve,
        "in P7": solve / unit * yardsticks.RECORD_SAMPLES / motion.samples.size,
    }


def together(case: Case, members: list[Member]) -> str:
    """What a row costs where records are run together, which were read before."""
    runner = Runner(case, None, None, False, None)
    chunk = runner.chunk(members)
    whole = least(lambda: runner.chunk(members)) / len(members)
    solved = 1e3 * float(np.nanmean(chunk.columns["seconds.solve"]))
    return (
        f"{len(members)} records together, read before: {whole:.3f} ms a row, {solved:.3f} solved"
    )


def difference(case: Case, member: Member, rtol: float) -> tuple[float, float]:
    """Difference of the peaks from CVODE's, relative to the largest, and CVODE's time (s)."""
    one = member_case(case, member, member.read())
    fast = simulate(one).peaks["abs_max"]
    began = time.thread_time()
    reference = simulate(one, "cvode", rtol).peaks["abs_max"]
    return float((fast - reference).abs().max() / reference.max()), time.thread_time() - began


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.suite")
    parser.add_argument("files", nargs="?")
    parser.add_argument("--index", type=Path, default=INDEX, help="of the real records")
    parser.add_argument("--reference-rtol", type=float, default=1e-11)
    options = parser.parse_args(arguments)
    with TemporaryDirectory() as folder:
        files = options.files
        if files is None:
            files, left_out = write_list(Path(folder), options.index)
            print("\n".join(f"left out {reason[:120]}" for reason in left_out))
        report(load_case(folder_of("bridge-record"), str(files)), options.reference_rtol)


def report(case: Case, reference_rtol: float) -> None:
    """Print the tables of a suite."""
    assert case.suite is not None
    rows, readable = [], []
    for member in case.suite.members(case.directory):
        try:
            rows.append(measure(case, member))
            readable.append(member)
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
    print(f"\n{together(case, readable[:MOST_RECORDS])}")
    print("\n| record | difference of the peaks | CVODE (s) |\n| --- | --- | --- |")
    for member in readable[::EVERY]:
        error, seconds = difference(case, member, reference_rtol)
        print(f"| {Path(member.name).name} | {error:.1e} | {seconds:.2f} |", flush=True)


if __name__ == "__main__":
    main()
