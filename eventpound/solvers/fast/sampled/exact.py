"""Exact steps of linear bodies from sample to sample of a record: their matrices.

Between samples the ground acceleration is a straight line. With stiffness K and
damping C for each unit of mass (matrices, of what the links are at present) the motion
after dt is linear in the velocities v, the relative accelerations a and the slope s of
the record, as N. C. Nigam and P. C. Jennings (Bull. Seism. Soc. Am. 59 (1969) 909-922)
have it for one body:

    u += α_v v + α_a a + α_s s,    v = β_v v + β_a a + β_s s.

The matrices are Taylor series, ``(k+1) (k+2) X_{k+2} = -K X_k - (k+1) C X_{k+1}``,
summed to rounding, once for every set of tangents of the links that a run comes upon.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_noinline, compiled_stepwise
from eventpound.tolerances import NO_TERM

MOST_BODIES = 4
"""Bodies up to which matrices cost less than series."""
KEPT = 16
"""Sets of tangents kept at a time."""
MOST_TERMS = 30
MOST_TURN = 0.5
"""Largest ``|C| dt + |K| dt²`` of a body for which the bounds of a step are good."""


class StepBodies(NamedTuple):
    """What is known of bodies in a step of length dt (s), (N,) each; A and a: accelerations."""

    acceleration: Floats  # A at the start, absolute (m/s²)
    pulled: Floats  # a = A - a_g at the start, relative to the ground (m/s²)
    fastest: Floats  # bound of |a| in the step (m/s²)
    sag: Floats  # dt² max|a| / 8: distance of u from a straight line, at most (m)
    next_u: Floats  # displacement at the end (m)
    next_v: Floats  # velocity at the end (m/s)
    next_acceleration: Floats  # A at the end (m/s²)
    bend: Floats  # dt² max|A''| / 8: distance of A from a straight line, at most (m/s²)
    unmoved: Floats  # A at no displacement (m/s²)


class StepLinks(NamedTuple):
    """Elongations (m) of links and their rates (m/s) at both ends of a step, (L,) each."""

    x: Floats
    x_rate: Floats
    next_x: Floats
    next_x_rate: Floats


class SafeBox(NamedTuple):
    """What pairs of bodies keep within while nothing happens, (N, N) each.

    low, high: bounds of their distance (m). way: the sign that its rate must keep, 0 for none;
    see `eventpound.solvers.fast.sampled.safe_box`.
    """

    low: Floats
    high: Floats
    way: Floats


class SampleTables(NamedTuple):
    """Tables of up to `KEPT` sets of tangents, N bodies and L links.

    tangents (KEPT, L), step (KEPT,): of which links and which dt (s), 0 for none.
    latest (2,): the last one made, the last one used. stiffness, damping (KEPT, N, N): K and
    C for each unit of mass. of_v, of_a, rate_of_v, rate_of_a (KEPT, N, N), of_slope, rate_of_slope
    (KEPT, N): α and β. turn (KEPT, N): ``Σ |C| dt + |K| dt²`` of a body; most_turn
    (KEPT,): the largest. work (3, N): scratch. bodies, along, box: what is known of bodies,
    links and pairs of bodies in a step.
    """

    tangents: Floats
    step: Floats
    latest: Ints
    stiffness: Floats
    damping: Floats
    of_v: Floats
    of_a: Floats
    rate_of_v: Floats
    rate_of_a: Floats
    of_slope: Floats
    rate_of_slope: Floats
    turn: Floats
    most_turn: Floats
    work: Floats
    bodies: StepBodies
    along: StepLinks
    box: SafeBox


def blank_tables(bodies: int, links: int) -> SampleTables:
    """Tables of nothing; without room where there are too many bodies."""
    n = bodies if bodies <= MOST_BODIES else 0
    tables: list[Any] = [
        np.zeros((KEPT, links)),
        np.zeros(KEPT),
        np.zeros(2, np.int64),
        *np.zeros((6, KEPT, n, n)),
        *np.zeros((3, KEPT, n)),
        np.zeros(KEPT),
        np.zeros((3, n)),
        StepBodies(*np.zeros((len(StepBodies._fields), n))),
        StepLinks(*np.zeros((len(StepLinks._fields), links))),
        SafeBox(*np.zeros((len(SafeBox._fields), n, n))),
    ]
    return SampleTables(*tables)


@compiled
def table_of(
    dt: float, tangents: Floats, ends: Ints, damping: Floats, mass: Floats, tables: SampleTables
) -> int:
    """Number of the table for a step of length dt (s) and the tangents of the links (N/m)."""
    for m in range(KEPT):
        i = (tables.latest[1] + m) % KEPT
        if _is_table(i, dt, tangents, tables):
            tables.latest[1] = i
            return i
    return _make_table(dt, tangents, ends, damping, mass, tables)


@compiled
def _is_table(i: int, dt: float, tangents: Floats, tables: SampleTables) -> bool:
    same = tables.step[i] == dt
    for a in range(tangents.size):
        same = same and tables.tangents[i, a] == tangents[a]
    return bool(same)


@compiled_noinline
def _make_table(
    dt: float, tangents: Floats, ends: Ints, damping: Floats, mass: Floats, tables: SampleTables
) -> int:
    """Fill the table that was made longest ago."""
    i = (tables.latest[0] + 1) % KEPT
    tables.latest[0] = tables.latest[1] = i
    tables.step[i] = dt
    for a in range(tangents.size):
        tables.tangents[i, a] = tangents[a]
    _put_links(tangents, ends, mass, tables.stiffness[i])
    _put_links(damping, ends, mass, tables.damping[i])
    n, largest = mass.size, 0.0
    for b in range(n):
        turn = 0.0
        for c in range(n):
            turn += dt * (abs(tables.damping[i, b, c]) + dt * abs(tables.stiffness[i, b, c]))
        tables.turn[i, b] = turn
        largest = max(largest, turn)
    tables.most_turn[i] = largest
    if largest <= MOST_TURN:
        K, C, work = tables.stiffness[i], tables.damping[i], tables.work
        for c in range(n):
            put_column(0, c, dt, K, C, work, tables.of_v[i, :, c], tables.rate_of_v[i, :, c])
            put_column(1, c, dt, K, C, work, tables.of_a[i, :, c], tables.rate_of_a[i, :, c])
        put_column(2, 0, dt, K, C, work, tables.of_slope[i], tables.rate_of_slope[i])
    return i


@compiled
def _put_links(constants: Floats, ends: Ints, mass: Floats, out: Floats) -> None:
    """Matrix of springs or dashpots for each unit of mass."""
    out[:, :] = 0.0
    for a in range(constants.size):
        first, second = ends[a, 0], ends[a, 1]
        if first >= 0:
            out[first, first] += constants[a] / mass[first]
        if second >= 0:
            out[second, second] += constants[a] / mass[second]
        if first >= 0 and second >= 0:
            out[first, second] -= constants[a] / mass[first]
            out[second, first] -= constants[a] / mass[second]


@compiled
def put_column(
    kind: int,
    c: int,
    dt: float,
    K: Floats,
    C: Floats,
    work: Floats,
    change: Floats,
    rate: Floats,
) -> None:
    """A column of α and of β: what comes of one of what the motion over dt (s) is linear in.

    Parameters
    ----------
    kind, c : int
        Of which: 0 the velocity of body c, 1 its relative acceleration, 2 the slope of the record.
    dt : float
        Length of the step (s).
    K, C : ndarray, shape (N, N)
        Stiffness and damping for each unit of mass.
    work : ndarray, shape (3, N)
        Overwritten.
    change, rate : ndarray, shape (N,)
        The columns, overwritten.
    """
    n = change.size
    low, high, following = work[0], work[1], work[2]
    low[:] = 0.0
    high[:] = 0.0
    if kind == 0:
        low[c] = 1.0
    elif kind == 1:
        high[c] = 0.5
    for b in range(n):
        change[b], rate[b] = dt * (low[b] + dt * high[b]), low[b] + 2.0 * dt * high[b]
    power, before, least = dt * dt, np.inf, NO_TERM * dt ** (kind + 1)
    for k in range(1, MOST_TERMS):
        for b in range(n):
            total = -1.0 if kind == 2 and k == 1 else 0.0
            for d in range(n):
                total -= K[b, d] * low[d] + C[b, d] * (k + 1) * high[d]
            following[b] = total / ((k + 1) * (k + 2))
        largest = 0.0
        for b in range(n):
            rate[b] += (k + 2) * following[b] * power
            change[b] += following[b] * power * dt
            largest = max(largest, abs(following[b]) * power * dt)
            low[b], high[b] = high[b], following[b]
        power *= dt
        # Without damping every other term is zero.
        if max(largest, before) < least:
            break
        before = largest


@compiled
def propose_by_matrices(
    n: int, i: int, slope: float, u: Floats, v: Floats, tables: SampleTables
) -> None:
    """The motion of n bodies at the end of a step by table i, and its bounds."""
    bodies, dt, largest = tables.bodies, tables.step[i], 0.0
    _motion_by_matrices(n, i, slope, u, v, tables)
    for b in range(n):
        jerk = abs(slope)
        for c in range(n):
            jerk += abs(tables.stiffness[i, b, c] * v[c])
        bodies.fastest[b] = abs(bodies.pulled[b]) + dt * jerk
        largest = max(largest, bodies.fastest[b])
    # |a| <= |a_0| + dt (|K| (|v_0| + dt |a|) + |C| |a| + |s|)
    largest /= 1.0 - tables.most_turn[i]
    for b in range(n):
        bodies.fastest[b] += tables.turn[i, b] * largest
        bodies.sag[b] = 0.125 * dt * dt * bodies.fastest[b]
    for b in range(n):
        # A'' = -K a - C a', where dt |a'| is part of the bound of |a|.
        bend = 0.0
        for c in range(n):
            fastest = bodies.fastest[c]
            bend += dt * abs(tables.stiffness[i, b, c]) * fastest
            bend += abs(tables.damping[i, b, c]) * (fastest - abs(bodies.pulled[c]))
        bodies.bend[b] = 0.125 * dt * bend


@compiled_stepwise
def _motion_by_matrices(
    n: int, i: int, slope: float, u: Floats, v: Floats, tables: SampleTables
) -> None:
    """Displacements and velocities at the end of a step."""
    bodies = tables.bodies
    for b in range(n):
        change, rate = tables.of_slope[i, b] * slope, tables.rate_of_slope[i, b] * slope
        for c in range(n):
            a = bodies.pulled[c]
            change += tables.of_v[i, b, c] * v[c] + tables.of_a[i, b, c] * a
            rate += tables.rate_of_v[i, b, c] * v[c] + tables.rate_of_a[i, b, c] * a
        bodies.next_u[b], bodies.next_v[b] = u[b] + change, rate
