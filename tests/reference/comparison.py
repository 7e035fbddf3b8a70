"""How far a run is from a solved problem, quantity by quantity.

``python -m tests.reference.comparison [RTOL] [SOLVER]`` prints the table.

Errors are parts of a scale: the largest |u|, the largest speed, the end time,
the bound of z. Allowed is a part of the scale (printed: `ALLOWED`) or, where the stated
amplification of that very quantity makes it larger, ten times rtol times
amplification, at most `CAP`. A count of impacts is skipped where the margin
of its threshold is below 0.3 decades, a sequence where the problem says that
rounding of the input changes it.
"""

import sys
from dataclasses import dataclass, field

import numpy as np

from eventpound.response import Response
from eventpound.simulation import response_of
from eventpound.solvers.base import EventKind
from tests.reference.problems import Problem, load

ALLOWED = 1e3
"""In rtol: 1e-9 at 1e-12."""
LISTED = 1e-4
"""Part of the largest closing speed above which impacts are compared."""
CAP = 1e-2
EXEMPT = {
    "D01": "final state: a graze, whose end state amplifies rounding by 1e8",
    "D07": "final state: contacts closing in the same instant, a jump of the answer",
}


def sensitive(name: str, key: str, accuracy: float) -> float:
    """What one quantity of a problem may err where positions err by `accuracy` of scale.

    A10: undamped, it comes to the barrier at the very end with no speed left, where
    ``v = sqrt(2 a (δ - u))``. A20: u_y is a thousandth of the motion, and z errs like
    u/u_y.
    """
    match name, key:
        case "A10", "final_v":
            return float(np.sqrt(2.0 * accuracy))
        case "A20", "final_z":
            return 10.0 * accuracy
    return accuracy


@dataclass
class Comparison:
    """Errors of a run: `errors` and `allowed` by quantity, `notes` on sequences."""

    name: str
    errors: dict[str, float] = field(default_factory=dict)
    allowed: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def failures(self) -> list[str]:
        """Every quantity beyond what is allowed, and every wrong sequence."""
        return [
            f"{self.name}: {key} off by {error:.2e}, allowed {self.allowed[key]:.2e}"
            for key, error in self.errors.items()
            if not error <= self.allowed[key]
        ] + self.notes


def _floats(values: list[str]) -> np.ndarray:
    return np.array([float(value) for value in values])


def compare(problem: Problem, response: Response, accuracy: float) -> Comparison:
    """Compare a run with the stored answer.

    Parameters
    ----------
    problem : Problem
        The problem.
    response : Response
        A run of it.
    accuracy : float
        Part of the scale that is allowed where amplification does not ask for more.
    """
    stored, run = problem.result, response.recording
    result = Comparison(problem.name)
    u_max, u_min = _floats(stored["u_max"]), _floats(stored["u_min"])
    length = max(np.abs(u_max).max(), np.abs(u_min).max())
    speed = max(np.abs(run.history.v).max(), float(stored["max_closing_speed"] or 0.0))
    amplification = stored["amplification"]

    def judge(key: str, error: float) -> None:
        amplified = 10.0 * response.task.rtol * (amplification.get(key) or 0.0)
        result.errors[key] = error
        result.allowed[key] = min(max(sensitive(problem.name, key, accuracy), amplified), CAP)

    x = run.displacement
    judge(
        "extremes", max(np.abs(x.maximum - u_max).max(), np.abs(x.minimum - u_min).max()) / length
    )
    times = np.concatenate(
        (
            x.time_of_maximum - _floats(stored["t_u_max"]),
            x.time_of_minimum - _floats(stored["t_u_min"]),
        )
    )
    judge("extreme_times", float(np.abs(times).max()) / problem.end)
    if problem.name not in EXEMPT:
        judge("final_u", np.abs(run.u - _floats(stored["final"]["u"])).max() / length)
        judge("final_v", np.abs(run.v - _floats(stored["final"]["v"])).max() / speed)
        if run.z.size:
            judge("final_z", np.abs(run.z - _floats(stored["final"]["z"])).max())
    _compare_events(problem, response, result, judge)
    return result


