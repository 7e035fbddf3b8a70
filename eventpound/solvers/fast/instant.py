"""What an instant demands: impacts, who rests, the mode that follows.

The rules are those of `eventpound.contact.modes` and `cascade`, and the
impact law and acceleration problem are the same compiled functions.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import last_speed
from eventpound.contact.friction import begin_beside_friction, decide_friction, settle_with_friction
from eventpound.contact.impacts import DONE, put_as_one
from eventpound.contact.instant import any_may_rest, decide_rests, settle_impacts
from eventpound.contact.kinks import still_rate
from eventpound.contact.rubbing import Rubs
from eventpound.contact.sliders import begin_beside_sliders, decide_sticks
from eventpound.contact.state import Instant
from eventpound.mechanics.clusters import Clusters, ContactEnds, form_clusters, have_ends
from eventpound.mechanics.oblique import are_tied, slips_of, with_slips
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.by_address import whole
from eventpound.numerics.compiled import deferred_kernel, kernel
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.followed import find_branches, follows, put_on_branches
from eventpound.solvers.fast.links import (
    all_variables,
    elongations,
    open_gaps,
    reverse,
    set_curve,
    turns_back,
)
from eventpound.solvers.fast.run import FastRun, FastSeries
from eventpound.solvers.fast.search import force_level
from eventpound.solvers.fast.sliding import any_rubbing, any_slider, own_contacts


@compiled
def enter_mode(run: FastRun) -> None:
    """Arrays of the mode that the resting contacts make; bodies that touch move as one."""
    plan, state, series = run.plan, run.state, run.series
    mass, links, progress = plan.mass, plan.links, state.progress[0]
    progress.resting = 0
    for j in range(state.resting.size):
        state.unlocked[j] = state.resting[j]
        progress.resting += state.resting[j]
    if progress.resting == 0 and plan.contacts.weights.shape[0] == 0:
        progress.clusters = mass.size
        for b in range(mass.size):
            series.of_body[b] = b
            series.inverse_mass[b] = 1.0 / mass[b]
    else:
        _enter_rest(run)
    progress.active = 0
    for a in range(links.offset.size):
        for side in range(2):
            b = links.ends[a, side]
            series.ends[a, side] = series.of_body[b] if b >= 0 else -1
        # A link within a cluster changes neither length nor force.
        if series.ends[a, 0] != series.ends[a, 1]:
            series.active[progress.active] = a
            progress.active += 1


@compiled_deferred
def _enter_rest(run: FastRun) -> None:
    """The clusters of bodies that rest on each other, their masses and velocities."""
    plan, series, progress = run.plan, run.series, run.state.progress[0]
    progress.clusters, progress.edges = _form(run)
    total = series.inverse_mass
    total[:] = 0.0
    for b in range(plan.mass.size):
        if series.of_body[b] >= 0:
            total[series.of_body[b]] += plan.mass[b]
    for c in range(plan.mass.size):
        # A cluster of points alone has no mass; what it does follows from others.
        total[c] = 1.0 / total[c] if total[c] > 0.0 else 0.0


@kernel.but(fused=True)
def _form(run: FastRun) -> tuple[int, int]:
    """Clusters, how the forces of the resting contacts follow from the motion, which are unique.

    The bodies of a cluster get one velocity, those that follow others theirs. Returned are the
    numbers of clusters and of rows of the elimination.
    """
    contacts, mass, state, series = run.plan.contacts, run.plan.mass, run.state, run.series
    ends = contacts.left, contacts.right, contacts.gap
    between = ContactEnds(*ends, mass, contacts.weights, own_contacts(run))
    clusters = form_clusters(between, state.resting, state.pressed)
    count = clusters.count
    edges = clusters.elimination.shape[0]
    for row in range(edges):
        copy_numbers(clusters.elimination[row], series.elimination[row])
    unlocked = have_ends(clusters, state.gap.size - contacts.rubbing.size)
    for i in range(clusters.resting.size):
        j = clusters.resting[i]
        state.unlocked[j] = unlocked[i]
        run.record.unique[j] &= clusters.unique[i]
    _put_equations(clusters, series)
    if any_rubbing(run):
        count = _enter_slips(clusters, between, run)
    put_as_one(clusters, False, mass, state.v)
    return count, edges


@kernel.but(fused=True)
def _put_equations(clusters: Clusters, series: FastSeries) -> None:
    """Who moves with whom, and what forces make of it in a scene with points."""
    copy_numbers(clusters.of_body, series.of_body)
    for row in range(clusters.force_map.shape[0]):
        series.resting[row] = clusters.resting[row]
        copy_numbers(clusters.force_map[row], series.force_map[row])
    for c in range(clusters.carried.size):
        series.carried[c] = clusters.carried[c]
        for d in range(clusters.carried.size):
            series.compliance[c, d] = clusters.compliance[c, d]


@deferred_kernel.but(fused=True)
def _enter_slips(clusters: Clusters, between: ContactEnds, run: FastRun) -> int:
    """Put the equations of a mode in which contacts slip in place; the number of its clusters."""
    contacts, branch, may_stop = run.plan.contacts, run.state.branch, run.series.may_stop
    own = contacts.rubbing, contacts.friction
    slips = slips_of(*own, between, branch, clusters.resting)
    oblique = with_slips(clusters, slips, may_stop.size, between)
    _put_equations(oblique, run.series)
    tied = are_tied(slips.left, slips.right, oblique)
    may_stop[:] = False
    for s in range(tied.size):
        may_stop[slips.which[s]] = not tied[s]
    return oblique.count


@compiled
def choose_directions(run: FastRun) -> None:
    """Turn round every hysteretic link whose elongation rate changed its sign in an impact."""
    plan, state, series = run.plan, run.state, run.series
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    still = still_rate(plan.limits.length, plan.limits.time)
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        if turns_back(state.part[h], state.sigma[h], series.x_rate[a], still):
            reverse(h, series.x[a], hysteresis, state)


@compiled
def instant_of(run: FastRun) -> Instant:
    """What the rules of an instant work on; `travel` of the series is free then."""
    plan, state, located = run.plan, run.state, run.located
    contacts, links, limits = plan.contacts, plan.links, plan.limits
    return Instant(
        mass=plan.mass,
        weights=contacts.weights,
        compliance=run.series.free,
        ends=links.ends,
        # As the event loop has it, so that what an instant demands is compiled once for both.
        law=whole(links.law),
        compression=links.compression,
        extension=links.extension,
        offset=links.offset,
        hysteretic=plan.hysteresis.link,
        left=contacts.left,
        right=contacts.right,
        opening=contacts.gap,
        restitution=contacts.restitution,
        length=limits.length,
        time=limits.time,
        last_speed=last_speed(
            limits.length / limits.time, links.sliders.size + contacts.rubbing.size > 0
        ),
        u=state.u,
        v=state.v,
        gap=state.gap,
        gap_rate=state.gap_rate,
        resting=state.resting,
        pressed=state.pressed,
        branch=state.branch,
        released=located.released,
        vanished=located.vanished,
        before=run.series.travel,
        now=state.now,
        events=run.record.events,
    )


@compiled
def settle(forcing: Forcing, z: Floats, at: Instant, run: FastRun) -> int:
    """Do the duties of the present instant; `z` (H,) is overwritten."""
    plan, state, series, limits = run.plan, run.state, run.series, run.plan.limits
    sliders, slides, rubs = plan.links.sliders, any_slider(run), any_rubbing(run)
    force, kinked, contacts = run.observed.contact_force, run.located.kinked, plan.contacts
    rubbing = Rubs(contacts.rubbing, contacts.friction, state.rubbed)
    if slides:
        begin_beside_sliders(force, kinked, sliders, at)
    if rubs:
        begin_beside_friction(force, kinked, rubbing, at)
    # What has ended by now has been seen to, and must not end once more.
    kinked[:] = False
    ended = settle_with_friction(rubbing, at) if rubs else settle_impacts(at)
    if ended != DONE:
        return ended
    if follows(run):
        put_on_branches(run)
    choose_directions(run)
    if slides or any_may_rest(at):
        all_variables(series.x, plan.hysteresis, state, z)
        if slides:
            # Of no clusters: their series are those of the step before.
            ended = decide_sticks(z, forcing, force_level(0, limits, series), sliders, at)
        elif rubs:
            ended = decide_friction(z, forcing, force_level(0, limits, series), rubbing, at)
        else:
            ended = decide_rests(z, forcing, at)
        if ended == DONE:
            if slides:
                put_on_branches(run)
                # Where forces are not unique some contacts have none.
                series.contact_force[:] = 0.0
            enter_mode(run)
    return ended


@compiled_noinline
def start(run: FastRun) -> None:
    """The first mode of a run, and its hysteretic links on their curves."""
    plan, state, series = run.plan, run.state, run.series
    open_gaps(plan, state)
    # The contacts that hold what sticks take no part in impacts.
    state.gap[own_contacts(run) :] = np.inf
    for a in range(plan.links.offset.size):
        copy_numbers(plan.links.law.memory[a], series.memory[a])
    enter_mode(run)
    # Nothing rests yet.
    for b in range(series.free.shape[0]):
        copy_numbers(series.compliance[b], series.free[b])
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    hysteresis = plan.hysteresis
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        y = state.xi_r[h]
        sigma = -1.0 if series.x_rate[a] < 0.0 else 1.0
        # One whose z is followed has no backbone.
        if hysteresis.scale[h] < np.inf:
            set_curve(h, series.x[a], sigma, sigma * y, hysteresis, state)
    if follows(run):
        find_branches(run)
