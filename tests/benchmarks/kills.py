"""A study killed with signal 9 at random moments and resumed each time.

    python -m tests.benchmarks.kills 20 1

prints for each kill what was stored and what was lost with it, and says whether
the table is the one of a study that was never killed. The second number seeds
the moments.
"""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from eventpound.study.engines.local import Batch
from eventpound.study.reading import load_study
from eventpound.study.running import run_study
from eventpound.study.store import Store
from tests.benchmarks.studies import CASE

RUNS = 40_000


def main(kills: int, seed: int) -> int:
    """Kill a study so many times; 0 where its table is right."""
    moments = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.toml").write_text(CASE.format(count=RUNS // 100))
        study = load_study(folder).study
        store = Store(Path(folder) / "results", study)
        share = study.chunk_size / study.size
        print(f"{study.size} runs in {len(list(study.chunks()))} chunks; a chunk is {share:.2%}")
        print(f"{'kill':>5} {'after (s)':>10} {'stored before':>14} {'after':>6} {'kept':>5}")
        began = 0
        for kill in range(1, kills + 1):
            before = stamps(store)
            command = [sys.executable, "-m", "eventpound", "study", folder]
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            # The import takes as long as it likes; the kill falls among the chunks.
            while len(stamps(store)) == len(before) and process.poll() is None:
                time.sleep(0.002)
            delay = moments.uniform(0.0, 1.5)
            time.sleep(delay)
            finished = process.poll() is not None
            process.kill()
            process.wait()
            after = stamps(store)
            kept = before.items() <= after.items()
            print(f"{kill:>5} {delay:>10.3f} {len(before):>14} {len(after):>6} {kept!s:>5}")
            began += 1
            if finished:
                print("it came to its end before the kill")
                break
        run_study(study, Path(folder) / "results", Batch())
        run_study(study, Path(folder) / "whole", Batch())
        tables = [(Path(folder) / d / "study.csv").read_bytes() for d in ("results", "whole")]
        print(f"{began} kills; at most one chunk in flight each, {share:.2%} of the study")
        print("identical, byte for byte" if tables[0] == tables[1] else "DIFFERENT TABLES")
    return int(tables[0] != tables[1])


def stamps(store: Store) -> dict[str, tuple[int, int]]:
    """Chunks that are stored, with what changes when one is written again."""
    found = store.unfinished.glob("[0-9]*.csv")
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in found}


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2])))
