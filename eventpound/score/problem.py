"""A problem: what is given, and the certified answer."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.score.difference import ScaledValue, Truth
from eventpound.score.levels import KEYS, UNIT_OF_TIME, Floats, ScoreError
from eventpound.score.pairing import Event


@dataclass(frozen=True)
class Problem:
    """A problem and its answer, as in ``problem.json`` and ``answer.json``."""

    given: dict[str, Any]
    answer: dict[str, Any]

    @property
    def name(self) -> str:
        """What the set calls it."""
        return str(self.given["problem"])

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return list(self.given["bodies"])

    @property
    def hysteretic(self) -> list[int]:
        """Positions of the springs with a z."""
        return [s for s, q in enumerate(self.given["springs"]["strength"]) if q != 0.0]

    @property
    def z_columns(self) -> list[str]:
        """Columns of the hysteretic variables."""
        return [f"z.{self.given['springs']['names'][s]}" for s in self.hysteretic]

    @property
    def duration(self) -> float:
        """Length of the run (s)."""
        return float(self.given["end"] - self.given["start"])

    @property
    def length(self) -> float:
        """Largest displacement (m)."""
        return max(row[4] for row in self.answer["quantities"] if row[0].endswith((".max", ".min")))

    @property
    def truth(self) -> Truth:
        """The answer."""
        contacts = list(self.given["contacts"])
        rows = (
            dict(zip(self.answer["event_columns"], row, strict=True))
            for row in self.answer["events"]
        )
        return Truth(
            [
                ScaledValue(name, value, scale, _unit(name), bound, amplification or 0.0)
                for name, value, bound, amplification, scale in self.answer["quantities"]
            ],
            [
                Event(e["kind"], e["t"], contacts.index(e["contact"]), e["before"],
                      math.nan if e["after"] is None else e["after"], e["t_bound"])
                for e in rows
            ],
            UNIT_OF_TIME * self.duration,
            (self.given["start"], self.given["end"]),
        )  # fmt: skip

    def array(self, key: str) -> Floats:
        """A matrix or vector of the problem."""
        return np.array(self.given[key], dtype=float)

    @property
    def directions(self) -> Floats:
        """B, whose columns make elongations of displacements, shape (N, springs)."""
        return self.array("B").reshape(len(self.bodies), -1)

    def gaps(self, u: Floats) -> Floats:
        """Gaps for displacements of shape (n, N): shape (n, contacts)."""
        return self.array("gaps") + u @ self.array("W").reshape(len(self.bodies), -1)

    def rates(self, v: Floats) -> Floats:
        """Their rates for velocities of shape (n, N)."""
        return v @ self.array("W").reshape(len(self.bodies), -1)

    def ground(self, t: Floats) -> list[Floats]:
        """Components of the ground acceleration (m/s^2) at times of shape (n,), one on a line.

        After a jump at its time.
        """
        keys = ("motion", "motion_across") if "iota" in self.given else ("motion",)
        return [self._component(key, t) for key in keys]

    def power(self, t: Floats, v: Floats) -> Floats:
        """Power against the ground (W), ``v^T M 1 a_g`` on a line, for v of shape (n, N)."""
        if "iota" not in self.given:
            return self.ground(t)[0] * (v @ self.array("M"))
        pushed = self.array("M")[:, None] * self.array("iota")
        return sum(a * (v @ part) for a, part in zip(self.ground(t), pushed.T, strict=True))

    def _component(self, key: str, t: Floats) -> Floats:
        a_g = np.zeros(t.shape)
        for piece in self.given[key]:
            inside = (t >= piece["start"]) & (t < piece["end"])
            s = t[inside] - piece["origin"]
            if "sinusoids" in piece:
                a_g[inside] = sum(a * np.cos(w * s + p) for a, w, p in piece["sinusoids"])
            elif "gaussian" in piece:
                q, *c = piece["gaussian"]
                a_g[inside] = np.polyval(c[::-1], s) * np.exp(-q * s * s)
            else:
                samples = np.array(piece["samples"])
                a_g[inside] = np.interp(s, piece["dt"] * np.arange(samples.size), samples)
        return a_g


def _unit(name: str) -> str:
    """Of a quantity, by its name."""
    key = name.rpartition(".")[2]
    of_state = {"v": "m/s", "z": ""} if name.startswith("final.") else {}
    return "s" if key in ("t_max", "t_min") else of_state.get(key, "m")


def read_problem(folder: Path) -> Problem:
    """The problem of a directory.

    Raises
    ------
    ScoreError
        Where it has none.
    """
    content = []
    for name, needed in KEYS.items():
        try:
            found = json.loads((folder / name).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise ScoreError(f"{folder / name}: cannot be read: {error}") from error
        missing = [key for key in needed.split() if key not in found]
        if missing:
            raise ScoreError(f"{folder / name}: has no {', '.join(missing)}")
        content.append(found)
    return Problem(content[0], content[1])
