"""Certificates of random scenes held against the oracle, bound by bound."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from eventpound.accuracy.certificate import Certificate, CertifiedQuantity
from eventpound.accuracy.routes import TIGHTEST
from eventpound.accuracy.verify import verify
from eventpound.scene import Scene
from tests.oracle.program import Answer, NoAnswerError, Number, ask
from tests.solvers.random_scenes import random_scene

PATIENCE = 10.0
"""Wall time of one run of a route, and of the oracle (s)."""
SURE = 0.1
"""Part of a bound that the oracle's own uncertainty may be."""
NEAR = 1e-6
"""Part of a run by which an event may be off in the oracle's list."""
SAME = 1e-3
"""Relative difference of closing speeds from which two impacts are not the same."""
KEYS = {"gap_velocity_before": "before", "gap_velocity_after": "after"}


@dataclass(frozen=True)
class Wrong:
    """A bound that does not hold: where, and by how much (in its unit)."""

    seed: int
    quantity: str
    error: float
    bound: float


@dataclass
class Tally:
    """What came of all scenes so far."""

    scenes: Counter[str] = field(default_factory=Counter)
    silent: Counter[str] = field(default_factory=Counter)
    bounds: Counter[str] = field(default_factory=Counter)
    wrong: list[Wrong] = field(default_factory=list)
    largest: float = 0.0
    largest_of: str = ""

    def text(self) -> str:
        """The counts, a line each."""
        lines = [
            "scenes: " + _counts(self.scenes),
            "oracle silent: " + (_counts(self.silent) or "never"),
            "bounds: " + _counts(self.bounds),
            f"exceeded: {len(self.wrong)}; "
            f"largest error/bound: {self.largest:.3g} ({self.largest_of})",
        ]
        return "\n".join(lines)


def _counts(words: Counter[str]) -> str:
    return ", ".join(f"{number} {word}" for word, number in words.most_common())


def judge(seed: int, tally: Tally, rtol: float = TIGHTEST) -> None:
    """Certify the scene of a seed and hold every bound against the oracle."""
    scene, end = random_scene(seed)
    tally.scenes["drawn"] += 1
    try:
        answer = ask(scene, 0.0, end, PATIENCE)
    except NoAnswerError as reason:
        tally.silent[str(reason)] += 1
        return
    certificate = verify(scene, rtol, duration=end, patience=PATIENCE)
    tally.scenes["given" if certificate.certified else "refused"] += 1
    hold(seed, scene, certificate, answer, end, tally)


def hold(
    seed: int, scene: Scene, certificate: Certificate, answer: Answer, end: float, tally: Tally
) -> None:
    """Count the bounds of a certificate that hold, and those that do not."""
    for quantity, true in _pairs(scene, certificate, answer, end, tally):
        bound = quantity.bound
        assert bound is not None
        if true.uncertainty > SURE * bound:
            tally.bounds["oracle unsure"] += 1
            continue
        tally.bounds["checked"] += 1
        error = true.distance(quantity.value)
        ratio = error / bound if error > 0.0 else 0.0
        if ratio > tally.largest:
            tally.largest, tally.largest_of = ratio, f"{seed}: {quantity.quantity}"
        if error > bound + true.uncertainty:
            tally.wrong.append(Wrong(seed, quantity.quantity, error, bound))


def _pairs(
    scene: Scene, certificate: Certificate, answer: Answer, end: float, tally: Tally
) -> Iterator[tuple[CertifiedQuantity, Number]]:
    """Every quantity with a bound that the oracle has, too."""
    of_events = {}
    ends = _ends_of_collapses(scene, certificate)
    for entry in certificate.events:
        head = f"events.{entry['row']}"
        of_events[head] = {} if head in ends else _event(scene, dict(entry), answer, end)
    for quantity in certificate.quantities:
        if quantity.bound is None:
            tally.bounds["refused"] += 1
            continue
        head, _, key = quantity.quantity.rpartition(".")
        known = of_events.get(head, answer.values)
        name = KEYS.get(key, key) if head in of_events else quantity.quantity
        if name in known:
            yield quantity, known[name]
        else:
            tally.bounds["without partner"] += 1


def _ends_of_collapses(scene: Scene, certificate: Certificate) -> set[str]:
    """Rows of impact problems that stand for infinitely many.

    A collapse ends in one problem of several contacts in the very instant of its last impact, or
    in a plastic impact at a contact that is not. The oracle follows the intervals farther
    before it does the same, so none of its own impacts is this one.
    """
    known = {quantity.quantity: quantity.value for quantity in certificate.quantities}
    restitution = {contact.name: contact.restitution for contact in scene.contacts}
    sizes = Counter(entry["group"] for entry in certificate.events)
    groups, instants = set(), set()
    for entry in certificate.events:
        head, group, t = f"events.{entry['row']}", entry["group"], entry["t"]
        before = float(str(entry["gap_velocity_before"]))
        plastic = known.get(f"{head}.gap_velocity_after") == 0.0 != before
        again = any(t == time and group != other for time, other in instants)
        if (plastic and restitution[str(entry["contact"])] > 0.0) or (again and sizes[group] > 1):
            groups.add(group)
        if entry["kind"] == "impact":
            instants.add((t, group))
    return {f"events.{e['row']}" for e in certificate.events if e["group"] in groups}


def _event(scene: Scene, entry: dict[str, object], answer: Answer, end: float) -> dict[str, Number]:
    """Numbers of the oracle's event that is a row of a certificate; none where it has none.

    It is the one of its kind and contact within `NEAR` and, of impacts, with its closing speed.
    Where there are several, as at the end of a cascade, nobody knows which one it is.
    """
    t, speed = float(str(entry["t"])), float(str(entry["gap_velocity_before"]))
    if entry["kind"] == "accumulation" and speed == 0.0:
        return {}  # The soft impacts at a contact that rests all along, gathered: no limit.
    near = [
        event
        for event in answer.events
        if event.kind == entry["kind"]
        and scene.contacts[event.contact].name == entry["contact"]
        and abs(event.t - t) <= NEAR * end
        and (
            event.kind != "impact"
            or abs(float(event.numbers["before"].value) - speed) <= SAME * abs(speed)
        )
    ]
    return dict(near[0].numbers) if len(near) == 1 else {}
