"""What an instant demands of contacts with Coulomb friction.

A contact that is closed slips one way or the other, or sticks; its friction is in impacts

    0 <= γ_N⁺ + ε γ_N⁻ ⊥ Λ_N >= 0,   Λ_T ∈ -μ Λ_N Sgn(γ_T⁺)

over all closed contacts that do not separate, or as Poisson's law has it
(`eventpound.contact.poisson`), and between them

    0 <= γ_N' ⊥ λ_N >= 0,   λ_T = -μ λ_N sgn γ_T;   |λ_T| <= μ λ_N and γ_T' = 0 where γ_T = 0

(`eventpound.numerics.coulomb`). Where no contact is about to move in a first rate, the first one in
which one is tells the same of that. One whose force has just vanished opens, and one whose friction
has just come to its bound slips that way, unless they cannot.

Along each contact with friction is a contact that rests while it sticks, whose gap counts as
infinite otherwise, and a link, whose branch is the way of a slip, 0 where there is none.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.impacts import (
    DONE,
    NO_IMPACT,
    PROBLEM,
    close_collapsed,
    close_several,
    clusters_of,
    list_impacts,
    next_problem,
    open_last,
    put_as_one,
    still_several,
)
from eventpound.contact.instant import begin_instant, end_instant, take_rests
from eventpound.contact.kinks import still_rate
from eventpound.contact.poisson import compress_and_expand
from eventpound.contact.rest import ORDER, Touching, free_accelerations, touching_of
from eventpound.contact.rubbing import (
    GAINS,
    NOT_UNIQUE,
    PATH,
    PLACE,
    Rubs,
    Sliding,
    all_joints,
    by_poisson,
    first_holding,
    is_at_bound,
    keep_friction,
    kinds_before,
    list_slides,
    matrix_of_rows,
    slide_of,
    sliding_of,
)
from eventpound.contact.state import Instant, between_now
from eventpound.mechanics.impact import rates_after, take_impulses
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.numerics.coulomb import (
    NO_ANSWER,
    OPEN,
    SEVERAL,
    STICK,
    Rubbing,
    solve_rubbing,
    sticks_well,
    way_of,
)
from eventpound.tolerances import CANCELLED, GAINED, QUIET


@deferred_kernel
def begin_beside_friction(force: Floats, kinked: Bools, rubs: Rubs, at: Instant) -> None:
    """Keep how far contacts have slid, stop slips that have ended, and let sticks slip that have.

    force (K,): of the contacts as the instant begins (N). kinked (L,): links whose rate vanishes.
    """
    own, stopped = first_holding(rubs), False
    held = at.resting.copy()
    for f in range(rubs.contact.size):
        t, a = own + f, slide_of(own + f, at)
        x = difference(at.u, at.left[t], at.right[t])
        if at.resting[rubs.contact[f]] and at.branch[a] != 0:
            rubs.kept[PATH, f] += abs(x - rubs.kept[PLACE, f])
        rubs.kept[PLACE, f] = x
        if at.now[0].here > 0:
            continue
        if at.released[t]:
            at.branch[a] = -1 if force[t] > 0.0 else 1
        elif kinked[a]:
            at.branch[a] = 0
        held[t] |= kinked[a]
        stopped |= kinked[a]
    if stopped:
        put_as_one(clusters_of(held, at.resting, at), False, at.mass, at.v)
    for f in range(rubs.contact.size):
        t = own + f
        at.gap[t] = np.inf
        at.gap_rate[t] = 0.0 if held[t] else difference(at.v, at.left[t], at.right[t])
    _still_slides(rubs, at)


@scalar_kernel
def _still_slides(rubs: Rubs, at: Instant) -> None:
    """Let contacts that slide so slowly that it has no direction not slide."""
    still = still_rate(at.length, at.time)
    for t in range(first_holding(rubs), at.gap.size):
        at.gap_rate[t] = at.gap_rate[t] if abs(at.gap_rate[t]) > still else 0.0


@deferred_kernel
def settle_with_friction(rubs: Rubs, at: Instant) -> int:
    """Impacts of an instant; ends as `settle_impacts`, or NOT_UNIQUE or GAINS."""
    begin_instant(at)
    close_collapsed(at)
    close_several(at)
    ended = _impacts(rubs, at)
    _still_slides(rubs, at)
    if ended == DONE and at.now[0].here > 0:
        own = first_holding(rubs)
        for f in range(rubs.contact.size):
            j, t = rubs.contact[f], own + f
            closed = at.gap[j] == 0.0 and at.gap_rate[j] == 0.0
            at.gap[t] = 0.0 if closed and at.gap_rate[t] == 0.0 else np.inf
        still_several(at)
        at.gap[own:] = np.inf
    return end_instant(ended, at)


@kernel
def _impacts(rubs: Rubs, at: Instant) -> int:
    """Impact problems until no closed contact approaches."""
    shut = at.gap == 0.0
    while True:
        ended, plastic = next_problem(shut, at)
        if ended != PROBLEM:
            return ended
        ended = _impact(plastic, shut, rubs, at)
        if ended != DONE:
            return ended


@kernel
def _impact(plastic: bool, shut: Bools, rubs: Rubs, at: Instant) -> int:
    """One impact problem; DONE, or how it fails."""
    before = at.gap_rate.copy()
    involved = shut & (before <= 0.0)
    sliding = sliding_of(np.flatnonzero(involved), rubs)
    members, rows, k = sliding.members, sliding.rows, sliding.members.size
    expands = by_poisson(rubs, at)
    # What Newton's law asks of γ_N⁺; a last impact ends with its compression.
    eps = np.zeros(before.size) if plastic or expands else at.restitution
    q = np.zeros(2 * k)
    for a in range(2 * k):
        if rows[a] >= 0:
            q[a] = (1.0 + eps[rows[a]] if a < k else 1.0) * before[rows[a]]
    noise = QUIET * np.max(-before[members])
    G, friction = matrix_of_rows(rows, at), rubs.friction[members]
    problem = Rubbing(G, q, friction, np.zeros(k, np.int64), np.full(2 * k, noise))
    x, w, state = np.zeros(2 * k), np.zeros(2 * k), np.zeros(k, np.int64)
    if expands and not plastic:
        found = compress_and_expand(problem, at.restitution[members], x, w, state)
    else:
        found = solve_rubbing(problem, x, w, state)
    if found in (NO_ANSWER, SEVERAL):
        return NO_IMPACT if found == NO_ANSWER else NOT_UNIQUE
    for i in range(k):
        # Least forces leave rounding, which would move what nothing pushes across.
        x[k + i] = x[k + i] if abs(x[k + i]) > CANCELLED * x[i] else 0.0
    impulse, opening, passed = np.zeros(before.size), np.zeros(k), 0.0
    joints, real = all_joints(at), rows >= 0
    rounding = take_impulses(joints, at.mass, rows[real], x[real], shut, at.gap_rate, at.v)
    for i in range(k):
        impulse[members[i]] = x[i]
        opening[i] = w[i] if w[i] > rounding[members[i]] else 0.0
    lost = rates_after(members, before[members], eps, noise, impulse, opening, at.gap_rate)
    for i in range(k):
        passed -= x[i] * before[members[i]]
        # None by Newton's law: what opens faster than that asks has no impulse.
        lost -= 0.5 * x[i] * opening[i]
        t = rows[k + i]
        if t >= 0:
            at.gap_rate[t] = w[k + i]
            by_friction = -0.5 * x[k + i] * (before[t] + w[k + i])
            lost += by_friction
            f = t - first_holding(rubs)
            keep_friction(f, x[i], x[k + i], by_friction, rubs.kept)
    if lost < -GAINED * passed:
        return GAINS
    open_last(plastic, shut, at)
    list_impacts(plastic, before, impulse, involved, lost, at)
    return DONE


@deferred_kernel
def decide_friction(z: Floats, forcing: Forcing, noise: float, rubs: Rubs, at: Instant) -> int:
    """Who rests, sticks or slips after the impacts of an instant; ends as `take_rests`.

    Parameters
    ----------
    z : ndarray, shape (H,)
        Hysteretic variables.
    forcing : Forcing
        The ground motion from now on.
    noise : float
        Contact forces below this (N) have no meaningful sign.
    rubs : Rubs
        The contacts with friction.
    at : Instant
        The instant, its impacts over.
    """
    K = at.gap.size
    resting, pressed = np.zeros(K, np.bool_), np.zeros(K, np.bool_)
    at.now[0].stale = True
    touching = touching_of(between_now(at), z, forcing, at)
    sliding = sliding_of(np.flatnonzero(touching.undecided), rubs)
    before = kinds_before(sliding, at)
    ended, x, w, state, level = _solve(sliding, touching, rubs, at)
    k, groups = sliding.members.size, at.now[0].groups
    for i in range(k):
        j, closed = sliding.members[i], state[i] != OPEN
        pressed[j] = closed and x[i] > noise
        resting[j] = closed or (w[i] <= level[i] and not at.released[j])
    _take_ways(sliding, state, resting, pressed, rubs, at)
    if ended == SEVERAL:
        return NOT_UNIQUE
    ended = take_rests(resting, pressed, ended != NO_ANSWER, at)
    if ended == DONE:
        list_slides(sliding, before, state, groups, at)
    return ended


@kernel
def _ways(sliding: Sliding, at: Instant) -> tuple[Ints, Bools]:
    """Ways of slip (k,) that are known, and whether from friction at its bound, not from a rate.

    Its bound has just been reached, or is that of a contact that slides no more than others let it.
    """
    k = sliding.members.size
    ways, bound = np.zeros(k, np.int64), np.zeros(k, np.bool_)
    for i in range(k):
        t = sliding.rows[k + i]
        if t < 0:
            continue
        if at.gap_rate[t] != 0.0:
            ways[i] = 1 if at.gap_rate[t] > 0.0 else -1
        elif at.released[t] or is_at_bound(sliding.members[i], t, at):
            ways[i], bound[i] = at.branch[slide_of(t, at)], True
    return ways, bound


@kernel
def _solve(
    sliding: Sliding, touching: Touching, rubs: Rubs, at: Instant
) -> tuple[int, Floats, Floats, Ints, Floats]:
    """Forces, accelerations and states of contacts that touch, and the noise of the second.

    They are those of the first order in which one is about to move.
    """
    rows, k = sliding.rows, sliding.members.size
    G, friction = matrix_of_rows(rows, at), rubs.friction[sliding.members]
    x, w, state = np.zeros(2 * k), np.zeros(2 * k), np.full(k, STICK)
    q, level, (ways, bound) = np.zeros(2 * k), np.zeros(2 * k), _ways(sliding, at)
    for highest in (1, ORDER):
        found, noise = free_accelerations(highest, touching)
        for order in range(highest):
            moves = False
            for a in range(2 * k):
                if rows[a] >= 0:
                    left, right = at.left[rows[a]], at.right[rows[a]]
                    q[a], level[a] = difference(found[order], left, right), 0.0
                    for end in (left, right):
                        level[a] = max(level[a], noise[order, end] if end >= 0 else 0.0)
                    moves |= abs(q[a]) > level[a]
            if moves:
                problem = Rubbing(G, q, friction, ways, level)
                ended = _answer(sliding, bound, problem, at, x, w, state)
                return ended, x, w, state, level
    # Nothing moves at all, and stays so.
    return 0, x, w, state, level


@kernel
def _answer(
    sliding: Sliding, bound: Bools, problem: Rubbing, at: Instant, x: Floats, w: Floats, state: Ints
) -> int:
    """Solve a problem in which those just released are open, or slip, where they can.

    First it is asked whether those whose friction is at its `bound` (k,) stick with less of it, as
    others may take it over where friction is not unique.
    """
    known = problem.way.copy()
    if bound.any():
        problem.way[bound] = 0
        outcome = _answer_where_open(sliding, bound, problem, at, x, w, state)
        taken_over = outcome not in (NO_ANSWER, SEVERAL)
        for i in range(bound.size):
            well = state[i] == STICK and sticks_well(i, x, problem.friction)
            taken_over &= well or not bound[i]
        if taken_over:
            return outcome
        problem.way[:] = known
    return _answer_where_open(sliding, bound, problem, at, x, w, state)


@kernel
def _answer_where_open(
    sliding: Sliding, bound: Bools, problem: Rubbing, at: Instant, x: Floats, w: Floats, state: Ints
) -> int:
    """The same with the ways of slip as they are given, or free where these cannot be."""
    k = sliding.members.size
    kept, ways = np.ones(k, np.bool_), problem.way
    for i in range(k):
        kept[i] = not at.released[sliding.members[i]]
    while True:
        outcome = _solve_some(np.flatnonzero(kept), problem, x, w, state)
        again = False
        for i in range(k):
            if not kept[i] and w[i] < -problem.noise[i]:
                # Others press it down again.
                kept[i] = again = True
            elif kept[i] and bound[i] and ways[i] != 0:
                # It does not go the way in which friction has come to its bound.
                slips = way_of(state[i]) != 0
                if outcome == NO_ANSWER or (slips and ways[i] * w[k + i] < -problem.noise[k + i]):
                    ways[i], again = 0, True
        if not again:
            return outcome


@kernel
def _solve_some(members: Ints, problem: Rubbing, x: Floats, w: Floats, state: Ints) -> int:
    """Solve the problem of some of k contacts, the others open."""
    k, m = problem.way.size, members.size
    rows = np.concatenate((members, k + members))
    G = np.empty((2 * m, 2 * m))
    for a in range(2 * m):
        for b in range(2 * m):
            G[a, b] = problem.G[rows[a], rows[b]]
    friction, way = problem.friction[members], problem.way[members]
    own = Rubbing(G, problem.q[rows], friction, way, problem.noise[rows])
    force, rate, states = np.zeros(2 * m), np.zeros(2 * m), np.zeros(m, np.int64)
    outcome = solve_rubbing(own, force, rate, states)
    x[:], state[:] = 0.0, OPEN
    x[rows], state[members] = force, states
    for a in range(2 * k):
        w[a] = problem.q[a]
        for b in range(2 * k):
            w[a] += problem.G[a, b] * x[b]
    w[rows] = rate
    return outcome


@kernel
def _take_ways(
    sliding: Sliding, state: Ints, resting: Bools, pressed: Bools, rubs: Rubs, at: Instant
) -> None:
    """Branches, and who sticks (K,) where, from the states of the contacts that touch."""
    k = sliding.members.size
    for t in range(first_holding(rubs), at.gap.size):
        at.branch[slide_of(t, at)], at.gap[t] = 0, np.inf
    for i in range(k):
        t = sliding.rows[k + i]
        if t < 0 or not resting[sliding.members[i]]:
            continue
        if state[i] == STICK:
            resting[t] = pressed[t] = True
            at.gap[t], at.gap_rate[t] = 0.0, 0.0
            if not at.resting[t]:
                at.opening[t] = -difference(at.u, at.left[t], at.right[t])
        else:
            at.branch[slide_of(t, at)] = way_of(state[i])
