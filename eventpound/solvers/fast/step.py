"""One step of any scene: expanded, ended by the first event, judged, recorded.

It serves smooth motion, the samples of a record, and a cascade of impacts whose
intervals shrink below the rounding of time.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import LONGEST_CASCADE, is_fleeting
from eventpound.contact.impacts import DONE
from eventpound.mechanics.followers import felt_mass
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece, ground_acceleration
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.evaluate import contact_force_series, observe_at, observe_at_noinline
from eventpound.solvers.fast.expansion import (
    begin_series,
    choose_step_size,
    defect_error,
    expand,
    largest_step_size,
    shortening,
    wrong_way,
)
from eventpound.solvers.fast.extremes import forces_inside_step, inside_step, take_instant
from eventpound.solvers.fast.followed import follows, keep_followed
from eventpound.solvers.fast.links import cross_border, elongations, gap_of, reverse
from eventpound.solvers.fast.locate import first_event
from eventpound.solvers.fast.record import (
    add_work,
    end_if_over,
    is_due,
    pass_time,
    restore_record,
    sample_step,
    write_row,
)
from eventpound.solvers.fast.run import (
    DRIFT,
    LOCAL_SHARE,
    MOST_HALVINGS,
    MOST_STALLS,
    NO_STEP,
    NOT_FINITE,
    PENETRATION,
    PULL,
    STUCK,
    FastObserved,
    FastRun,
    FastState,
)
from eventpound.solvers.fast.search import force_level, set_travel
from eventpound.solvers.fast.sliding import margin_at_rest
from eventpound.tolerances import DRIFTED, FORCE, PENETRATED, PULLED, RELEASED_AT

_SAMPLES = int(Family.SAMPLES)
SOONER = 0.2
"""Part of the length tried that is tried next, at the least, after an event."""


@compiled
def take_step(stop: float, piece: CurrentPiece, run: FastRun) -> int:
    """One step, to `stop` (s) at most; DONE, or why not."""
    plan, state, series, observed = run.plan, run.state, run.series, run.observed
    now, progress = state.now[0], state.progress[0]
    t = now.t
    order, h = _expansion(stop - t, piece, run)
    set_travel(order, h, progress.clusters, series)
    first = first_event(order, h, run)
    tau = min(h, first)
    t_end, g_end, error, pulls = t, 0.0, np.inf, False
    for _again in range(MOST_HALVINGS):
        # t and the rest of the way may add up to another number than the stop.
        t_end = stop if tau == stop - t else t + tau
        g_end = ground_acceleration(piece, t_end)
        observe_at(tau, order, g_end, run)
        error = defect_error(tau, order, g_end, observed.a, series)
        pulls = _pulls(first <= tau, run)
        if progress.resting > 0:
            # One that pulls has passed its release: the step is cut as by any other error.
            error = max(error, 2.0 if pulls else 0.0, _contact_force_error(tau, order, run))
        if error <= 1.0:
            break
        # What was located lies beyond the end now.
        first = np.inf
        tau *= shortening(error, order)
    ended = PULL if pulls else audit(error, run)
    if ended != DONE:
        return ended
    if first <= tau and _still_pressed(tau, run):
        first = np.inf
    fleeting = first <= tau and is_fleeting(tau, now, plan.limits.time)
    if fleeting:
        t_end = t
    if _record_inside(tau, t_end, order, piece, run):
        observe_at_noinline(tau, order, g_end, run)
    take_instant(t_end, run)
    _move(state, observed)
    pass_time(tau, t_end, 1, now, progress)
    if follows(run):
        keep_followed(first <= tau, run)
    if first <= tau:
        # What happens soon after the last event may be followed as soon by the next.
        progress.trial = min(progress.trial, max(tau, SOONER * progress.trial))
        _apply(run)
        if fleeting and progress.due == 1:
            restore_record(run)
    else:
        progress.trial, progress.known = tau, not follows(run)
        end_if_over(run)
    endless = t_end == t and now.in_a_row > LONGEST_CASCADE
    return STUCK if endless or progress.stalled > MOST_STALLS else DONE


@compiled
def _expansion(limit: float, piece: CurrentPiece, run: FastRun) -> tuple[int, float]:
    """Series of everything; their order, and the length of a step of at most `limit` (s)."""
    most, progress = run.plan.limits.order, run.state.progress[0]
    longest, tried = largest_step_size(limit, piece, run)
    order, error = 0, 0.0
    for _again in range(4):
        begin_series(run.state.now[0].t, piece, run)
        order, error = expand(tried, most, run)
        progress.expansions += 1
        progress.known = False
        # A link that was turned round has other terms.
        if not wrong_way(order, run):
            break
    h = choose_step_size(tried, order, error, longest)
    if progress.resting > 0:
        contact_force_series(order, run)
    return order, h


@compiled_deferred.but(ahead=True)
def _record_inside(tau: float, t_end: float, order: int, piece: CurrentPiece, run: FastRun) -> bool:
    """Extremes, energy and rows inside a step; whether `observed` was overwritten."""
    plan, state = run.plan, run.state
    inside_step(tau, order, run)
    # Where a force turns is looked at, too.
    copy_numbers(run.observed.a, run.series.end)
    again = forces_inside_step(tau, order, run.series.end, run)
    if plan.limits.ledger:
        add_work(tau, order, piece, run)
        again = True
    if is_due(t_end, plan.output_times, state.progress[0]):
        sample_step(state.now[0].t, t_end, order, piece, run)
        again = True
    return again


@compiled
def _still_pressed(tau: float, run: FastRun) -> bool:
    """Whether truncation of the series released a contact too soon; the next step finds it."""
    plan, state, located, observed = run.plan, run.state, run.located, run.observed
    if tau <= RELEASED_AT * plan.limits.time:
        return False
    weak = force_level(state.progress[0].clusters, plan.limits, run.series)
    for j in range(observed.gap.size):
        if located.released[j] and margin_at_rest(j, observed.contact_force[j], run) > weak:
            return True
    return False


@compiled
def audit(error: float, run: FastRun) -> int:
    """Invariants after every step: its error, finite numbers, gaps.

    None may penetrate, and one with variables of its own must stay the difference of the
    displacements that it is.
    """
    plan, observed = run.plan, run.observed
    if not error <= 1.0:
        return NO_STEP
    length, contacts = plan.limits.length, plan.contacts
    largest = length
    for b in range(plan.mass.size):
        if not (abs(observed.u[b]) < np.inf and abs(observed.v[b]) < np.inf):
            return NOT_FINITE
        largest = max(largest, abs(observed.u[b]))
    for j in range(observed.gap.size):
        gap, _ = gap_of(j, contacts, observed.u, observed.v)
        if not observed.gap[j] >= -PENETRATED * length:
            return PENETRATION
        # One of a slider that slips is inf.
        if not (abs(gap - observed.gap[j]) <= DRIFTED * largest or observed.gap[j] == np.inf):
            return DRIFT
    return DONE


@compiled_noinline
def _contact_force_error(tau: float, order: int, run: FastRun) -> float:
    """Error of the series of contact forces over a step in units of its tolerance, from its end.

    The end has just been looked at. By these series a contact is let go, and no equation of motion
    shows their error where a support moves what rests on it.
    """
    plan, series, forces = run.plan, run.series, run.series.contact_force
    limits, contacts = plan.limits, plan.contacts
    largest, worst = 0.0, 0.0
    for a in range(plan.links.offset.size):
        largest = max(largest, abs(series.F[a, 0]))
    rounding = FORCE * largest + force_level(run.state.progress[0].clusters, limits, series)
    for j in range(forces.shape[0]):
        if not run.state.unlocked[j]:
            continue
        force, left, right = run.observed.contact_force[j], contacts.left[j], contacts.right[j]
        lighter = min(_mass_at(left, run), _mass_at(right, run))
        scale = lighter * limits.length / limits.time**2
        allowed = LOCAL_SHARE * limits.rtol * (scale + abs(force))
        allowed = max(allowed, rounding)
        worst = max(worst, abs(value_and_slope(forces[j, : order - 1], tau)[0] - force) / allowed)
    return worst


@compiled
def _mass_at(end: int, run: FastRun) -> float:
    """What a contact force has to move at an end by itself (kg), inf at a barrier."""
    return felt_mass(end, run.plan.mass, run.series.free) if end >= 0 else np.inf


@compiled
def _pulls(ends: bool, run: FastRun) -> bool:
    """Whether a contact at rest pulls at the end of a step though nothing lets it go.

    It has then passed the instant that lets it go. `ends`: whether what is to happen at the end
    does.
    """
    state, observed, located = run.state, run.observed, run.located
    if state.progress[0].resting == 0:
        return False
    level = PULLED * force_level(state.progress[0].clusters, run.plan.limits, run.series)
    for j in range(observed.gap.size):
        stays = state.unlocked[j] and not (ends and located.released[j])
        if stays and not margin_at_rest(j, observed.contact_force[j], run) >= -level:
            return True
    return False


@compiled
def _move(state: FastState, observed: FastObserved) -> None:
    """Make the end of the step the present state."""
    copy_numbers(observed.u, state.u)
    copy_numbers(observed.v, state.v)
    for j in range(observed.gap.size):
        state.gap[j], state.gap_rate[j] = observed.gap[j], observed.gap_rate[j]


@compiled
def _apply(run: FastRun) -> None:
    """Do what is located at the end of a step; an event of contacts or kinks is settled next."""
    plan, state, series, located = run.plan, run.state, run.series, run.located
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    for h in range(hysteresis.link.size):
        x = series.x[hysteresis.link[h]]
        # A reversal first: what lies on a border after it is another curve's.
        if located.turned[h]:
            reverse(h, x, hysteresis, state)
        elif located.crossed[h]:
            cross_border(h, x, hysteresis, state)
    due = False
    for j in range(state.gap.size):
        if located.closing[j]:
            state.gap[j] = 0.0
        due = due or located.closing[j] or located.released[j]
    for a in range(state.branch.size):
        due = due or located.kinked[a]
    if due:
        write_row(state.now[0].t, run)
        state.progress[0].due = 1
