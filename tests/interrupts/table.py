"""Interrupts of one job, counted by how they ended."""

import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from tests.interrupts.jobs import JOBS, Job

FINE = {"0", "130"}
"""Done before the signal came, or interrupted."""


class Row(NamedTuple):
    """How the interrupts of a job ended.

    seconds: the job takes without one. ends: how many ended by each exit code or exception.
    crashes: processes that died, by the number of the signal.
    """

    job: Job
    seconds: float
    ends: Counter[str]
    crashes: Counter[int]

    @property
    def wrong(self) -> int:
        """Interrupts that ended otherwise than they may."""
        others = sum(n for end, n in self.ends.items() if end not in FINE)
        return others + sum(self.crashes.values())


def interrupted(number: int, count: int, seed: int, folder: Path) -> Row:
    """Interrupt a job so many times; a process that dies is replaced.

    Parameters
    ----------
    number : int
        Of the job in `JOBS`.
    count, seed : int
        Interrupts, and the dice that say when.
    folder : Path
        Where it works.
    """
    ends: Counter[str] = Counter()
    crashes: Counter[int] = Counter()
    seconds, left = 0.0, count
    while left > 0:
        words = [str(number), str(left), str(seed + left), str(folder)]
        done = subprocess.run(
            [sys.executable, "-m", "tests.interrupts.worker", *words],
            capture_output=True,
            text=True,
            check=False,
        )
        if "Traceback" in done.stderr or done.returncode != 0:
            print(done.stderr, file=sys.stderr)
        length, *lines = done.stdout.split("\n")[:-1] or ["nan"]
        seconds = float(length)
        ends.update(lines)
        left -= len(lines)
        if done.returncode != 0:
            crashes[done.returncode] += 1
            left -= 1
    return Row(JOBS[number], seconds, ends, crashes)


def head() -> str:
    """Names of the columns."""
    return (
        f"{'command':<18} {'solver':<22} {'s':>6} {'interrupts':>10} "
        f"{'130':>5} {'done':>5} {'other':>5} {'crashes':>7}"
    )


def line(row: Row) -> str:
    """A row of the table."""
    other = {end: n for end, n in row.ends.items() if end not in FINE}
    total = sum(row.ends.values()) + sum(row.crashes.values())
    return (
        f"{row.job.command:<18} {row.job.solver:<22} {row.seconds:>6.2f} {total:>10} "
        f"{row.ends['130']:>5} {row.ends['0']:>5} {sum(other.values()):>5} "
        f"{sum(row.crashes.values()):>7}  {dict(row.crashes) or ''} {other or ''}".rstrip()
    )
