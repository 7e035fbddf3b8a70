"""Impacts of one instant: closed gaps put on their constraints, then problem after problem.

The rules by which a cascade ends are those of `eventpound.contact.cascade`. Shared by
all event-driven solvers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.cascade import WINDOW, is_endless, is_plastic
from eventpound.contact.event_rows import EventRow, kind_of_impact, new_group, write_event
from eventpound.contact.modes import IMPACT, duty
from eventpound.contact.state import Instant, Now, between_now
from eventpound.mechanics.clusters import Clusters, close_one, form_clusters
from eventpound.mechanics.contact_problem import Joints
from eventpound.mechanics.followers import answers, drive, own_mass
from eventpound.mechanics.impact import impact_law, inverse_mass, newton, push_apart
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.tolerances import FADED, LAST_INTERVAL, LISTED_SPEED

DONE, NO_IMPACT, NO_FORCES, ENDLESS, FULL = 0, 1, 2, 3, 11
"""How settling an instant ends; FULL: the record needs more room, then it goes on."""
MEANING = {
    NO_IMPACT: "an impact problem has no solution",
    NO_FORCES: "the forces of resting contacts could not be found",
}
"""What some of them are told as."""
PROBLEM = 12
"""It does not yet: an impact is to be solved."""
NONE, SEVERAL = -1, -2
"""What `_only_closed` finds where it is not a single contact."""

_close_one = scalar_kernel(close_one)


@scalar_kernel
def settle_closed(at: Instant) -> int:
    """Put closed contacts on their constraints, and impacts until none approaches."""
    close_collapsed(at)
    one = _only_closed(at.gap)
    if one >= 0 and at.compliance.size == 0:
        left, right = at.left[one], at.right[one]
        _close_one(left, right, at.opening[one], at.mass, at.u)
        if at.gap_rate[one] < 0.0:
            _impact_of_only(one, at)
    elif one != NONE:
        close_several(at)
        ended = _impacts_of_several(at)
        # Without an impulse nothing has been left at the rounding of velocities.
        if ended == DONE and at.now[0].here > 0:
            still_several(at)
        return ended
    return DONE


@scalar_kernel
def _collapsed(interval: float, time: float) -> bool:
    """Whether the last interval (s) was none beside the scene's own time (s)."""
    return interval <= LAST_INTERVAL * time


@scalar_kernel
def close_collapsed(at: Instant) -> None:
    """Where an interval was none, close every gap that is none beside it."""
    if not _collapsed(at.now[0].interval, at.time):
        return
    # No impact of the run so far goes further in such an interval.
    none = LAST_INTERVAL * (at.length + at.now[0].fastest * at.time)
    for j in range(at.gap.size):
        if abs(at.gap[j]) <= none:
            at.gap[j] = 0.0


@scalar_kernel
def _only_closed(gap: Floats) -> int:
    """The only closed contact; `NONE` where there is none, `SEVERAL` where there are more."""
    found = NONE
    for j in range(gap.size):
        if gap[j] == 0.0:
            if found >= 0:
                return SEVERAL
            found = j
    return found


@deferred_kernel
def close_several(at: Instant) -> None:
    """Put all bodies that closed contacts join in touch, their centres of mass kept."""
    shut = at.gap == 0.0
    put_as_one(clusters_of(shut, shut, at), True, at.mass, at.u)


@deferred_kernel
def still_several(at: Instant) -> None:
    """Give all bodies that contacts join which neither open nor close the same velocity.

    On a barrier they have none. Of what rounding leaves of it after an impulse, stiff springs and
    dashpots would make accelerations that open a contact on which no force acts.
    """
    still = (at.gap == 0.0) & (at.gap_rate == 0.0)
    if still.any():
        put_as_one(clusters_of(still, still, at), False, at.mass, at.v)


@kernel
def clusters_of(resting: Bools, pressed: Bools, at: Instant) -> Clusters:
    """Clusters with these contacts (K,) at rest."""
    return form_clusters(between_now(at), resting, pressed)


