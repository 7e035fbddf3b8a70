"""``python -m tests.oracle [COUNT] [SEED]``: certificates of random scenes against the oracle.

Certifies COUNT scenes from SEED on at the tightest tolerance and compares every bound with
the oracle's answer. Prints each bound that does not hold, and the counts as they grow.
"""

import sys

from tests.oracle.certificates import Tally, judge

REPORTED_EVERY = 20


def main(count: int, first: int) -> int:
    """Try so many scenes; the number of bounds exceeded."""
    tally = Tally()
    for seed in range(first, first + count):
        known = len(tally.wrong)
        judge(seed, tally)
        for wrong in tally.wrong[known:]:
            print(f"{wrong.seed}: {wrong.quantity}: error {wrong.error:.3e}, "
                  f"bound {wrong.bound:.3e}", flush=True)  # fmt: skip
        if (seed + 1 - first) % REPORTED_EVERY == 0 or seed + 1 == first + count:
            print(f"# {seed + 1 - first} of {count}\n{tally.text()}", flush=True)
    return len(tally.wrong)


if __name__ == "__main__":
    words = [int(word) for word in sys.argv[1:]]
    sys.exit(1 if main(*(words + [20, 0][len(words) :])) else 0)
