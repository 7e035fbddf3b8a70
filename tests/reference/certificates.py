"""Whether certificates of the solved problems hold: true errors against the bounds stated.

``python -m tests.reference.certificates [NAME ...]`` prints a row of each, its last column but one
processor time, and the table of docs/accuracy.md.

An impact is compared with the row of its contact that is nearest in time; where the
stored answer has several within `INSTANT` of the run, which are one problem to
double precision, it is left out, and so is an end of a rest that the same contact
takes up again in that time.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from eventpound.accuracy.certificate import Certificate, CertifiedQuantity
from eventpound.accuracy.verify import verify
from eventpound.scene import BoucWen
from tests.reference.problems import Problem, load

INSTANT = 1e-9
"""Part of a run below which two events of a contact are not told apart."""
COLUMNS = (
    *("case", "given", "stated", "found", "bounds", "refused", "checked", "wrong", "digits"),
    *("median", "95 %", "s", "remark"),
)
SAME = 1e-3
"""Relative difference of closing speeds from which two impacts are not the same."""


@dataclass(frozen=True)
class Checked:
    """A quantity of a certificate and its true error (in its unit)."""

    quantity: CertifiedQuantity
    error: float

    @property
    def violated(self) -> bool:
        """Whether a bound was stated and does not hold."""
        return self.quantity.bound is not None and self.error > self.quantity.bound

    @property
    def slack(self) -> float | None:
        """Bound over error; None where there is no bound or no error at all."""
        if self.quantity.bound is None or self.error == 0.0:
            return None
        return self.quantity.bound / self.error


def check(problem: Problem, certificate: Certificate) -> list[Checked]:
    """Every quantity whose true value is stored, with its true error."""
    known = {quantity.quantity: quantity for quantity in certificate.quantities}
    return [
        Checked(known[name], _distance(known[name].value, true))
        for name, true in (*_states(problem), *_impacts(problem, known, certificate))
        if name in known
    ] + [
        Checked(known[name], _distance(known[name].value, true))
        for name, true in _rests(problem, certificate)
    ]


def _distance(value: float, true: str) -> float:
    """Error of a double against 28 digits."""
    return float(abs(Decimal(float(value)) - Decimal(true)))


def _states(problem: Problem) -> Iterator[tuple[str, str]]:
    stored = problem.result
    for i, body in enumerate(problem.scene.bodies):
        yield f"peaks.{body.name}.max", stored["u_max"][i]
        yield f"peaks.{body.name}.t_max", stored["t_u_max"][i]
        yield f"peaks.{body.name}.min", stored["u_min"][i]
        yield f"peaks.{body.name}.t_min", stored["t_u_min"][i]
        yield f"final.{body.name}.u", stored["final"]["u"][i]
        yield f"final.{body.name}.v", stored["final"]["v"][i]
        spring = problem.scene.springs[i]
        if isinstance(spring.law, BoucWen):
            yield f"final.{spring.name}.z", stored["final"]["z"][i]


def _impacts(
    problem: Problem, known: dict[str, CertifiedQuantity], certificate: Certificate
) -> Iterator[tuple[str, str]]:
    stored = problem.result["first_impacts"]
    for entry in stored:
        for position, contact in enumerate(entry["contacts"]):
            t = float(entry["t"])
            others = [
                other
                for other in stored
                if other is not entry
                and contact in other["contacts"]
                and abs(float(other["t"]) - t) <= INSTANT * problem.end
            ]
            row = _nearest(certificate, f"c{contact}", ("impact",), t)
            speed = float(entry["pre_gap_speed"][position])
            if others or row is None or f"events.{row}.t" not in known:
                continue
            if abs(known[f"events.{row}.gap_velocity_before"].value - speed) > SAME * abs(speed):
                continue
            yield f"events.{row}.t", entry["t"]
            yield f"events.{row}.gap_velocity_before", entry["pre_gap_speed"][position]
            yield f"events.{row}.gap_velocity_after", entry["post_gap_speed"][position]
            yield f"events.{row}.impulse", entry["impulse"][position]


def _rests(problem: Problem, certificate: Certificate) -> Iterator[tuple[str, str]]:
    spells = problem.result["persistent"]
    near = INSTANT * problem.end

    def taken_up(spell: dict, key: str, other_key: str) -> bool:
        t = float(spell[key])
        return any(
            other["contact"] == spell["contact"] and abs(float(other[other_key]) - t) <= near
            for other in spells
        )

    for spell in spells:
        contact = f"c{spell['contact']}"
        start = _nearest(certificate, contact, ("rest",), float(spell["start"]))
        if start is not None and not taken_up(spell, "start", "end"):
            yield f"events.{start}.t", spell["start"]
        kinds = ("detachment", "separation")
        end = _nearest(certificate, contact, kinds, float(spell["end"]))
        if spell["ended_by"] != "end" and end is not None and not taken_up(spell, "end", "start"):
            yield f"events.{end}.t", spell["end"]


def _nearest(
    certificate: Certificate, contact: str, kinds: tuple[str, ...], t: float
) -> int | None:
    """Row of the event of a contact that is nearest in time."""
    rows = [
        (abs(float(str(e["t"])) - t), int(str(e["row"])))
        for e in certificate.events
        if e["contact"] == contact and e["kind"] in kinds
    ]
    return min(rows)[1] if rows else None


def stated_amplification(problem: Problem) -> float:
    """The largest amplification stored, inf where the sequence of impacts changes."""
    stored = problem.result["amplification"]
    return max(value or 0.0 for key, value in stored.items() if key != "impact_sequence_unchanged")


def _line(problem: Problem) -> list[float]:
    """Print what came of a problem; its slacks."""
    began = time.process_time()
    certificate = verify(problem.scene, duration=problem.end)
    seconds = time.process_time() - began
    checked = check(problem, certificate)
    slack = [c.slack for c in checked if c.slack is not None]
    held = [q for q in certificate.quantities if q.certified]
    worst = min(held, key=lambda q: q.digits, default=None)
    median, most = np.percentile(slack, [50, 95]) if slack else (0.0, 0.0)
    cells = (
        problem.name,
        "yes" if certificate.certified else "no",
        f"{stated_amplification(problem):.1e}",
        f"{certificate.largest_amplification:.1e}",
        *(str(number) for number in (len(held), len(certificate.refused), len(checked))),
        str(sum(c.violated for c in checked)),
        f"{0.0 if worst is None else worst.digits:.1f}",
        f"{median:.1e}",
        f"{most:.1e}",
        f"{seconds:.1f}",
        _remark(certificate, worst),
    )
    print("| " + " | ".join(cells) + " |", flush=True)
    for c in checked:
        if c.violated:
            print(
                f"{c.quantity.quantity}: error {c.error:.1e}, bound {c.quantity.bound:.1e}",
                file=sys.stderr,
            )
    return slack


def _remark(certificate: Certificate, worst: CertifiedQuantity | None) -> str:
    """Where routes part, what was refused, or what has the fewest digits."""
    if certificate.parting is not None:
        return f"routes part at {certificate.parting.t:.6g} s"
    if certificate.refused:
        first = certificate.refused[0]
        return f"{first.quantity} refused: {first.limited_by}"
    return "" if worst is None else f"fewest digits: {worst.quantity}"


def main() -> None:
    """Print the table."""
    problems = load()
    print("| " + " | ".join(COLUMNS) + " |\n|" + " --- |" * len(COLUMNS))
    slack = []
    for name in sys.argv[1:] or problems:
        slack += _line(problems[name])
    median, most = np.percentile(slack, [50, 95])
    print("\n| bound over true error | median | 95 % below | largest |\n| --- | --- | --- | --- |")
    print(f"| all {len(slack)} | {median:.3g} | {most:.3g} | {max(slack):.3g} |")


if __name__ == "__main__":
    main()
