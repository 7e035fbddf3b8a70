"""Whether a run is as wrong as it says: the shipped cases, as a fresh installation runs them.

``python -m tests.accuracy.honesty [CASE ...]``

A process whose store of kernels is empty does ``eventpound run`` for each case that is one run:
`fast` is never compiled there, so that `cvode` judges itself. The truth is a run of `fast` at rtol
1e-13, of `cvode` where `fast` does not take the scene. A run *holds* where its largest error is at
most `TIMES` what it says, or `ROUNDING`; or it *warns*; else it is *unsaid*, and the program ends
with 1. Scenes that take a minute are left out.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from eventpound import Case, InputError, Response, load_case
from eventpound.accuracy.judge import INDEPENDENT
from eventpound.accuracy.quantities import truth_of
from eventpound.score.difference import difference
from eventpound.simulation import response_of
from eventpound.solvers import knows_scene, solver_named
from tests.hard.catalogue import LONG
from tests.models import CASES

TRUE_RTOL = 1e-13
TIMES, ROUNDING = 2.0, 1e-11
"""What an estimate may be exceeded by: the judge errs, too. And the part of a scale by which the
truth may be off: 100 of its rtol."""


def true_run(case: Case) -> Response:
    """The run that is taken for the truth."""
    able = knows_scene(solver_named(INDEPENDENT), case.scene)
    return response_of(case, INDEPENDENT if able else "cvode", TRUE_RTOL)


def true_error(values: Mapping[str, float], truth: Response) -> tuple[float, str]:
    """The largest error of peaks and final values, in parts of its scale, and of what."""
    known = truth_of(truth.task, truth.recording)
    worst = difference(known, values, (), ()).worst("")
    return worst.error, worst.quantity.name


def word(error: float, estimate: Mapping[str, Any]) -> str:
    """What an estimate is worth beside the true error."""
    said = estimate["largest"]["part"] if "largest" in estimate else 0.0
    if estimate.get("warnings"):
        return "warns"
    return "holds" if error <= max(TIMES * said, ROUNDING) else "unsaid"


def _flat(summary: Mapping[str, Any]) -> dict[str, float]:
    """Peaks and final values of a summary by their names."""
    return {
        f"{kind}.{owner}.{key}": value
        for kind in ("peaks", "final")
        for owner, of_owner in summary[kind].items()
        for key, value in of_owner.items()
    }


WORKER = """\
import json, sys, time
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from eventpound.cli import main
for line in sys.stdin:
    case, out = json.loads(line)
    began, said = time.perf_counter(), StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        code = main(["run", case, "--no-figures", "--out", out])
    last = said.getvalue().strip().splitlines()[-1]
    print(json.dumps([code, time.perf_counter() - began, last]), flush=True)
"""


class Fresh:
    """A process that has compiled nothing yet, and keeps to itself what it compiles."""

    def __init__(self, store: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", WORKER],
            env=os.environ | {"NUMBA_CACHE_DIR": store},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, folder: Path, out: Path) -> tuple[int, float, str]:
        """Exit code, seconds and last line of ``eventpound run``."""
        assert self._process.stdin is not None
        print(json.dumps([str(folder), str(out)]), file=self._process.stdin, flush=True)
        code, seconds, last = json.loads(self._process.stdout.readline())
        return code, seconds, last

    def end(self) -> None:
        """Let it go."""
        self._process.communicate()


def row(folder: Path, fresh: Fresh, out: Path) -> tuple[str, str, float]:
    """Run a case as a user does; its row of the table, what it is worth, its error in rtol."""
    name = folder.relative_to(CASES)
    code, seconds, last = fresh.run(folder, out)
    if code:
        return f"| {name} | exit {code} | | | | {seconds:.1f} | {last} |", "refused", math.nan
    summary = json.loads((out / "summary.json").read_text())
    estimate = summary["error_estimate"]
    case = load_case(folder)
    error, quantity = true_error(_flat(summary), true_run(case))
    found = word(error, estimate)
    part = estimate["largest"]["part"] if "largest" in estimate else float("nan")
    return (
        (
            f"| {name} | {estimate['by']} | {part:.1e} | {error:.1e} ({quantity}) | {found} "
            f"| {seconds:.1f} | {'; '.join(estimate['warnings'])} |"
        ),
        found,
        error / case.solver.rtol,
    )


def single_runs(names: Sequence[str]) -> list[Path]:
    """Folders of cases that are one run, of all where none is named."""
    found = []
    paths = sorted(CASES.rglob("case.toml"))
    for folder in [CASES / name for name in names] or [path.parent for path in paths]:
        # A study is refused, since it is no case of one run.
        with suppress(InputError):
            if folder.name not in LONG and load_case(folder).suite is None:
                found.append(folder)
    return found


def main(names: Sequence[str]) -> int:
    """Print the table; 1 where a run is more wrong than it says."""
    words: Counter[str] = Counter()
    errors: list[float] = []
    folders = single_runs(names)
    print("| case | judged by | says | is | | seconds | warnings |")
    print("|" + " --- |" * 7)
    with tempfile.TemporaryDirectory() as place:
        fresh = Fresh(f"{place}/store")
        for folder in folders:
            text, found, error = row(folder, fresh, Path(place) / "results")
            words[found] += 1
            errors.append(error)
            print(text, flush=True)
        fresh.end()
    quantiles = np.nanquantile(errors, [0.5, 0.75, 0.9])
    print(f"{words.total()} cases: {dict(words)}")
    print("errors in rtol: " + ", ".join(f"{each:.2g}" for each in quantiles) + " (50, 75, 90 %)")
    return int("unsaid" in words)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
