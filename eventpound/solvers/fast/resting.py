"""Who rests: the acceleration problem, and the mode that the resting contacts make."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.clusters import Clusters, form_clusters, unique_forces
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Ints
from eventpound.solvers.events.modes import transition_code
from eventpound.solvers.events.rest import rest_contacts
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import all_variables
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_with_arrays
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.event_rows import write_change
from eventpound.solvers.fast.plan import (
    ACTIVE,
    CLUSTERS,
    EDGES,
    GROUPS,
    LEAST_NORM,
    RESTED_AT,
    RESTING,
    Plan,
    Record,
    Series,
    State,
    T,
)


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
        if code == 1:
            state.clock[RESTED_AT] = state.clock[T]
        write_change(code, j, group, state.gap_rate[j], state.clock[T], state.count, record.events)


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
