"""Points of the paper's figures, drawn at random, made again on CVODE.

    python -m tests.benchmarks.figure_agreement 1000 1

draws so many runs from all studies among the cases, makes each on the solver
and tolerance of its study and on CVODE at rtol 1e-10, and prints how far apart
their Pi_um are, relative to it. The second number seeds the draw.
"""

import sys
import tomllib
from dataclasses import replace

import numpy as np

from eventpound.errors import ComputationError
from eventpound.simulation import response_of
from eventpound.study.plan import Plan
from eventpound.study.reading import load_study
from eventpound.study.variants import rows_of_base, scene_of_row
from tests.models import CASES

REFERENCE, RTOL = "cvode", 1e-10
LIMIT = 1e-6


def studies() -> dict[str, Plan]:
    """Studies of the paper's figures, by their names."""
    found = {}
    for file in sorted(CASES.glob("*/case.toml")):
        if {"study", "figure"} <= tomllib.loads(file.read_text(encoding="utf-8")).keys():
            found[file.parent.name] = load_study(file).study
    return found


def difference(study: Plan, run: int) -> tuple[float, str]:
    """Relative difference of the peaks of one run, and which run it is."""
    for base in study.bases:
        if run < base.size:
            break
        run -= base.size
    rows = rows_of_base(base, run, run + 1)
    case = replace(base.case, scene=scene_of_row(rows, 0))
    duration = float(rows.lengths[0])
    peaks = []
    for solver, rtol in ((study.solver, study.rtol), (REFERENCE, RTOL)):
        response = response_of(case, solver, rtol, duration=duration, output_step=duration)
        peaks.append(float(response.peaks["abs_max"].iloc[0]))
    values = {key: f"{float(v[0]):.6g}" for key, v in rows.values.items()}
    return abs(peaks[0] - peaks[1]) / peaks[1], f"{dict(base.labels) | values}"


def main(count: int, seed: int) -> None:
    """Draw runs and print how their peaks differ."""
    rng = np.random.default_rng(seed)
    found = studies()
    sizes = np.array([study.size for study in found.values()])
    shares = rng.multinomial(count, sizes / sizes.sum())
    print(f"| study | points | median difference | 99 % | largest | above {LIMIT:g} |")
    print("|" + " --- |" * 6)
    above: list[str] = []
    for (name, study), points in zip(found.items(), shares.tolist(), strict=True):
        if not points:
            continue
        differences = []
        for run in rng.choice(study.size, points, replace=False).tolist():
            try:
                apart, which = difference(study, run)
            except ComputationError as error:
                above.append(f"{name}: run {run}: {error}")
                continue
            differences.append(apart)
            if apart > LIMIT:
                above.append(f"{name}: {apart:.2e} at {which}")
        many = np.array(differences)
        print(
            f"| `{name}` | {many.size} | {np.median(many):.1e} | {np.quantile(many, 0.99):.1e} "
            f"| {many.max():.1e} | {int((many > LIMIT).sum())} |",
            flush=True,
        )
    print("\n".join(above))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
