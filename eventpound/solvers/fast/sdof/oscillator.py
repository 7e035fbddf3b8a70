"""A whole run of a single body, in scalars: its steps, and its instants.

Each step is one that `eventpound.solvers.fast.advance` could have taken, and
leaves the same state: series, length from the last terms, first event, defect
at the end, extremes and history.

The rules of contact are those of `eventpound.contact.modes` for the two barriers, of
which one at most is closed. Newton's law is ``v⁺ = -ε v⁻``. A body that stands
still at a barrier moves, once let go, as ``u'' = A - a_g`` with A a constant as
long as it has not moved, so of ``0 <= g'' ⊥ λ >= 0`` and all higher orders there
remain the Taylor coefficients of A - a_g: the first that differs from zero decides.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.contact.cascade import end_flight, last_speed
from eventpound.contact.event_rows import new_group, write_change
from eventpound.contact.impacts import DONE, FULL, Meeting, end_impacts, rebound
from eventpound.contact.modes import ACCELERATION, IMPACT, duty, transition_code
from eventpound.contact.rest import ORDER as MOST_DECIDING
from eventpound.mechanics.monitored import places_of, running_of
from eventpound.motion.base import Family
from eventpound.motion.forcing import (
    GAUSSIAN_STEP,
    CurrentPiece,
    decay_time,
    ground_acceleration,
    ground_taylor,
    sample_time,
)
from eventpound.numerics.by_address import by_address, whole
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.links import turns_back
from eventpound.solvers.fast.record import has_room_for
from eventpound.solvers.fast.run import (
    GOING_ON,
    MOST_STALLS,
    STUCK,
    FastPlan,
    FastRecord,
    FastRun,
    FastState,
    Sdof,
    piece_of,
)
from eventpound.solvers.fast.sdof.body import (
    SdofRun,
    absolute_acceleration,
    acceleration_level,
    load_body,
    set_force,
    side_closed,
    spring_state,
    store_body,
    turn_round,
)
from eventpound.solvers.fast.sdof.exact import (
    NOT_FREE,
    rest_step,
    sample_steps,
    swing_freely,
    swings_freely,
)
from eventpound.solvers.fast.sdof.record import take_if_new, take_settled, write_present
from eventpound.solvers.fast.sdof.series import know_piece, pair_at, sample_after
from eventpound.solvers.fast.sdof.step import take_step
from eventpound.tolerances import SAME_SAMPLE


@compiled_noinline
def impact_at_barrier(side: float, j: int, solo: SdofRun) -> None:
    """Newton's law at the barrier on one side, contact j, which the body has met."""
    body, limits, restitution = solo.body, solo.plan.limits, solo.plan.contacts.restitution[j]
    last = last_speed(limits.length / limits.time, False)
    # On the right the gap is right_gap - u, so its rate is -v; on the left v.
    meeting = Meeting(j, -side * body.v, restitution, 1.0 / body.mass, last, limits.time)
    after, _ = rebound(meeting, solo.now, solo.events)
    end_impacts(solo.now)
    body.v = -side * after


@compiled_deferred
def stays_closed(side: float, piece: CurrentPiece, solo: SdofRun) -> bool:
    """Whether a body that stands still at a barrier without a contact force stays there.

    Parameters
    ----------
    side : float
        1 for a barrier on the right, -1 for one on the left.
    piece : CurrentPiece
        The ground motion from now on.
    solo : SdofRun
        The run.
    """
    ground, level, t = solo.body.work[:], solo.body.no_acceleration, solo.now.t
    ground_taylor(piece, t, MOST_DECIDING, ground)
    time = min(solo.plan.limits.time, decay_time(piece, t))
    for k in range(1, MOST_DECIDING):
        level /= time * k
        if abs(ground[k]) > level:
            # λ = ± m (A - a_g) with A constant: its coefficients are those of a_g, turned round.
            return side * ground[k] < 0.0
    return True


@compiled
def settle_sdof(g: float, piece: CurrentPiece, solo: SdofRun) -> None:
    """Do the duties of the present instant; `g` is the acceleration of the ground (m/s²)."""
    body = solo.body
    side = side_closed(body)
    j = solo.plan.oscillator.right if side > 0.0 else solo.plan.oscillator.left
    if side != 0.0:
        # The displacement agrees with a gap of zero.
        body.u = body.right_gap if side > 0.0 else -body.left_gap
    body.z = spring_state(body.u, solo)
    if side != 0.0 and duty(0.0, -side * body.v) == IMPACT:
        impact_at_barrier(side, j, solo)
    # After the impact, which may have turned it.
    if turns_back(body.part, body.sigma, body.v, body.still):
        turn_round(body.u, solo)
    body.a = absolute_acceleration(body.u, body.v, body.z, body)
    rests = 0.0
    if side != 0.0 and duty(0.0, -side * body.v) == ACCELERATION:
        pull = body.a - g
        stays = side * pull > 0.0
        # Order zero tells nothing, or has vanished by definition: the next ones do.
        if body.released or abs(pull) <= acceleration_level(body):
            stays = stays_closed(side, piece, solo)
        rests = side if stays else 0.0
    if rests != body.rests_on:
        _write_rest(rests != 0.0, j, -side * body.v, solo)
    body.rests_on, body.released = rests, False
    solo.progress.resting = 1 if rests != 0.0 else 0


@compiled_deferred
def _write_rest(rests: bool, j: int, rate: float, solo: SdofRun) -> None:
    """Write down that the body comes to rest on contact j, or no longer rests on it."""
    code = transition_code(not rests, rests, rate)
    write_change(code, j, new_group(solo.now), rate, solo.now, solo.events)


