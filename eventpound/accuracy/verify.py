"""Certify a case: run independent routes, compare, change the inputs, bound every number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.accuracy.certificate import SENSITIVE, Certificate, PartedRoute, RouteReport
from eventpound.accuracy.certified_quantities import (
    RoutesCompared,
    certified_quantities,
    compare_routes,
    from_truth,
    in_order,
)
from eventpound.accuracy.conditioning import Conditioning, conditioning
from eventpound.accuracy.digits import DigitsOverTime, digits_over_time, positions
from eventpound.accuracy.near_misses import grazes, near_misses
from eventpound.accuracy.quantities import MOST_EVENTS, scales_of_task
from eventpound.accuracy.routes import (
    TIGHTEST,
    RouteFailure,
    RouteRun,
    left_out,
    routes_of,
    run_route,
    shared_code,
    solve,
)
from eventpound.accuracy.sequences import instead_of
from eventpound.basics.given import checked, number, positive
from eventpound.case.case import Case, case_of
from eventpound.case.run_options import Way, warn_left_out
from eventpound.case.solver_options import rtol_problems
from eventpound.errors import ComputationError, InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.simulation import check_case, options_of, task_with
from eventpound.solvers.base import Recording, Task
from eventpound.units import Dimension

SAMPLES = 2000
"""Intervals at which motions are compared and searched for turning points."""

INTERRUPTED = "interrupted"
"""What is said of a route that was not done at Ctrl-C."""

PATIENCE = 600.0
"""Wall time (s) after which a run is given up, if nothing else is said."""

Report = Callable[[str], None]


class CertificateInterrupted(KeyboardInterrupt):
    """Ctrl-C in `verify`.

    Parameters
    ----------
    certificate : Certificate
        Of the routes that were done: refused, and marked by a warning.
    """

    def __init__(self, certificate: Certificate) -> None:
        self.certificate = certificate
        super().__init__("interrupted")


@checked
def verify(
    case: Case | Scene,
    rtol: float | str = TIGHTEST,
    *,
    duration: float | str | None = None,
    moments: Sequence[float | str] = (),
    patience: float | str = PATIENCE,
    report: Report | None = None,
) -> Certificate:
    """Certify every peak, event and final value of a case.

    Parameters
    ----------
    case : Case or Scene
        What moves. The tolerance and solver of a case play no part, nor the quantities that it
        names.
    rtol : float
        Tolerance of the most accurate routes.
    duration : float, optional
        Length of the run (s), instead of the case's own.
    moments : sequence of float, optional
        Times (s) within the run at which displacements are certified, too.
    patience : float
        Wall time (s) after which a run is given up; its route is listed as failed.
    report : callable, optional
        Told what is done next, a line each time.

    Returns
    -------
    Certificate
        Numbers on which routes disagree are in it, too, as refused.

    Raises
    ------
    InputError
        Where the scene or the tolerance cannot be run.
    CertificateInterrupted
        After Ctrl-C, where a route was done by then.
    """
    tolerance = number("rtol", rtol, Dimension.NUMBER)
    if problems := rtol_problems(tolerance):
        raise InputError(problems)
    patience = positive("patience", patience, Dimension.TIME)
    case = case_of(case)
    title = case.title or "scene"
    check_case(case)
    say = report or (lambda _: None)
    warn_left_out(case.run, Way.VERIFY)
    task = _task(case, duration)
    times = [number("moments", t, Dimension.TIME) for t in moments]
    if outside := [t for t in times if not task.start <= t <= task.end]:
        raise InputError(
            f"moments: found {outside[0]:g} s; accepted: times of the run, "
            f"{task.start:g} to {task.end:g} s"
        )
    task = replace(task, output_times=np.union1d(task.output_times, times))
    routes = routes_of(task.scene, tolerance)
    runs: list[RouteRun | RouteFailure] = []
    try:
        for route in routes:
            say(f"{route.label} at rtol {route.tight:g} and {route.loose:g}")
            runs.append(run_route(route, task, patience))
        finished = [run for run in runs if isinstance(run, RouteRun)]
        if not finished:
            nothing: Any = {}, False, "", (), (), (), (), None, None, ("no route finished",)
            return Certificate(title, _reported(task, runs), *nothing)
        found = compare_routes(task, finished, times)
        say("the inputs changed in their last digits")
        conditions = _conditioning(task, found, times, patience)
    except KeyboardInterrupt:
        finished = [run for run in runs if isinstance(run, RouteRun)]
        if not finished:
            raise
        missing = [RouteFailure(route, INTERRUPTED) for route in routes[len(runs) :]]
        reports, done = _reported(task, [*runs, *missing]), compare_routes(task, finished)
        kept = _refused(_certificate(title, task, reports, done, None))
        raise CertificateInterrupted(kept) from None
    return _certificate(title, task, _reported(task, runs), found, conditions)


def _refused(certificate: Certificate) -> Certificate:
    """Of what was done before Ctrl-C."""
    # Without the changed inputs no bound is known to hold.
    refused = tuple(replace(q, bound=None, certified=False) for q in certificate.quantities)
    warnings = ("interrupted: nothing is certified", *certificate.warnings)
    return replace(certificate, certified=False, quantities=refused, warnings=warnings)


def _reported(task: Task, runs: Sequence[RouteRun | RouteFailure]) -> tuple[RouteReport, ...]:
    """What is said of every route."""
    reports = []
    for run in runs:
        route, message, share = run.route, "", None
        if isinstance(run, RouteFailure):
            message = run.message
        elif run.tight.integrated is not None:
            share = run.tight.integrated / (task.end - task.start)
        tolerances = (route.tight, route.loose)
        given = route.label, route.solver, route.formulation, tolerances, message
        reports.append(RouteReport(*given, share))
    return tuple(reports)


def _task(case: Case, duration: float | str | None) -> Task:
    run, options = options_of(case, duration=duration, energy=False)
    run = run.lasting(run.duration, run.duration / SAMPLES)
    return task_with(case.scene, run, replace(options, name="cvode", settings={}, atol={}), None)


def _conditioning(
    task: Task, found: RoutesCompared, moments: Sequence[float], patience: float
) -> Conditioning | None:
    """How the reference route answers to changed inputs; None where it fails.

    It is run at a tolerance below the smaller changes, whatever the others are run at.
    """
    route, stated = found.runs[found.reference].route, found.stated
    rtol = min(route.tight, TIGHTEST)

    def measure(scene: Scene) -> tuple[Floats, Floats]:
        known = scene is task.scene and rtol == route.tight
        recording = stated if known else solve(route, replace(task, scene=scene), rtol, patience)
        values = in_order(found.truth, from_truth(found.truth, scene, recording, moments))
        return values, positions(recording.history, task.output_times)

    try:
        return conditioning(task.scene, measure)
    except ComputationError:
        return None


def _certificate(
    title: str,
    task: Task,
    reports: tuple[RouteReport, ...],
    found: RoutesCompared,
    conditions: Conditioning | None,
) -> Certificate:
    stated, route = found.stated, found.runs[found.reference].route
    warnings = [f"{r.label} failed: {r.message}" for r in reports if r.message]
    if left := left_out(task.scene):
        warnings.append(
            f"left out: {' and '.join(left)}, which do{'es' if len(left) == 1 else ''} not take "
            "every contact of the scene"
        )
        if all(run.route.solver == "cvode" for run in found.runs):
            warnings[-1] += (
                "; the routes are methods of cvode, and what they share no other program confirms"
            )
    if conditions is None:
        warnings.append("runs with changed inputs failed: how inputs come through is not known")
        unknown = np.full(len(found.truth.quantities), np.nan)
        conditions = Conditioning(unknown, unknown, unknown == 0.0, 0.0 * task.output_times)
    quantities = certified_quantities(task, found, conditions)
    parting = _parting(task, found)
    digits = _digits(task, found, conditions)
    values = [q for q in quantities if q.is_value]
    certificate = Certificate(
        case=title,
        solver_routes=reports,
        shared_code=shared_code(tuple(run.route for run in found.runs), task.scene),
        certified=parting is None and all(q.certified for q in values),
        reference=f"{route.label} at rtol {route.tight:g}",
        quantities=quantities,
        events=_events(task, stated),
        near_misses=near_misses(task.scene, stated),
        grazes=grazes(task.scene, stated),
        parting=parting,
        digits_over_time=digits,
        warnings=(),
    )
    return replace(certificate, warnings=tuple(warnings + _warnings(certificate)))


def _parting(task: Task, found: RoutesCompared) -> PartedRoute | None:
    first = min(found.partings, key=lambda parting: parting[1].t, default=None)
    if first is None:
        return None
    route, pair, other = first
    kind = (pair.reference or pair.found).kind.value
    name = task.scene.contacts[pair.contact].name
    return PartedRoute(route.label, pair.t, name, kind, instead_of(pair, other.events))


def _digits(task: Task, found: RoutesCompared, conditions: Conditioning) -> DigitsOverTime:
    times = task.output_times
    independent = found.agreement.independent
    return digits_over_time(
        times,
        positions(found.stated.history, times),
        positions(found.runs[found.reference].loose.history, times),
        [
            positions(run.tight.history, times)
            for run, other in zip(found.runs, independent, strict=True)
            if other
        ],
        conditions.growth,
        scales_of_task(task).length,
    )


def _events(task: Task, stated: Recording) -> tuple[dict[str, object], ...]:
    names = [contact.name for contact in task.scene.contacts]
    return tuple(
        {
            "row": row,
            "t": e.t,
            "kind": e.kind.value,
            "group": e.group,
            "contact": names[e.contact],
            "gap_velocity_before": e.gap_velocity_before,
        }
        for row, e in enumerate(stated.events)
    )


def _warnings(certificate: Certificate) -> list[str]:
    warnings = []
    if len({r.formulation for r in certificate.solver_routes if not r.message}) < 2:
        warnings.append("fewer than two independent formulations: nothing is certified")
    if len(certificate.events) > MOST_EVENTS:
        warnings.append(f"bounds are stated for the first {MOST_EVENTS} events only")
    largest = certificate.largest_amplification
    if largest >= SENSITIVE:
        worst = max(certificate.quantities, key=lambda q: q.amplification or 0.0)
        warnings.append(
            f"ill-conditioned: {worst.quantity} changes by {largest:.1e} times "
            "a relative change of the inputs"
        )
    return warnings
