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

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_stepwise
from eventpound.tolerances import NO_TERM

MOST_BODIES = 8
"""Bodies up to which matrices cost less than series."""
KEPT = 16
"""Sets of tangents kept at a time."""
MOST_TERMS = 30
MOST_TURN = 0.5
"""Largest ``|C| dt + |K| dt²`` of a body for which the bounds of a step are good."""

(ACCELERATION, PULLED, FASTEST, SAG, NEXT_U, NEXT_V, NEXT_ACCELERATION, BEND) = range(8)
"""Rows of `SampleTables.bodies`: absolute and relative acceleration at the start (m/s²), the
largest relative one in the step, how far the body strays from a straight line (m),
displacement, velocity and absolute acceleration at the end, and how far that strays (m/s²)."""
(EXPECTED, JERK, NEXT_JERK, UNMOVED) = range(8, 12)
"""Further rows: relative acceleration at the end by the series (m/s²), rates of the absolute
acceleration at both ends (m/s³), absolute acceleration at no displacement (m/s²)."""
(X, X_RATE, NEXT_X, NEXT_X_RATE) = range(4)
"""Rows of `SampleTables.along`: elongations (m) and their rates at both ends of the step."""
(LOW, HIGH, WAY) = range(3)
"""Layers of `SampleTables.room`: bounds of the distance of two bodies (m), and the sign that its
rate must keep, 0 for none (`eventpound.solvers.fast.sampled.room`)."""


class SampleTables(NamedTuple):
    """Tables of up to `KEPT` sets of tangents, N bodies and L links.

    tangents (KEPT, L), step (KEPT,): of which links and which dt (s), 0 for none.
    latest (2,): the last one made, the last one used. stiffness, damping (KEPT, N, N): K and
    C for each unit of mass. of_v, of_a, rate_of_v, rate_of_a (KEPT, N, N), of_slope, rate_of_slope
    (KEPT, N): α and β. turn (KEPT, N): ``Σ |C| dt + |K| dt²`` of a body; most_turn
    (KEPT,): the largest. work (3, N): scratch. bodies (12, N), along (4, L): what is known
    of bodies and links in a step, room (3, N, N): of pairs of bodies, in the rows named above.
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
    bodies: Floats
    along: Floats
    room: Floats


def blank_tables(bodies: int, links: int) -> SampleTables:
    """Tables of nothing; without room where there are too many bodies."""
    n = bodies if bodies <= MOST_BODIES else 0
    matrices, lines = np.zeros((6, KEPT, n, n)), np.zeros((3, KEPT, n))
    return SampleTables(
        np.zeros((KEPT, links)),
        np.zeros(KEPT),
        np.zeros(2, np.int64),
        matrices[0],
        matrices[1],
        matrices[2],
        matrices[3],
        matrices[4],
        matrices[5],
        lines[0],
        lines[1],
        lines[2],
        np.zeros(KEPT),
        np.zeros((3, n)),
        np.zeros((12, n)),
        np.zeros((4, links)),
        np.zeros((3, n, n)),
    )


@compiled
def table_of(
    dt: float, tangents: Floats, ends: Ints, damping: Floats, mass: Floats, tables: SampleTables
) -> int:
    """Number of the table for a step of length dt (s) and the tangents of the links (N/m)."""
    i = tables.latest[1]
    if _is_table(i, dt, tangents, tables):
        return i
    for i in range(KEPT):
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


@compiled_apart
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
        for c in range(n):
            _column(0, c, dt, i, tables, tables.of_v[i, :, c], tables.rate_of_v[i, :, c])
            _column(1, c, dt, i, tables, tables.of_a[i, :, c], tables.rate_of_a[i, :, c])
        _column(2, 0, dt, i, tables, tables.of_slope[i], tables.rate_of_slope[i])
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
def _column(
    kind: int, c: int, dt: float, i: int, tables: SampleTables, change: Floats, rate: Floats
) -> None:
    """What comes of a velocity (`kind` 0) or acceleration (1) of one of body c, or a slope (2)."""
    n, work = change.size, tables.work
    K, C = tables.stiffness[i], tables.damping[i]
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
        bodies[FASTEST, b] = abs(bodies[PULLED, b]) + dt * jerk
        largest = max(largest, bodies[FASTEST, b])
    # |a| <= |a_0| + dt (|K| (|v_0| + dt |a|) + |C| |a| + |s|)
    largest /= 1.0 - tables.most_turn[i]
    for b in range(n):
        bodies[FASTEST, b] += tables.turn[i, b] * largest
        bodies[SAG, b] = 0.125 * dt * dt * bodies[FASTEST, b]
    for b in range(n):
        # A'' = -K a - C a', where dt |a'| is part of the bound of |a|.
        bend = 0.0
        for c in range(n):
            fastest = bodies[FASTEST, c]
            bend += dt * abs(tables.stiffness[i, b, c]) * fastest
            bend += abs(tables.damping[i, b, c]) * (fastest - abs(bodies[PULLED, c]))
        bodies[BEND, b] = 0.125 * dt * bend


@compiled_stepwise
def _motion_by_matrices(
    n: int, i: int, slope: float, u: Floats, v: Floats, tables: SampleTables
) -> None:
    """Displacements and velocities at the end of a step."""
    bodies = tables.bodies
    for b in range(n):
        change, rate = tables.of_slope[i, b] * slope, tables.rate_of_slope[i, b] * slope
        for c in range(n):
            a = bodies[PULLED, c]
            change += tables.of_v[i, b, c] * v[c] + tables.of_a[i, b, c] * a
            rate += tables.rate_of_v[i, b, c] * v[c] + tables.rate_of_a[i, b, c] * a
        bodies[NEXT_U, b], bodies[NEXT_V, b] = u[b] + change, rate


@compiled_apart
def set_jerks(i: int, g: float, v: Floats, tables: SampleTables) -> None:
    """Rates of the absolute accelerations, ``-K v - C a``, at both ends of a step (m/s³).

    `g` is the acceleration of the ground at the end (m/s²).
    """
    bodies = tables.bodies
    for b in range(v.size):
        rate, next_rate = 0.0, 0.0
        for c in range(v.size):
            K, C = tables.stiffness[i, b, c], tables.damping[i, b, c]
            rate -= K * v[c] + C * bodies[PULLED, c]
            next_rate -= K * bodies[NEXT_V, c] + C * (bodies[NEXT_ACCELERATION, c] - g)
        bodies[JERK, b], bodies[NEXT_JERK, b] = rate, next_rate
