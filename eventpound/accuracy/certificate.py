"""What is certified of a case, what is not and why; as text and as two files."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields

from eventpound.accuracy.bound import Limit, decade
from eventpound.accuracy.digits import DigitsOverTime
from eventpound.accuracy.near_misses import Graze, NearMiss
from eventpound.results import write_together
from eventpound.results.jsontext import to_json
from eventpound.results.tables import aligned

FEWEST_DIGITS = 4.0
"""Digits below which a value is refused."""
SENSITIVE = 1e5
"""Amplification from which a case is said to be ill-conditioned."""


@dataclass(frozen=True, slots=True)
class CertifiedQuantity:
    """A number with its bound, or the reason why it has none.

    Parameters
    ----------
    quantity : str
        As in ``summary.json`` and, of events, by the row in ``events.csv``.
    value : float
        What `route` found, in `unit`.
    bound : float or None
        The true value is within this distance; None where it is refused.
    unit : str
        SI; empty for a pure number.
    digits : float
        ``-log10(bound/scale)``; the digits on which routes agree where it is refused.
    certified : bool
        Whether there is a bound.
    limited_by : Limit
        The largest part of the bound, or the reason of the refusal.
    amplification : float or None
        Relative change (of its scale) for a relative change of the inputs.
    scale : float
        What the digits are counted from, in `unit`.
    confirmed : float or None
        Distance of the nearest independent route, in `unit`.
    route : str
        Label of the route that the value is of: the reference solver's where it is as good.
    by_reference : float or None
        What CVODE, the reference solver, found, where `value` is another's and it lies within
        the bound.
    """

    quantity: str
    value: float
    bound: float | None
    unit: str
    digits: float
    certified: bool
    limited_by: Limit
    amplification: float | None
    scale: float
    confirmed: float | None
    route: str
    by_reference: float | None = None

    @property
    def is_value(self) -> bool:
        """Whether it is a peak or a final value: no time, no event, no moment of the history."""
        return self.quantity.startswith(("peaks.", "final.")) and ".t_" not in self.quantity


@dataclass(frozen=True, slots=True)
class RouteReport:
    """A route of a certificate.

    Parameters
    ----------
    label, solver, formulation : str
        What it is.
    tolerances : tuple of float
        At which it ran, tight and loose.
    message : str
        Why it failed, empty where it did not.
    sundials : float or None
        Share of the run that an integrator of SUNDIALS carried, 0 to 1, local series after events
        the rest; None of other solvers.
    """

    label: str
    solver: str
    formulation: str
    tolerances: tuple[float, float]
    message: str
    sundials: float | None = None


@dataclass(frozen=True, slots=True)
class PartedRoute:
    """The first event that one route has and another has not, and the route that parts there.

    Parameters
    ----------
    route : str
        Its label.
    t : float
        Time of the event (s).
    contact : str
        Where it is.
    found : str
        Its kind.
    instead : str
        The kind of what the other run has in its place; "nothing" where there is none.
    """

    route: str
    t: float
    contact: str
    found: str
    instead: str


@dataclass(frozen=True)
class Certificate:
    """Everything that was found out about the accuracy of a case.

    Parameters
    ----------
    case : str
        Its title.
    solver_routes : tuple of RouteReport
        The routes, those that failed too.
    shared_code : mapping of str to str
        Modules that independent routes have in common, and what they do.
    certified : bool
        Whether the routes agree on the sequence of events and every peak and
        final value is certified.
    reference : str
        The route and tolerance that is stated: of events, and of the values that are not the
        reference solver's.
    quantities : tuple of CertifiedQuantity
        Peaks, final values, events.
    events : tuple of mapping
        Row, time (s), kind, group, contact and rate of the gap before (m/s) of the
        events of that route.
    near_misses, grazes : tuple
        Where a small error makes or unmakes an event.
    parting : PartedRoute or None
        The first event at which routes part.
    digits_over_time : DigitsOverTime or None
        Of the displacements.
    warnings : tuple of str
        What a reader should know.
    """

    case: str
    solver_routes: tuple[RouteReport, ...]
    shared_code: Mapping[str, str]
    certified: bool
    reference: str
    quantities: tuple[CertifiedQuantity, ...]
    events: tuple[Mapping[str, object], ...]
    near_misses: tuple[NearMiss, ...]
    grazes: tuple[Graze, ...]
    parting: PartedRoute | None
    digits_over_time: DigitsOverTime | None
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        digits = [q.digits for q in self.quantities if q.certified]
        worst = f", the worst to {min(digits):g} digits" if digits else ""
        return f"<Certificate: {len(digits)} of {len(self.quantities)} numbers hold{worst}>"

    @property
    def refused(self) -> tuple[CertifiedQuantity, ...]:
        """Quantities without a bound."""
        return tuple(quantity for quantity in self.quantities if not quantity.certified)

    @property
    def largest_amplification(self) -> float:
        """Of all quantities, events included."""
        found = [q.amplification for q in self.quantities if q.amplification is not None]
        return max(found, default=0.0)

    def as_dict(self) -> dict[str, object]:
        """The content of ``certificate.json``."""
        content: dict[str, object] = {
            field.name: getattr(self, field.name) for field in fields(self)
        }
        for name in ("solver_routes", "quantities", "near_misses", "grazes"):
            content[name] = [asdict(entry) for entry in getattr(self, name)]
        content["parting"] = None if self.parting is None else asdict(self.parting)
        digits = self.digits_over_time
        content["digits_over_time"] = None if digits is None else asdict(digits)
        return content


JSON, TEXT = "certificate.json", "certificate.txt"
MOST_ROWS = 200
"""Event times in the table; every one is in the JSON file."""


def write_certificate(certificate: Certificate, directory: str | os.PathLike[str]) -> None:
    """Write ``certificate.json`` and ``certificate.txt``, both or none.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    write_together(
        directory,
        {TEXT: certificate_text(certificate).encode(), JSON: to_json(certificate.as_dict())},
    )


