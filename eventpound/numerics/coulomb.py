"""Contacts with Coulomb friction: which separate, slip and stick, and whether that is unique.

Of k contacts with normal and tangential forces N, T, and what these change, ``w = G x + q`` with
``x = (N, T)``: velocities and impulses of an impact, or accelerations and forces,

    0 <= w_N ⊥ N >= 0,   T ∈ -μ N Sgn(w_T)

where no velocity tells the way of slip already; where one does, ``T = -σ μ N``. G is symmetric and
positive semidefinite, and yet for large μ there may be no answer or several (P. Painlevé, C. R.
Acad. Sci. Paris 121, 1895; Ch. Glocker, Set-Valued Force Laws, 2001).

A *state* of all contacts, each open, slipping one way or the other, or sticking, makes a linear
system; its solution answers where it keeps the inequalities. All states of few contacts are gone
through, and so every answer is known. Answers with the same w are one, since for a G ``Wᵀ M⁻¹ W``
these are the same motion. For many contacts Lemke's method finds one answer
(`eventpound.numerics.lemke`), and whether it is unique stays unknown.

Friction of contacts that stick is not always unique: the two corners of an edge share what one
could carry. Any split within the cones has the same motion. Of all splits the least forces are
tried first; where these leave a cone another one may not, and then a corner of the set of splits
does not: in it a contact is at the bound of its friction and counts as slipping, though nothing
slides. Corners are states with independent equations, and so a split is found where there is one
as long as normal forces are unique.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.numerics.graph import root
from eventpound.numerics.lemke import solve_lemke
from eventpound.numerics.small_systems import (
    dot,
    independent_columns,
    invert,
    rounding_growth,
    solve_by_inverse,
)
from eventpound.tolerances import DEPENDENT, LCP_ROUNDING, SAME_ANSWER, TAKEN_OVER

OPEN, FORWARD, BACKWARD, STICK = range(4)
"""States of a contact: apart, slipping with w_T >= 0 or the other way, sticking."""
UNIQUE, ANSWERED, NO_ANSWER, SEVERAL = range(4)
"""What came of a problem: one answer; one, others not excluded; none found; different ones."""
MOST_STATES = 1024
"""States of contacts that are gone through; those of five."""


class Rubbing(NamedTuple):
    """A problem of k contacts.

    G (2k, 2k), q (2k,): normal rows in front, tangential ones behind. friction (k,): μ. way (k,):
    1 or -1 where a velocity tells the way of slip, else 0. noise (2k,): what q may be wrong by.
    """

    G: Floats
    q: Floats
    friction: Floats
    way: Ints
    noise: Floats


@scalar_kernel
def _is_given(i: int, problem: Rubbing) -> bool:
    """Whether contact i has no choice but between open and one way of slip."""
    # Without friction it is all the same which.
    return problem.way[i] != 0 or problem.friction[i] == 0.0


@scalar_kernel
def way_of(state: int) -> int:
    """The way of slip in a state: 1, -1, or 0 where there is none."""
    return 1 if state == FORWARD else -1 if state == BACKWARD else 0


@scalar_kernel
def _drag(i: int, state: int, problem: Rubbing) -> float:
    """T of a contact for N = 1, in a state of slip."""
    return -way_of(state) * float(problem.friction[i])


@scalar_kernel
def _slipping(i: int, problem: Rubbing) -> int:
    """The way of slip of a contact that has no choice."""
    return BACKWARD if problem.way[i] < 0 else FORWARD


@scalar_kernel
def _next_state(state: Ints, problem: Rubbing) -> bool:
    """Go on to the next state of all contacts, as a counter does; False after the last."""
    for i in range(state.size):
        if not _is_given(i, problem):
            state[i] = (state[i] + 1) % 4
        elif state[i] == OPEN:
            state[i] = _slipping(i, problem)
        else:
            state[i] = OPEN
        if state[i] != OPEN:
            return True
    return False


@kernel
def _columns(state: Ints, problem: Rubbing) -> tuple[Ints, Floats]:
    """Rows of w that vanish in a state (n,), and what each unknown does to all rows, (2k, n).

    The unknowns are N of contacts that are closed, with the friction of those that slip, and T of
    those that stick.
    """
    k, G = state.size, problem.G
    rows, effect, n = np.empty(2 * k, np.int64), np.empty((2 * k, 2 * k)), 0
    for i in range(k):
        if state[i] != OPEN:
            rows[n], effect[:, n] = i, G[:, i]
            if state[i] != STICK:
                effect[:, n] += _drag(i, state[i], problem) * G[:, k + i]
            n += 1
    for i in range(k):
        if state[i] == STICK:
            rows[n], effect[:, n] = k + i, G[:, k + i]
            n += 1
    return rows[:n], effect[:, :n]


@kernel
def _least_forces(
    stuck: Bools, matrix: Floats, effect: Floats, right: Floats
) -> tuple[Floats, float]:
    """Solve dependent equations with the least forces; spread as `_unknowns` has it.

    Forces of contacts that stick (n,) alone may do nothing together: any other would take part in
    the motion.
    """
    kept = independent_columns(effect, DEPENDENT)
    own = np.flatnonzero(kept)
    m, n = own.size, kept.size
    part, inverse, found = np.empty((m, m)), np.empty((m, m)), np.zeros(n)
    for a in range(m):
        part[a] = matrix[own[a]][own]
    if not invert(part.copy(), inverse, DEPENDENT):
        return found, np.inf
    found[own] = solve_by_inverse(part, inverse, right[own])
    idle, count = np.zeros((n - m, n)), 0
    for a in range(n):
        if kept[a]:
            continue
        z = idle[count]
        z[own], z[a] = -solve_by_inverse(part, inverse, matrix[own, a]), 1.0
        for b in range(n):
            if not stuck[b] and abs(z[b]) > DEPENDENT:
                return found, np.inf
        for b in range(count):
            z -= dot(idle[b], z) * idle[b]
        z /= np.sqrt(dot(z, z))
        found -= dot(z, found) * z
        count += 1
    return found, rounding_growth(inverse)


@kernel
def _unknowns(state: Ints, rows: Ints, effect: Floats, problem: Rubbing) -> tuple[Floats, float]:
    """Forces (n,) in a state, and how much rounding is multiplied by; inf where there are none."""
    k, n = state.size, rows.size
    matrix, inverse, right = np.empty((n, n)), np.empty((n, n)), np.empty(n)
    stuck = np.empty(n, np.bool_)
    for a in range(n):
        matrix[a], right[a] = effect[rows[a]], -problem.q[rows[a]]
        stuck[a] = state[rows[a] % k] == STICK
    if invert(matrix.copy(), inverse, DEPENDENT):
        return solve_by_inverse(matrix, inverse, right), rounding_growth(inverse)
    return _least_forces(stuck, matrix, effect, right)


@kernel
def solve_state(state: Ints, problem: Rubbing) -> tuple[Floats, Floats, float]:
    """Forces and motion in a state, and how far they are from an answer.

    Returns
    -------
    x, w : ndarray, shape (2k,)
        What solves its equations; the least forces where those of sticks are not unique.
    excess : float
        By how much an inequality fails, as part of the rounding that is allowed; up to 1 it is an
        answer, and inf where the equations depend on each other otherwise.
    """
    k, x, w = state.size, np.zeros(2 * state.size), np.zeros(2 * state.size)
    rows, effect = _columns(state, problem)
    found, spread = _unknowns(state, rows, effect, problem)
    if spread == np.inf:
        return x, w, np.inf
    rounding, left = 0.0, 0.0
    for i in range(2 * k):
        w[i], terms = problem.q[i], abs(problem.q[i])
        for a in range(rows.size):
            w[i] += effect[i, a] * found[a]
            terms += abs(effect[i, a] * found[a])
        rounding = max(rounding, LCP_ROUNDING * terms + problem.noise[i])
    for a in range(rows.size):
        # Of dependent equations those left out hold, too, or there is no such motion.
        left = max(left, abs(w[rows[a]]))
        x[rows[a]], w[rows[a]] = found[a], 0.0
    for i in range(k):
        if way_of(state[i]) != 0:
            x[k + i] = _drag(i, state[i], problem) * x[i]
    failing = _failing(state, x, w, problem) if left <= rounding * spread else np.inf
    return x, w, failing / (rounding * spread) if failing > 0.0 else 0.0


@scalar_kernel
def _failing(state: Ints, x: Floats, w: Floats, problem: Rubbing) -> float:
    """By how much an inequality of a state fails."""
    k, most = state.size, 0.0
    for i in range(k):
        if state[i] == OPEN:
            most = max(most, -w[i])
            continue
        most = max(most, -x[i])
        if state[i] == STICK:
            most = max(most, abs(x[k + i]) - problem.friction[i] * x[i])
        elif not _is_given(i, problem):
            most = max(most, -way_of(state[i]) * w[k + i])
    return most


@scalar_kernel
def sticks_well(i: int, x: Floats, friction: Floats) -> bool:
    """Whether friction of contact i is well below its bound, forces x (2k,)."""
    bound = friction[i] * x[i]
    return bound - abs(x[friction.size + i]) > TAKEN_OVER * bound


@scalar_kernel
def _held_well(state: Ints, x: Floats, problem: Rubbing) -> int:
    """How many contacts stick with less than their bounds."""
    count = 0
    for i in range(state.size):
        count += state[i] == STICK and sticks_well(i, x, problem.friction)
    return count


@kernel
def _go_through(problem: Rubbing) -> tuple[Floats, Floats, Ints, int]:
    """Every state; of answers with one motion that with most sticks, then the most exact one."""
    k = problem.way.size
    state, best = np.zeros(k, np.int64), np.zeros(k, np.int64)
    x, w, least, outcome = np.zeros(2 * k), np.zeros(2 * k), np.inf, NO_ANSWER
    most, going = -1, True
    while going:
        force, motion, excess = solve_state(state, problem)
        if excess <= 1.0:
            if outcome == NO_ANSWER:
                outcome = UNIQUE
            elif np.max(np.abs(motion - w)) > SAME_ANSWER:
                outcome = SEVERAL
            sticks = _held_well(state, force, problem)
            if sticks > most or (sticks == most and excess < least):
                x, w, least, most = force, motion, excess, sticks
                best[:] = state
        going = _next_state(state, problem)
    return x, w, best, outcome


@kernel
def _free(problem: Rubbing) -> Ints:
    """Contacts whose way of slip is open."""
    free, count = np.empty(problem.way.size, np.int64), 0
    for i in range(problem.way.size):
        if not _is_given(i, problem):
            free[count] = i
            count += 1
    return free[:count]


@kernel
def _by_lemke(problem: Rubbing) -> tuple[Floats, Floats, Ints, int]:
    """One answer to a problem of many contacts.

    Free contacts have ``T = R - μ N``: R, and what is left of 2 μ N, are complementary to the two
    ways of slip.
    """
    k, G, free = problem.way.size, problem.G, _free(problem)
    count = free.size
    M, right = np.zeros((k + 2 * count, k + 2 * count)), np.zeros(k + 2 * count)
    for i in range(k + count):
        row = i if i < k else k + free[i - k]
        right[i] = problem.q[row]
        for j in range(k):
            M[i, j] = G[row, j] + _drag(j, _slipping(j, problem), problem) * G[row, k + j]
        for f in range(count):
            M[i, k + f] = G[row, k + free[f]]
    for f in range(count):
        M[k + f, k + count + f] = 1.0
        M[k + count + f, free[f]] = 2.0 * problem.friction[free[f]]
        M[k + count + f, k + f] = -1.0
    z, solved = solve_lemke(M, right)
    state = np.zeros(k, np.int64)
    for i in range(k):
        state[i] = _slipping(i, problem) if z[i] > 0.0 else OPEN
    for f in range(count):
        i = free[f]
        if z[i] > 0.0 and z[k + f] > 0.0:
            ends = z[k + f] >= 2.0 * problem.friction[i] * z[i] * (1.0 - DEPENDENT)
            state[i] = BACKWARD if ends else STICK
    # From the state anew, without the rounding of many pivots.
    x, w, excess = solve_state(state, problem)
    if not (solved and excess <= 1.0):
        return x, w, state, NO_ANSWER
    # It is a corner of all answers with this motion: rather the one in which what need not slides.
    still = state.copy()
    for i in free:
        still[i] = STICK if state[i] != OPEN and abs(w[k + i]) <= SAME_ANSWER else state[i]
    force, motion, excess = solve_state(still, problem)
    if excess <= 1.0 and np.max(np.abs(motion - w)) <= SAME_ANSWER:
        return force, motion, still, ANSWERED
    return x, w, state, ANSWERED


@kernel
def _parts(G: Floats) -> Ints:
    """Parts of contacts (k,) that do not influence each other."""
    k = G.shape[0] // 2
    parent = np.arange(k)
    for i in range(k):
        for j in range(i):
            if np.any(G[i::k, j::k] != 0.0):
                parent[root(parent, i)] = root(parent, j)
    label = np.empty(k, np.int64)
    for i in range(k):
        label[i] = root(parent, i)
    return label


@kernel
def _states(problem: Rubbing) -> int:
    """How many states the contacts have together, or more than are gone through."""
    count = 1
    for i in range(problem.way.size):
        count *= 2 if _is_given(i, problem) else 4
        if count > MOST_STATES:
            break
    return count


@kernel
def _of_part(rows: Ints, members: Ints, scale: Floats, size: float, problem: Rubbing) -> Rubbing:
    """Problem of some contacts, with unit diagonal and right-hand sides up to 1."""
    G, friction = np.empty((rows.size, rows.size)), np.empty(members.size)
    for a in range(rows.size):
        for b in range(rows.size):
            G[a, b] = problem.G[rows[a], rows[b]] / (scale[rows[a]] * scale[rows[b]])
    k = problem.way.size
    for a in range(members.size):
        i = members[a]
        friction[a] = problem.friction[i] * scale[k + i] / scale[i]
    q, noise = problem.q[rows] / scale[rows] / size, problem.noise[rows] / scale[rows] / size
    return Rubbing(G, q, friction, problem.way[members], noise)


@deferred_kernel
def solve_rubbing(problem: Rubbing, x: Floats, w: Floats, state: Ints) -> int:
    """Solve a problem of contacts with friction.

    Parameters
    ----------
    problem : Rubbing
        Of k contacts.
    x, w : ndarray, shape (2k,)
        Forces and what comes of them; overwritten.
    state : ndarray of int, shape (k,)
        `OPEN`, `FORWARD`, `BACKWARD` or `STICK`; overwritten.

    Returns
    -------
    int
        `UNIQUE`, `ANSWERED`, `NO_ANSWER` or `SEVERAL`, the worst of the parts of the problem.
    """
    k, worst = problem.way.size, UNIQUE
    label, scale = _parts(problem.G), np.ones(2 * k)
    for i in range(2 * k):
        if problem.G[i, i] > 0.0:
            # With a unit diagonal thresholds mean the same for light and for heavy bodies.
            scale[i] = np.sqrt(problem.G[i, i])
    for first in range(k):
        members = np.flatnonzero(label == label[first])
        if members[0] != first:
            continue
        rows = np.concatenate((members, k + members))
        size = float(np.max(np.abs(problem.q[rows]) / scale[rows])) or 1.0
        own = _of_part(rows, members, scale, size, problem)
        if _states(own) <= MOST_STATES:
            found, motion, states, outcome = _go_through(own)
        else:
            found, motion, states, outcome = _by_lemke(own)
        for a in range(rows.size):
            x[rows[a]] = found[a] * size / scale[rows[a]]
            w[rows[a]] = motion[a] * size * scale[rows[a]]
        for a in range(members.size):
            state[members[a]] = states[a]
        worst = max(worst, outcome)
    return worst