@compiled_noinline
def oscillate_alone(budget: int, run: FastRun) -> int:
    """`oscillate` of a run by address."""
    sdof = whole(run.series.sdof)
    return oscillate(budget, whole(run.plan), whole(run.state), sdof, whole(run.record))


_SAMPLES, _GAUSSIAN, _ZERO = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.ZERO)


@compiled_deferred.but(recipe=SMALL)
def oscillate(budget: int, plan: FastPlan, state: FastState, sdof: Sdof, record: FastRecord) -> int:
    """Carry a single body to the end of its run, or as far as steps and room reach.

    Parameters
    ----------
    budget : int
        Most steps.
    plan, state, sdof, record
        See `eventpound.solvers.fast.run`; a record whose rows have no width takes none.

    Returns
    -------
    int
        As of `eventpound.solvers.fast.advance.advance`.
    """
    start = plan.hysteresis.at[0] if plan.hysteresis.at.size > 0 else 0
    at = places_of(1, plan.links.springs, plan.contacts.gap.size)
    solo = by_address(
        SdofRun(
            sdof.body[0],
            state.now[0],
            state.progress[0],
            record.events,
            record.rows,
            running_of(record.extremes, at),
            plan.hysteresis.tables[start:],
            plan,
            sdof,
        )
    )
    body, now, progress = solo.body, solo.now, solo.progress
    if not progress.started:
        load_body(plan, state, solo)
        progress.started = True
    last_step = progress.steps + budget
    code = GOING_ON
    while code == GOING_ON:
        if not has_room_for(1, solo.plan.output_times.size, now, progress, solo.events, solo.rows):
            code = FULL
            break
        if progress.due == 1 or now.t >= solo.plan.limits.end:
            _settle(solo)
            if now.t >= solo.plan.limits.end:
                code = DONE
                break
        if progress.steps >= last_step:
            break
        code = _rest(last_step, solo) if body.rests_on != 0.0 else _swing(last_step, solo)
    store_body(plan.oscillator, body, state)
    return code


@compiled
def _settle(solo: SdofRun) -> None:
    """Do the duties of the present instant and write down what follows it."""
    body, ground, t, progress = solo.body, solo.plan.ground, solo.now.t, solo.progress
    # At a border of pieces the motion from now on counts.
    while progress.due == 1 and ground.ends[progress.piece] <= t:
        progress.piece += 1
    piece = by_address(piece_of(progress.piece, ground))
    g = ground_acceleration(piece, t)
    if progress.due == 1:
        settle_sdof(g, piece, solo)
        progress.due = 0
        body.segment = -1
    set_force(g, body)
    write_present(t, g, solo)
    # A body at rest has the acceleration of the ground, whatever its spring pulls.
    take_settled(t, g if body.rests_on != 0.0 else body.a, solo)


@compiled_deferred.but(recipe=SMALL)
def _rest(last_step: int, solo: SdofRun) -> int:
    """Steps of a body at rest, until something is to be settled."""
    ground, body, now, progress = solo.plan.ground, solo.body, solo.now, solo.progress
    i = progress.piece
    piece = by_address(piece_of(i, ground))
    piece_end = min(ground.ends[i], solo.plan.limits.end)
    while progress.steps < last_step and progress.due == 0 and now.t < piece_end:
        if not rest_step(piece_end, piece, solo):
            return FULL
        if body.released:
            end_flight(now)
            g = ground_acceleration(piece, now.t)
            write_present(now.t, g, solo)
            progress.due = 1
        if progress.stalled > MOST_STALLS:
            return STUCK
    if now.t >= ground.ends[i]:
        progress.due = 1
    return GOING_ON


@compiled
def _swing(last_step: int, solo: SdofRun) -> int:
    """Steps of a body that moves, until something is to be settled."""
    body, ground, now, progress = solo.body, solo.plan.ground, solo.now, solo.progress
    i = progress.piece
    piece = by_address(piece_of(i, ground))
    piece_end = min(ground.ends[i], solo.plan.limits.end)
    family, coefficients = piece.family, piece.coefficients
    if body.piece_known != i + 1:
        know_piece(i, piece, body)
    longest = GAUSSIAN_STEP / math.sqrt(coefficients[1]) if family == _GAUSSIAN else np.inf
    stop, segment, code = piece_end, 0, GOING_ON
    if family == _SAMPLES:
        stop, segment = sample_after(now.t, piece_end, piece)
    while code == GOING_ON and progress.due == 0 and now.t < piece_end:
        if progress.steps >= last_step:
            break
        if family == _SAMPLES:
            dt = coefficients[1]
            if stop <= now.t + SAME_SAMPLE * dt and stop < piece_end:
                stop, segment = sample_after(now.t, piece_end, piece)
            # Exact steps go from sample to sample.
            if now.t == sample_time(coefficients[0], dt, segment):
                budget = last_step - progress.steps
                if sample_steps(budget, segment, piece_end, piece, solo) > segment:
                    stop, segment = sample_after(now.t, piece_end, piece)
                if progress.steps >= last_step:
                    break
        # On another segment of a record the ground is another line.
        if body.pair and body.segment != segment:
            body.segment = segment
            body.even, body.odd = pair_at(now.t, piece, body)
        if family == _ZERO and swings_freely(body):
            code = swing_freely(stop, piece, solo)
            if code != NOT_FREE:
                continue
        code = take_step(min(stop - now.t, longest), stop, piece, solo)
    if now.t >= ground.ends[i]:
        progress.due = 1
    if progress.due == 1 or now.t >= piece_end:
        # The end of a stretch may be an extreme.
        take_if_new(now.t, body.u, body.a, solo)
    return code
