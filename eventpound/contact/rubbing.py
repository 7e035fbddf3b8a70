"""What is known of contacts with friction: their rows, what they do, and what is kept of it.

A contact at rest sticks or slips. One that slips by its branch while others that stick keep it from
sliding is at the bound of its friction, and sticks: its part of friction is not unique.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eventpound.contact.event_rows import STICKS, kind_of_slide, new_group, write_slide
from eventpound.contact.impacts import NO_FORCES, NO_IMPACT
from eventpound.contact.kinks import still_rate
from eventpound.contact.state import Instant
from eventpound.mechanics.contact_problem import Joints, coupling
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.coulomb import OPEN, STICK, way_of
from eventpound.numerics.small_systems import independent_columns
from eventpound.tolerances import DEPENDENT

AMBIGUOUS = "what follows is not unique"
GAINING = (
    "an impact gains kinetic energy, as Newton's law with friction may; Poisson's does not where "
    "ε is the same everywhere (impact_law)"
)
"""How friction ends a run, of whatever solver."""
NOT_UNIQUE, GAINS = 13, 14
"""How settling an instant ends besides: several answers; an impact that gains energy."""
FRICTION_MEANING = {
    NO_IMPACT: "an impact has no solution",
    NO_FORCES: "no forces go with the motion (Painlevé's paradox)",
    NOT_UNIQUE: AMBIGUOUS,
    GAINS: GAINING,
}
"""What these are told as, with the contacts behind."""
PATH, WORK, IMPULSE, TANGENTIAL, PLACE = range(5)
"""Rows of what is kept of friction: way slid (m); energy taken in impacts (J); largest normal and
tangential impulse (N s); where it was at the last instant (m)."""


class Rubs(NamedTuple):
    """F contacts with friction of K; their holding contacts and links are the last F.

    contact (F,): which. friction (K,): μ. kept (5, F): see above.
    """

    contact: Ints
    friction: Floats
    kept: Floats


class Sliding(NamedTuple):
    """Contacts that take part in a problem (k,) as rows of it.

    members (k,): which. rows (2k,): the members, and the contacts that hold them, -1 without
    friction.
    """

    members: Ints
    rows: Ints


@scalar_kernel
def first_holding(rubs: Rubs) -> int:
    """The first of the contacts that rest while those with friction stick."""
    return rubs.friction.size - rubs.contact.size


@scalar_kernel
def slide_of(t: int, at: Instant) -> int:
    """The link beside a contact that holds what sticks, whose branch is the way of the slip."""
    return at.branch.size - at.gap.size + t


@scalar_kernel
def by_poisson(rubs: Rubs, at: Instant) -> bool:
    """Whether impacts follow Poisson's law, not Newton's."""
    return at.restitution[first_holding(rubs)] > 0.0


@kernel
def sliding_of(members: Ints, rubs: Rubs) -> Sliding:
    """Rows of some contacts."""
    rows = np.full(2 * members.size, -1)
    for i in range(members.size):
        rows[i] = members[i]
        for f in range(rubs.contact.size):
            if rubs.contact[f] == members[i]:
                rows[members.size + i] = first_holding(rubs) + f
    return Sliding(members, rows)


@kernel
def all_joints(at: Instant) -> Joints:
    """What impulses of all contacts act on."""
    return Joints(at.left, at.right, 1.0 / at.mass, at.compliance)


@kernel
def matrix_of_rows(rows: Ints, at: Instant) -> Floats:
    """``G = Wᵀ M⁻¹ W`` of rows, with nothing for those that are -1."""
    joints = all_joints(at)
    G = np.zeros((rows.size, rows.size))
    for a in range(rows.size):
        for b in range(rows.size):
            if rows[a] >= 0 and rows[b] >= 0:
                G[a, b] = coupling(joints, int(rows[a]), int(rows[b]))
    return G


@scalar_kernel
def keep_friction(f: int, normal: float, tangential: float, lost: float, kept: Floats) -> None:
    """Keep what friction took (J) at contact f in an impact with such impulses (N s)."""
    kept[WORK, f] += lost
    kept[IMPULSE, f] = max(kept[IMPULSE, f], normal)
    kept[TANGENTIAL, f] = max(kept[TANGENTIAL, f], abs(tangential))


@scalar_kernel
def is_at_bound(j: int, t: int, at: Instant) -> bool:
    """Whether contact j, which has not slid, was one of those that slip all the same."""
    slid = difference(at.before, at.left[t], at.right[t])
    slips = at.branch[slide_of(t, at)] != 0
    return at.resting[j] and slips and abs(slid) <= still_rate(at.length, at.time)


@kernel
def kinds_before(sliding: Sliding, at: Instant) -> Ints:
    """What contacts did up to the instant (k,): the kind of row that told it, -1 of open ones."""
    k = sliding.members.size
    kinds = np.full(k, -1)
    for i in range(k):
        t = sliding.rows[k + i]
        if t >= 0 and at.resting[sliding.members[i]]:
            way = at.branch[slide_of(t, at)]
            if at.resting[t] or is_at_bound(sliding.members[i], t, at):
                kinds[i] = STICKS
            elif way != 0:
                # One whose slip has just ended is told anew, whatever follows.
                kinds[i] = kind_of_slide(way)
    return kinds


@kernel
def list_slides(sliding: Sliding, before: Ints, state: Ints, groups: int, at: Instant) -> None:
    """Write down which contacts at rest begin to stick or to slip, with the rests that begin."""
    k, now, group = sliding.members.size, at.now[0], groups
    for i in range(k):
        t, kind = sliding.rows[k + i], STICKS
        if t < 0 or state[i] == OPEN or not at.resting[sliding.members[i]]:
            continue
        if state[i] != STICK and (at.gap_rate[t] != 0.0 or not _is_held(i, sliding, state, at)):
            kind = kind_of_slide(way_of(state[i]))
        if kind != before[i]:
            if now.groups == groups:
                group = new_group(now)
            write_slide(now.t, kind, sliding.members[i], group, now, at.events)


@kernel
def _is_held(i: int, sliding: Sliding, state: Ints, at: Instant) -> bool:
    """Whether others that stick keep a member from sliding, which is at the bound of friction."""
    k, rows, count = sliding.members.size, np.empty(2 * sliding.members.size + 1, np.int64), 0
    for a in range(2 * k):
        if sliding.rows[a] >= 0 and (state[a] != OPEN if a < k else state[a - k] == STICK):
            rows[count] = sliding.rows[a]
            count += 1
    rows[count] = sliding.rows[k + i]
    G = matrix_of_rows(rows[: count + 1], at)
    return not independent_columns(G, DEPENDENT)[count]


def friction_message(
    ended: int, names: Sequence[str], rubs: Rubs, gap: Floats, gap_rate: Floats, resting: Bools
) -> str:
    """What to say where an instant cannot be settled at contacts with friction.

    names (K,): of the contacts. gap, gap_rate, resting (K,): as of an `Instant`.
    """
    told = []
    for t, j in enumerate(rubs.contact.tolist(), gap.size - rubs.contact.size):
        if gap[j] == 0.0 or resting[j]:
            rate = gap_rate[t]
            way = f"slides with {rate:.3g} m/s" if rate != 0.0 else "does not slide"
            told.append(f"{names[j]!r} (friction {rubs.friction[j]:g}, {way})")
    return f"{FRICTION_MEANING[ended]}: {', '.join(told)}; try less friction there"
