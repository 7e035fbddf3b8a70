"""Hard scenes whose record is too long to be kept: ``python -m tests.hard.generated DIRECTORY``.

Writes the record, beside a copy of the case that `eventpound run` then takes.
"""

import shutil
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from eventpound.numerics.arrays import Floats
from tests.models import CASES

FOLDER = CASES / "hard"
SAMPLES, STEP = 1_000_000, 0.001
AMPLITUDES, PERIODS = (1.0, 0.7, 0.5), (1.6, np.sqrt(2.0), 0.31)
"""Sines (m/s^2, s) whose sum never repeats; the second is near the structure's period."""


def million_samples() -> Floats:
    """An acceleration (m/s^2) of a thousand seconds."""
    t = STEP * np.arange(SAMPLES)
    waves = [a * np.sin(2.0 * np.pi * t / p) for a, p in zip(AMPLITUDES, PERIODS, strict=True)]
    return np.asarray(sum(waves), dtype=np.float64)


GENERATED: dict[str, Callable[[], Floats]] = {"record-of-a-million-samples": million_samples}
"""What makes the record of a scene."""


def write(name: str, folder: Path) -> None:
    """Write the case of a scene and its record into a directory."""
    shutil.copy(FOLDER / name / "case.toml", folder)
    np.savetxt(folder / "ground.txt", GENERATED[name](), fmt="%.9e")


@cache
def _scratch(name: str) -> TemporaryDirectory[str]:
    """Made once and taken away at the end of the program."""
    scratch = TemporaryDirectory(prefix="hard-")
    write(name, Path(scratch.name))
    return scratch


def folder_of(name: str) -> Path:
    """Directory of a scene with everything that it needs."""
    return Path(_scratch(name).name) if name in GENERATED else FOLDER / name


if __name__ == "__main__":
    for scene in GENERATED:
        target = Path(sys.argv[1]) / scene
        target.mkdir(parents=True, exist_ok=True)
        write(scene, target)
        print(target)
