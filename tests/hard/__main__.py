"""``python -m tests.hard [NAME ...] [--csv FILE]``: the catalogue of hard scenes, by solver.

Digits are those to which fast and ida agree with cvode, the largest difference of anything
that is compared, in parts of its scale.
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

from tests.hard.catalogue import catalogue
from tests.hard.table import head, line, row, write


def main() -> int:
    """Print a line for each scene, and the counts; 1 where a scene fails."""
    parser = argparse.ArgumentParser(prog="python -m tests.hard", description=__doc__)
    parser.add_argument("names", metavar="NAME", nargs="*", help="scenes (all)")
    parser.add_argument("--csv", metavar="FILE", type=Path, help="write the table as CSV, too")
    options = parser.parse_args()
    wanted = [hard for hard in catalogue() if not options.names or hard.name in options.names]
    print(head())
    rows = []
    for hard in wanted:
        rows.append(row(hard))
        print(line(rows[-1]), flush=True)
    if options.csv:
        write(rows, options.csv)
    words = Counter(each.verdict.word for each in rows)
    print(f"{len(rows)} scenes: {dict(words)}")
    return int("fails" in words)


if __name__ == "__main__":
    sys.exit(main())
