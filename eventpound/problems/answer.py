"""The answer of a problem: certified numbers with bounds and conditioning, and its events.

    columns     quantity, value, bound, amplification, scale
    events      kind, contact, t, bound of t, rates of the gap before and after (m/s)

as a certificate has them (page "accuracy" of the docs): peaks and their times, final values,
``history.<k>.<body>`` at the `MOMENTS` - 1 moments k T/`MOMENTS` of a run of length T. A
number without a bound is no part of the answer; of impacts only those faster than `LISTED`
of the fastest are, since slower ones are told apart by rounding.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from eventpound.accuracy.certificate import Certificate, CertifiedQuantity
from eventpound.accuracy.verify import PATIENCE, Report, verify
from eventpound.case.run_options import RunOptions
from eventpound.mechanics.model import assemble
from eventpound.problems.collection import Collection, ProblemFolder
from eventpound.score.levels import LISTED
from eventpound.solvers.base import EventKind

MOMENTS = 40
"""Equal parts of a run at whose borders displacements are stated."""
COLUMNS = ("quantity", "value", "bound", "amplification", "scale")
EVENT_COLUMNS = ("kind", "contact", "t", "t_bound", "before", "after")


def moments_of(run: RunOptions) -> list[float]:
    """The times (s) at which a history is stated, the ends of the run not among them."""
    return [run.start_time + run.duration * k / MOMENTS for k in range(1, MOMENTS)]


def answer_of(
    collection: Collection,
    problem: ProblemFolder,
    *,
    patience: float = PATIENCE,
    report: Report | None = None,
) -> tuple[dict[str, object], Certificate]:
    """Certify a problem.

    Parameters
    ----------
    collection : Collection
        The set.
    problem : ProblemFolder
        One of it.
    patience : float
        Wall time (s) after which a run of a route is given up.
    report : callable, optional
        Told what is done next.

    Returns
    -------
    answer : dict
        The content of its ``answer.json``.
    certificate : Certificate
        What it is from.
    """
    case = problem.case()
    moments = moments_of(case.run)
    certificate = verify(case, moments=moments, patience=patience, report=report)
    bounded = [q for q in certificate.quantities if q.bound is not None]
    known = {q.quantity: q for q in certificate.quantities}
    states = [q for q in bounded if not q.quantity.startswith("events.")]
    events = _events(certificate, known)
    model = assemble(case.scene)
    answer: dict[str, object] = {
        "set": f"{collection.name} {collection.version}",
        "problem": problem.name,
        "certified": certificate.certified,
        "independent": None,
        "reference": certificate.reference,
        "routes": [route.label for route in certificate.solver_routes if not route.message],
        "properties": {
            "bodies": model.bodies,
            "contacts": model.contacts,
            "events": dict(Counter(str(event[0]) for event in events)),
            "amplification": _rounded(max((q.amplification or 0.0 for q in states), default=0.0)),
            "near_misses": len(certificate.near_misses),
            "grazes": len(certificate.grazes),
        },
        "moments": moments,
        "columns": COLUMNS,
        "quantities": [
            [q.quantity, q.value, _rounded(q.bound), _rounded(q.amplification), q.scale]
            for q in states
        ],
        "event_columns": EVENT_COLUMNS,
        "events": events,
    }
    return answer, certificate


def _events(certificate: Certificate, known: dict[str, CertifiedQuantity]) -> list[list[object]]:
    """Events in order, slow impacts left out; a bound of None where there is none."""
    impact = EventKind.IMPACT.value
    speeds = [-float(str(e["gap_velocity_before"])) for e in certificate.events]
    fastest = max(
        (s for s, e in zip(speeds, certificate.events, strict=True) if e["kind"] == impact),
        default=0.0,
    )
    listed: list[list[object]] = []
    for speed, event in zip(speeds, certificate.events, strict=True):
        if event["kind"] == impact and speed <= LISTED * fastest:
            continue
        head = f"events.{event['row']}"
        t = known.get(f"{head}.t")
        after = known.get(f"{head}.gap_velocity_after")
        listed.append(
            [
                event["kind"],
                event["contact"],
                event["t"],
                None if t is None else _rounded(t.bound),
                event["gap_velocity_before"],
                None if after is None else after.value,
            ]
        )
    return listed


def _rounded(value: float | None) -> float | None:
    """Two digits, never less than the value."""
    if value is None or not np.isfinite(value):
        return None
    return float(f"{1.05 * value:.1e}")