@kernel
def put_as_one(clusters: Clusters, places: bool, mass: Floats, x: Floats) -> None:
    """Put displacements of bodies (N,) in their `places` in clusters, or velocities, overwritten.

    A cluster keeps the mean of its bodies. Cluster -1, of the barriers, has the value zero; that of
    a support its own. Where some follow others all move the least, weighted by mass.
    """
    cluster, offset = clusters.of_body, clusters.offset if places else np.zeros(mass.size)
    if clusters.compliance.size > 0:
        _put_followers(clusters, offset, mass, x)
        return
    total, mean = np.zeros(mass.size), np.zeros(mass.size)
    for b in range(mass.size):
        if cluster[b] >= 0:
            total[cluster[b]] += mass[b]
            mean[cluster[b]] += own_mass(b, mass) * (x[b] - offset[b])
    for c in range(clusters.count):
        mean[c] /= total[c]
    drive(cluster, mass, x - offset, mean)
    for b in range(mass.size):
        c = cluster[b]
        if c < 0:
            x[b] = offset[b]
        # A body by itself keeps every bit.
        elif total[c] != mass[b]:
            x[b] = offset[b] + mean[c]


@kernel
def _put_followers(clusters: Clusters, offset: Floats, mass: Floats, x: Floats) -> None:
    """`put_as_one` in a scene with points."""
    compliance, count = clusters.compliance, clusters.count
    moment, placed = np.zeros(count), np.zeros(count)
    bodies, tied = np.zeros(count, np.int64), np.zeros(count, np.bool_)
    for b in range(mass.size):
        c = clusters.of_body[b]
        if c >= 0:
            moment[c] += own_mass(b, mass) * (x[b] - offset[b])
            bodies[c] += 1
    drive(clusters.of_body, mass, x - offset, moment)
    answers(compliance, moment, placed)
    for c in range(count):
        for d in range(count):
            tied[c] |= bodies[c] > 1 or (c != d and compliance[c, d] != 0.0)
    for b in range(mass.size):
        c = clusters.of_body[b]
        if c < 0:
            x[b] = offset[b]
        # Whom nothing holds, and who holds nothing, keeps every bit.
        elif tied[c]:
            x[b] = offset[b] + placed[c]


@scalar_kernel
def is_last(approach: float, last_speed: float, time: float, now: Now) -> bool:
    """Whether an impact of this closing speed (m/s) is taken as plastic; counts it.

    last_speed (m/s): that of `eventpound.contact.cascade`. time: the scene's own, T (s).
    """
    now.fastest = max(now.fastest, approach)
    now.here += 1
    now.in_a_row += 1
    last = is_plastic(approach, now.fastest, last_speed, now.in_a_row, now.here)
    return last or _collapsed(now.interval, time)


class Meeting(NamedTuple):
    """A single contact that closes.

    contact. before: rate of its gap γ⁻ (m/s). restitution: ε. inverse: 1/m of both bodies together
    (1/kg). last_speed, time: as `is_last` has them.
    """

    contact: int
    before: float
    restitution: float
    inverse: float
    last_speed: float
    time: float


@scalar_kernel
def rebound(meeting: Meeting, now: Now, events: Floats) -> tuple[float, float]:
    """Newton's law at one contact, γ⁺ = -ε γ⁻, and its row: no complementarity problem.

    Returns
    -------
    after, impulse : float
        γ⁺ (m/s), and Λ (N s).
    """
    before, restitution = meeting.before, meeting.restitution
    plastic = is_last(-before, meeting.last_speed, meeting.time, now)
    listed = -before >= LISTED_SPEED * now.fastest
    kind = kind_of_impact(listed, plastic, before, restitution)
    # After the kind: a last impact is told from one whose own law is plastic.
    if plastic:
        restitution = 0.0
    after, impulse, lost = newton(before, restitution, meeting.inverse)
    now.since_impact = 0.0
    t, group = now.t, new_group(now)
    write_event(
        EventRow(t, kind, group, meeting.contact, before, after, impulse, lost, 1), now, events
    )
    return after, impulse


@scalar_kernel
def _impact_of_only(j: int, at: Instant) -> None:
    """A single contact closes: a scalar instead of a complementarity problem."""
    left, right = at.left[j], at.right[j]
    inverse = inverse_mass(left, right, at.mass)
    meeting = Meeting(j, at.gap_rate[j], at.restitution[j], inverse, at.last_speed, at.time)
    after, impulse = rebound(meeting, at.now[0], at.events)
    push_apart(j, impulse, at.mass, at.left, at.right, at.gap_rate, at.v)
    # By the law itself, where the velocities have left their rounding.
    at.gap_rate[j] = after
    if after == 0.0:
        _close_one(left, right, 0.0, at.mass, at.v)


