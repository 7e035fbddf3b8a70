"""What independent routes found for one task, quantity by quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eventpound.accuracy.bound import Agreement
from eventpound.accuracy.digits import positions
from eventpound.accuracy.quantities import OF_IMPACTS, quantities_at, values_by_name
from eventpound.accuracy.routes import Route, RouteRun
from eventpound.accuracy.sequences import KINDS, first_parting, touches, weights_for
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.score.difference import Difference, Truth, difference
from eventpound.score.levels import UNIT_OF_TIME
from eventpound.score.pairing import Pair
from eventpound.solvers.base import Recording, Task


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


def from_truth(truth: Truth, scene: Scene, run: Recording, moments: Sequence[float]) -> Difference:
    """How far a run is from the one that is stated, its events paired with that one's."""
    return difference(truth, values_by_name(scene, run, moments), run.events, KINDS)


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
