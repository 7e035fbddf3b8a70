"""An estimate of the errors of one run: its distance from another one.

`eventpound.accuracy.judge` says whose run that is. An estimate is no bound: it says nothing
about conditioning, and two runs may agree by chance. `verify` gives bounds.

Where a quantity is off by more than `DOUBTFUL` of its scale, or `TIMES` rtol, or where the
runs do not see the same events, there is a warning: then the tolerance does not tell them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from eventpound.accuracy.judge import INDEPENDENT, judge_of, task_of_judge
from eventpound.accuracy.quantities import own_scale, quantities_at, scales_of_task, values_by_name
from eventpound.accuracy.sequences import KINDS, first_parting, instead_of, weights_for
from eventpound.basics.told import Reached
from eventpound.errors import ComputationError, InterruptionError
from eventpound.numerics.arrays import Floats
from eventpound.response import Response
from eventpound.score.difference import Deviation, Truth, difference
from eventpound.score.levels import UNIT_OF_TIME
from eventpound.score.pairing import Paired
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind
from eventpound.solvers.events.recorder import resting_times

DOUBTFUL, TIMES = 1e-4, 1e3
"""An error that is more than this part of its scale, and than so many rtol, is a warning."""
DIGITLESS = 0.1
"""One of more than this part always is."""


def estimate_of(
    response: Response, *, asked: bool | None, progress: Reached | None = None
) -> dict[str, Any] | None:
    """What is said of the errors of a single run.

    Parameters
    ----------
    response : Response
        The run.
    asked : bool, optional
        Whether an estimate is wanted, whatever it costs; None for what nothing was said of.
    progress : callable, optional
        Called with the time (s) that the judge has reached.

    Returns
    -------
    dict or None
        Of `estimate_errors`; ``by`` None and the reason as ``missing`` where nobody judges the
        run; None where none is wanted.
    """
    if asked is False:
        return None
    judge = judge_of(response, asked=bool(asked))
    if judge is None:
        return {
            "by": None,
            "missing": f"{response.solver} is judged only when that is asked for: by "
            "--error-estimate, or error_estimate=True from Python",
        }
    return estimate_errors(response, judge, progress)


def estimate_errors(
    response: Response, judge: str = INDEPENDENT, progress: Reached | None = None
) -> dict[str, Any]:
    """Estimated errors of the peaks and final values of a run.

    Parameters
    ----------
    response : Response
        The run.
    judge : str
        The solver of the run that it is compared with.
    progress : callable, optional
        Called with the time (s) that this one has reached.

    Returns
    -------
    dict
        ``by`` what, ``events_agree``, ``peaks`` and ``final`` as in the
        summary, with errors in the place of values, ``largest``, the largest of them in
        parts of its scale and of what, and ``warnings``, sentences; ``failed`` with the
        reason, and a warning of it, instead of these where the judge failed.

    Raises
    ------
    InterruptionError
        Where `progress` does.
    """
    task, recording = response.task, response.recording
    again = replace(task_of_judge(response, judge), progress=progress)
    itself = " itself" if judge == response.solver else ""
    estimate: dict[str, Any] = {"by": f"{judge}{itself} at rtol {again.rtol:g}"}
    try:
        other = solver_named(judge).solve(again)
    except InterruptionError:
        raise
    except ComputationError as error:
        unknown = f"error not known: {estimate['by']} failed {error}"
        return estimate | {"failed": str(error), "warnings": [unknown]}
    own = Truth(
        quantities_at(task, recording),
        recording.events,
        UNIT_OF_TIME * (task.end - task.start),
        weights=weights_for(allowed_part(task.rtol)),
    )
    found = difference(own, values_by_name(task.scene, other), other.events, KINDS)
    estimate["events_agree"] = not found.events.alone
    for off in found.quantities:
        kind, _, rest = off.quantity.name.partition(".")
        name, _, key = rest.rpartition(".")
        apart = abs(off.value - off.quantity.value)
        estimate.setdefault(kind, {}).setdefault(name, {})[key] = apart
    worst = found.worst("")
    assert worst is not None
    estimate["largest"] = {"quantity": worst.quantity.name, "part": worst.error}
    estimate["warnings"] = [
        *_doubts(response, other.events, found.events, estimate["by"]),
        *_doubts_of_values(task.rtol, worst),
    ]
    return estimate


@dataclass(frozen=True)
class _Rests:
    """How often a contact comes to rest in each of two runs, and for how long in all (s)."""

    ours: int
    theirs: int
    our_time: float
    their_time: float


def allowed_part(rtol: float) -> float:
    """Part of its scale up to which a difference of two runs is no warning."""
    return max(DOUBTFUL, min(TIMES * rtol, DIGITLESS))


def rests_of_both(
    ours: Sequence[Event], theirs: Sequence[Event], paired: Paired, contacts: int, end: float
) -> list[_Rests]:
    """Rests of each contact in two runs up to `end` (s), without those that are none to one."""
    listed = {id(event) for pair in paired.listed for event in (pair.reference, pair.found)}
    kept = [[event for event in events if id(event) in listed] for events in (ours, theirs)]
    counts = (
        [sum(e.kind is EventKind.REST and e.contact == j for e in mine) for j in range(contacts)]
        for mine in kept
    )
    times = (resting_times(mine, contacts, end).tolist() for mine in kept)
    return [_Rests(*numbers) for numbers in zip(*counts, *times, strict=True)]


def speed_differences(
    ours: Sequence[Event], theirs: Sequence[Event], contacts: int, of_scene: float
) -> Floats:
    """How far the impacts of two runs differ at each contact, shape (K,).

    The largest difference of the closing speeds of the fastest impacts of either run, of the
    second fastest and so on, in parts of the fastest of all, or of the speed `of_scene` (m/s) where
    none is more than rounding; an impact that only one run has differs by its speed. An order in
    time would shift with each soft impact more or less.
    """
    speeds = [_closing_speeds(events, contacts) for events in (ours, theirs)]
    apart, fastest = np.zeros(contacts), 0.0
    for j, (mine, yours) in enumerate(zip(*speeds, strict=True)):
        more, fewer = (mine, yours) if mine.size >= yours.size else (yours, mine)
        if more.size:
            fastest = max(fastest, more[-1], *fewer[-1:])
            apart[j] = np.abs(more - np.pad(fewer, (more.size - fewer.size, 0))).max()
    return np.asarray(apart / own_scale(fastest, of_scene))


def _closing_speeds(events: Sequence[Event], contacts: int) -> list[Floats]:
    """Closing speeds of the impacts of each contact (m/s), ascending."""
    found: list[list[float]] = [[] for _ in range(contacts)]
    for event in events:
        if event.kind is EventKind.IMPACT and event.gap_velocity_before < 0.0:
            found[event.contact].append(-event.gap_velocity_before)
    return [np.sort(each) for each in found]


def _doubts_of_values(rtol: float, worst: Deviation) -> Iterator[str]:
    if worst.error > allowed_part(rtol):
        yield (
            f"{worst.quantity.name} is off by {worst.error:.1e} of the largest value of its "
            "kind, as estimated; `eventpound verify` tells why, a smaller rtol may help"
        )


def _said(kind: str) -> str:
    """The kind of an event in words: a separation is a distance in the trade."""
    return "detachment" if kind == EventKind.SEPARATION.value else kind


def _doubts(response: Response, others: Sequence[Event], paired: Paired, by: str) -> Iterator[str]:
    """What is otherwise by the judge, contact by contact: rests, events, speeds of impacts."""
    task, ours = response.task, response.recording.events
    names = [f"contact {contact.name!r}" for contact in task.scene.contacts]
    allowed = allowed_part(task.rtol)
    rests = rests_of_both(ours, others, paired, len(names), task.end)
    partings = first_parting(paired)
    restless = [j for j, found in enumerate(rests) if found.ours != found.theirs]
    for j in restless:
        yield (
            f"{names[j]} comes to rest {rests[j].ours} times, by {by} {rests[j].theirs} times: it "
            f"changes its mode more often than rtol {task.rtol:g} can tell; its counts, times and "
            "forces are not to be relied on (`eventpound verify` tells why, a smaller rtol may "
            "help)"
        )
    first = next(iter(partings.values()), None)
    apart = [names[j] for j in partings if j not in restless]
    if restless and apart:
        yield f"so are not the events at {', '.join(apart)}, which are others by {by}"
    elif first is not None and not restless:
        later = f", later at {', '.join(apart[1:])}, too" if apart[1:] else ""
        yield (
            f"from t = {first.t:.6g} s on events are not those by {by}: at {names[first.contact]} "
            f"one has {first.kind}, the other {_said(instead_of(first, paired))}{later} "
            "(`eventpound verify` tells why)"
        )
    for j, found in enumerate(rests):
        off = abs(found.our_time - found.their_time) > allowed * (task.end - task.start)
        if off and j not in (*restless, *partings):
            yield (
                f"{names[j]} rests for {found.our_time:.6g} s in all, "
                f"by {by} for {found.their_time:.6g} s"
            )
    speed = scales_of_task(task).speed
    for j, part in enumerate(speed_differences(ours, others, len(names), speed)):
        if part > allowed and j not in partings:
            yield (
                f"impacts at {names[j]} have other speeds than by {by}, "
                f"by up to {part:.1e} of the fastest in the run"
            )