def certificate_text(certificate: Certificate) -> str:
    """A certificate as lines of text."""
    parts = (_head, _table, _doubts, _over_time, _code)
    return (
        "\n\n".join("\n".join(lines) for part in parts if (lines := list(part(certificate)))) + "\n"
    )


def sentence(certificate: Certificate) -> str:
    """What a certificate comes to, in a sentence."""
    digits = [q.digits for q in certificate.quantities if q.certified]
    return digits_words(digits, len(certificate.quantities))


def digits_words(digits: Sequence[float], of: int) -> str:
    """How many numbers are certified, from the digits of those that are, and to how many digits."""
    if not digits:
        return "no number is certified"
    count = f"all {of}" if len(digits) == of else f"{len(digits)} of {of}"
    return f"{count} numbers hold to {math.floor(10.0 * min(digits)) / 10.0:g} digits or more"


def _head(c: Certificate) -> Iterator[str]:
    yield f"case        {c.case}"
    yield f"certificate {'given' if c.certified else 'REFUSED'}"
    if c.reference:
        count = len(c.quantities) - len(c.refused)
        routes = Counter(q.route for q in c.quantities)
        of = ", ".join(f"{number} of {label}" for label, number in routes.most_common())
        yield f"values      {of}; {count} of {len(c.quantities)} certified"
        yield f"events      of {c.reference}"
    for route in c.solver_routes:
        tight, loose = route.tolerances
        ended = f"failed: {route.message}" if route.message else route.formulation + _shares(route)
        yield f"route       {route.label}, rtol {tight:g} and {loose:g}: {ended}"
    for warning in c.warnings:
        yield f"warning     {warning}"


def _shares(route: RouteReport) -> str:
    """Who carried a run of SUNDIALS for how much of its time."""
    if route.sundials is None:
        return ""
    percent = 100.0 * route.sundials
    name = route.solver.upper()
    return (
        f"; {percent:.3g} % of the time by {name}, {100.0 - percent:.3g} % by series after events"
    )


def _table(c: Certificate) -> Iterator[str]:
    if not c.quantities:
        return
    listed = [q for q in c.quantities if not q.quantity.startswith("events.")]
    times = [q for q in c.quantities if q.quantity.startswith("events.") and q.unit == "s"]
    kinds = {f"events.{event['row']}.t": event for event in c.events}
    rows = [(*_cells(q), str(q.limited_by)) for q in listed]
    for q in times[:MOST_ROWS]:
        event = kinds[q.quantity]
        rows.append((*_cells(q), f"{q.limited_by}; {event['kind']} {event['contact']}"))
    heads = ("quantity", "value", "bound", "unit", "digits", "amplified", "of", "by cvode")
    yield aligned((*heads, "limited by"), rows, {0, 3, 6, 8})
    if len(times) > MOST_ROWS:
        yield f"and {len(times) - MOST_ROWS} more events"


def _cells(q: CertifiedQuantity) -> tuple[str, ...]:
    """A line of the table, but for what limits the bound."""
    return (
        q.quantity,
        significant(q.value, q.bound),
        "refused" if q.bound is None else f"{q.bound:.1e}",
        q.unit,
        f"{q.digits:.1f}",
        "" if q.amplification is None else f"{q.amplification:.1e}",
        q.route.partition(",")[0],
        "" if q.by_reference is None else significant(q.by_reference, q.bound),
    )


def significant(value: float, bound: float | None) -> str:
    """A value with the decimals that its bound leaves, one uncertain digit included."""
    if bound is None or bound <= 0.0:
        return f"{value:.6g}"
    return f"{value:.{min(max(0, -decade(bound)), 20)}f}"


def _doubts(c: Certificate) -> Iterator[str]:
    for miss in c.near_misses:
        yield f"near miss   {miss.contact}: {miss.gap:.3g} m left at {miss.t:.6f} s"
    for graze in c.grazes:
        yield f"graze       {graze.contact}: closed with {graze.closing_speed:.3g} m/s " + (
            f"at {graze.t:.6f} s"
        )
    if c.parting is not None:
        p = c.parting
        yield f"routes part at {p.t:.9g} s, contact {p.contact}: {p.found} in one, {p.instead} " + (
            f"in the other ({p.route})"
        )


def _over_time(c: Certificate) -> Iterator[str]:
    digits = c.digits_over_time
    if digits is None:
        return
    columns = zip(digits.t, digits.digits, digits.amplification, strict=True)
    lines = [(f"{t:.6g}", f"{n:.1f}", f"{size:.1e}") for t, n, size in columns]
    rows = lines[:: max(1, len(lines) // 10)]
    yield aligned(("up to (s)", "digits", "amplification"), rows, ())
    if digits.lost_from is not None:
        yield f"three digits and more are lost from {digits.lost_from:.6g} s on"


def _code(c: Certificate) -> Iterator[str]:
    if c.shared_code:
        yield "what follows is shared by independent routes and not checked by their agreement:"
    for module, what in c.shared_code.items():
        yield f"  {module}: {what}"
