"""Time and memory of a study of an elastoplastic oscillator, small and large.

    python -m tests.benchmarks.studies 10000 1000000

A process for each size runs ``eventpound study`` on Pi_Q and Pi_delta at random
ends, and prints runs, seconds, and the largest memory that the process held.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

CASE = """
[excitation]
kind = "cosine"
[pi]
structure = "elastoplastic"
uy = 0.2
epsilon = 0.7
periods = 5
[solver]
name = "fast"
rtol = 1e-6
[study]
quantities = ["pi_um", "impacts", "resting_time"]
[[study.axis]]
key = "pi.delta"
from = 0.1
to = 2.0
count = 100
[[study.axis]]
key = "pi.Q"
from = 0.1
to = 2.0
count = {count}
"""


def measure(runs: int) -> None:
    """Run a study of so many runs and print what it took."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.toml").write_text(CASE.format(count=runs // 100))
        command = [sys.executable, "-m", "eventpound", "study", folder]
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        seconds = time.perf_counter() - started
        size = (Path(folder) / "results" / "study.csv").stat().st_size / 1e6
        print(
            f"| {runs} | {seconds:.1f} | {usage.ru_utime + usage.ru_stime:.1f} "
            f"| {usage.ru_maxrss / 1024:.0f} | {size:.1f} |",
            flush=True,
        )
        if status:
            raise SystemExit(f"the study of {runs} runs ended with {process.returncode}")


def main(sizes: Sequence[int]) -> None:
    """Print the table."""
    print("| runs | wall (s) | processor (s) | largest memory (MB) | table (MB) |")
    print("|" + " --- |" * 5)
    for size in sizes:
        measure(size)


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]])
