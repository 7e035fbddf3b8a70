"""``python -m tests.hard [NAME ...]``: the catalogue of hard scenes, solver by solver."""

from __future__ import annotations

import sys
from collections import Counter

from tests.hard.catalogue import catalogue
from tests.hard.outcome import SOLVERS, outcome, verdict


def main() -> None:
    """Print a line for each scene, and the counts."""
    names = sys.argv[1:]
    words: Counter[str] = Counter()
    for hard in catalogue():
        if names and hard.name not in names:
            continue
        word, remark = verdict(hard, [outcome(hard, solver) for solver in SOLVERS])
        words[word] += 1
        print(f"{hard.name:<34} {word:<8} {remark}", flush=True)
    print(dict(words))


if __name__ == "__main__":
    main()
