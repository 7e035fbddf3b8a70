"""The present state of a run as the state vector of its mode, and back; what it shows."""

from __future__ import annotations

import numpy as np

from eventpound.contact.kinks import pass_kinks
from eventpound.mechanics.monitored import copy_extremes, update_extremes, update_settled, value_of
from eventpound.mechanics.observables import (
    Bodies,
    Observed,
    bodies_motion,
    difference,
    observe_motion,
)
from eventpound.mechanics.reduced import Forcing, Reduced, state_vector
from eventpound.mechanics.reduced_loads import placed
from eventpound.motion.forcing import CurrentPiece
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import borrow, copy_numbers
from eventpound.numerics.by_address import by_address
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.recorder import write_row
from eventpound.solvers.events.run import Dynamics, Rules, Run, RunRecord, State


@kernel
def forcing_now(piece: CurrentPiece, t: float) -> Forcing:
    """The ground motion from the time t (s) on."""
    return Forcing(piece.family, borrow(piece.coefficients), borrow(piece.samples), t)


@kernel
def tolerances_of_state(rules: Rules, system: Reduced, bodies: Bodies) -> Floats:
    """Absolute tolerance of each entry of a state vector, shape (size,).

    Bodies that move together have the smallest of any of them.
    """
    result = np.full(system.size, np.inf)
    for b in range(bodies.mass.size):
        c = bodies.of_body[b]
        if c >= 0:
            result[system.iq[c]] = min(result[system.iq[c]], rules.atol_u[b])
            result[system.iv[c]] = min(result[system.iv[c]], rules.atol_v[b])
    # A z that stands still has no place.
    for h in range(system.z_of.size):
        if system.z_of[h] >= 0:
            result[system.z_of[h]] = rules.atol_z[h]
    if system.ledger >= 0:
        result[system.ledger :] = rules.atol_energy
    return result


@kernel
def set_state(y: Floats, t: float, mode: Dynamics, forcing: Forcing, state: State) -> None:
    """Make a state vector the present state, at the time t (s)."""
    system, bodies = mode.system, mode.bodies
    now = state.now[0]
    # Before the clock goes on.
    now.since_impact += t - now.t
    now.t = t
    bodies_motion(placed(t, y, system, forcing), bodies, state.u, state.v)
    for h in range(state.z.size):
        if system.z_of[h] >= 0:
            state.z[h] = y[system.z_of[h]]
    if system.ledger >= 0:
        copy_numbers(y[system.ledger :], state.ledger)
    for j in range(state.gap.size):
        # That of a contact with a law, or of a slider that slips.
        if state.gap[j] == np.inf:
            continue
        left, right, resting = bodies.left[j], bodies.right[j], state.resting[j]
        gap = bodies.gap[j] + difference(state.u, left, right)
        state.gap[j] = 0.0 if resting else gap
        state.gap_rate[j] = 0.0 if resting else difference(state.v, left, right)


@scalar_kernel
def close_located(arrays: Run) -> None:
    """Put what has closed exactly on its constraint, and links on the branch that follows."""
    located, state = arrays.located, arrays.state
    for j in range(state.gap.size):
        if located.closing[j]:
            state.gap[j] = 0.0
    pass_kinks(located.kinked, state.z, arrays.instant)


@kernel
def put_instant(t: float, observed: Observed, record: RunRecord) -> None:
    """Put one side of an event into the history and the extremes."""
    write_row(t, observed, record.journal)
    update_extremes(observed, t, record.running)


@kernel
def make_ready(arrays: Run, mode: Dynamics, piece: CurrentPiece) -> None:
    """Leave the present instant as a step begins with it: `y`, `rate`, `atol`, what is observed.

    The gaps observed are their own variables.
    """
    system, bodies, state = mode.system, mode.bodies, arrays.state
    rate = arrays.rate[: system.size]
    forcing = by_address(forcing_now(piece, state.now[0].t))
    # What links of one cluster are observed with: their z are not in the state.
    copy_numbers(state.z, bodies.frozen_z)
    y = state_vector(bodies, system, bodies.mass, state.u, state.v, state.z, state.ledger)
    copy_numbers(y, arrays.y)
    copy_numbers(tolerances_of_state(arrays.rules, system, bodies), arrays.atol)
    observed = arrays.observations[0]
    observe_motion(0.0, y, rate, system, bodies, forcing, observed)
    for j in range(state.gap.size):
        if state.gap[j] < np.inf:
            observed.gap[0, j], observed.gap[1, j] = state.gap[j], state.gap_rate[j]


@kernel
def put_present(arrays: Run, settled: bool) -> None:
    """Put the present instant, which is ready, into history and extremes.

    The bodies of a `settled` one are on their constraints.
    """
    record, t = arrays.record, arrays.state.now[0].t
    observed = arrays.observations[0]
    if settled:
        at = record.running.at
        for i in range(at.gap, at.acceleration):
            update_settled(i, value_of(i, at, observed), t, record.running)
    put_instant(t, observed, record)


@kernel
def save_record(record: RunRecord) -> None:
    """Remember history and extremes as they are, for `restore_record`."""
    copy_numbers(record.journal.cursor, record.saved_cursor)
    copy_extremes(record.extremes, record.saved_extremes)


@kernel
def restore_record(record: RunRecord) -> None:
    """Take back what has come into history and extremes since `save_record`."""
    copy_numbers(record.saved_cursor, record.journal.cursor)
    copy_extremes(record.saved_extremes, record.extremes)
