"""Every quantity of a comparison: what routes agree on, with its bound, or the reason for none.

Two turning points that are higher than the other by less than either may be wrong
cannot be told apart: the true first attainment may be at any of them, however well
each is located. Its time is then uncertain by their distance, while the peak itself
is not. A body held back by a barrier, directly or through a row of closed contacts,
cannot go farther than the gaps add up to; later touches of that limit do not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from eventpound.accuracy.bound import Agreement, ErrorBounds, Limit, bounds_of, decade
from eventpound.accuracy.certificate import FEWEST_DIGITS, CertifiedQuantity
from eventpound.accuracy.conditioning import Conditioning
from eventpound.accuracy.digits import positions
from eventpound.accuracy.left_out import displaced, time_to_limits
from eventpound.accuracy.near_misses import Turn, largest_turns
from eventpound.accuracy.quantities import (
    OF_IMPACTS,
    quantities_at,
    row_of,
    scales_of_task,
    values_by_name,
)
from eventpound.accuracy.routes import REFERENCE, Route, RouteRun
from eventpound.accuracy.sequences import KINDS, first_parting, touches, weights_for
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER
from eventpound.scene.scene import Scene
from eventpound.score.card import digits_of
from eventpound.score.difference import Difference, Truth, difference
from eventpound.score.levels import UNIT_OF_TIME
from eventpound.score.pairing import Pair
from eventpound.solvers.base import Extremes, History, Recording, Task
from eventpound.solvers.supported import relative_accelerations
from eventpound.tolerances import ATTAINED_ANEW


class RoutesCompared(NamedTuple):
    """Runs of one task by several routes.

    runs: of the routes that finished. reference: the one whose tight run is stated.
    truth: that run, as the others are held against it. agreement: values of its quantities.
    differences: of every tight run from it.
    """

    runs: list[RouteRun]
    reference: int
    truth: Truth
    agreement: Agreement
    differences: list[Difference]

    @property
    def partings(self) -> list[tuple[Route, Pair, Difference]]:
        """The first event that a route has and the reference has not, or the other way round."""
        each = ((run.route, found) for run, found in zip(self.runs, self.differences, strict=True))
        return [
            (route, pair, found)
            for route, found in each
            for pair in [*first_parting(found.events).values()][:1]
        ]

    @property
    def parted_from(self) -> float:
        """When routes part first (s), inf where they never do."""
        return min((pair.t for _, pair, _ in self.partings), default=np.inf)

    @property
    def stated(self) -> Recording:
        """The run that is stated."""
        return self.runs[self.reference].tight


def compare_routes(
    task: Task, runs: list[RouteRun], moments: Sequence[float] = ()
) -> RoutesCompared:
    """Values of all routes; stated is the route that its tolerance moves least."""
    moved = [_restlessness(task, run) for run in runs]
    reference = min(range(len(runs)), key=moved.__getitem__)
    stated = runs[reference].tight
    truth = Truth(
        quantities_at(task, stated, moments, events=True),
        stated.events,
        UNIT_OF_TIME * (task.end - task.start),
        weights=weights_for(),
        of_events=("t", *OF_IMPACTS),
    )
    tight, loose = (
        [from_truth(truth, task.scene, run, moments) for run in which]
        for which in ([run.tight for run in runs], [run.loose for run in runs])
    )
    agreement = Agreement(
        np.array([in_order(truth, found) for found in tight]),
        np.array([in_order(truth, found) for found in loose]),
        [run.route.formulation for run in runs],
        reference,
        touches(loose[reference].events, stated.events, runs[reference].loose.events),
        any(found.events.alone for found in tight),
    )
    return RoutesCompared(runs, reference, truth, agreement, tight)


def from_truth(
    truth: Truth, scene: Scene, recording: Recording, moments: Sequence[float]
) -> Difference:
    """How far a run is from the one that is stated, its events paired with that one's."""
    return difference(truth, values_by_name(scene, recording, moments), recording.events, KINDS)


def in_order(truth: Truth, found: Difference) -> Floats:
    """Values of a run in the order of the quantities, NaN for what it has not; shape (n,)."""
    values = {deviation.quantity.name: deviation.value for deviation in found.quantities}
    return np.array([values.get(quantity.name, np.nan) for quantity in truth.quantities])


