"""Ways to compute one scene that share as little as they can.

A *formulation* is a system of equations and the integrator that carries it; routes
of one formulation differ in method or coordinates. Only routes of different
formulations are independent of each other. Right after an event CVODE and IDA give way to one
local series; where neither comes to a step, all their routes are of one formulation. Of a scene
that only CVODE takes, the routes of its two methods stand for two formulations, which share the
equations of motion; a certificate says so. Every route is run at two tolerances, `Route.loose` =
ten times `Route.tight`.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from eventpound.errors import ComputationError, InputError
from eventpound.motion.base import Family
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Slider
from eventpound.solvers import available, knows_scene
from eventpound.solvers.base import Recording, Task

TIGHTEST = 1e-13
"""Relative tolerance at which rounding and the tolerance weigh about the same."""
STEP = 10.0
"""Ratio of the two tolerances of a route."""
LOOSEST = 1e-4
"""A route is not run at a larger tolerance than this."""


@dataclass(frozen=True, slots=True)
class Route:
    """One way to compute a scene.

    Parameters
    ----------
    label : str
        What it is called in a certificate.
    solver : str
        Name of the solver.
    formulation : str
        What is integrated, and how.
    tight : float
        The smaller one of its two tolerances.
    settings : mapping
        Settings of the solver.
    """

    label: str
    solver: str
    formulation: str
    tight: float
    settings: Mapping[str, object] = field(default_factory=dict)

    @property
    def finds_events(self) -> bool:
        """Whether SUNDIALS' root finder finds its events."""
        return self.settings.get("events") == "sundials"

    @property
    def loose(self) -> float:
        """The larger one of its two tolerances."""
        return self.tight * STEP


@dataclass(frozen=True)
class RouteRun:
    """A route and its runs at both tolerances."""

    route: Route
    tight: Recording
    loose: Recording


@dataclass(frozen=True, slots=True)
class RouteFailure:
    """A route that failed, and what it said."""

    route: Route
    message: str


TAYLOR = "Taylor series, plain Bouc-Wen laws eliminated"
MULTISTEP = "linear multistep methods, hysteresis in rate form"
ALGEBRAIC = "differential-algebraic system, contact forces unknown"
LOCAL = "Taylor series after events, hysteresis in rate form"
"""What a run of either comes to in which no step of SUNDIALS was taken."""
BY_METHOD = {method: f"{MULTISTEP}, {method}" for method in ("Adams", "BDF")}
"""Formulations of the routes of a scene that only CVODE takes."""
REFERENCE = "cvode Adams"
"""Label of the route of the reference solver."""

# Label, solver, formulation, decades by which the tolerance is larger (a method of low order
# takes ten times the steps at the tightest one), settings; the last group under records only.
# Two of them find their events by the root finder of SUNDIALS instead of our location.
_WAYS: tuple[tuple[str, str, str, int, Mapping[str, object]], ...] = (
    ("fast", "fast", TAYLOR, 0, {}),
    (REFERENCE, "cvode", MULTISTEP, 0, {"method": "Adams"}),
    ("cvode BDF, SUNDIALS' roots", "cvode", MULTISTEP, 1, {"method": "BDF", "events": "sundials"}),
    ("ida", "ida", ALGEBRAIC, 1, {"events": "sundials"}),
)
_UNDER_RECORDS: tuple[tuple[str, str, str, int, Mapping[str, object]], ...] = (
    ("cvode Adams, relative", "cvode", MULTISTEP, 0, {"coordinates": "relative"}),
)

_LOOP = frozenset((MULTISTEP, ALGEBRAIC, LOCAL, *BY_METHOD.values()))
_ALL = _LOOP | {TAYLOR}

LOCATION = "eventpound.solvers.events.location"
"""The module that a route with its own root finder uses for extremes only, and right after events,
where local series carry the motion."""

