"""Many variants in one compiled call, one after the other, and what is kept of each.

Their arrays have a leading axis of runs; each run gets its plan and its state as views of them.
"""

from __future__ import annotations

from typing import Any, NamedTuple, get_type_hints

import numpy as np

from eventpound.contact.event_rows import (
    ACCUMULATION,
    DETACHMENT,
    EVENT_WIDTH,
    IMPACT,
    REST,
    SEPARATION,
    UNLISTED,
    UNLISTED_LAST,
)
from eventpound.mechanics.monitored import places_of, running_of
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.by_address import by_address
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.solvers.fast.advance import carry_on
from eventpound.solvers.fast.columns import Motions, VariantArrays
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.constants import blank_located, blank_series, clear_scratch
from eventpound.solvers.fast.evaluate import blank_fast_observed
from eventpound.solvers.fast.links import all_variables, elongations
from eventpound.solvers.fast.run import (
    GOING_ON,
    FastLocated,
    FastObserved,
    FastPlan,
    FastRecord,
    FastRun,
    FastSeries,
    FastState,
    Ground,
)
from eventpound.solvers.fast.sdof.oscillator import oscillate
from eventpound.solvers.fast.solver import BUDGET, FIRST_ROOM

LOGGED_AT_ONCE = 16
"""Runs whose events have room in the log, however many they have; most have few."""


@compiled
def _ground_of(i: int, motions: Motions) -> Ground:
    """Ground motion of run i; its samples are put into `motions.scaled`."""
    ground, scaled = motions.ground, motions.scaled
    m = motions.of_variant[i]
    size = ground.first_sample[m, -1]
    if i == 0 or m != motions.of_variant[i - 1]:
        for k in range(size):
            scaled[k] = ground.samples[motions.begins[m] + k] * motions.factor[m]
    return Ground(
        ground.ends[m],
        ground.family,
        ground.coefficients[m],
        ground.first,
        scaled[:size],
        ground.first_sample[m],
    )


_SHARED = frozenset(
    (
        *("links.ends", "links.on_ground", "links.z_of_link", "links.springs"),
        *("links.grounded", "links.sliders"),
        *("hysteresis.link", "hysteresis.tables", "hysteresis.followed"),
        *("contacts.left", "contacts.right", "contacts.weights"),
        *("contacts.rubbing", "contacts.friction"),
        *("limits.rtol", "limits.order", "limits.ledger", "output_times"),
        *("oscillator.right", "oscillator.left", "distances.first", "distances.second"),
    )
)
"""Fields of a plan that are the same in every run; `ground` is made by `_ground_of`."""


def _one_run(kind: Any, shared: frozenset[str]) -> Any:
    """A compiled function that makes a `kind` of run i from one whose arrays have an axis of runs.

    Numba has no loop over the fields of a named tuple that makes another, so the function is
    written out here: ``kind(runs.mass[i], Links(runs.links.ends, ...), ...)``.

    Parameters
    ----------
    kind : type
        A named tuple of arrays, numbers and named tuples.
    shared : set of str
        Fields, with dots, that have no such axis.
    """
    names: dict[str, Any] = {"__name__": __name__, "_ground_of": _ground_of}

    def made(each: Any, path: str) -> str:
        names[each.__name__] = each
        fields = []
        for name, hint in get_type_hints(each).items():
            inner = f"{path}{name}"
            if inner == "ground":
                fields.append("_ground_of(i, motions)")
            elif hasattr(hint, "_fields"):
                fields.append(made(hint, f"{inner}."))
            else:
                fields.append(f"runs.{inner}" + ("" if inner in shared else "[i]"))
        return f"{each.__name__}({', '.join(fields)})"

    text = f"def one_{kind.__name__.lower()}(i, runs, motions):\n    return {made(kind, '')}"
    exec(compile(text, __file__, "exec"), names)
    return compiled(names[f"one_{kind.__name__.lower()}"])


plan_of_run = _one_run(FastPlan, _SHARED)
state_of_run = _one_run(FastState, frozenset())


class Kept(NamedTuple):
    """What is kept of n runs beside their states and extremes.

    z (n, H). impacts, resting_time (n, K), and whether forces were always unique (n, K). ended
    (n,): how they ended. log (E, 1 + EVENT_WIDTH): number of the run and row of every event
    that is kept; `logged`: how many of them there are.
    """

    z: Floats
    impacts: Floats
    resting_time: Floats
    unique: Bools
    ended: Ints
    log: Floats
    logged: Ints


class Scratch(NamedTuple):
    """Arrays that serve one run after the other; events have room for one, and no line is kept."""

    series: FastSeries
    located: FastLocated
    observed: FastObserved
    events: Floats
    no_lines: Floats
    unique: Bools
    since: Floats


