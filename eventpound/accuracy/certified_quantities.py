"""Every quantity of a comparison with its bound, or with the reason why it has none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eventpound.accuracy.agreement import RoutesCompared
from eventpound.accuracy.attainment import ambiguities
from eventpound.accuracy.bound import ErrorBounds, Limit, bounds_of, decade
from eventpound.accuracy.certificate import FEWEST_DIGITS, CertifiedQuantity
from eventpound.accuracy.conditioning import Conditioning
from eventpound.accuracy.left_out import displaced, time_to_limits
from eventpound.accuracy.quantities import row_of, scales_of_task
from eventpound.accuracy.routes import REFERENCE
from eventpound.score.card import digits_of
from eventpound.solvers.base import Task
from eventpound.tolerances import ATTAINED_ANEW


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