def _compare_events(problem: Problem, response: Response, result: Comparison, judge) -> None:
    stored, events = problem.result, response.recording.events
    fastest = float(stored["max_closing_speed"] or 0.0)
    impacts: dict[int, list] = {}
    for event in events:
        if event.kind is EventKind.IMPACT:
            impacts.setdefault(event.group, []).append(event)
    loud = [
        group
        for group in impacts.values()
        if min(e.gap_velocity_before for e in group) < -LISTED * fastest
    ]
    if stored["threshold_margin_log10"] >= 0.3:
        wanted = stored["n_impacts_above_fraction_of_max_speed"]["1e-4"]
        if len(loud) != wanted:
            result.notes.append(f"{problem.name}: {len(loud)} impacts, not {wanted}")
    if not stored["amplification"]["impact_sequence_unchanged"]:
        return
    listed = [
        entry
        for entry in stored["first_impacts"]
        if min(float(v) for v in entry["pre_gap_speed"]) < -LISTED * fastest
    ]
    mine = [min(group, key=lambda e: e.gap_velocity_before) for group in loud[: len(listed)]]
    leading = [e["contacts"][int(np.argmin(_floats(e["pre_gap_speed"])))] for e in listed]
    if [event.contact for event in mine] != leading and not any(
        len(e["contacts"]) > 1 for e in listed
    ):
        result.notes.append(f"{problem.name}: impacts at {[e.contact for e in mine]}")
        return
    if listed:
        errors = [abs(e.t - float(entry["t"])) for e, entry in zip(mine, listed, strict=False)]
        judge("impact_times", max(errors) / problem.end)
    _compare_rests(problem, events, result, judge)


def _compare_rests(problem: Problem, events: tuple, result: Comparison, judge) -> None:
    stored = problem.result["persistent"]
    rests = [e for e in events if e.kind is EventKind.REST]
    ends = [e for e in events if e.kind in (EventKind.DETACHMENT, EventKind.SEPARATION)]
    if len(rests) != len(stored):
        result.notes.append(f"{problem.name}: {len(rests)} rests, not {len(stored)}")
        return
    errors = [0.0]
    for spell in stored:
        j = spell["contact"]
        errors.append(min(abs(e.t - float(spell["start"])) for e in rests if e.contact == j))
        if spell["ended_by"] == "end":
            continue
        kind = {"force": EventKind.DETACHMENT, "impact": EventKind.SEPARATION}[spell["ended_by"]]
        mine = [abs(e.t - float(spell["end"])) for e in ends if (e.contact, e.kind) == (j, kind)]
        errors.append(min(mine, default=np.inf))
    judge("persistent_times", max(errors) / problem.end)


def run_all(rtol: float, accuracy: float, solver: str = "cvode") -> list[Comparison]:
    """Run every stored problem and compare."""
    comparisons = []
    for problem in load().values():
        response = response_of(problem.scene, solver, rtol, duration=problem.end)
        comparisons.append(compare(problem, response, accuracy))
    return comparisons


def main() -> None:
    """Print the table of errors of all problems at one tolerance."""
    rtol = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-13
    solver = sys.argv[2] if len(sys.argv) > 2 else "cvode"
    keys = (
        "extremes", "extreme_times", "final_u", "final_v", "final_z", "impact_times",
        "persistent_times",
    )  # fmt: skip
    print(f"errors as parts of scale, {solver} at rtol {rtol:g}; * beyond what is allowed")
    print("problem" + "".join(f"{key:>18}" for key in keys))
    for comparison in run_all(rtol, ALLOWED * rtol, solver):
        row = f"{comparison.name:<7}"
        for key in keys:
            error = comparison.errors.get(key)
            if error is None:
                row += f"{'-':>18}"
            else:
                row += f"{error:>17.1e}" + ("*" if error > comparison.allowed[key] else " ")
        print(row, "; ".join(comparison.notes), EXEMPT.get(comparison.name, ""))


if __name__ == "__main__":
    main()