def run(rows: VariantArrays, events: bool = False) -> Kept:
    """Carry variants to their ends; the final states and extremes stand in `rows` then.

    A run that needs more room for its events than there is ends with FULL.

    Parameters
    ----------
    rows : VariantArrays
        The variants.
    events : bool
        Whether the events of every run are kept.
    """
    plan = rows.plan
    count = plan.mass.shape[0]
    hysteretic, contacts = plan.hysteresis.link.size, plan.contacts.left.size
    scratch = Scratch(
        blank_series(plan),
        blank_located(plan),
        blank_fast_observed(plan),
        np.zeros((FIRST_ROOM + 4 * contacts, EVENT_WIDTH)),
        np.zeros((0, 0)),
        np.ones(contacts, np.bool_),
        np.zeros(contacts),
    )
    room = LOGGED_AT_ONCE * scratch.events.shape[0] if events else 0
    kept = Kept(
        np.zeros((count, hysteretic)),
        np.zeros((count, contacts)),
        np.zeros((count, contacts)),
        np.ones((count, contacts), np.bool_),
        np.zeros(count, np.int64),
        np.zeros((room, 1 + EVENT_WIDTH)),
        np.zeros(1, np.int64),
    )
    alone: Any = plan.oscillator.alone
    logs = [kept.log[:0]]
    for kernel, some in ((run_sdof_rows, alone.any()), (run_rows, not alone.all())):
        done = 0 if some else count
        while done < count:
            kept.logged[0] = 0
            done = kernel(BUDGET, done, rows, scratch, kept)
            logs.append(kept.log[: kept.logged[0]].copy())
    return kept._replace(log=np.concatenate(logs))


@compiled_noinline
def run_rows(budget: int, begun: int, rows: VariantArrays, scratch: Scratch, kept: Kept) -> int:
    """Run rows from `begun` on that are not a single body's; returns where the log was full."""
    series, located, observed = scratch.series, scratch.located, scratch.observed
    for i in range(begun, kept.ended.size):
        if _is_full(scratch.events, kept):
            return i
        plan = plan_of_run(i, rows.plan, rows.motions)
        if plan.oscillator.alone:
            continue
        state = state_of_run(i, rows.state, rows.motions)
        record = FastRecord(scratch.events, scratch.no_lines, rows.extremes[i], scratch.unique)
        # Nothing of the run before may show in this one.
        clear_scratch(series, located, observed)
        record.unique[:] = True
        at = places_of(plan.mass.size, plan.links.springs, plan.contacts.gap.size)
        running = running_of(record.extremes, at)
        one = by_address(FastRun(plan, state, series, located, record, observed, running))
        ended = GOING_ON
        while ended == GOING_ON:
            ended = carry_on(budget, one)
        kept.ended[i] = ended
        _keep(i, plan, state, scratch, kept)
    return int(kept.ended.size)


@compiled_noinline.but(recipe=SMALL)
def run_sdof_rows(
    budget: int, begun: int, rows: VariantArrays, scratch: Scratch, kept: Kept
) -> int:
    """Run every row of a single body, as `run_rows`; no lines of a history are written."""
    sdof = scratch.series.sdof
    for i in range(begun, kept.ended.size):
        if _is_full(scratch.events, kept):
            return i
        plan = plan_of_run(i, rows.plan, rows.motions)
        if not plan.oscillator.alone:
            continue
        state = state_of_run(i, rows.state, rows.motions)
        record = FastRecord(scratch.events, scratch.no_lines, rows.extremes[i], scratch.unique)
        record.unique[:] = True
        ended = GOING_ON
        while ended == GOING_ON:
            ended = oscillate(budget, plan, state, sdof, record)
        kept.ended[i] = ended
        _keep(i, plan, state, scratch, kept)
    return int(kept.ended.size)


@compiled
def _keep(i: int, plan: FastPlan, state: FastState, scratch: Scratch, kept: Kept) -> None:
    """Keep what is wanted of run i."""
    now, series, events = state.now[0], scratch.series, scratch.events
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    all_variables(series.x, plan.hysteresis, state, kept.z[i])
    impacts, resting_time = kept.impacts[i], kept.resting_time[i]
    _count_events(now.t, now.events, events, scratch.since, impacts, resting_time)
    for j in range(scratch.unique.size):
        kept.unique[i, j] = scratch.unique[j]
    if kept.log.shape[0] > 0:
        for row in range(now.events):
            place, event = kept.log[kept.logged[0]], events[row]
            place[0] = i
            for k in range(event.size):
                place[1 + k] = event[k]
            kept.logged[0] += 1


@compiled
def _is_full(events: Floats, kept: Kept) -> bool:
    """Whether the log, where there is one, has too little room for the events of a run."""
    return 0 < kept.log.shape[0] < kept.logged[0] + events.shape[0]


@compiled_noinline
def _count_events(
    t: float, count: int, events: Floats, since: Floats, impacts: Floats, resting_time: Floats
) -> None:
    """Impacts of each contact and the time it rested until t (s), from the events of a run."""
    since[:] = np.inf
    for row in range(count):
        event = events[row]
        kind, j = int(event[1]), int(event[3])
        if kind in (IMPACT, UNLISTED, UNLISTED_LAST, ACCUMULATION):
            impacts[j] += event[8]
        elif kind == REST:
            since[j] = event[0]
        elif kind in (DETACHMENT, SEPARATION) and since[j] < np.inf:
            resting_time[j] += event[0] - since[j]
            since[j] = np.inf
    for j in range(since.size):
        # What still rests has no end among the events.
        if since[j] < np.inf:
            resting_time[j] += t - since[j]
