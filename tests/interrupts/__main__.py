"""``python -m tests.interrupts [COUNT] [NAME ...]``: interrupt every command at random instants.

COUNT interrupts (10) of each job, or of those whose command is NAMEd, each at a random
instant of its run. A job may end by exit code 130 or KeyboardInterrupt, or be done before
the signal comes; the exit code of this is the number of those that ended otherwise.
"""

import sys
import tempfile
from pathlib import Path

from tests.interrupts.jobs import JOBS
from tests.interrupts.table import head, interrupted, line


def main(words: list[str]) -> int:
    """Print a line for each job; how many interrupts ended as they must not."""
    count = int(words[0]) if words else 10
    print(head(), flush=True)
    wrong = total = 0
    for number, job in enumerate(JOBS):
        if words[1:] and job.command not in words[1:]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            row = interrupted(number, count, number, Path(folder))
        print(line(row), flush=True)
        wrong += row.wrong
        total += sum(row.ends.values()) + sum(row.crashes.values())
    print(f"{total} interrupts, {wrong} ended otherwise than they may")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
