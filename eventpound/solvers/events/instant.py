"""What an instant demands, and the short steps that follow it, until nothing is near.

Impacts, the acceleration problem, the mode that follows
(`eventpound.contact.modes` tabulates them), then steps on the local
series: cascades whose intervals are too short for an integrator (accumulating
bounces, a light body caught between heavy ones, a chain of plastic contacts)
are followed impact by impact until `eventpound.contact.cascade` calls them over.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import INTERVAL, LONGEST_CASCADE, RESTED_AT, T
from eventpound.contact.event_rows import (
    end_cascade,
    events_wanted,
    gather_unlisted,
    write_changes,
)
from eventpound.contact.impacts import (
    DONE,
    FULL,
    NO_FORCES,
    end_impacts,
    settle_closed,
)
from eventpound.contact.modes import ACCELERATION, duty
from eventpound.mechanics.observables import difference
from eventpound.mechanics.series import evaluate_series
from eventpound.motion.forcing import next_corner
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.lending import lend
from eventpound.solvers.events.dense import Dense, DenseStep, look
from eventpound.solvers.events.event_bounds import update_extremes
from eventpound.solvers.events.law_contacts import gather, turn_elements
from eventpound.solvers.events.location import (
    anything,
    forget,
)
from eventpound.solvers.events.present import (
    closed_of,
    forcing_now,
    forget_held,
    hold,
    make_ready,
    pass_kinks,
    put_instant,
    put_present,
    take,
)
from eventpound.solvers.events.recorder import PASSED, WRITTEN, is_due
from eventpound.solvers.events.rest import Touching, rest_contacts
from eventpound.solvers.events.run import (
    KNOTS,
    PHASE,
    POINTS,
    SHORT_STEPS,
    STALE,
    STEPS,
    TAKEN_AT,
    Dynamics,
    Piece,
    Run,
)
from eventpound.solvers.events.second_look import (
    BROKEN,
    end_of_look,
    look_again,
    look_between,
)
from eventpound.solvers.events.short_series import local_series
from eventpound.solvers.events.step_check import broken_contact
from eventpound.tolerances import FLEETING, SPEED

MOST_KNOTS = 3
"""Reversals of links after which short steps end although no event is in sight."""
(DUTIES, RESTS, ARRIVAL, FLIGHT, AGAIN, TAKE, READY, LAST) = range(8)
"""What is to be done next: impacts; who rests; the instant into the history; a short step. Or
only this: look again at a step of an integrator; make the state vector of the run the
present state; make the present instant ready for a step; put it, the last, into the history."""
(OVER, NEW_MODE, PAUSED, FIRST_BRANCHES, AT_POINTS) = range(20, 25)
"""How `proceed` returns beside the ends of impacts: nothing is near; the mode is another;
steps are used up; links have no branch yet; what is to be done is that of
`eventpound.solvers.events.point_instant`."""
NOT_FINITE, UNENDING = 30, 32
"""How it fails, beside BROKEN: no numbers; more than `LONGEST_CASCADE` steps."""


@kernel
def turn_at_kinks(run: Run) -> None:
    """Put links that are on their kinks on the sides to which they move after an impact."""
    rules, state = run.rules, run.state
    still = SPEED * rules.length / rules.time
    for a in range(state.branch.size):
        if state.branch[a] == 0:
            continue
        first, second = rules.link_ends[a, 0], rules.link_ends[a, 1]
        x, rate = difference(state.u, first, second), difference(state.v, first, second)
        if abs(x - rules.offset[a]) <= rules.length_noise and abs(rate) > still:
            side = -1 if rate < 0.0 else 1
            state.count[STALE] |= side != state.branch[a]
            state.branch[a] = side


@kernel
def _spare_moved(before: Floats, run: Run) -> None:
    """What presses the bodies that an impact has moved is another matter than before it."""
    rules, v, released = run.rules, run.state.v, run.happened.released
    for j in range(released.size):
        for body in (rules.left[j], rules.right[j]):
            if body >= 0 and v[body] != before[body]:
                released[j] = False


@kernel
def _do_duties(run: Run) -> int:
    """Impacts of the present instant; ends as `settle_closed` does."""
    state = run.state
    before = state.v.copy()
    ended = settle_closed(lend(closed_of(run)))
    _spare_moved(before, run)
    if ended == DONE:
        end_impacts(state.clock, state.count)
        turn_at_kinks(run)
        state.count[PHASE] = RESTS
    return ended


@scalar_kernel
def any_may_rest(gap: Floats, gap_rate: Floats, resting: Bools) -> bool:
    """Whether a contact rests, or is closed and still."""
    some = False
    for j in range(gap.size):
        some = some or resting[j] or duty(gap[j], gap_rate[j]) == ACCELERATION
    return some


@kernel
def touching_of(undecided: Bools, run: Run, piece: Piece) -> Touching:
    """The acceleration problem of the present instant over contacts with g = γ = 0."""
    rules, state = run.rules, run.state
    stiffness = np.where(state.branch < 0, rules.compression, rules.extension)
    return Touching(
        undecided,
        run.happened.released,
        state.u,
        state.v,
        state.z,
        rules.left,
        rules.right,
        rules.gap,
        rules.mass,
        rules.link_ends,
        rules.law,
        rules.hysteretic,
        stiffness,
        -stiffness * rules.offset,
        forcing_now(piece, state.clock[T]),
        SPEED * rules.length / rules.time,
        rules.length / rules.time**2,
        rules.time,
    )


@kernel
def take_rests(resting: Bools, pressed: Bools, run: Run) -> None:
    """Make contacts (K,) the resting ones; records who came to rest or opened."""
    state, events = run.state, run.record.events
    for j in range(resting.size):
        if resting[j] and not state.resting[j]:
            gather_unlisted(j, state.count, events)
    write_changes(state.resting, resting, state.gap_rate, state.clock, state.count, events)
    for j in range(resting.size):
        changed = state.resting[j] != resting[j] or state.pressed[j] != pressed[j]
        state.count[STALE] |= changed
        state.resting[j], state.pressed[j] = resting[j], pressed[j]
        if resting[j]:
            state.gap_rate[j] = 0.0
    state.count[PHASE] = ARRIVAL


@kernel
def _decide_rests(run: Run, piece: Piece) -> int:
    """Acceleration problem; records who came to rest or opened. DONE or NO_FORCES.

    The contacts of a problem without a solution are marked as resting.
    """
    state = run.state
    undecided = (state.gap == 0.0) & (state.gap_rate == 0.0)
    resting, pressed = undecided, undecided.copy()
    if undecided.any():
        resting, pressed, solved = rest_contacts(touching_of(undecided, run, piece))
        if not solved:
            for j in range(resting.size):
                state.resting[j] = resting[j]
            return NO_FORCES
    take_rests(resting, pressed, run)
    return DONE


@scalar_kernel
def is_fleeting(tau: float, clock: Floats, time: float) -> bool:
    """Whether a mode that ends after tau (s) is none: a contact has only just come to rest.

    `time`: the scene's own (s).
    """
    return clock[T] - clock[RESTED_AT] + tau < FLEETING * time


@kernel
def _short_step(run: Run, mode: Dynamics, piece: Piece) -> int:
    """A step on the local series to what happens, perhaps nothing; DONE, OVER or how it fails."""
    rules, state, record, happened = run.rules, run.state, run.record, run.happened
    clock, count = state.clock, state.count
    t = clock[T]
    stop = next_corner(piece, t, piece.stop)
    forcing = forcing_now(piece, t)
    series = local_series(run, forcing, mode, stop - t)
    if not series.finite:
        return NOT_FINITE
    springs = mode.watched.springs
    # The arrays of `series` are kept alive by its use at the end.
    step = lend(DenseStep(series.dense, mode, forcing, run.looks[2]))
    tau = series.dense.end
    look(tau, lend(DenseStep(series.dense, mode, forcing, run.looks[1])))
    located, marked = look_between(tau, run, mode, step)
    if located < np.inf:
        tau = located
    else:
        forget(happened)
        for j in range(series.closing.size):
            happened.closing[j] = series.closing[j]
    any_event = anything(happened)
    pass_kinks(happened, state)
    fleeting = any_event and is_fleeting(tau, clock, rules.time)
    # Where a mode is none no time passes either.
    end = t if fleeting else t + tau
    if marked or is_due(end, record.journal):
        end_of_look(tau, marked, run, step)
    if run.laws.contact.size > 0:
        gather(tau, run, step)
    look(tau, step)
    seen = step.seen
    if fleeting:
        forget_held(record)
    elif any_event:
        put_instant(end, seen, record)
    else:
        update_extremes(seen, springs, end, record.running)
    if broken_contact(seen, mode.watched, rules.length_noise) >= 0:
        clock[T] = end
        return BROKEN
    take(evaluate_series(series.dense.Y, tau)[0], end, mode, forcing, state)
    for j in range(state.gap.size):
        if state.gap[j] == np.inf:
            continue
        closes = happened.closing[j]
        state.gap[j], state.gap_rate[j] = 0.0 if closes else seen.gap[0, j], seen.gap[1, j]
    if tau > 0.0:
        # What was closed already did not fly.
        clock[INTERVAL] = tau
    count[KNOTS] = 0 if any_event else count[KNOTS] + series.knot
    count[STEPS] += 1
    count[SHORT_STEPS] += 1
    count[PHASE] = DUTIES if any_event else FLIGHT
    again = series.knot and count[KNOTS] <= MOST_KNOTS
    return DONE if any_event or mode.system.mass.size == 0 or again else OVER


@kernel
def proceed(
    most: int,
    run: Run,
    mode: Dynamics,
    piece: Piece,
    dense: Dense,
) -> int:
    """Do what is to be done at the present instant, and follow the motion until nothing is near.

    All that Python asks for is one function, since most of it shares most of its parts.

    Parameters
    ----------
    most : int
        Steps of the run after which it pauses.
    run : Run
        The run, which goes on where `count[PHASE]` says; on loan.
    mode : Dynamics
        The present mode; on loan.
    piece : Piece
        The ground motion.
    dense : Dense
        The step to be looked at again, where that is what is to be done.

    Returns
    -------
    int
        OVER, where the run is made ready for an integrator, or another of the ends above.
    """
    count = run.state.count
    if count[PHASE] == AGAIN:
        return look_again(run, mode, piece, dense)
    if count[PHASE] == TAKE:
        t = run.state.clock[TAKEN_AT]
        take(run.y[: mode.system.size], t, mode, forcing_now(piece, t), run.state)
        return OVER
    if count[PHASE] in (READY, LAST):
        make_ready(run, mode, piece)
        if count[PHASE] == LAST:
            put_present(run, False)
        return OVER
    return _settle(most, run, mode, piece)


@kernel
def _settle(most: int, run: Run, mode: Dynamics, piece: Piece) -> int:
    """Follow the motion from the present instant until nothing is near; ends as `proceed`."""
    state = run.state
    clock, count = state.clock, state.count
    ended = DONE
    while ended == DONE:
        if not _has_room(run):
            return FULL
        if count[POINTS] > 0 and count[PHASE] <= RESTS:
            return AT_POINTS
        if count[PHASE] == DUTIES:
            ended = _do_duties(run)
            if ended != DONE:
                return ended
        if count[PHASE] == RESTS:
            if lacks_branch(run):
                return FIRST_BRANCHES
            if run.laws.contact.size > 0:
                turn_elements(run)
            may_rest = any_may_rest(state.gap, state.gap_rate, state.resting)
            if may_rest and _decide_rests(run, piece) != DONE:
                return NO_FORCES
            count[PHASE] = ARRIVAL
        if count[PHASE] == ARRIVAL:
            if count[STALE]:
                return NEW_MODE
            if is_fleeting(0.0, clock, run.rules.time):
                hold(run.record)
            make_ready(run, mode, piece)
            put_present(run, True)
            count[PHASE] = FLIGHT
        if clock[T] >= piece.stop:
            ended = OVER
        elif count[STEPS] >= most:
            return PAUSED
        elif count[SHORT_STEPS] >= LONGEST_CASCADE:
            return UNENDING
        else:
            ended = _short_step(run, mode, piece)
            if count[PHASE] == FLIGHT:
                make_ready(run, mode, piece)
    if ended == OVER:
        end_cascade(state.resting, count, run.record.events)
    return ended


@kernel
def _has_room(run: Run) -> bool:
    """Whether the record can take what an instant and a step may write, at the least."""
    journal, count, events = run.record.journal, run.state.count, run.record.events
    rows = journal.cursor[WRITTEN] + journal.times.size - journal.cursor[PASSED] + 4
    wanted = events_wanted(run.state.gap.size, count)
    return rows <= journal.rows.shape[0] and wanted <= events.shape[0]


@kernel
def lacks_branch(run: Run) -> bool:
    """Whether a kinked link has no branch yet: at the start of a run."""
    rules, branch = run.rules, run.state.branch
    for a in range(branch.size):
        if branch[a] == 0 and rules.compression[a] != rules.extension[a]:
            return True
    return False
