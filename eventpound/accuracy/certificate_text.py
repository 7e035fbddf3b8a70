"""A certificate to be read, and its two files."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterator, Sequence

from eventpound.accuracy.bound import decade
from eventpound.accuracy.certificate import Certificate, CertifiedQuantity, RouteReport
from eventpound.results import write_together
from eventpound.results.jsontext import to_json

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
        {
            TEXT: certificate_text(certificate).encode(),
            JSON: to_json(certificate.as_dict()),
        },
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
    yield (
        f"{'quantity':<32} {'value':>24} {'bound':>9} {'unit':<4} {'digits':>6} "
        f"{'amplified':>9} {'of':<11} {'by cvode':>24} limited by"
    )
    listed = [q for q in c.quantities if not q.quantity.startswith("events.")]
    times = [q for q in c.quantities if q.quantity.startswith("events.") and q.unit == "s"]
    kinds = {f"events.{event['row']}.t": event for event in c.events}
    for quantity in listed:
        yield _row(quantity)
    for quantity in times[:MOST_ROWS]:
        event = kinds[quantity.quantity]
        yield f"{_row(quantity)}; {event['kind']} {event['contact']}"
    if len(times) > MOST_ROWS:
        yield f"and {len(times) - MOST_ROWS} more events"


def _row(q: CertifiedQuantity) -> str:
    bound = "refused" if q.bound is None else f"{q.bound:.1e}"
    amplified = "" if q.amplification is None else f"{q.amplification:.1e}"
    by_reference = "" if q.by_reference is None else significant(q.by_reference, q.bound)
    return (
        f"{q.quantity:<32} {significant(q.value, q.bound):>24} {bound:>9} {q.unit:<4} "
        f"{q.digits:>6.1f} {amplified:>9} {q.route.partition(',')[0]:<11} {by_reference:>24} "
        f"{q.limited_by}"
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
    yield f"{'up to (s)':>12} {'digits':>7} {'amplification':>14}"
    for k in range(0, digits.t.size, max(1, digits.t.size // 10)):
        yield f"{digits.t[k]:>12.6g} {digits.digits[k]:>7.1f} {digits.amplification[k]:>14.1e}"
    if digits.lost_from is not None:
        yield f"three digits and more are lost from {digits.lost_from:.6g} s on"


def _code(c: Certificate) -> Iterator[str]:
    if c.shared_code:
        yield "what follows is shared by independent routes and not checked by their agreement:"
    for module, what in c.shared_code.items():
        yield f"  {module}: {what}"
