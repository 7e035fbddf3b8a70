"""What a run leaves behind step by step: rows of the history, energy, times in contact.

Rows are written at output times and at both sides of events. The powers of the energy ledger are
integrated over a step by Gauss's rule, apart from the series. What a mode leaves that is none,
since it ends as soon as a contact has come to rest (`FLEETING`), is taken back, and no time passes
in it.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import is_fleeting, is_over
from eventpound.contact.event_rows import end_cascade, events_wanted
from eventpound.contact.state import Now
from eventpound.mechanics.elements import drag, pull_per_z
from eventpound.mechanics.followers import is_unmoved, own_mass
from eventpound.mechanics.model import WORK_OF_SUPPORTS
from eventpound.mechanics.monitored import copy_extremes
from eventpound.motion.forcing import CurrentPiece, ground_acceleration
from eventpound.motion.loads import LOADED, body_of, is_driven, load_value, rows_of
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.recorder import put_line
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.evaluate import observe_at_noinline
from eventpound.solvers.fast.run import FastProgress, FastRun
from eventpound.solvers.fast.sliding import add_friction, any_rubbing, any_slider, observe_slider_z


@compiled
def rows_wanted(outputs: int, progress: FastProgress) -> int:
    """Rows of the history for which there is to be room, with `outputs` output times in all."""
    return progress.rows + outputs - progress.output + 4


@compiled
def takes_rows(rows: Floats) -> bool:
    """Whether a history is kept: rows without width take none."""
    return rows.shape[1] > 0


@compiled
def has_room_for(
    contacts: int, outputs: int, now: Now, progress: FastProgress, events: Floats, rows: Floats
) -> bool:
    """Whether the record of a run can take what one more step may write, at the least."""
    if takes_rows(rows) and rows_wanted(outputs, progress) > rows.shape[0]:
        return False
    return events_wanted(contacts, now) <= events.shape[0]


@compiled
def has_room(run: FastRun) -> bool:
    """As `has_room_for`, of a run."""
    state, record, outputs = run.state, run.record, run.plan.output_times.size
    now, progress = state.now[0], state.progress[0]
    return has_room_for(state.gap.size, outputs, now, progress, record.events, record.rows)


@compiled
def is_due(t: float, times: Floats, progress: FastProgress) -> bool:
    """Whether a row of the history is due before t (s)."""
    return bool(progress.output < times.size and times[progress.output] < t)


@compiled
def pass_time(tau: float, t: float, steps: int, now: Now, progress: FastProgress) -> None:
    """Let the time be t (s), tau (s) later, after some steps."""
    now.t = t
    # By the length itself: between the short flights of a cascade times do not differ.
    now.since_impact += tau
    progress.steps += steps
    progress.stalled = progress.stalled + steps if tau == 0.0 else 0


@compiled
def end_if_over(run: FastRun) -> None:
    """List the impacts that were held back of a cascade that is over."""
    state, now = run.state, run.state.now[0]
    if is_over(now, run.plan.limits.time):
        end_cascade(state.resting, now, run.record.events)


@compiled_noinline
def write_row(t: float, run: FastRun) -> None:
    """Add a line to the history, where one is kept."""
    plan, state, record, observed = run.plan, run.state, run.record, run.observed
    if not takes_rows(record.rows):
        return
    if any_slider(run):
        observe_slider_z(run)
    progress = state.progress[0]
    row = record.rows[progress.rows]
    progress.rows += 1
    gap, force = observed.gap, observed.force[: plan.links.springs]
    parts = observed.u, observed.v, observed.a, observed.z, force, gap, observed.contact_force
    put_line(t, observed.base[0], parts, row)


@compiled_noinline
def sample_step(t: float, t_end: float, order: int, piece: CurrentPiece, run: FastRun) -> None:
    """History at the output times of a step; `observed` is overwritten."""
    plan, state = run.plan, run.state
    times, progress = plan.output_times, state.progress[0]
    while is_due(t_end, times, progress):
        at = times[progress.output]
        if at >= t:
            g = ground_acceleration(piece, at)
            observe_at_noinline(at - t, order, g, run)
            write_row(at, run)
        progress.output += 1


@compiled_noinline
def save_record(run: FastRun) -> None:
    """Remember history and extremes as they are before a mode that may be none."""
    plan, state, series, record = run.plan, run.state, run.series, run.record
    now, progress = state.now[0], state.progress[0]
    if not is_fleeting(0.0, now, plan.limits.time):
        return
    progress.saved_rows, progress.saved_at = progress.rows, now.t
    copy_extremes(record.extremes, series.saved)


@compiled_noinline
def restore_record(run: FastRun) -> None:
    """Take back what has come into history and extremes since `save_record`, and the time passed.

    What follows happens in the instant of `save_record`, to which its events belong then.
    """
    state, series, record, times = run.state, run.series, run.record, run.plan.output_times
    now, progress = state.now[0], state.progress[0]
    progress.rows, now.t = progress.saved_rows, progress.saved_at
    # Rows at output times are written again where time passes once more.
    while progress.output > 0 and times[progress.output - 1] >= now.t:
        progress.output -= 1
    copy_extremes(series.saved, record.extremes)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
"""Exact for polynomials up to degree 23 (Abramowitz and Stegun, table 25.4)."""


@compiled_deferred
def add_work(tau: float, order: int, piece: CurrentPiece, run: FastRun) -> None:
    """Add all work of a step (J) to the ledger; overwrites `observed`."""
    plan, state, observed = run.plan, run.state, run.observed
    links, memory = plan.links, run.series.memory
    for i in range(NODES.size):
        at = 0.5 * tau * (1.0 + NODES[i])
        weight = 0.5 * tau * WEIGHTS[i]
        g = ground_acceleration(piece, state.now[0].t + at)
        observe_at_noinline(at, order, g, run)
        if piece.family == LOADED:
            _add_loaded(state.now[0].t + at, weight, piece, run)
        if any_rubbing(run):
            add_friction(weight, run)
        for b in range(plan.mass.size):
            # The work of a support is its own, and its mass infinite.
            state.ledger[0] -= weight * own_mass(b, plan.mass) * observed.v[b] * g
        for a in range(links.ends.shape[0]):
            first, second = links.ends[a, 0], links.ends[a, 1]
            x_rate = observed.v[second] if second >= 0 else 0.0
            x_rate -= observed.v[first] if first >= 0 else 0.0
            state.ledger[1] += weight * drag(a, links.law, x_rate) * x_rate
            h = links.z_of_link[a]
            if h >= 0:
                state.ledger[2] += weight * pull_per_z(a, memory) * observed.z[h] * x_rate


@compiled
def goes_with(b: int, s: int, run: FastRun) -> float:
    """By how much a body, -1 for none, goes with a support s: wholly where it is or rests on it."""
    of_body, series = run.series.of_body, run.series
    if b == s:
        return 1.0
    if is_unmoved(b, run.plan.mass) or of_body[b] < 0 or of_body[s] < 0:
        return 0.0
    if series.free.shape[0] > 0:
        return float(series.compliance[of_body[b], of_body[s]])
    return 1.0 if of_body[b] == of_body[s] else 0.0


@compiled_noinline
def _add_loaded(t: float, weight: float, piece: CurrentPiece, run: FastRun) -> None:
    """Add `weight` (s) times the powers at the time t (s) that is `observed` (W) to the ledger.

    Of forces; and of supports, each of which gives what moves with it what that
    takes, less what links and forces give.
    """
    plan, observed, ledger = run.plan, run.observed, run.state.ledger
    coefficients = piece.coefficients
    for row in range(1, rows_of(coefficients) + 1):
        b = body_of(row, coefficients)
        if not is_driven(row, coefficients):
            ledger[0] += weight * observed.v[b] * load_value(row, piece, t)
    for k in range(ledger.size - WORK_OF_SUPPORTS - plan.contacts.rubbing.size):
        taken = -observed.body_force[k]
        for b in range(plan.mass.size):
            part = goes_with(b, k, run)
            if part != 0.0 and b != k:
                taken += part * (plan.mass[b] * observed.a[b] - observed.body_force[b])
        ledger[WORK_OF_SUPPORTS + k] += weight * observed.v[k] * taken
