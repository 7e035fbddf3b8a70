"""``python -m tests.fuzz cases|records COUNT SEED``: damaged files, read or refused.

Prints how many of each outcome there were, and of every kind of defect the
first file, which it keeps in a directory it names.
"""

from __future__ import annotations

import re
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

from tests.fuzz.targets import defects, limit_memory


def main(kind: str, count: int, seed: int) -> int:
    """Try so many files; the number of defects."""
    limit_memory()
    warnings.simplefilter("error")
    kept = Path(tempfile.mkdtemp(prefix=f"fuzz-{kind}-"))
    words: Counter[str] = Counter()
    found: Counter[str] = Counter()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for number, content, outcome in defects(kind, count, seed, Path(folder)):
            if isinstance(outcome, str):
                words[outcome] += 1
            else:
                where = _where(outcome)
                found[where] += 1
                if found[where] == 1:
                    (kept / str(number)).write_bytes(content)
                    print(f"{number}: {where}\n    kept as {kept / str(number)}", flush=True)
            if (number + 1) % 10_000 == 0:
                print(
                    f"{number + 1} in {time.monotonic() - began:.0f} s: {dict(words)}", flush=True
                )
    print(f"{count} {kind}, seed {seed}: {dict(words)}, {sum(found.values())} defects")
    for where, times in found.most_common():
        print(f"{times:6d} {where}")
    return sum(found.values())


def _where(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if "eventpound" in frame.filename] or list(frames)
    last = own[-1]
    text = re.sub(r"[\d.e+-]*\d", "0", str(error))[:110]
    return f"{type(error).__name__}: {text} at {Path(last.filename).name}:{last.lineno}"


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])) else 0)
