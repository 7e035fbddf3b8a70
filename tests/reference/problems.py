"""The solved problems of ``open.json`` as scenes, and how far an answer is from them."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.motion.free import NoMotion
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.record import Record
from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)

FILE = Path(__file__).parent / "open.json"


@dataclass(frozen=True)
class Problem:
    """One solved problem: its scene, the end of the run (s), and the stored answer."""

    name: str
    scene: Scene
    end: float
    result: dict[str, Any]


def load(path: Path = FILE) -> dict[str, Problem]:
    """Every problem of a file of solved problems, by its id."""
    data = json.loads(path.read_text())
    problems = [
        _problem(entry["case"], entry["result"], data["records"]) for entry in data["cases"]
    ]
    return {problem.name: problem for problem in problems}


def _problem(case: dict[str, Any], result: dict[str, Any], records: dict[str, Any]) -> Problem:
    count = case["N"]
    names = [f"b{i}" for i in range(count)]
    initial = case["initial"]
    bodies = tuple(
        Body(names[i], case["m"][i], initial["u"][i], initial["v"][i]) for i in range(count)
    )
    springs = [
        Spring(
            f"s{i}",
            (GROUND, names[i]),
            BoucWen(
                case["k"][i],
                case["Q"][i],
                case["uy"][i],
                case["n"][i],
                case["beta"][i],
                case["gamma"][i],
                initial["z"][i],
            )
            if case["Q"][i] != 0.0
            else Linear(case["k"][i]),
        )
        for i in range(count)
    ]
    springs += [
        Spring(f"link{i}", (names[i], names[i + 1]), Linear(k))
        for i, k in enumerate(case["links"])
        if k != 0.0
    ]
    springs += [
        Spring(
            f"abutment{i}",
            (GROUND, names[a["body"]]),
            BilinearElastic(a["k_minus"], a["k_plus"], a["offset"]),
        )
        for i, a in enumerate(case["abutments"])
    ]
    dashpots = tuple(Dashpot((GROUND, names[i]), c) for i, c in enumerate(case["c"]) if c != 0.0)
    contacts = tuple(
        Contact(
            f"c{i}",
            BARRIER if c["left"] is None else names[c["left"]],
            BARRIER if c["right"] is None else names[c["right"]],
            c["delta"],
            c["eps"],
        )
        for i, c in enumerate(case["contacts"])
    )
    scene = Scene(bodies, tuple(springs), dashpots, contacts, _motion(case["excitation"], records))
    end = case["t_end"]
    if case.get("t_end_exact"):
        factor, _, _ = case["t_end_exact"].partition("*")
        end = float(factor) * math.pi
    return Problem(case["id"], scene, end, result)


def _motion(excitation: dict[str, Any], records: dict[str, Any]) -> Any:
    kind = excitation["kind"]
    if kind == "none":
        return NoMotion()
    if kind == "record":
        source = excitation
        if "ag" not in excitation:
            source = records[excitation["name"]]
        scale = excitation.get("scale", 1.0)
        return Record(np.array(source["ag"]) * scale, source["dt"])
    amplitude = abs(excitation["ap"])
    reverse = excitation["ap"] < 0.0
    if kind == "ricker":
        return Ricker(amplitude, excitation["Tp"], reverse=reverse, center=excitation["t0"])
    period = 2.0 * math.pi / excitation["w"]
    return {"sine": Sine, "cosine": Cosine}[kind](amplitude, period, reverse=reverse)
