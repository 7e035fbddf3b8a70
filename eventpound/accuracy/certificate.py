"""What is certified of a case, what is not, and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from eventpound.accuracy.bound import Limit
from eventpound.accuracy.digits import DigitsOverTime
from eventpound.accuracy.near_misses import Graze, NearMiss

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