@scalar_kernel
def _any_approaches(gap: Floats, gap_rate: Floats) -> bool:
    """Whether a closed contact approaches."""
    some = False
    for j in range(gap.size):
        some = some or duty(gap[j], gap_rate[j]) == IMPACT
    return some


@kernel
def next_problem(shut: Bools, at: Instant) -> tuple[int, bool]:
    """Whether an instant has another impact PROBLEM, or how it ends; and whether that is plastic.

    `shut` (K,): closed contacts.
    """
    gap_rate, now = at.gap_rate, at.now[0]
    # What the instant has seen so far outlives a pause in which the record gets more room.
    if now.events + 3 * shut.size > at.events.shape[0]:
        return FULL, False
    if not _any_approaches(at.gap, gap_rate):
        return DONE, False
    approach = -np.min(gap_rate[shut])
    fastest = max(now.fastest_here, approach)
    now.fastest_here = fastest
    if approach <= FADED * fastest:
        # A row squeezed without play: what is left is rounding of the first speeds.
        for j in range(shut.size):
            if shut[j] and abs(gap_rate[j]) <= 10.0 * FADED * fastest:
                gap_rate[j] = 0.0
        return DONE, False
    if is_endless(now.here, now.lost_here, now.passed_on):
        return ENDLESS, False
    # Every window is judged by itself, or early losses would hide that none are left.
    if now.here % WINDOW == 0:
        now.lost_here = now.passed_on = 0.0
    return PROBLEM, is_last(approach, at.last_speed, at.time, now)


@deferred_kernel
def _impacts_of_several(at: Instant) -> int:
    """Impact problems of this instant, until no closed contact approaches."""
    gap_rate, shut = at.gap_rate, at.gap == 0.0
    joints = Joints(at.left, at.right, 1.0 / at.mass, at.compliance)
    while True:
        ended, plastic = next_problem(shut, at)
        if ended != PROBLEM:
            return ended
        restitution = np.zeros(shut.size) if plastic else at.restitution
        before = gap_rate.copy()
        impulse, involved, lost, solved = impact_law(
            joints, at.mass, restitution, shut, gap_rate, at.v
        )
        if not solved:
            return NO_IMPACT
        open_last(plastic, shut, at)
        list_impacts(plastic, before, impulse, involved, lost, at)


@scalar_kernel
def open_last(plastic: bool, shut: Bools, at: Instant) -> None:
    """Let nothing open beside a last, `plastic` impact more slowly than such impacts are.

    Else two contacts of one body would open each other until no number is small enough. `shut`
    (K,): closed contacts.
    """
    for j in range(shut.size):
        if plastic and shut[j] and 0.0 < at.gap_rate[j] <= at.last_speed:
            at.gap_rate[j] = 0.0


@scalar_kernel
def list_impacts(
    plastic: bool, before: Floats, impulse: Floats, involved: Bools, lost: float, at: Instant
) -> None:
    """One row for each contact that took an impulse; the first tells what the problem lost (J).

    Counts that, and what was passed on.
    """
    gap_rate, now = at.gap_rate, at.now[0]
    group, speed = new_group(now), 0.0
    now.since_impact = 0.0
    now.lost_here += lost
    for j in range(before.size):
        now.passed_on -= impulse[j] * before[j]
        if involved[j]:
            speed = max(speed, -before[j])
    listed = speed >= LISTED_SPEED * now.fastest
    for j in range(before.size):
        if not (involved[j] and impulse[j] > 0.0):
            continue
        if plastic:
            gap_rate[j] = 0.0
        kind = kind_of_impact(listed, plastic, before[j], at.restitution[j])
        row = EventRow(now.t, kind, group, j, before[j], gap_rate[j], impulse[j], lost, 1)
        write_event(row, now, at.events)
        lost = 0.0


@scalar_kernel
def end_impacts(now: Now) -> None:
    """The last impact of an instant is over."""
    now.fastest_here = 0.0
    now.here = 0