def _restlessness(task: Task, run: RouteRun) -> float:
    """By how much the tolerance moves the motion (m), at the quieter quarter of the times.

    Once routes part at a graze, those that agree there by chance look the calmest; so the
    rest of the motion decides.
    """
    times = task.output_times
    moved = positions(run.tight.history, times) - positions(run.loose.history, times)
    return float(np.quantile(np.max(np.abs(moved), axis=1), 0.25))


INTERPOLATION = 1e-11
"""Part of its range by which a peak between two samples may be misjudged."""
ULPS = 64.0
"""Roundings by which a body at a limit may be off it."""


@dataclass(frozen=True)
class Reach:
    """How far bodies can go, and what holds them there.

    Parameters
    ----------
    reach : ndarray, shape (N,)
        Displacement that no body can exceed (m); inf where nothing holds it.
    chain : tuple of list
        For every body the contacts that are all closed when it is there.
    """

    reach: Floats
    chain: tuple[list[int], ...]


def limits_of(scene: Scene, sign: float) -> Reach:
    """Reach of the displacements to one side.

    Parameters
    ----------
    scene : Scene
        With its gaps.
    sign : float
        1 to the right, -1 to the left; then displacements are those to the left.
    """
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    # A support that moves is no limit.
    moving = {support.name for support in scene.supports}
    reach = np.full(len(scene.bodies), np.inf)
    chain: list[list[int]] = [[] for _ in scene.bodies]
    for _ in scene.bodies:
        for j, contact in enumerate(scene.contacts):
            if contact.at_point:
                # It holds no body by itself.
                continue
            ends = contact.ends if sign > 0.0 else contact.ends[::-1]
            if ends[0] == BARRIER or moving & {*ends}:
                continue
            held, holder = index[ends[0]], index.get(ends[1])
            beyond = 0.0 if holder is None else reach[holder]
            if contact.gap + beyond < reach[held]:
                reach[held] = contact.gap + beyond
                chain[held] = [j, *([] if holder is None else chain[holder])]
    return Reach(reach, tuple(chain))


def ambiguities(
    scene: Scene, history: History, extremes: Extremes, bounds: Floats, length: float
) -> Floats:
    """How far from the stated time the first attainment of each peak may be.

    Parameters
    ----------
    scene : Scene
        What moved.
    history : History
        Samples, dense enough that a turning point lies between two.
    extremes : Extremes
        Of the displacements.
    bounds : ndarray, shape (2, N)
        Error bounds of the largest and the smallest displacement (m).
    length : float
        L of the scene (m), for the rounding by which an extreme counts as exceeded.

    Returns
    -------
    ndarray, shape (2, N)
        Times (s); zero where no other turning point comes near.
    """
    apart, acceleration = np.zeros((2, len(scene.bodies))), relative_accelerations(scene, history)
    for side, sign in enumerate((1.0, -1.0)):
        limits = limits_of(scene, sign)
        peaks = sign * (extremes.minimum if side else extremes.maximum)
        times = extremes.time_of_minimum if side else extremes.time_of_maximum
        for i in range(len(scene.bodies)):
            x = sign * history.u[:, i]
            near = 2.0 * (bounds[side, i] + ATTAINED_ANEW * length)
            near += INTERPOLATION * float(np.ptp(x))
            turns = largest_turns(
                history.t, x, sign * history.v[:, i], sign * acceleration[:, i], peaks[i] - near
            )
            rivals = _until_held(_others(turns, history, times[i]), history, limits, i, x)
            apart[side, i] = max((abs(turn.t - times[i]) for turn in rivals), default=0.0)
    return apart


def _others(turns: list[Turn], history: History, t: float) -> list[Turn]:
    """Turning points but the one between the two samples that hold the time of the peak."""
    times = history.t
    return [
        turn
        for turn in turns
        if not (turn.between and times[turn.sample] <= t <= times[turn.sample + 1])
    ]


def _until_held(
    turns: list[Turn], history: History, limits: Reach, body: int, x: Floats
) -> list[Turn]:
    """Turning points up to the first at which the body is held at its limit, that one included.

    A row of bodies comes to its limit by ever smaller impacts; it is there only when all
    the gaps are closed at once.
    """
    reach, chain = limits.reach[body], limits.chain[body]
    if not np.isfinite(reach):
        return turns
    rounding = ULPS * np.finfo(float).eps * (abs(reach) + float(np.ptp(x)))
    kept = []
    for turn in turns:
        kept.append(turn)
        closed = not turn.between and not np.any(history.gap[turn.sample, chain])
        if closed and turn.value >= reach - rounding:
            break
    return kept


