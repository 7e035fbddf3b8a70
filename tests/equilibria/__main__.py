"""Equilibria of random scenes beside an independent program, and runs that stay there.

``python -m tests.equilibria [COUNT] [SEED] [memory]``

Prints every scene that is wrong, refused without need or moves, and the counts.
"""

import sys
from collections import Counter

import numpy as np

from tests.equilibria.examined import LIMITS, examine


def main() -> int:
    """Examine COUNT scenes from SEED on; 1 where one is wrong."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    words: Counter[str] = Counter()
    worst: dict[str, float] = {}
    for seed in range(first, first + count):
        found = examine(seed, memory="memory" in sys.argv)
        words[found.word] += 1
        for name, value in found.numbers.items():
            worst[name] = max(worst.get(name, 0.0), value)
        if found.wrong:
            print(f"{seed}: {found.word}: {found.remark}", flush=True)
    print(dict(words))
    for name, value in worst.items():
        print(f"{name}: {value:.1e} (at most {LIMITS[name]:.0e})")
    return int(any(np.isnan(v) or v > LIMITS[name] for name, v in worst.items()))


if __name__ == "__main__":
    sys.exit(main())
