"""The oracle as a function: compiled once, run on a scene, its answer with uncertainties."""

import atexit
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from pathlib import Path

from eventpound.scene import BoucWen, Scene
from tests.oracle.scene_text import scene_text

SOURCE = Path(__file__).with_name("oracle.cpp")
PATIENCE = 60.0
"""Wall time after which an answer is given up (s)."""


class NoAnswerError(Exception):
    """The oracle refuses a scene, or takes too long over it."""


@dataclass(frozen=True)
class Number:
    """A value and how far two runs of the oracle at different settings are apart."""

    value: Decimal
    uncertainty: float

    def distance(self, value: float) -> float:
        """Distance of a double."""
        return float(abs(Decimal(value) - self.value))


@dataclass(frozen=True)
class OracleEvent:
    """An event at the contact of this position, its numbers by their names (SI)."""

    kind: str
    contact: int
    numbers: Mapping[str, Number]

    @property
    def t(self) -> float:
        """Its time (s)."""
        return float(self.numbers["t"].value)


@dataclass(frozen=True)
class Answer:
    """Peaks and final values by their names in a certificate, and the events in order."""

    values: Mapping[str, Number]
    events: tuple[OracleEvent, ...]


@cache
def program() -> Path:
    """The compiled program, in a folder that is removed when Python ends.

    Raises
    ------
    NoAnswerError
        Where there is no g++, or what it makes is no more precise than a double.
    """
    compiler = shutil.which("g++")
    if compiler is None:
        raise NoAnswerError("there is no g++ to compile the oracle")
    folder = tempfile.mkdtemp(prefix="oracle-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    made = Path(folder) / "oracle"
    command = [compiler, "-O2", "-std=c++17", "-o", str(made), str(SOURCE)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise NoAnswerError(f"g++ does not compile the oracle: {run.stderr.strip()[:300]}")
    return made


def ask(
    scene: Scene,
    start: float,
    end: float,
    patience: float = PATIENCE,
    moments: Sequence[float] = (),
) -> Answer:
    """What the oracle says of a scene that runs from `start` to `end` (s), and at some moments.

    Raises
    ------
    NoAnswerError
        Where it refuses or takes longer than `patience` (s).
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.txt"
        file.write_text(scene_text(scene, start, end, moments))
        try:
            run = subprocess.run(
                [program(), file], capture_output=True, text=True, timeout=patience, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise NoAnswerError("takes too long") from error
    if run.returncode == 3:
        raise NoAnswerError(run.stdout.strip().splitlines()[-1].removeprefix("refused "))
    if run.returncode != 0:
        raise NoAnswerError(f"ended with {run.returncode}: {run.stderr.strip()}")
    return _answer(scene, run.stdout)


def _answer(scene: Scene, text: str) -> Answer:
    values: dict[str, Number] = {}
    events = []
    hysteretic = [spring.name for spring in scene.springs if isinstance(spring.law, BoucWen)]
    for line in text.splitlines():
        word, *rest = line.split()
        if word == "body":
            name = scene.bodies[int(rest[0])].name
            for key, number in _numbers(rest[1:]).items():
                kind = "final" if key in ("u", "v") else "peaks"
                values[f"{kind}.{name}.{key}"] = number
        elif word == "moment":
            name = scene.bodies[int(rest[1])].name
            values[f"history.{rest[0]}.{name}"] = _numbers(rest[2:])["u"]
        elif word == "spring":
            values[f"final.{hysteretic[int(rest[0])]}.z"] = _numbers(rest[1:])["z"]
        elif word == "event":
            events.append(OracleEvent(rest[0], int(rest[1]), _numbers(rest[2:])))
    return Answer(values, tuple(events))


def _numbers(words: list[str]) -> dict[str, Number]:
    return {
        words[i]: Number(Decimal(words[i + 1]), float(words[i + 2]))
        for i in range(0, len(words), 3)
    }