def certified_quantities(
    task: Task, found: RoutesCompared, conditions: Conditioning
) -> tuple[CertifiedQuantity, ...]:
    """Bound every quantity, and print the reference solver's value where it is as good.

    Parameters
    ----------
    task : Task
        What was computed.
    found : RoutesCompared
        What the routes found.
    conditions : Conditioning
        What changed inputs do.
    """
    scale = np.array([quantity.scale for quantity in found.truth.quantities])
    run = found.stated
    bounds = bounds_of(found.agreement, conditions, scale, displaced(run, task.scene))
    _widen_times(task, found, bounds)
    _widen_limits(found, bounds)
    _refuse_after_parting(found, bounds)
    stated, labels = found.agreement, [run.route.label for run in found.runs]
    place = labels.index(REFERENCE) if REFERENCE in labels else found.reference
    reference = replace(stated, reference=place)
    certified = []
    for i, quantity in enumerate(found.truth.quantities):
        bound, slope = float(bounds.bound[i]), float(conditions.largest_slope[i])
        apart = abs(float(reference.values[i] - stated.values[i]))
        good = is_as_good(apart, bound, 10.0**-FEWEST_DIGITS * quantity.scale)
        printed = reference if good else stated
        bound += apart if good else 0.0
        confirmed = float(printed.confirmed[i])
        width = bound if np.isfinite(bound) else confirmed
        digits = digits_of(width / quantity.scale)
        holds = bool(np.isfinite(bound)) and digits >= FEWEST_DIGITS
        certified.append(
            CertifiedQuantity(
                quantity.name,
                float(printed.values[i]),
                bound if holds else None,
                quantity.unit,
                digits,
                holds,
                bounds.limit[i],
                slope / quantity.scale if np.isfinite(slope) else None,
                quantity.scale,
                confirmed if np.isfinite(confirmed) else None,
                labels[printed.reference],
                float(reference.values[i]) if holds and not good and apart <= bound else None,
            )
        )
    return tuple(certified)


def is_as_good(apart: float, bound: float, most: float) -> bool:
    """Whether a value is printed in the place of one that has a bound, so far from it.

    It errs by at most `bound` + `apart`. It has to be within the bound, leave as many decimals and
    not be refused, as it is beyond `most`.
    """
    if apart == 0.0:
        return True
    return apart <= bound and bound + apart <= most and decade(bound + apart) == decade(bound)


def _widen_limits(found: RoutesCompared, bounds: ErrorBounds) -> None:
    """Add to the times of a cascade's end what is left of it there, the same by every route."""
    events = found.stated.events
    later = time_to_limits(events)
    for i, quantity in enumerate(found.truth.quantities):
        if quantity.name.endswith(".t"):
            bounds.bound[i] += later.get(events[row_of(quantity)].t, 0.0)


def _refuse_after_parting(found: RoutesCompared, bounds: ErrorBounds) -> None:
    """Take away the bounds of events from the first parting on: what follows may not be paired."""
    events = found.stated.events
    for i, quantity in enumerate(found.truth.quantities):
        row = row_of(quantity)
        if row >= 0 and events[row].t >= found.parted_from:
            bounds.bound[i] = np.nan
            bounds.limit[i] = Limit.PARTED


def _widen_times(task: Task, found: RoutesCompared, bounds: ErrorBounds) -> None:
    """Add to the bounds of peaks and their times what rival turning points make uncertain.

    An extreme that exceeds an earlier one by the rounding of the recorder does not count.
    """
    place = {quantity.name: i for i, quantity in enumerate(found.truth.quantities)}
    names = [body.name for body in task.scene.bodies]
    values = np.array(
        [[bounds.bound[place[f"peaks.{name}.{key}"]] for name in names] for key in ("max", "min")]
    )
    length = scales_of_task(task).length
    stated = found.stated
    apart = ambiguities(
        task.scene, stated.history, stated.displacement, np.nan_to_num(values), length
    )
    for side, key in enumerate(("t_max", "t_min")):
        for i, name in enumerate(names):
            k = place[f"peaks.{name}.{key}"]
            if apart[side, i] > bounds.bound[k]:
                bounds.limit[k] = Limit.RIVALS
            bounds.bound[k] += apart[side, i]
            if apart[side, i] > 0.0:
                bounds.bound[place[f"peaks.{name}.{key[2:]}"]] += ATTAINED_ANEW * length
