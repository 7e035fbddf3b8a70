"""What an instant demands: impacts, who rests, the mode that follows.

The rules are those of `eventpound.contact.modes` and `cascade`, and the
impact law and acceleration problem are the same compiled functions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.cascade import SINCE_IMPACT, T
from eventpound.contact.event_rows import write_changes
from eventpound.contact.impacts import DONE, NO_FORCES, Closed, end_impacts, settle_closed
from eventpound.mechanics.clusters import form_clusters, is_support, unique_forces
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.borrowing import copy_numbers
from eventpound.solvers.events.rest import Touching, rest_contacts
from eventpound.solvers.fast.compiled import (
    compiled,
    compiled_apart,
    compiled_deferred,
    compiled_with_arrays,
)
from eventpound.solvers.fast.links import CORE, all_variables, elongations, reverse, set_curve
from eventpound.solvers.fast.run import (
    ACTIVE,
    CLUSTERS,
    EDGES,
    LINEAR,
    RESTING,
    SETTLED_AT,
    TIED,
    TIED_LINKS,
    Contacts,
    Happened,
    Run,
    Series,
    State,
)
from eventpound.tolerances import LENGTH, OF_A_FLIGHT, SAME_INSTANT, SPEED, TOGETHER


@compiled
def any_rest(state: State) -> bool:
    """Whether a contact rests, or is closed and still."""
    for j in range(state.gap.size):
        if state.resting[j] or (state.gap[j] == 0.0 and state.gap_rate[j] == 0.0):
            return True
    return False


@compiled_deferred
def rest(forcing: Forcing, released: Bools, z: Floats, run: Run) -> bool:
    """Acceleration problem; records who came to rest or opened. False where it has no solution.

    `z` (H,) is overwritten.
    """
    plan, state, series, record = run.plan, run.state, run.series, run.record
    was_resting = series.rests
    undecided = False
    for j in range(state.gap.size):
        was_resting[j] = 1 if state.resting[j] else 0
        state.resting[j] = state.pressed[j] = False
        undecided = undecided or (state.gap[j] == 0.0 and state.gap_rate[j] == 0.0)
    if undecided:
        elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
        all_variables(series.x, plan.hysteresis, state, z)
        if not _decide(forcing, released, z, run):
            return False
    write_changes(
        was_resting, state.resting, state.gap_rate, state.clock, state.count, record.events
    )
    for j in range(state.gap.size):
        if state.resting[j]:
            state.gap_rate[j] = 0.0
    return True


@compiled_with_arrays
def _decide(forcing: Forcing, released: Bools, z: Floats, run: Run) -> bool:
    """Solve the acceleration problem; False where it has no solution."""
    state, contacts, links, limits = run.state, run.plan.contacts, run.plan.links, run.plan.limits
    stiffness = np.where(state.branch < 0, links.compression, links.extension)
    touching = Touching(
        (state.gap == 0.0) & (state.gap_rate == 0.0),
        released,
        state.u,
        state.v,
        z,
        contacts.left,
        contacts.right,
        contacts.gap,
        run.plan.mass,
        links.ends,
        links.law,
        run.plan.hysteresis.link,
        stiffness,
        -stiffness * links.offset,
        forcing,
        SPEED * limits.length / limits.time,
        limits.length / limits.time**2,
        limits.time,
    )
    resting, pressed, solved = rest_contacts(touching)
    if solved:
        copy_numbers(resting, state.resting)
        copy_numbers(pressed, state.pressed)
    return solved


@compiled
def enter_mode(run: Run) -> None:
    """Arrays of the mode that the resting contacts make; bodies that touch move as one."""
    plan, state, series = run.plan, run.state, run.series
    mass, links, count = plan.mass, plan.links, state.count
    count[RESTING] = 0
    for j in range(state.resting.size):
        state.unlocked[j] = state.resting[j]
        count[RESTING] += state.resting[j]
    if count[RESTING] == 0:
        count[CLUSTERS] = mass.size
        for b in range(mass.size):
            series.of_body[b] = b
            series.inverse_mass[b] = 1.0 / mass[b]
    else:
        _enter_rest(run)
    for a in range(links.offset.size):
        for side in range(2):
            b = links.ends[a, side]
            series.ends[a, side] = series.of_body[b] if b >= 0 else -1
    _find_apart(run)
    _sort_active(run)


@compiled_apart
def _find_apart(run: Run) -> None:
    """Clusters that go by themselves: on links to the ground only, one of them hysteretic at most.

    There are none where the forces of contacts or of loads are followed.
    """
    series, links, count = run.series, run.plan.links, run.state.count
    hysteretic = series.apart.hysteretic
    none = count[RESTING] > 0 or series.load.shape[0] > 0
    hysteretic[:] = TIED if none else LINEAR
    for a in range(0 if none else links.offset.size):
        first, second = series.ends[a, 0], series.ends[a, 1]
        if min(first, second) >= 0:
            hysteretic[first] = hysteretic[second] = TIED
        elif links.z_of_link[a] >= 0:
            c = max(first, second)
            hysteretic[c] = a if hysteretic[c] == LINEAR else TIED


@compiled_apart
def _sort_active(run: Run) -> None:
    """Links that move: of clusters that go together, then of each that goes by itself."""
    series, count = run.series, run.state.count
    first_of, hysteretic, clusters = series.apart.links, series.apart.hysteretic, count[CLUSTERS]
    first_of[:] = 0
    count[ACTIVE] = 0
    for a in range(series.ends.shape[0]):
        first, second = series.ends[a, 0], series.ends[a, 1]
        if first == second:
            continue
        if hysteretic[max(first, second)] == TIED:
            series.active[count[ACTIVE]] = a
            count[ACTIVE] += 1
        else:
            first_of[max(first, second) + 1] += 1
    count[TIED_LINKS] = first_of[0] = count[ACTIVE]
    for c in range(clusters):
        first_of[c + 1] += first_of[c]
    for a in range(series.ends.shape[0]):
        c = max(series.ends[a, 0], series.ends[a, 1])
        if min(series.ends[a, 0], series.ends[a, 1]) < c and hysteretic[c] != TIED:
            series.active[first_of[c]] = a
            first_of[c] += 1
            count[ACTIVE] += 1
    # Each has come to where the next one begins.
    for c in range(clusters, 0, -1):
        first_of[c] = first_of[c - 1]
    first_of[0] = count[TIED_LINKS]


@compiled_deferred
def _enter_rest(run: Run) -> None:
    """The clusters of bodies that rest on each other, their masses and velocities."""
    plan, state, series, count = run.plan, run.state, run.series, run.state.count
    forces = Resting(
        state.resting,
        state.pressed,
        state.unlocked,
        series.of_body,
        series.rests,
        series.elimination,
        run.record.unique,
    )
    bodies = plan.mass.size
    count[CLUSTERS], count[EDGES] = _form(plan.contacts, bodies, forces)
    _move_as_one(plan.mass, state.v, series)


@compiled_apart
def _move_as_one(mass: Floats, v: Floats, series: Series) -> None:
    """Inverse masses of the clusters; one velocity for all bodies of one, none on a barrier.

    A support does not change its own.
    """
    total, momentum = series.inverse_mass, series.force
    for b in range(mass.size):
        total[b] = momentum[b] = 0.0
    for b in range(mass.size):
        c = series.of_body[b]
        if c >= 0:
            total[c] += mass[b]
            if not is_support(b, mass):
                momentum[c] += mass[b] * v[b]
    for b in range(mass.size - 1, -1, -1):
        c = series.of_body[b]
        if c >= 0 and is_support(b, mass):
            momentum[c] = v[b]
    for b in range(mass.size):
        c = series.of_body[b]
        if c < 0:
            v[b] = 0.0
        elif is_support(c, total):
            v[b] = momentum[c]
        elif total[c] != mass[b]:
            v[b] = momentum[c] / total[c]
    for c in range(mass.size):
        total[c] = 1.0 / total[c] if total[c] > 0.0 else 0.0


class Resting(NamedTuple):
    """What the mode of resting contacts is made of, and where it goes; see `State`, `Series`."""

    resting: Bools
    pressed: Bools
    unlocked: Bools
    of_body: Ints
    rests: Ints
    elimination: Ints
    unique: Bools


@compiled_with_arrays
def _form(contacts: Contacts, bodies: int, forces: Resting) -> tuple[int, int]:
    """Clusters, how the forces of the resting contacts follow from the motion, which are unique.

    Returned are the numbers of clusters and of rows of the elimination.
    """
    left, right = contacts.left, contacts.right
    clusters = form_clusters(left, right, contacts.gap, forces.resting, forces.pressed, bodies)
    for b in range(bodies):
        forces.of_body[b] = clusters.of_body[b]
    copy_numbers(clusters.resting, forces.rests)
    edges = clusters.elimination.shape[0]
    for row in range(edges):
        copy_numbers(clusters.elimination[row], forces.elimination[row])
    unique = unique_forces(clusters, left, right)
    for i in range(clusters.resting.size):
        j = clusters.resting[i]
        forces.unlocked[j] = not (clusters.locked[i] or clusters.redundant[i])
        forces.unique[j] &= unique[i]
    return clusters.count, edges


@compiled_apart
def choose_branches(acceleration: Floats, ground: float, onset: float, run: Run) -> None:
    """Side of the kink of links that have none yet: on it by the first of its rates that tells.

    `acceleration` (N,) is absolute, `ground` that of the ground (m/s²). Where a link has no
    relative acceleration either, it goes as the ground moves away from its body: `onset` is
    `eventpound.motion.forcing.ground_onset`. Later a link changes its branch where it falls
    below zero on it.
    """
    plan, state, series = run.plan, run.state, run.series
    links = plan.links
    near = LENGTH * plan.limits.length
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    for a in range(links.offset.size):
        if links.compression[a] == links.extension[a] or state.branch[a] != 0:
            continue
        side = series.x[a] - links.offset[a]
        if abs(side) <= near:
            side = series.x_rate[a]
            first, second = links.ends[a, 0], links.ends[a, 1]
            if side == 0.0:
                side = acceleration[second] if second >= 0 else ground
                side -= acceleration[first] if first >= 0 else ground
            if side == 0.0:
                side = (0.0 if second >= 0 else onset) - (0.0 if first >= 0 else onset)
        state.branch[a] = -1 if side < 0.0 else 1


@compiled_apart
def turn_at_kinks(run: Run) -> None:
    """Put every link that is on its kink on the side to which it moves after an impact."""
    plan, state, series = run.plan, run.state, run.series
    links, limits = plan.links, plan.limits
    near = LENGTH * limits.length
    still = SPEED * limits.length / limits.time
    elongations(links.ends, state.u, state.v, series.x, series.x_rate)
    for a in range(links.offset.size):
        on_kink = state.branch[a] != 0 and abs(series.x[a] - links.offset[a]) <= near
        if on_kink and abs(series.x_rate[a]) > still:
            state.branch[a] = -1 if series.x_rate[a] < 0.0 else 1


@compiled
def choose_directions(run: Run) -> None:
    """Turn round every hysteretic link whose elongation rate changed its sign in an impact."""
    plan, state, series = run.plan, run.state, run.series
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    still = SPEED * plan.limits.length / plan.limits.time
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        if state.part[h] != CORE and state.sigma[h] * series.x_rate[a] < -still:
            reverse(h, series.x[a], hysteresis, state)


@compiled_apart
def mark_together(tau: float, run: Run) -> None:
    """Close the gaps that do so in the same instant to rounding."""
    plan, state, happened = run.plan, run.state, run.happened
    limits = plan.limits
    instant = min(TOGETHER * limits.time, OF_A_FLIGHT * state.clock[SINCE_IMPACT])
    instant = max(instant, SAME_INSTANT * tau)
    if not happened.closing.any():
        return
    for j in range(state.gap.size):
        closes = not state.resting[j] and state.gap_rate[j] < 0.0
        if closes and state.gap[j] <= -instant * state.gap_rate[j]:
            state.gap[j] = 0.0


@compiled
def _mark_vanished(before: Floats, contacts: Contacts, state: State, happened: Happened) -> None:
    """Contacts whose force has vanished in this instant, and that its impacts spared.

    What presses the others is another matter after the impact.
    """
    released, vanished, v = happened.released, happened.vanished, state.v
    clock = state.clock
    for j in range(released.size):
        if clock[SETTLED_AT] != clock[T]:
            vanished[j] = False
        released[j] = released[j] or vanished[j]
        for end in (contacts.left[j], contacts.right[j]):
            if end >= 0 and v[end] != before[end]:
                released[j] = False
        vanished[j] = released[j]
    clock[SETTLED_AT] = clock[T]


@compiled
def _closed_of(run: Run) -> Closed:
    """What impacts work on."""
    plan, state, record = run.plan, run.state, run.record
    contacts, limits = plan.contacts, plan.limits
    return Closed(
        plan.mass,
        state.u,
        state.v,
        contacts.left,
        contacts.right,
        contacts.gap,
        contacts.restitution,
        state.gap,
        state.gap_rate,
        state.clock,
        state.count,
        record.events,
        limits.length,
        limits.time,
    )


@compiled
def settle(forcing: Forcing, z: Floats, run: Run) -> int:
    """Do the duties of the present instant; `z` (H,) is overwritten."""
    plan, state, series, happened = run.plan, run.state, run.series, run.happened
    before = series.travel
    for b in range(before.size):
        before[b] = state.v[b]
    ended = settle_closed(_closed_of(run))
    # It goes on where it stopped once there is more room.
    _mark_vanished(before, plan.contacts, state, happened)
    if ended != DONE:
        return ended
    end_impacts(state.clock, state.count)
    choose_directions(run)
    turn_at_kinks(run)
    if any_rest(state):
        if not rest(forcing, happened.released, z, run):
            return NO_FORCES
        enter_mode(run)
    return DONE


@compiled_apart
def start(run: Run) -> None:
    """The first mode of a run, and its hysteretic links on their curves."""
    plan, state, series = run.plan, run.state, run.series
    enter_mode(run)
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    hysteresis = plan.hysteresis
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        y = state.xi_r[h]
        sigma = -1.0 if series.x_rate[a] < 0.0 else 1.0
        set_curve(h, series.x[a], sigma, sigma * y, hysteresis, state)