_EVENTS, _MECHANICS = "eventpound.solvers.events", "eventpound.mechanics"
_CONTACT = "eventpound.contact"
SHARED: tuple[tuple[str, str, frozenset[str]], ...] = (
    ("eventpound.motion.forcing", "the ground acceleration and its breakpoints", _ALL),
    (f"{_MECHANICS}.model", "the scene as arrays", _ALL),
    (f"{_MECHANICS}.elements", "the laws of springs", _ALL),
    (f"{_MECHANICS}.link_law", "the constants of these laws", _ALL),
    ("eventpound.scene.elastic_laws", "elastic laws in series condensed to one", _ALL),
    (f"{_MECHANICS}.impact", "the impact law over all closed contacts", _ALL),
    (f"{_MECHANICS}.contact_problem", "accelerations over resting contacts", _ALL),
    (f"{_MECHANICS}.clusters", "bodies at rest on each other, uniqueness of forces", _ALL),
    (f"{_MECHANICS}.series", "derivatives of the motion, by which rests are decided", _ALL),
    ("eventpound.numerics.lcp", "linear complementarity problems", _ALL),
    ("eventpound.numerics.polynomial", "first roots of polynomials", _ALL),
    (f"{_CONTACT}.modes", "what follows from what happens at a contact", _ALL),
    (f"{_CONTACT}.instant", "what an instant demands, and what belongs to one", _ALL),
    (f"{_CONTACT}.kinks", "on which side of its kink a link is", _ALL),
    (f"{_CONTACT}.impacts", "impacts of one instant, one after the other", _ALL),
    (f"{_CONTACT}.cascade", "where cascades of impacts end", _ALL),
    (f"{_CONTACT}.rest", "which resting contacts open", _ALL),
    (f"{_CONTACT}.rounding", "what of an acceleration is rounding, not a reason to open", _ALL),
    ("eventpound.tolerances", "what is rounding, and what one instant", _ALL),
    (f"{_EVENTS}.scales", "scales of the motion, tolerances of each body", _ALL),
    (f"{_EVENTS}.event_bounds", "what counts as a new extreme", _ALL),
    (f"{_MECHANICS}.monitored", "which extremes are recorded", _ALL),
    (f"{_EVENTS}.loop", "the loop over segments and instants", _LOOP),
    (f"{_EVENTS}.instant", "steps by series from instant to instant", _LOOP),
    (f"{_EVENTS}.short_series", "the series that carry the motion after events", _LOOP),
    (LOCATION, "location of events and extremes in a step", _LOOP),
    ("eventpound.solvers.sundials.loop", "the loop over the steps of SUNDIALS", _LOOP - {LOCAL}),
    (f"{_MECHANICS}.observables", "forces, powers and friction that a state has", _LOOP),
)
"""Module, what it does, and the formulations that run through it."""
SHARED_AT_POINTS = {
    f"{_MECHANICS}.followers": "what follows from what at points, forces of contacts there"
}
"""What routes of a scene with ends at points between bodies share besides."""
SHARED_WITH_LAWS = {
    f"{_MECHANICS}.contact_laws": "contact laws and their constants",
    f"{_MECHANICS}.contact_elements": "contact laws as links of the scene",
    f"{_EVENTS}.law_contacts": "what is told of contacts with a law",
}
"""What those share besides whose contacts have laws of their own."""
SHARED_WITH_SLIDERS = {
    "eventpound.contact.sliders": "which sliders stick, and which way others slip",
    "eventpound.numerics.box": "the forces of what may stick or rest",
}
"""What those of a scene with sliders share besides."""
SHARED_WITH_FRICTION = {
    "eventpound.contact.friction": "impacts with friction, and which contacts slip or stick",
    "eventpound.contact.poisson": "impacts by Poisson's law, where it is asked for",
    "eventpound.contact.rubbing": "what is known and kept of contacts with friction",
    "eventpound.numerics.coulomb": "forces and states of contacts with friction",
    f"{_MECHANICS}.oblique": "how what slips moves",
}
"""What those of a scene share besides in which contacts have friction."""
SHARED_WITH_LOADS = {
    "eventpound.motion.loads": "forces and motions of supports at a time",
    "eventpound.motion.travel": "displacements of supports from their accelerations",
    "eventpound.solvers.supported": "supports taken in and out of a scene",
}
"""What those share besides that have supports or forces, or are in plan."""


