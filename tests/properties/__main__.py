"""Properties of the solvers on scenes drawn at random.

``python -m tests.properties [COUNT] [SEED] [SOLVER]``

Prints every finding but those where a property simply holds, and the counts.
"""

import sys
from collections import Counter

from tests.properties.invariance import examine

SILENT = (
    "holds",
    "identical",
    "holds when tight",
    "ill-conditioned",
    "a graze",
    "a faint rest",
    "refused",
)


def main() -> None:
    """Examine COUNT scenes from SEED on."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    solver = sys.argv[3] if len(sys.argv) > 3 else "fast"
    words: dict[str, Counter[str]] = {}
    for number, seed in enumerate(range(first, first + count), 1):
        for finding in examine(seed, solver):
            words.setdefault(finding.property, Counter())[finding.word] += 1
            if finding.word not in SILENT:
                print(f"{seed}: {finding.property}: {finding.word}: {finding.remark}", flush=True)
        if number % 50 == 0:
            print(f"# {number} scenes", flush=True)
    for name, counts in words.items():
        print(f"{name}: {dict(counts)}")


if __name__ == "__main__":
    main()
