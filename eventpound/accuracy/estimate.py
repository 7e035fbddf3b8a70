"""A quick estimate of the errors of one run: its distance from a finer one.

The finer run is that of the fast solver two decades below the tolerance, so that for any
other solver it is independent of the one it judges. An estimate is no bound: it says
nothing about conditioning, and two runs may agree by chance. `verify` gives bounds.

Where a quantity is off by more than `DOUBTFUL` of its scale, or `TIMES` rtol, or where the
runs do not see the same events, there is a warning: then the tolerance does not tell them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.accuracy.errors import motion_scales, value_scales
from eventpound.accuracy.quantities import values_of_state
from eventpound.accuracy.sequences import BRIEF, Matching, lasting_rows, match_events
from eventpound.errors import ComputationError
from eventpound.mechanics.model import assemble
from eventpound.numerics.arrays import Floats
from eventpound.response import Response
from eventpound.scene.periods import local_periods
from eventpound.simulation import SMALLEST_RTOL
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind, Recording, Task
from eventpound.solvers.events.recorder import resting_times
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.kept import kernels_kept

FINER = 100.0
"""Ratio of the tolerances."""
JUDGE = "fast"
"""The solver of the finer run."""
JUDGED = ("cvode", "ida")
"""Solvers whose single runs are judged unasked where that costs milliseconds."""
RESTLESS = 10
"""Rests of one contact, or its impacts in a stiff scene, above which a run is judged unasked, by
itself if need be."""
STIFF = 30.0
"""Ratio of the periods of two bodies above which a scene is stiff: where in its vibration the
quick body is at an impact is then a matter of many digits."""
_ASK = "--error-estimate, or error_estimate=True from Python, asks for it"
DOUBTFUL, TIMES = 1e-4, 1e3
"""An error that is more than this part of its scale, and than so many rtol, is a warning."""


def default_estimate(response: Response) -> dict[str, Any] | None:
    """What is said of the errors of a single run where nothing was asked for.

    Parameters
    ----------
    response : Response
        The run.

    Returns
    -------
    dict or None
        Of `estimate_errors`; ``by`` None and the reason as ``missing`` where the finer run
        would first have to be compiled; None for solvers that are not judged unasked.
    """
    if response.solver not in (*JUDGED, JUDGE):
        return None
    restless = _is_restless(response)
    if response.solver == JUDGE:
        return estimate_errors(response) if restless else None
    if kernels_kept(_finer(response, JUDGE)):
        return estimate_errors(response)
    if restless:
        return estimate_errors(response, response.solver)
    return missing_estimate(f"{JUDGE} is not compiled yet; {_ASK}")


def _is_restless(response: Response) -> bool:
    """Whether the events of a run are of the kind that a tolerance may not tell."""

    def most(kind: EventKind) -> int:
        of_contact = Counter(e.contact for e in response.recording.events if e.kind is kind)
        return max(of_contact.values(), default=0)

    if most(EventKind.REST) > RESTLESS:
        return True
    if most(EventKind.IMPACT) <= RESTLESS:
        return False
    periods = [T for T in local_periods(response.scene).values() if math.isfinite(T)]
    return bool(periods) and max(periods) > STIFF * min(periods)


def estimate_of(response: Response, *, asked: bool | None, bounded: bool) -> dict[str, Any] | None:
    """What is said of the errors of a single run.

    Parameters
    ----------
    response : Response
        The run.
    asked : bool, optional
        Whether an estimate is wanted, whatever it costs; None for what nothing was said of.
    bounded : bool
        Whether the run may take so long only.
    """
    if asked is False:
        return None
    if asked:
        return estimate_errors(response)
    if bounded:
        return missing_estimate(f"the run is bounded; {_ASK}")
    return default_estimate(response)


def missing_estimate(reason: str) -> dict[str, Any]:
    """What stands in the place of an estimate that there is none of."""
    return {"by": None, "missing": reason}


def estimate_errors(response: Response, judge: str = JUDGE) -> dict[str, Any]:
    """Estimated errors of the peaks and final values of a run.

    Parameters
    ----------
    response : Response
        The run.
    judge : str
        The solver of the finer run.

    Returns
    -------
    dict
        ``by`` what, ``events_agree``, ``peaks`` and ``final`` as in the
        summary, with errors in the place of values, ``largest``, the largest of them in
        parts of its scale and of what, and ``warnings``, sentences; ``failed`` with the
        reason instead of these where the finer run failed.
    """
    task, recording = response.task, response.recording
    finer = _finer(response, judge)
    estimate: dict[str, Any] = {"by": f"{judge} at rtol {finer.rtol:g}"}
    try:
        other = solver_named(judge).solve(finer)
    except ComputationError as error:
        return estimate | {"failed": str(error)}
    matching = match_events(recording.events, other.events, len(task.scene.contacts))
    estimate["events_agree"] = matching.parting is None
    ours, theirs = (values_of_state(task.scene, run) for run in (recording, other))
    errors = {quantity: float(abs(ours[quantity] - theirs[quantity])) for quantity in ours}
    for quantity, off in errors.items():
        kind, _, rest = quantity.partition(".")
        name, _, key = rest.rpartition(".")
        estimate.setdefault(kind, {}).setdefault(name, {})[key] = off
    estimate["largest"] = _largest(response, errors)
    counts = _rests(response, recording.events), _rests(response, other.events)
    estimate["warnings"] = [
        *_doubts_of_events(response, counts, matching, estimate["by"]),
        *_doubts_of_rests(response, other, matching, estimate["by"]),
        *_doubts_of_values(task.rtol, estimate["largest"]),
    ]
    return estimate


def _finer(response: Response, judge: str) -> Task:
    """The run by which another is judged."""
    task = response.task
    return replace(
        task,
        rtol=max(task.rtol / FINER, SMALLEST_RTOL),
        atol={},
        energy=False,
        settings=task.settings if judge == response.solver else {},
        output_times=np.empty(0),
        progress=None,
        max_steps=None,
    )


def _doubts_of_rests(
    response: Response, other: Recording, matching: Matching, by: str
) -> list[str]:
    """Contacts that rest for another time, though not with other events."""
    task = response.task
    ours, theirs = (_rested(response, run) for run in (response.recording, other))
    allowed = max(DOUBTFUL, TIMES * task.rtol) * (task.end - task.start)
    return [
        f"contact {response.scene.contacts[j].name!r} rests for {ours[j]:.6g} s in all, by {by} "
        f"for {theirs[j]:.6g} s"
        for j in np.flatnonzero(np.abs(ours - theirs) > allowed)
        if j not in matching.parted
    ]


def _rested(response: Response, run: Recording) -> Floats:
    """Time for which each contact rests (s), shape (K,); NaN where a run does not say."""
    contacts = len(response.scene.contacts)
    if np.isnan(run.resting_time).any():
        return run.resting_time
    return resting_times(_lasting(response, run.events), contacts, run.t)


def _lasting(response: Response, events: Sequence[Event]) -> list[Event]:
    """Events that rounding does not decide."""
    task = response.task
    brief = BRIEF * (task.end - task.start)
    rows = (lasting_rows(events, j, brief) for j in range(len(response.scene.contacts)))
    return [events[row] for each in rows for row in each]


def _rests(response: Response, events: Sequence[Event]) -> Counter[int]:
    """How often each contact comes to rest."""
    return Counter(e.contact for e in _lasting(response, events) if e.kind is EventKind.REST)


def _largest(response: Response, errors: Mapping[str, float]) -> dict[str, Any]:
    """The largest error of a peak or final value in parts of its scale, times left out."""
    task, recording = response.task, response.recording
    scales = scene_scales(task.scene, assemble(task.scene), task.end - task.start)
    size = motion_scales(recording.history, recording, scales.time, scales.length, scales.z_bound)
    parts = {
        name: errors[name] / scale
        for name, scale in value_scales(task.scene, size).items()
        if name in errors
    }
    name = max(parts, key=lambda each: parts[each])
    return {"quantity": name, "part": parts[name]}


def _doubts_of_values(rtol: float, largest: Mapping[str, Any]) -> list[str]:
    if largest["part"] <= max(DOUBTFUL, TIMES * rtol):
        return []
    return [
        f"{largest['quantity']} is off by {largest['part']:.1e} of its scale, as estimated; "
        "`eventpound verify` tells why, a smaller rtol may help"
    ]


def _doubts_of_events(
    response: Response,
    counts: tuple[Counter[int], Counter[int]],
    matching: Matching,
    by: str,
) -> list[str]:
    """Contacts that rest another number of times, and the others at which the runs part."""
    contacts, rtol = response.scene.contacts, response.task.rtol
    ours, theirs = counts
    restless = [
        f"contact {contacts[j].name!r} comes to rest {ours[j]} times, by {by} {theirs[j]} times: "
        f"it changes its mode more often than rtol {rtol:g} can tell; its counts, times and "
        "forces are not to be relied on (`eventpound verify` tells why, a smaller rtol may help)"
        for j in sorted(ours.keys() | theirs.keys())
        if ours[j] != theirs[j]
    ]
    first = matching.parting
    if first is None:
        return restless
    others = [f"contact {contacts[j].name!r}" for j in matching.parted if ours[j] == theirs[j]]
    if restless:
        text = f"so are not the events at {', '.join(others)}, which are others by {by}"
        return [*restless, text] if others else restless
    later = f", later at {', '.join(others[1:])}, too" if others[1:] else ""
    return [
        f"from t = {first.t:.6g} s on events are not those by {by}: at contact "
        f"{contacts[first.contact].name!r} one has {first.found}, the other "
        f"{first.instead}{later} (`eventpound verify` tells why)"
    ]
