"""What a first run costs: ``python -m tests.benchmarks.first_run [--checkout DIR] [--only WORDS]``.

Each run has an empty cache and a fresh process, and no estimate of its error. Printed are
processor and wall time, the same of a second run, how many functions were compiled
(specialisations and functions that Numba itself brings counted), the size of what is kept and the
largest memory. Another checkout of this repository can stand beside, each run in turns with it.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parents[2]
FROZEN_BRIDGE = str(Path(__file__).parent / "frozen" / "bridge-el-centro")
RUNS = (
    ("one elastic body, no contact", "", "cvode"),
    ("elastoplastic-barrier", "cases/elastoplastic-barrier", "fast"),
    ("elastoplastic-barrier", "cases/elastoplastic-barrier", "cvode"),
    ("pair", "cases/pair", "fast"),
    ("bridge-el-centro", FROZEN_BRIDGE, "fast"),
    ("bridge-el-centro", FROZEN_BRIDGE, "ida"),
    ("bridge-el-centro", FROZEN_BRIDGE, "cvode"),
    ("row-of-eight", "cases/row-of-eight", "moreau"),
)
"""What is shown, case (none: a scene of one elastic body), solver."""
PROGRAM = """\
import json, resource, sys, time
wall, used = time.perf_counter(), time.process_time()
import eventpound
from numba.core.compiler import CompilerBase
compiled, core = [], CompilerBase._compile_core
CompilerBase._compile_core = lambda self: (compiled.append(1), core(self))[1]
case, solver = sys.argv[1:]
if case:
    scene = eventpound.load_case(case)
else:
    from eventpound.motion import Cosine
    scene = eventpound.Scene(
        bodies=(eventpound.Body("deck", 1.0),),
        springs=(eventpound.Spring("frame", ("ground", "deck"), eventpound.Linear(4.0)),),
        motion=Cosine(1.0, 2.0),
    )
eventpound.simulate(scene, solver, error_estimate=False)
print(json.dumps({
    "processor": time.process_time() - used,
    "wall": time.perf_counter() - wall,
    "compiled": len(compiled),
    "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
}))
"""


def run(checkout: Path, case: str, solver: str, cache: str) -> dict[str, float]:
    """One run in a process of its own; what it cost, and the size of what is kept (MB)."""
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": cache,
        "PYTHONPATH": str(checkout),
        "PYTHONWARNINGS": "ignore",
    }
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, case, solver],
        cwd=checkout,
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    cost: dict[str, float] = json.loads(done.stdout)
    files = [path.stat().st_size for path in Path(cache).rglob("*") if path.is_file()]
    return {**cost, "kept": sum(files) / 2**20}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--checkout", type=Path, help="another checkout to stand beside")
    parser.add_argument("--only", default="", help="runs whose case or solver has this word")
    options = parser.parse_args()
    checkouts = [HERE, *([options.checkout.resolve()] if options.checkout else [])]
    columns = ("processor (s)", "wall (s)", "again (s)", "compiled", "kept (MB)", "memory (MB)")
    print("| scene | solver | checkout | " + " | ".join(columns) + " |")
    print("|" + " --- |" * (3 + len(columns)))
    for name, case, solver in RUNS:
        if options.only not in f"{name} {solver}":
            continue
        for checkout in checkouts:
            with tempfile.TemporaryDirectory() as cache:
                first = run(checkout, case, solver, cache)
                again = run(checkout, case, solver, cache)
            print(
                f"| {name} | {solver} | {'this' if checkout == HERE else 'other'} "
                f"| {first['processor']:.1f} | {first['wall']:.1f} | {again['processor']:.1f} "
                f"| {first['compiled']:.0f} | {first['kept']:.1f} | {first['memory']:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