SHARED_BY_METHODS = {
    f"{_MECHANICS}.reduced": "the equations of motion",
    f"{_EVENTS}.reversals": "reversals at which steps end",
    "eventpound.solvers.sundials.compiled_cvode": "how a step of CVODE is taken",
}
"""What the methods of one solver share besides."""


def routes_of(scene: Scene, rtol: float = TIGHTEST) -> tuple[Route, ...]:
    """Routes of a scene, by the solvers there are.

    Parameters
    ----------
    scene : Scene
        What is to be computed.
    rtol : float
        Tolerance of the most accurate ones.
    """
    sampled = any(piece.family is Family.SAMPLES for piece in scene.motion.pieces())
    known = available()
    found = tuple(
        Route(label, solver, formulation, min(rtol * STEP**decades, LOOSEST / STEP), settings)
        for label, solver, formulation, decades, settings in (
            _WAYS + _UNDER_RECORDS if sampled else _WAYS
        )
        if solver in known and knows_scene(known[solver], scene)
    )
    if any(route.solver != "cvode" for route in found):
        return found
    methods = [BY_METHOD[str(route.settings.get("method", "Adams"))] for route in found]
    return tuple(replace(r, formulation=own) for r, own in zip(found, methods, strict=True))


def left_out(scene: Scene) -> list[str]:
    """Solvers that could be another route, but do not take every contact of a scene."""
    known = available()
    solvers = dict.fromkeys(solver for _, solver, *_ in _WAYS)
    return [s for s in solvers if s in known and not knows_scene(known[s], scene)]


def shared_code(routes: tuple[Route, ...], scene: Scene) -> dict[str, str]:
    """Code that routes of more than one formulation run through, and what it does."""
    used = {route.formulation for route in routes}
    if len(used) < 2:
        return {}
    shared = {module: what for module, what, formulations in SHARED if len(formulations & used) > 1}
    if used <= set(BY_METHOD.values()):
        shared |= SHARED_BY_METHODS
    if scene.at_points:
        shared |= SHARED_AT_POINTS
    if any(contact.law is not None for contact in scene.contacts):
        shared |= SHARED_WITH_LAWS
    if any(isinstance(spring.law, Slider) for spring in scene.springs):
        shared |= SHARED_WITH_SLIDERS
    if scene.rubbing:
        shared |= SHARED_WITH_FRICTION
    if scene.is_driven:
        shared |= SHARED_WITH_LOADS
    found = " and ".join(repr(route.label) for route in routes if route.finds_events)
    if LOCATION in shared and found:
        shared[LOCATION] += f", but for the events of {found}, which SUNDIALS' root finder finds"
    return shared


def run_route(route: Route, task: Task, patience: float) -> RouteRun | RouteFailure:
    """Run a route at both tolerances; a failure of either is returned as its message.

    A run that takes longer than `patience` (s) is a failure.
    """
    recordings = []
    for rtol in (route.tight, route.loose):
        try:
            recordings.append(solve(route, task, rtol, patience))
        except (ComputationError, InputError) as error:
            # An integrator that this installation lacks is an error of the input, too.
            return RouteFailure(route, f"rtol {rtol:g}: {error}")
    if all(recording.integrated == 0.0 for recording in recordings):
        route = replace(route, formulation=LOCAL)
    return RouteRun(route, recordings[0], recordings[1])


def solve(route: Route, task: Task, rtol: float, patience: float) -> Recording:
    """One run of a route.

    Raises
    ------
    ComputationError
        Where it fails or takes longer than `patience` (s).
    """
    began = time.monotonic()

    def progress(t: float) -> None:
        if time.monotonic() - began > patience:
            raise ComputationError(f"the run takes longer than {patience:g} s", t)

    return available()[route.solver].solve(
        replace(task, rtol=rtol, atol={}, energy=False, settings=route.settings, progress=progress)
    )
