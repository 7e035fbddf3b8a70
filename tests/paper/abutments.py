"""Readings of the bridge's abutments, and which of them show ends of continuous contact.

    python -m tests.paper.abutments [FILE --units m/s2 --time-step 0.01]

runs the bridge of the paper's section 6 under a record (El Centro 1940 without one) in every
reading of its ends, with the damping of eq. 2 and of the initial stiffness, as recorded and
reversed, and prints impacts / ends of continuous contact / largest displacements (cm).
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

from eventpound import Record, Response, load_case, read_record, simulate
from eventpound.scene import BilinearElastic, Linear, Scene, Series, Spring
from eventpound.solvers.base import EventKind
from tests.benchmarks.problem import CASES

BEARING, ACTIVE, PASSIVE = 150000e3, 1751e3, 455328e3
"""Table 1 of the paper (N/m)."""
ABUTMENT = BilinearElastic(PASSIVE, ACTIVE)
Law = Linear | BilinearElastic | Series
READINGS: dict[str, tuple[Law, ...]] = {
    "in series with the bearing (eq. 19)": (Series((Linear(BEARING), ABUTMENT)),),
    "in series, no pull": (Series((Linear(BEARING), BilinearElastic(PASSIVE, 0.0))),),
    "in series, stiffnesses exchanged": (
        Series((Linear(BEARING), BilinearElastic(ACTIVE, PASSIVE))),
    ),
    "bearing and abutment side by side": (Linear(BEARING), ABUTMENT),
    "bearing only": (Linear(BEARING),),
    "none": (),
    "in series, bearing ten times as stiff": (Series((Linear(10.0 * BEARING), ABUTMENT)),),
    "abutment acts on the deck": (ABUTMENT,),
}
"""Springs between the ground and an end of the bridge."""
DAMPINGS = {"eq. 2": "bridge-el-centro", "initial stiffness": "bridge-initial-damping"}


def with_ends(scene: Scene, laws: Sequence[Law]) -> Scene:
    """The bridge with other springs at both of its ends."""
    kept = tuple(s for s in scene.springs if not s.name.endswith("abutment"))
    ends = (("left", ("ground", "segment1")), ("right", ("segment2", "ground")))
    new = tuple(
        Spring(f"{side}-{i}", between, law) for side, between in ends for i, law in enumerate(laws)
    )
    return replace(scene, springs=kept + new)


def in_words(response: Response) -> str:
    """Impacts, ends of continuous contact with the time of the first, and the peaks (cm)."""
    ends = [e.t for e in response.recording.events if e.kind is EventKind.DETACHMENT]
    first = f" from {min(ends):.1f} s" if ends else ""
    peaks = ", ".join(f"{100.0 * u:.2f}" for u in response.peaks["abs_max"])
    return f"{response.impacts} / {len(ends)}{first} / {peaks}"


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.paper.abutments")
    parser.add_argument("record", nargs="?", type=Path)
    parser.add_argument("--units")
    parser.add_argument("--time-step", type=float)
    parser.add_argument("--rtol", type=float, default=1e-9)
    options = parser.parse_args(arguments)
    record: Any = load_case(CASES / "bridge-el-centro").scene.motion
    if options.record is not None:
        data = read_record(options.record, units=options.units, time_step=options.time_step)
        record = Record(data.acceleration, data.time_step)
    print(f"under {options.record or 'El Centro 1940'}\n")
    columns = list(product(DAMPINGS, (False, True)))
    words = [f"{damping}, {'reversed' if reverse else 'as given'}" for damping, reverse in columns]
    print(f"| abutments | {' | '.join(words)} |\n|{' --- |' * (1 + len(words))}")
    for name, laws in READINGS.items():
        cells = []
        for damping, reverse in columns:
            scene = with_ends(load_case(CASES / DAMPINGS[damping]).scene, laws)
            scene = replace(scene, motion=replace(record, reverse=reverse))
            cells.append(in_words(simulate(scene, "fast", options.rtol)))
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
