"""What independent routes found for one task, quantity by quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eventpound.accuracy.bound import Agreement
from eventpound.accuracy.digits import positions
from eventpound.accuracy.quantities import in_order, quantities_of, values_of
from eventpound.accuracy.routes import REFERENCE, RouteRun
from eventpound.accuracy.sequences import Matching, match_events
from eventpound.numerics.arrays import Floats
from eventpound.score import ScaledValue
from eventpound.solvers.base import Recording, Task

AS_GOOD = 1e-14
"""Part of the largest displacement below which rounding moves a motion, not the tolerance."""


class RoutesCompared(NamedTuple):
    """Runs of one task by several routes.

    runs: of the routes that finished. reference: the one whose tight values are stated.
    wanted: quantities. agreement: their values. matchings: of the events of every tight
    run with those of the reference.
    """

    runs: list[RouteRun]
    reference: int
    wanted: list[ScaledValue]
    agreement: Agreement
    matchings: list[Matching]

    @property
    def parted_from(self) -> float:
        """When routes part first (s), inf where they never do."""
        times = [m.parting.t for m in self.matchings if m.parting is not None]
        return min(times, default=np.inf)

    @property
    def stated(self) -> Recording:
        """The run the values are of."""
        return self.runs[self.reference].tight


def compare_routes(
    task: Task, runs: list[RouteRun], moments: Sequence[float] = ()
) -> RoutesCompared:
    """Values of all routes, those stated of the route that its tolerance moves least.

    That of the reference solver is, where only rounding moves either.
    """
    moved = [_restlessness(task, run) for run in runs]
    reference = min(range(len(runs)), key=moved.__getitem__)
    largest = float(np.abs(runs[reference].tight.history.u).max(initial=0.0))
    for r, run in enumerate(runs):
        if run.route.label == REFERENCE and moved[r] <= AS_GOOD * largest:
            reference = r
    stated = runs[reference].tight
    wanted = quantities_of(task, stated, moments, events=True)
    contacts = len(task.scene.contacts)

    def valued(recordings: list[Recording]) -> tuple[Floats, list[Matching]]:
        matched = [match_events(stated.events, found.events, contacts) for found in recordings]
        values = [
            in_order(wanted, values_of(task.scene, found, moments, matching.pairs))
            for found, matching in zip(recordings, matched, strict=True)
        ]
        return np.array(values), matched

    tight, matchings = valued([run.tight for run in runs])
    loose, looser = valued([run.loose for run in runs])
    agreement = Agreement(
        tight,
        loose,
        [run.route.formulation for run in runs],
        reference,
        looser[reference].touches,
        any(matching.parting is not None for matching in matchings),
    )
    return RoutesCompared(runs, reference, wanted, agreement, matchings)


def _restlessness(task: Task, run: RouteRun) -> float:
    """By how much the tolerance moves the motion (m), at the quieter quarter of the times.

    Once routes part at a graze, those that agree there by chance look the calmest; so the
    rest of the motion decides.
    """
    times = task.output_times
    moved = positions(run.tight.history, times) - positions(run.loose.history, times)
    return float(np.quantile(np.max(np.abs(moved), axis=1), 0.25))
