"""What an instant demands: impacts, the acceleration problem, the mode that follows.

The rules are those of `eventpound.solvers.events.modes` and `settling`, and the
impact law and acceleration problem are the same compiled functions.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.clusters import Clusters, form_clusters, join_bodies, unique_forces
from eventpound.mechanics.impact import impact_law, impact_of_one
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.solvers.events.modes import duties, transition_code
from eventpound.solvers.events.rest import rest_contacts
from eventpound.solvers.events.settling import (
    FADED,
    LAST_INTERVAL,
    LAST_SPEED,
    LISTED_SPEED,
    TIRED,
)
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import (
    CORE,
    all_variables,
    reverse,
    set_curve,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_with_arrays
from eventpound.solvers.fast.plan import (
    ACTIVE,
    CLUSTERS,
    EDGES,
    EVENTS,
    FASTEST,
    FASTEST_HERE,
    GROUPS,
    IN_A_ROW,
    INTERVAL,
    LEAST_NORM,
    RESTING,
    SINCE_IMPACT,
    Contacts,
    Happened,
    Plan,
    Record,
    Series,
    State,
    T,
)

IMPACT, ACCUMULATION, REST, DETACHMENT, SEPARATION, ERASED, UNLISTED = 0, 1, 2, 3, 4, -1, -2
"""Kinds of an event row; an impact too slow to be listed may yet be counted."""
NONE, SEVERAL = -1, -2
"""What `_only_closed` finds where it is not a single contact."""
MOST_IMPACTS = 200_000
"""Impact problems of one instant after which a run gives up."""
DONE, NO_IMPACT, NO_FORCES, ENDLESS, FULL = 0, 1, 2, 3, 11
"""How settling ended; FULL: the record needs more room, after which it can go on."""


@compiled_apart
def write_event(
    t: float,
    count: Ints,
    events: Floats,
    kind: int,
    group: int,
    contact: int,
    before: float,
    after: float,
    impulse: float,
    lost: float,
    impacts: int,
) -> None:
    """Add a row to the events."""
    row = events[count[EVENTS]]
    row[0], row[1], row[2], row[3] = t, kind, group, contact
    row[4], row[5], row[6], row[7], row[8] = before, after, impulse, lost, impacts
    count[EVENTS] += 1


@compiled
def _only_closed(gap: Floats) -> int:
    """The only closed contact; `NONE` where there is none, `SEVERAL` where there are more."""
    found = NONE
    for j in range(gap.size):
        if gap[j] == 0.0:
            if found >= 0:
                return SEVERAL
            found = j
    return found


@compiled
def put_on_constraint(plan: Plan, state: State) -> None:
    """Make the displacements of closed contacts agree with their gaps of zero."""
    contacts = plan.contacts
    one = _only_closed(state.gap)
    if one >= 0:
        left, right = contacts.left[one], contacts.right[one]
        _close_one(left, right, contacts.gap[one], plan.mass, state.u)
    elif one == SEVERAL:
        _close_several(contacts, plan.mass, state.gap, state.u)


@compiled_with_arrays
def _close_several(contacts: Contacts, mass: Floats, gap: Floats, u: Floats) -> None:
    """Put all bodies that closed contacts join in touch, their centres of mass kept."""
    closed = gap == 0.0
    touching = join_bodies(contacts.left, contacts.right, contacts.gap, closed, closed, mass.size)
    total, moment = np.zeros(mass.size), np.zeros(mass.size)
    for b in range(mass.size):
        c = touching.of_body[b]
        if c >= 0:
            total[c] += mass[b]
            moment[c] += mass[b] * (u[b] - touching.offset[b])
    for b in range(mass.size):
        c = touching.of_body[b]
        u[b] = touching.offset[b] + (moment[c] / total[c] if c >= 0 else 0.0)


@compiled
def _close_one(left: int, right: int, gap: float, mass: Floats, u: Floats) -> None:
    """Put two bodies, or one at a barrier, in touch, their centre of mass kept."""
    if right < 0:
        u[left] = gap
    elif left < 0:
        u[right] = -gap
    else:
        opening = gap + u[right] - u[left]
        share = mass[right] / (mass[left] + mass[right])
        u[left] += share * opening
        u[right] = u[left] - gap


@compiled
def impacts(plan: Plan, state: State, record: Record) -> int:
    """Impact problems of this instant, until no closed contact approaches."""
    one = _only_closed(state.gap)
    if one == SEVERAL:
        return _impact_problems(plan, state, record)
    if one >= 0 and state.gap_rate[one] < 0.0:
        _impact_of_one(one, plan, state, record)
    return DONE


@compiled_with_arrays
def _impact_problems(plan: Plan, state: State, record: Record) -> int:
    contacts = plan.contacts
    for _ in range(MOST_IMPACTS):
        if state.count[EVENTS] + 3 * contacts.gap.size > record.events.shape[0]:
            return FULL
        closed = state.gap == 0.0
        if not (duties(closed, state.gap_rate) == 1).any():
            return DONE
        approach = -np.min(state.gap_rate[closed])
        plastic = is_plastic(approach, plan.limits.time, state.clock, state.count)
        fastest = max(state.clock[FASTEST_HERE], approach)
        # It outlives a pause in which the record gets more room.
        state.clock[FASTEST_HERE] = fastest
        if approach <= FADED * fastest:
            # A row squeezed without play: what is left is rounding of the first speeds.
            for j in range(closed.size):
                if closed[j] and abs(state.gap_rate[j]) <= 10.0 * FADED * fastest:
                    state.gap_rate[j] = 0.0
            return DONE
        restitution = np.zeros(closed.size) if plastic else contacts.restitution
        before = state.gap_rate.copy()
        impulse, involved, lost, solved = impact_law(
            plan.mass,
            contacts.left,
            contacts.right,
            restitution,
            closed,
            state.gap_rate,
            state.v,
        )
        if not solved:
            return NO_IMPACT
        _write_impact(plastic, before, impulse, involved, lost, state, record)
    return ENDLESS


@compiled
def is_plastic(approach: float, time: float, clock: Floats, count: Ints) -> bool:
    """Whether an impact is the last of a cascade, after which its contacts rest.

    `approach` is the closing speed (m/s), `time` the scene's own (s).
    """
    clock[FASTEST] = max(clock[FASTEST], approach)
    count[IN_A_ROW] += 1
    if count[IN_A_ROW] > TIRED and approach <= LISTED_SPEED * clock[FASTEST]:
        return True
    return clock[INTERVAL] <= LAST_INTERVAL * time or approach <= LAST_SPEED * clock[FASTEST]


@compiled
def _impact_of_one(j: int, plan: Plan, state: State, record: Record) -> None:
    """A single contact closes: a scalar instead of a complementarity problem."""
    contacts = plan.contacts
    before = state.gap_rate[j]
    plastic = is_plastic(-before, plan.limits.time, state.clock, state.count)
    restitution = 0.0 if plastic else contacts.restitution[j]
    impulse, lost = impact_of_one(
        j, plan.mass, contacts.left, contacts.right, restitution, state.gap_rate, state.v
    )
    kind = IMPACT if -before >= LISTED_SPEED * state.clock[FASTEST] else UNLISTED
    group = state.count[GROUPS]
    state.count[GROUPS] += 1
    state.clock[SINCE_IMPACT] = 0.0
    write_event(
        state.clock[T],
        state.count,
        record.events,
        kind,
        group,
        j,
        before,
        state.gap_rate[j],
        impulse,
        lost,
        1,
    )


@compiled_apart
def _write_impact(
    plastic: bool,
    before: Floats,
    impulse: Floats,
    involved: Bools,
    lost: float,
    state: State,
    record: Record,
) -> None:
    """One row for each contact that took an impulse."""
    group = state.count[GROUPS]
    state.count[GROUPS] += 1
    state.clock[SINCE_IMPACT] = 0.0
    speed = 0.0
    for j in range(before.size):
        if involved[j]:
            speed = max(speed, -before[j])
    listed = speed >= LISTED_SPEED * state.clock[FASTEST]
    for j in range(before.size):
        if not (involved[j] and impulse[j] > 0.0):
            continue
        if plastic:
            state.gap_rate[j] = 0.0
        kind = IMPACT if listed else UNLISTED
        write_event(
            state.clock[T],
            state.count,
            record.events,
            kind,
            group,
            j,
            before[j],
            state.gap_rate[j],
            impulse[j],
            lost,
            1,
        )
        lost = 0.0


@compiled
def any_rest(state: State) -> bool:
    """Whether a contact rests, or is closed and still."""
    for j in range(state.gap.size):
        if state.resting[j] or (state.gap[j] == 0.0 and state.gap_rate[j] == 0.0):
            return True
    return False


@compiled_with_arrays
def rest(
    forcing: Forcing, released: Bools, plan: Plan, state: State, series: Series, record: Record
) -> bool:
    """Acceleration problem; records who came to rest or opened. False where it has no solution."""
    contacts, limits = plan.contacts, plan.limits
    was_resting = state.resting.copy()
    undecided = (state.gap == 0.0) & (state.gap_rate == 0.0)
    state.resting[:] = False
    state.pressed[:] = False
    if undecided.any():
        z = np.empty(plan.hysteresis.link.size)
        elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
        all_variables(series.x, plan.hysteresis, state, z)
        links = plan.links
        stiffness = np.where(state.branch < 0, links.compression, links.extension)
        resting, pressed, solved = rest_contacts(
            undecided,
            released,
            state.u,
            state.v,
            z,
            contacts.left,
            contacts.right,
            contacts.gap,
            plan.mass,
            links.ends,
            links.law,
            plan.hysteresis.link,
            stiffness,
            -stiffness * links.offset,
            forcing,
            noise.SPEED * limits.length / limits.time,
            limits.length / limits.time**2,
            limits.time,
        )
        if not solved:
            return False
        state.resting[:], state.pressed[:] = resting, pressed
    _write_changes(was_resting, state, record)
    for j in range(was_resting.size):
        if state.resting[j]:
            state.gap_rate[j] = 0.0
    return True


@compiled
def elongations(ends: Ints, u: Floats, v: Floats, x: Floats, x_rate: Floats) -> None:
    """Elongations of all links (m) and their rates (m/s), into `x` and `x_rate` (L,)."""
    for a in range(ends.shape[0]):
        first, second = ends[a, 0], ends[a, 1]
        x[a] = x_rate[a] = 0.0
        if second >= 0:
            x[a], x_rate[a] = u[second], v[second]
        if first >= 0:
            x[a] -= u[first]
            x_rate[a] -= v[first]


@compiled_apart
def _write_changes(was_resting: Bools, state: State, record: Record) -> None:
    group = -1
    for j in range(was_resting.size):
        code = transition_code(was_resting[j], state.resting[j], state.gap_rate[j])
        if code == 0:
            continue
        if group < 0:
            group = state.count[GROUPS]
            state.count[GROUPS] += 1
        write_change(code, j, group, state.gap_rate[j], state.clock[T], state.count, record.events)


@compiled_apart
def write_change(
    code: int, contact: int, group: int, rate: float, t: float, count: Ints, events: Floats
) -> None:
    """Write down that a contact changed its mode, by a code of `transition_code`."""
    kind = REST + code - 1
    if kind == REST:
        gather_unlisted(contact, t, count, events)
    write_event(t, count, events, kind, group, contact, 0.0, rate, 0.0, 0.0, 1)


@compiled_apart
def gather_unlisted(contact: int, t: float, count: Ints, events: Floats) -> None:
    """Make one accumulation of the unlisted impacts of a contact that came to rest."""
    impulse, lost, impacts, last = 0.0, 0.0, 0, -1
    for i in range(count[EVENTS]):
        row = events[i]
        if row[1] == UNLISTED and row[3] == contact:
            impulse += row[6]
            lost += row[7]
            impacts += 1
            last = i
            row[1] = ERASED
    if impacts > 0:
        row = events[last]
        group, rate = int(row[2]), row[4]
        write_event(
            t, count, events, ACCUMULATION, group, contact, rate, 0.0, impulse, lost, impacts
        )


@compiled_apart
def list_all(count: Ints, events: Floats) -> None:
    """List the impacts that were held back: their cascade has ended otherwise."""
    for i in range(count[EVENTS]):
        if events[i, 1] == UNLISTED:
            events[i, 1] = IMPACT


@compiled_with_arrays
def enter_mode(plan: Plan, state: State, series: Series, record: Record) -> None:
    """Arrays of the mode that the resting contacts make; bodies that touch move as one."""
    contacts, mass, links, count = plan.contacts, plan.mass, plan.links, state.count
    clusters = form_clusters(
        contacts.left, contacts.right, contacts.gap, state.resting, state.pressed, mass.size
    )
    total, momentum = np.zeros(mass.size), np.zeros(mass.size)
    for b in range(mass.size):
        c = clusters.of_body[b]
        series.of_body[b] = c
        if c >= 0:
            total[c] += mass[b]
            momentum[c] += mass[b] * state.v[b]
    for c in range(clusters.count):
        series.inverse_mass[c] = 1.0 / total[c]
    for b in range(mass.size):
        c = clusters.of_body[b]
        if c < 0:
            state.v[b] = 0.0
        elif total[c] != mass[b]:
            state.v[b] = momentum[c] / total[c]
    active = 0
    for a in range(links.offset.size):
        for side in range(2):
            b = links.ends[a, side]
            series.ends[a, side] = series.of_body[b] if b >= 0 else -1
        if series.ends[a, 0] != series.ends[a, 1]:
            series.active[active] = a
            active += 1
    count[ACTIVE], count[CLUSTERS], count[RESTING] = active, clusters.count, clusters.resting.size
    state.unlocked[:] = state.resting
    if clusters.resting.size > 0:
        _contact_forces(clusters, contacts.left, contacts.right, state, series, record)


@compiled_with_arrays
def _contact_forces(
    clusters: Clusters, left: Ints, right: Ints, state: State, series: Series, record: Record
) -> None:
    """How the forces of the resting contacts follow from the motion, and which are unique."""
    count = state.count
    series.rests[: clusters.resting.size] = clusters.resting
    count[EDGES] = clusters.elimination.shape[0]
    series.elimination[: count[EDGES]] = clusters.elimination
    count[LEAST_NORM] = clusters.least_norm.size
    if clusters.least_norm.size > 0:
        series.least_norm[: clusters.least_norm.shape[0]] = clusters.least_norm
    unique = unique_forces(clusters, left, right)
    for i in range(clusters.resting.size):
        j = clusters.resting[i]
        state.unlocked[j] = not (clusters.locked[i] or clusters.redundant[i])
        record.unique[j] &= unique[i]


@compiled_apart
def choose_branches(
    plan: Plan, state: State, series: Series, acceleration: Floats, ground: float
) -> None:
    """Side of the kink of links that have none yet: on it by their rate, then acceleration.

    `acceleration` (N,) is absolute, `ground` that of the ground (m/s²). Later a
    link changes its branch where it falls below zero on it.
    """
    links = plan.links
    near = noise.LENGTH * plan.limits.length
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    for a in range(links.offset.size):
        if links.compression[a] == links.extension[a] or state.branch[a] != 0:
            continue
        side = series.x[a] - links.offset[a]
        if abs(side) <= near:
            side = series.x_rate[a]
            if side == 0.0:
                first, second = links.ends[a, 0], links.ends[a, 1]
                side = acceleration[second] if second >= 0 else ground
                side -= acceleration[first] if first >= 0 else ground
        state.branch[a] = -1 if side < 0.0 else 1


@compiled
def choose_directions(plan: Plan, state: State, series: Series) -> None:
    """Turn round every hysteretic link whose elongation rate changed its sign in an impact."""
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    still = noise.SPEED * plan.limits.length / plan.limits.time
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        if state.part[h] != CORE and state.sigma[h] * series.x_rate[a] < -still:
            reverse(h, series.x[a], hysteresis, state)


@compiled_apart
def mark_together(tau: float, plan: Plan, state: State, happened: Happened) -> None:
    """Close the gaps that do so in the same instant to rounding."""
    limits = plan.limits
    instant = min(noise.TOGETHER * limits.time, 1e-9 * state.clock[SINCE_IMPACT])
    instant = max(instant, noise.SAME_INSTANT * tau)
    if not happened.closing.any():
        return
    for j in range(state.gap.size):
        closes = not state.resting[j] and state.gap_rate[j] < 0.0
        if closes and state.gap[j] <= -instant * state.gap_rate[j]:
            state.gap[j] = 0.0


@compiled
def _keep_released(before: Floats, contacts: Contacts, v: Floats, released: Bools) -> None:
    """Of contacts whose force has vanished, those that the impacts of the same instant spared.

    What presses the others is another matter after the impact.
    """
    for j in range(released.size):
        for end in (contacts.left[j], contacts.right[j]):
            if end >= 0 and v[end] != before[end]:
                released[j] = False


@compiled
def settle(
    forcing: Forcing,
    happened: Happened,
    plan: Plan,
    state: State,
    series: Series,
    record: Record,
) -> int:
    """Do the duties of the present instant."""
    put_on_constraint(plan, state)
    before = series.travel
    for b in range(before.size):
        before[b] = state.v[b]
    ended = impacts(plan, state, record)
    # It goes on where it stopped once there is more room.
    _keep_released(before, plan.contacts, state.v, happened.released)
    if ended != DONE:
        return ended
    choose_directions(plan, state, series)
    if any_rest(state):
        if not rest(forcing, happened.released, plan, state, series, record):
            return NO_FORCES
        enter_mode(plan, state, series, record)
    return DONE


@compiled_apart
def start(plan: Plan, state: State, series: Series, record: Record) -> None:
    """The first mode of a run, and its hysteretic links on their curves."""
    enter_mode(plan, state, series, record)
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    hysteresis = plan.hysteresis
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        y = state.xi_r[h]
        sigma = -1.0 if series.x_rate[a] < 0.0 else 1.0
        set_curve(h, series.x[a], sigma, sigma * y, hysteresis, state)
