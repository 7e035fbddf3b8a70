"""Whether certificates at a loose tolerance hold on scenes drawn at random.

``python -m tests.benchmarks.bounds [COUNT] [SEED] [RTOL]``

Every certified number is compared with a run of the fast solver at `FINE`, whose own
errors are far below bounds at the loose tolerance.
"""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eventpound.accuracy.certificate import Certificate
from eventpound.accuracy.quantities import Quantity, values_of
from eventpound.accuracy.sequences import match_events
from eventpound.accuracy.verify import verify
from eventpound.errors import ComputationError
from eventpound.scene import Scene
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind, Recording, Task
from tests.solvers.random_scenes import random_scene

FINE = 1e-13
PATIENCE = 20.0
"""Wall time of one run (s)."""
SHOWN = 4
"""Wrong bounds that are shown of a scene."""


@dataclass
class Tally:
    """What came of all scenes so far."""

    words: Counter[str] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)
    slack: list[float] = field(default_factory=list)
    checked: int = 0
    wrong: int = 0


def rows_of(scene: Scene, certificate: Certificate, run: Recording) -> dict[int, int]:
    """The row in a run of every event of a certificate."""
    names = [contact.name for contact in scene.contacts]
    listed: list[dict[str, Any]] = [dict(event) for event in certificate.events]
    events = [
        Event(
            e["t"],
            EventKind(e["kind"]),
            e["group"],
            names.index(e["contact"]),
            e["gap_velocity_before"],
        )
        for e in listed
    ]
    return match_events(events, run.events, len(names)).pairs


def true_values(scene: Scene, certificate: Certificate, run: Recording) -> dict[str, float]:
    """Every quantity of a certificate in a run; NaN for an event it does not have."""
    asked = []
    for q in certificate.quantities:
        kind, _, rest = q.quantity.partition(".")
        row = int(rest.partition(".")[0]) if kind == "events" else -1
        asked.append(Quantity(q.quantity, q.unit, q.scale, row))
    values = values_of(scene, run, asked, rows_of(scene, certificate, run))
    return {q.name: float(value) for q, value in zip(asked, values, strict=True)}


def judge(seed: int, rtol: float, tally: Tally) -> None:
    """Certify a scene, compare, and print what is not simply right."""
    scene, end = random_scene(seed)
    certificate = verify(scene, rtol, duration=end, patience=PATIENCE)
    if not certificate.quantities:
        tally.words["no route finished"] += 1
        return
    try:
        truth = solver_named("fast").solve(Task(scene, 0.0, end, FINE))
    except ComputationError as error:
        tally.words["no truth"] += 1
        print(f"{seed}: {error}")
        return
    tally.words["given" if certificate.certified else "refused"] += 1
    true = true_values(scene, certificate, truth)
    wrong = []
    for q in certificate.quantities:
        if q.bound is None:
            tally.reasons[q.limited_by.value] += 1
            continue
        error = abs(q.value - true[q.quantity])
        tally.checked += not np.isnan(error)
        if error > 0.0:
            tally.slack.append(q.bound / error)
        if error > q.bound:
            wrong.append(f"{q.quantity}: error {error:.2e}, bound {q.bound:.2e}, {q.limited_by}")
    tally.wrong += len(wrong)
    if wrong or certificate.parting is not None:
        print(f"{seed}: {len(wrong)} wrong, parting {certificate.parting}", flush=True)
    for line in wrong[:SHOWN]:
        print(f"    {line}", flush=True)


def main() -> None:
    """Print the scenes with wrong bounds or partings, and the counts."""
    words = sys.argv[1:]
    count, first = (int(words[i]) if len(words) > i else d for i, d in ((0, 50), (1, 0)))
    rtol = float(words[2]) if len(words) > 2 else 1e-9
    tally = Tally()
    for seed in range(first, first + count):
        judge(seed, rtol, tally)
        if seed % 20 == 19:
            print(f"# up to {seed}: {dict(tally.words)}, {tally.wrong} wrong", flush=True)
    median, most = np.percentile(tally.slack, [50, 95])
    print(f"{dict(tally.words)}; {tally.checked} bounds, {tally.wrong} wrong")
    print(f"slack: median {median:.3g}, 95 % below {most:.3g}; refused: {dict(tally.reasons)}")


if __name__ == "__main__":
    main()
