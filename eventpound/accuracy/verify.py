"""Certify a case: run independent routes, compare, change the inputs, bound every number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from eventpound.accuracy.attainment import ambiguities
from eventpound.accuracy.bound import Agreement, Bounds, Limit, bounds_of
from eventpound.accuracy.certificate import (
    FEWEST_DIGITS,
    SENSITIVE,
    Certificate,
    CertifiedQuantity,
    PartedRoute,
    RouteReport,
)
from eventpound.accuracy.conditioning import Conditioning, conditioning
from eventpound.accuracy.digits import DigitsOverTime, digits_over_time, positions
from eventpound.accuracy.near_misses import grazes, near_misses
from eventpound.accuracy.quantities import Quantity, quantities_of, values_of
from eventpound.accuracy.routes import (
    TIGHTEST,
    RouteRun,
    routes_of,
    run_route,
    shared_code,
    solve,
)
from eventpound.accuracy.sequences import Matching, match_events
from eventpound.case.case import Case
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import assemble
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.simulation import LARGEST_RTOL, SMALLEST_RTOL, options_of, task_with
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.recorder import ROUNDING
from eventpound.solvers.events.scales import scene_scales

SAMPLES = 2000
"""Intervals at which motions are compared and searched for turning points."""

Report = Callable[[str], None]


class _Found(NamedTuple):
    """Runs of the routes that finished, quantities, values and matchings."""

    runs: list[RouteRun]
    reference: int
    wanted: list[Quantity]
    agreement: Agreement
    matchings: list[Matching]

    @property
    def stated(self) -> Recording:
        """The run the values are of."""
        return _tight(self.runs[self.reference])


def certify(
    case: Case | Scene,
    rtol: float = TIGHTEST,
    *,
    duration: float | None = None,
    report: Report | None = None,
) -> Certificate:
    """Certify every peak, event and final value of a case.

    Parameters
    ----------
    case : Case or Scene
        What moves. The tolerance and solver of a case play no part.
    rtol : float
        Tolerance of the most accurate routes.
    duration : float, optional
        Length of the run (s), instead of the case's own.
    report : callable, optional
        Told what is done next, a line each time.

    Returns
    -------
    Certificate
        Refusals, too, are in it: nothing that routes disagree on is certified.

    Raises
    ------
    InputError
        Where the scene or the tolerance cannot be run.
    """
    if not SMALLEST_RTOL <= rtol <= LARGEST_RTOL:
        raise InputError(f"rtol = {rtol:g}; accepted: {SMALLEST_RTOL:g} to {LARGEST_RTOL:g}")
    say = report or (lambda _: None)
    task = _task(case, duration)
    routes = routes_of(task.scene, rtol)
    runs = []
    for route in routes:
        say(f"{route.label} at rtol {route.tight:g} and {route.loose:g}")
        runs.append(run_route(route, task))
    reports = tuple(
        RouteReport(
            r.route.label, r.route.solver, r.route.formulation,
            (r.route.tight, r.route.loose), r.message,
        )
        for r in runs
    )  # fmt: skip
    title = case.title if isinstance(case, Case) else "scene"
    finished = [run for run in runs if run.tight is not None and run.loose is not None]
    if not finished:
        return _nothing(title, reports)
    found = _compare(task, finished)
    say("the inputs changed in their last digits")
    conditions = _conditioning(task, found)
    return _certificate(title, task, reports, found, conditions)


def _task(case: Case | Scene, duration: float | None) -> Task:
    run, options = options_of(case, duration, None, False)
    scene = case.scene if isinstance(case, Case) else case
    run = replace(run, output_step=run.duration / SAMPLES)
    return task_with(scene, run, replace(options, name="fast", settings={}, atol={}), None)


def _tight(run: RouteRun) -> Recording:
    assert run.tight is not None
    return run.tight


def _loose(run: RouteRun) -> Recording:
    assert run.loose is not None
    return run.loose


def _compare(task: Task, runs: list[RouteRun]) -> _Found:
    """Values of all routes, with the route as reference that its tolerance moves least."""
    reference = min(range(len(runs)), key=lambda r: _restlessness(task, runs[r]))
    stated = _tight(runs[reference])
    wanted = quantities_of(task.scene, stated, task.end - task.start)
    contacts = len(task.scene.contacts)
    matchings = [match_events(stated.events, _tight(run).events, contacts) for run in runs]
    looser = [match_events(stated.events, _loose(run).events, contacts) for run in runs]
    agreement = Agreement(
        np.array(
            [
                values_of(task.scene, _tight(run), wanted, matching.pairs)
                for run, matching in zip(runs, matchings, strict=True)
            ]
        ),
        np.array(
            [
                values_of(task.scene, _loose(run), wanted, matching.pairs)
                for run, matching in zip(runs, looser, strict=True)
            ]
        ),
        [run.route.formulation for run in runs],
        reference,
        looser[reference].touches,
    )
    return _Found(runs, reference, wanted, agreement, matchings)


def _restlessness(task: Task, run: RouteRun) -> float:
    """By how much the tolerance moves the motion (m), at the quieter quarter of the times.

    Once routes part at a graze, those that agree there by chance look the calmest; so the
    rest of the motion decides.
    """
    times = task.output_times
    moved = positions(_tight(run).history, times) - positions(_loose(run).history, times)
    return float(np.quantile(np.max(np.abs(moved), axis=1), 0.25))


def _conditioning(task: Task, found: _Found) -> Conditioning | None:
    """How the reference route answers to changed inputs; None where it fails.

    It is run at a tolerance below the smaller changes, whatever the others are run at.
    """
    route, stated = found.runs[found.reference].route, found.stated
    rtol = min(route.tight, TIGHTEST)
    contacts = len(task.scene.contacts)

    def measure(scene: Scene) -> tuple[Floats, Floats]:
        known = scene is task.scene and rtol == route.tight
        recording = stated if known else solve(route, replace(task, scene=scene), rtol)
        rows = match_events(stated.events, recording.events, contacts).pairs
        values = values_of(scene, recording, found.wanted, rows)
        return values, positions(recording.history, task.output_times)

    try:
        return conditioning(task.scene, measure)
    except ComputationError:
        return None


def _nothing(title: str, reports: tuple[RouteReport, ...]) -> Certificate:
    return Certificate(
        title, reports, {}, False, "", (), (), (), (), None, None, ("no route finished",)
    )


def _certificate(
    title: str,
    task: Task,
    reports: tuple[RouteReport, ...],
    found: _Found,
    conditions: Conditioning | None,
) -> Certificate:
    stated, route = found.stated, found.runs[found.reference].route
    warnings = [f"{r.label} failed: {r.message}" for r in reports if r.message]
    if conditions is None:
        warnings.append("a scene with changed inputs failed: the conditioning is not known")
        n = len(found.wanted)
        conditions = Conditioning(
            np.full(n, np.nan), np.full(n, np.nan), np.ones(n, np.bool_),
            np.zeros(task.output_times.size),
        )  # fmt: skip
    quantities = _quantities(task, found, conditions)
    parting = _parting(task, found)
    digits = _digits(task, found, conditions)
    values = [q for q in quantities if _is_value(q.quantity)]
    certificate = Certificate(
        case=title,
        solver_routes=reports,
        shared_code=shared_code(tuple(run.route for run in found.runs)),
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


def _is_value(name: str) -> bool:
    """Whether a quantity is a peak or a final value."""
    return not name.startswith("events.") and ".t_" not in name


def _quantities(
    task: Task, found: _Found, conditions: Conditioning
) -> tuple[CertifiedQuantity, ...]:
    scale = np.array([quantity.scale for quantity in found.wanted])
    bounds = bounds_of(found.agreement, conditions, scale, found.stated.work.steps)
    _widen_times(task, found, bounds)
    certified = []
    for i, quantity in enumerate(found.wanted):
        bound, slope = float(bounds.bound[i]), float(conditions.largest_slope[i])
        confirmed = float(bounds.confirmed[i])
        width = bound if np.isfinite(bound) else confirmed
        digits = _digits_of(width / quantity.scale)
        holds = bool(np.isfinite(bound)) and digits >= FEWEST_DIGITS
        certified.append(
            CertifiedQuantity(
                quantity.name,
                float(found.agreement.values[i]),
                bound if holds else None,
                quantity.unit,
                digits,
                holds,
                bounds.limit[i],
                slope / quantity.scale if np.isfinite(slope) else None,
                quantity.scale,
                confirmed if np.isfinite(confirmed) else None,
            )
        )
    return tuple(certified)


def _digits_of(part: float) -> float:
    """Decimal digits that an error of this part of the scale leaves, to a tenth, 0 to 16."""
    if not np.isfinite(part):
        return 0.0
    return round(float(np.clip(-np.log10(max(part, 1e-16)), 0.0, 16.0)), 1)


def _widen_times(task: Task, found: _Found, bounds: Bounds) -> None:
    """Add to the bounds of peaks and their times what rival turning points make uncertain.

    An extreme that exceeds an earlier one by the rounding of the recorder does not count.
    """
    place = {quantity.name: i for i, quantity in enumerate(found.wanted)}
    names = [body.name for body in task.scene.bodies]
    values = np.array(
        [[bounds.bound[place[f"peaks.{name}.{key}"]] for name in names] for key in ("max", "min")]
    )
    scales = scene_scales(task.scene, assemble(task.scene), task.end - task.start)
    apart = ambiguities(
        task.scene,
        found.stated.history,
        found.stated.displacement,
        np.nan_to_num(values),
        scales.length,
    )
    for side, key in enumerate(("t_max", "t_min")):
        for i, name in enumerate(names):
            k = place[f"peaks.{name}.{key}"]
            if apart[side, i] > bounds.bound[k]:
                bounds.limit[k] = Limit.RIVALS
            bounds.bound[k] += apart[side, i]
            if apart[side, i] > 0.0:
                bounds.bound[place[f"peaks.{name}.{key[2:]}"]] += ROUNDING * scales.length


def _parting(task: Task, found: _Found) -> PartedRoute | None:
    parted = [
        PartedRoute.of(run.route.label, m.parting, task.scene.contacts[m.parting.contact].name)
        for run, m in zip(found.runs, found.matchings, strict=True)
        if m.parting is not None
    ]
    return min(parted, key=lambda parting: parting.t, default=None)


def _digits(task: Task, found: _Found, conditions: Conditioning) -> DigitsOverTime:
    times = task.output_times
    independent = found.agreement.independent
    return digits_over_time(
        times,
        positions(found.stated.history, times),
        positions(_loose(found.runs[found.reference]).history, times),
        [
            positions(_tight(run).history, times)
            for run, other in zip(found.runs, independent, strict=True)
            if other
        ],
        conditions.growth,
    )


def _events(task: Task, stated: Recording) -> tuple[dict[str, object], ...]:
    names = [contact.name for contact in task.scene.contacts]
    return tuple(
        {"row": row, "t": e.t, "kind": e.kind.value, "contact": names[e.contact]}
        for row, e in enumerate(stated.events)
    )


def _warnings(certificate: Certificate) -> list[str]:
    warnings = []
    if len({r.formulation for r in certificate.solver_routes if not r.message}) < 2:
        warnings.append("fewer than two independent formulations: nothing is certified")
    largest = certificate.largest_amplification
    if largest >= SENSITIVE:
        worst = max(certificate.quantities, key=lambda q: q.amplification or 0.0)
        warnings.append(
            f"ill-conditioned: {worst.quantity} changes by {largest:.1e} times "
            "a relative change of the inputs"
        )
    return warnings
