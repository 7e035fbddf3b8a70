"""The problems P1-P7 and PZ of ``problems_p.json`` as scenes, with their stored answers.

P1-P3 and PZ: an elastoplastic or bilinear oscillator at a barrier; P4 an elastic
one; P5 and P6: two and three bilinear oscillators in a row; P7: a bilinear
oscillator at a barrier under a record. Post-yield frequencies give k = m omega_s^2.
PZ rests on its barrier after infinitely many impacts.
"""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.motion.base import GroundMotion
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer, Impact
from tests.benchmarks.problem import Problem

FILE = Path(__file__).parents[1] / "reference" / "problems_p.json"
RECORD_STEP, RECORD_SAMPLES = 0.005, 4001


def load() -> dict[str, Problem]:
    """Every problem of the file, by its name."""
    problems = json.loads(FILE.read_text(encoding="utf-8"))["problems"]
    return {name: _problem(name, entry) for name, entry in problems.items()}


def _problem(name: str, entry: dict[str, Any]) -> Problem:
    definition = entry["definition"]
    motion = _motion(definition["motion"])
    names = [f"body{i}" for i in range(definition["bodies"])]
    springs = tuple(
        Spring(f"spring{i}", (GROUND, body), _law(definition, i, motion))
        for i, body in enumerate(names)
    )
    if "barrier_right_gap" in definition:
        sides, gaps = [(names[0], BARRIER)], [definition["barrier_right_gap"]]
    else:
        sides, gaps = list(pairwise(names)), definition["gaps"]
    contacts = tuple(
        Contact(f"contact{i}", left, right, gap, definition["restitution"])
        for i, ((left, right), gap) in enumerate(zip(sides, gaps, strict=True))
    )
    bodies = tuple(Body(body, float(definition["mass"])) for body in names)
    answer = Answer(
        np.array(entry["u_min"]),
        np.array(entry["u_max"]),
        np.array(entry["final"]["u"]),
        tuple(Impact(t, contact, speed) for t, contact, speed in entry["impacts"]),
    )
    factor, _, pi = definition["end"].partition(" ")
    end = float(factor) * (math.pi if pi else 1.0)
    task = Task(Scene(bodies, springs, (), contacts, motion), 0.0, end, rtol=1e-9)
    return Problem(name, task, answer)


def _law(definition: dict[str, Any], i: int, motion: GroundMotion) -> BoucWen | Linear:
    mass = definition["mass"]
    if "frequency" in definition:
        return Linear(mass * definition["frequency"][i] ** 2)
    strength = definition["Q"][i]
    if isinstance(motion, Record):
        # Stored in words: 0.2 max|a_k|, for a mass of one.
        strength = 0.2 * np.abs(motion.samples).max()
    stiffness = mass * definition["post_yield_frequency"][i] ** 2
    return BoucWen(stiffness, float(strength), definition["u_y"][i])


def _motion(words: str) -> GroundMotion:
    if words.startswith("record"):
        return Record(record_samples(), RECORD_STEP)
    shape = Sine if words.startswith("sine") else Cosine
    return shape(1.0, 2.0 * math.pi, reverse="reversed" in words)


def record_samples() -> Floats:
    """P7's record, shape (4001,): a_k = exp(-((t-6)/3)^2) sum_j sin(1.7 j^1.3 t + j^2) / 5."""
    t = RECORD_STEP * np.arange(RECORD_SAMPLES)
    j = np.arange(1, 26)[:, None]
    samples: Floats = np.exp(-(((t - 6.0) / 3.0) ** 2)) * np.sin(1.7 * j**1.3 * t + j**2).sum(0) / 5
    return samples
