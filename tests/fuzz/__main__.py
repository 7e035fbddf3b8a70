"""``python -m tests.fuzz cases|records COUNT SEED``: damaged files, read or refused.

Prints the counts of each outcome as they grow, and every distinct defect where
it first appears, with its traceback and the file, which it keeps in a directory
it names. What holds up even the watchdog of a single file (a hang in compiled
code) ends the run, which then says in which directory that file is.
"""

import faulthandler
import re
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

from tests.fuzz.targets import LONGEST, defects, limit_memory

REPORTED_EVERY = 1000
LONGEST_IN_ALL = 60.0 * LONGEST
"""Time without a finished file after which the run ends (s); other programs may be busy."""
IN_MEMORY = Path("/dev/shm")
"""Where Linux keeps files in memory: opening one on a disk costs more than reading it."""


def main(kind: str, count: int, seed: int) -> int:
    """Try so many files; the number of defects."""
    limit_memory()
    warnings.simplefilter("error")
    kept = Path(tempfile.mkdtemp(prefix=f"fuzz-{kind}-"))
    words: Counter[str] = Counter()
    found: Counter[str] = Counter()
    began = time.monotonic()
    scratch = tempfile.TemporaryDirectory(dir=IN_MEMORY if IN_MEMORY.is_dir() else None)
    print(f"{count} {kind}, seed {seed}; scratch {scratch.name}, defects {kept}", flush=True)
    with scratch as folder:
        for number, content, outcome in defects(kind, count, seed, Path(folder)):
            faulthandler.dump_traceback_later(LONGEST_IN_ALL, exit=True)
            if isinstance(outcome, str):
                words[outcome] += 1
            else:
                where = _where(outcome)
                found[where] += 1
                if found[where] == 1:
                    (kept / str(number)).write_bytes(content)
                    print(f"{number}: {where}\n    kept as {kept / str(number)}")
                    print("".join(traceback.format_exception(outcome)), flush=True)
            if (number + 1) % REPORTED_EVERY == 0:
                print(_counts(number + 1, began, words, found), flush=True)
    faulthandler.cancel_dump_traceback_later()
    print(f"done: {_counts(count, began, words, found)}")
    for where, times in found.most_common():
        print(f"{times:6d} {where}")
    return found.total()


def _counts(tried: int, began: float, words: Counter[str], found: Counter[str]) -> str:
    seconds = time.monotonic() - began
    each = ", ".join(f"{number} {word}" for word, number in sorted(words.items()))
    return (
        f"{tried} in {seconds:.0f} s ({tried / seconds:.0f}/s): {each}; "
        f"{found.total()} defects of {len(found)} kinds"
    )


def _where(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if "eventpound" in frame.filename] or list(frames)
    last = own[-1]
    text = re.sub(r"[\d.e+-]*\d", "0", str(error))[:110]
    return f"{type(error).__name__}: {text} at {Path(last.filename).name}:{last.lineno}"


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])) else 0)
