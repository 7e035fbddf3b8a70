"""What reading records costs: a thousand AT2 files of 4 000 samples, and each format.

python -m tests.benchmarks.reading
"""

from __future__ import annotations

import cProfile
import pstats
import tempfile
import time
from pathlib import Path

from eventpound.motion.readers import read_record
from tests.motion.readers.writers import WRITERS, motion

FILES, SAMPLES, STEP = 1000, 4000, 0.01


def read_all(paths: list[Path]) -> tuple[float, float]:
    """Seconds for reading some AT2 files, of the clock and of this process."""
    start, start_cpu = time.perf_counter(), time.process_time()
    for path in paths:
        read_record(path)
    return time.perf_counter() - start, time.process_time() - start_cpu


def seconds_per_file(name: str, folder: Path, repeats: int = 20) -> float:
    """Seconds for reading a file of a format, the best of some."""
    written = WRITERS[name](motion(SAMPLES, STEP), STEP)
    path = folder / name
    path.write_text(written.text)
    component = "#1" if len(written.components) > 1 else None
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        read_record(path, units=written.units, time_step=written.time_step, component=component)
        best = min(best, time.perf_counter() - start)
    return best


def main() -> None:
    """Print the tables."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        paths = [directory / f"{i}.AT2" for i in range(FILES)]
        for i, path in enumerate(paths):
            path.write_text(WRITERS["at2"](motion(SAMPLES, STEP, seed=i), STEP).text)
        clock, cpu = read_all(paths)
        print(f"{FILES} AT2 files of {SAMPLES} samples: {clock:.2f} s, {cpu:.2f} s of one core")
        with cProfile.Profile() as profile:
            read_all(paths[:200])
        pstats.Stats(profile).sort_stats("tottime").print_stats(8)
        print(f"{'format':<14} {'ms a file of ' + str(SAMPLES) + ' samples':>28}")
        for name in WRITERS:
            print(f"{name:<14} {1000.0 * seconds_per_file(name, directory):28.2f}")


if __name__ == "__main__":
    main()
