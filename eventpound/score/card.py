"""The card of an answer: what is found of it, which levels that passes, and both in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from eventpound.score.answer import Motion, impacts_of, read_off
from eventpound.score.difference import Deviation, difference
from eventpound.score.found import created_energy_of, crests_of, values_of
from eventpound.score.levels import COUNTED, CREATED, EVENTS, LEVELS, UNIT_OF_TIME
from eventpound.score.pairing import Event, Paired, pair_events
from eventpound.score.problem import Problem

UNKNOWN: dict[str, Any] = dict.fromkeys(("expected", "matched", "missed", "extra", "largest_shift"))
"""What is counted of events of a kind, where nothing is known of them."""


@dataclass
class Card:
    """What is found of an answer.

    Parameters
    ----------
    problem : str
        Its name.
    digits : dict
        Fewest digits by what is judged; None where nothing is known.
    worst : dict
        The quantity that has them.
    deviations : tuple of Deviation
        Every number beside the certified one.
    impacts : dict
        expected, matched, missed, extra, largest_shift (part of `UNIT_OF_TIME` of the run).
    events : dict of dict
        The same of the other events by their kinds, the keys of `EVENTS`; matched is None where
        the program does not report them.
    penetration : float
        Deepest overlap, part of the largest displacement.
    energy : float or None
        What appears from nowhere, part of the largest energy.
    impact_rows : list of dict
        Of each impact ``contact``, ``t`` (s), ``speed`` (m/s, closing) and ``restitution`` (how
        many times faster it opens), by the answer, and the same as ``t_found`` ..., by the
        velocities of the rows; None where either has it not.
    reasons : dict of list
        By level everything that keeps it from being passed; nothing where it is.
    not_judged : list of str
        What was left out, and why.
    seconds : float or None
        What the run took.
    size : str
        Step or tolerance of the run.
    """

    problem: str
    digits: dict[str, float | None] = field(default_factory=dict)
    worst: dict[str, str] = field(default_factory=dict)
    deviations: tuple[Deviation, ...] = ()
    impacts: dict[str, Any] = field(default_factory=dict)
    events: dict[str, dict[str, Any]] = field(default_factory=dict)
    penetration: float = 0.0
    energy: float | None = None
    impact_rows: list[dict[str, Any]] = field(default_factory=list)
    reasons: dict[str, list[str]] = field(default_factory=dict)
    not_judged: list[str] = field(default_factory=list)
    seconds: float | None = None
    size: str = ""

    @classmethod
    def of_failure(cls, problem: str, why: str, size: str = "") -> Card:
        """Of a run that gave no answer."""
        reasons = {level: [why] for level in LEVELS}
        return cls(problem, impacts=UNKNOWN | {"expected": 0}, reasons=reasons, size=size)

    @property
    def levels(self) -> dict[str, str]:
        """By level why it is not passed, empty where it is."""
        return {level: "; ".join(why) for level, why in self.reasons.items()}

    @property
    def next_why(self) -> list[str]:
        """What keeps it from the easiest level that is not passed."""
        return next((why for why in self.reasons.values() if why), [])

    @property
    def passed(self) -> str | None:
        """The hardest level passed."""
        passed = [level for level, why in self.reasons.items() if not why]
        return passed[-1] if passed else None

    @property
    def fewest(self) -> float:
        """Digits of peaks, final values and history; 0 where nothing is right."""
        known = [self.digits.get(group) for group in ("peaks", "final", "history")]
        return min((d for d in known if d is not None), default=0.0)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        names = (
            "problem size passed digits worst impacts events penetration energy levels "
            "impact_rows not_judged seconds"
        )
        numbers = [
            [q.quantity.name.partition(".")[0], q.quantity.name, q.error, q.floor]
            for q in self.deviations
        ]
        return {name: getattr(self, name) for name in names.split()} | {"quantities": numbers}


def judge(problem: Problem, history: Motion, seconds: float | None = None) -> Card:
    """Hold a history against the answer.

    Parameters
    ----------
    problem : Problem
        With its answer.
    history : Motion
        That `check` has passed.
    seconds : float, optional
        What it took to compute.
    """
    card = Card(problem.name, seconds=seconds)
    impacts = impacts_of(problem, history)
    crests = crests_of(history, impacts)
    values, left_out = values_of(problem, history, crests)
    card.not_judged += left_out
    others = [event for event in history.events if event.kind != "impact"]
    found = difference(problem.truth, values, [*(impacts or ()), *others])
    card.deviations = found.quantities
    for group in ("peaks", "final", "history"):
        worst = found.worst(group)
        card.digits[group] = None if worst is None else digits_of(max(worst.error, worst.floor))
        card.worst[group] = "" if worst is None else worst.quantity.name
    card.impacts = _counts(problem, found.events, "impact", impacts is not None)
    if impacts is None:
        card.not_judged.append("impacts: there are neither velocities nor a list of them")
    card.events = {
        kind: _counts(problem, found.events, kind, kind in history.reported) for kind in EVENTS
    }
    shift = card.impacts["largest_shift"]
    card.digits["impacts"] = None if shift is None else digits_of(shift)
    card.penetration = abs(float(problem.gaps(history.u).min(initial=0.0))) / problem.length
    card.energy, why = created_energy_of(problem, history, impacts)
    if why:
        card.not_judged.append(f"energy: {why}")
    card.impact_rows = _impact_rows(problem, history)
    card.reasons = {level: _why_not(card, size) for level, size in LEVELS.items()}
    return card


def _counts(problem: Problem, events: Paired, kind: str, known: bool) -> dict[str, Any]:
    """Events of a kind in numbers; shifts in parts of `UNIT_OF_TIME` of the run.

    Of impacts only shifts of those that count do; other events of the answer whose time has no
    bound may be found or not.
    """
    impact = kind == "impact"
    of_kind = Paired(tuple(
        p for p in events.of(kind).pairs
        if impact or p.reference is None or p.reference.bound is not None
    ))  # fmt: skip
    nothing = UNKNOWN | {"expected": of_kind.expected}
    if not known:
        return nothing
    unit = UNIT_OF_TIME * problem.duration
    shifts = [
        max(abs(p.shift) - (p.reference.bound or 0.0), 0.0) / unit
        for p in of_kind.pairs
        if not math.isnan(p.shift) and (not impact or p.weight > COUNTED)
    ]
    return nothing | {
        "matched": of_kind.matched, "missed": of_kind.missed, "extra": of_kind.extra,
        "largest_shift": max(shifts, default=None),
    }  # fmt: skip


def _impact_rows(problem: Problem, motion: Motion) -> list[dict[str, Any]]:
    """Every impact of the answer beside that in the rows, with what restitution both come to."""

    def row(event: Event | None) -> tuple[float | None, float | None, float | None]:
        if event is None:
            return None, None, None
        before, after = event.gap_velocity_before, event.gap_velocity_after
        return event.t, -before, -after / before if before < 0.0 else None

    truth, contacts = problem.truth, problem.given["contacts"]
    found = read_off(problem, motion) or []
    keys = ("t", "speed", "restitution")
    return [
        {"contact": contacts[p.contact]}
        | dict(zip(keys, row(p.reference), strict=True))
        | {f"{key}_found": x for key, x in zip(keys, row(p.found), strict=True)}
        for p in pair_events(truth.events, found, truth.unit).listed
    ]


def digits_of(part: float) -> float:
    """Decimal digits that an error of this part of the scale leaves, to a tenth, 0 to 16."""
    if not math.isfinite(part):
        return 0.0
    return round(min(max(-math.log10(max(part, 1e-16)), 0.0), 16.0) + 0.0, 1)


def _why_not(card: Card, level: float) -> list[str]:
    """Everything that keeps an answer from passing a level."""
    found, why = card.impacts, []
    if found["expected"] and found["matched"] is None:
        why.append("impacts not judged")
    if found["missed"] or found["extra"]:
        wrong = f"{found['missed']} missed, {found['extra']} extra"
        why.append(f"of {found['expected']} impacts {wrong}")
    if card.penetration > level + 1e-12:
        why.append(f"penetrates by {card.penetration:.1e} of the largest displacement")
    judged = [q for q in card.deviations if ".t_" not in q.quantity.name]
    off = [q for q in judged if q.error > level + q.floor]
    if off:
        worst = max(off, key=lambda q: q.error - q.floor)
        more = f", and {len(off) - 1} more" if off[1:] else ""
        why.append(f"{worst.quantity.name} off by {worst.error:.1e} of its scale{more}")
    if (found["largest_shift"] or 0.0) > level:
        shift = found["largest_shift"] * UNIT_OF_TIME
        why.append(f"an impact comes {shift:.1e} of the run off")
    if card.energy is not None and card.energy > max(level, CREATED):
        why.append(f"{card.energy:.1e} of the energy comes from nowhere")
    if not judged:
        why.append("nothing could be judged")
    missing = [what.partition(":")[0] for what in card.not_judged if what.startswith("peaks")]
    return why + [f"{what} not judged" for what in missing]


def card_text(card: Card) -> str:
    """A card as lines of text."""
    lines = [("problem", card.problem), ("passed", card.passed or "no level")]
    for level, why in card.levels.items():
        lines.append((f"  {level}", f"{LEVELS[level]:<7g}{why or 'passed'}"))
    for group, digits in card.digits.items():
        said = "not judged" if digits is None else f"{digits:.1f} digits"
        worst = card.worst.get(group)
        lines.append((group, f"{said}{f', fewest at {worst}' if worst else ''}"))
    if card.impacts["matched"] is not None:
        lines.append(("", _counted(card.impacts)))
    lines += [("restitution", said) for said in _restitution_words(card)]
    lines += [(f"{kind}s", said) for kind, said in event_words(card).items()]
    lines.append(("penetration", f"{card.penetration:.1e} of the largest displacement"))
    if card.energy is not None:
        lines.append(("energy", f"{card.energy:.1e} of the largest from nowhere"))
    if card.seconds is not None:
        lines.append(("time", f"{card.seconds:.3g} s"))
    lines += [("not judged", what) for what in card.not_judged]
    return "".join(f"{head:<15}{said}\n" for head, said in lines)


def _restitution_words(card: Card) -> list[str]:
    """The impact whose effective restitution is the most wrong."""
    keys = ("restitution", "restitution_found")
    fastest = max((r["speed"] or 0.0 for r in card.impact_rows), default=0.0)
    known = [
        r
        for r in card.impact_rows
        if None not in (r[keys[0]], r[keys[1]]) and r["speed"] > COUNTED * fastest
    ]
    if not known:
        return []
    worst = max(known, key=lambda r: abs(r[keys[0]] - r[keys[1]]))
    return [
        f"{worst[keys[1]]:.3g} in the rows where it is {worst[keys[0]]:.3g}, "
        f"{worst['contact']} at {worst['t']:.4g} s, furthest off"
    ]


def event_words(card: Card) -> dict[str, str]:
    """What is said of events beside impacts, by kinds, where any are expected or found."""
    said = {}
    for kind, found in card.events.items():
        if found["matched"] is None:
            if found["expected"]:
                said[kind] = f"{found['expected']} expected, not reported"
        elif found["expected"] or found["extra"]:
            shift = found["largest_shift"]
            digits = "" if shift is None else f", {digits_of(shift):.1f} digits"
            said[kind] = _counted(found) + digits
    return said


def _counted(found: dict[str, Any]) -> str:
    words = ("expected", "matched", "missed", "extra")
    return ", ".join(f"{found[word]} {word}" for word in words)
