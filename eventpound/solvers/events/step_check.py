"""One compiled call after every step: observe, audit, inspect, keep the extremes.

Most steps hold no event, so this is all that they cost; only where the
inspection leaves a mark is the step searched, on the integrator's own
interpolant. A step over samples of a record is inspected from sample to
sample, on the Hermite polynomial of the smooth motion in the moving frame
(`eventpound.mechanics.ground_frame`).

The state after every step is audited (numbers that are none, |z| beyond its bound). The
invariants of contacts and energy stand here, too: a run that breaks one stops and says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.monitored import update_extremes
from eventpound.mechanics.observables import Observed, observe_motion
from eventpound.mechanics.reduced import Forcing, Reduced, motion_rate
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python, kernel, scalar_kernel
from eventpound.numerics.hermite import cubic_at, quintic_at
from eventpound.solvers.base import Energy
from eventpound.solvers.events.event_bounds import Guards, Marks, inspect_step, margin_at_rest
from eventpound.solvers.events.run import Dynamics, RunRecord
from eventpound.tolerances import ENERGY_ERROR, GAP_NOISE, PULLED, SAME_SAMPLE

CLEAR, NOT_FINITE, BEYOND_BOUND, MARKED, EVENT_FOUND = range(5)
"""Verdicts on a step: nothing; a state that is no number; a |z| that exceeds its bound by more than
is allowed; something may have happened; an event that the integrator found, at which it ends."""


class Examination(NamedTuple):
    """What an examination works on, kept for all steps of a mode in a piece; with an address.

    dynamics, record, marks: the mode, what the run leaves and marks, with addresses. frame:
    the moving frame. observations: both ends, two between, and any other. y, rate (2, size):
    both ends. z_bound (H,); z_allowed: by how much a |z| may exceed it at the end of any step.
    """

    dynamics: Dynamics
    forcing: Forcing
    frame: Floats
    observations: tuple[Observed, ...]
    y: Floats
    rate: Floats
    record: RunRecord
    marks: Marks
    z_bound: Floats
    z_allowed: float


@kernel
def rate_at(
    tau: float, y: Floats, rate: Floats, system: Reduced, forcing: Forcing, frame: Floats
) -> None:
    """Fill `rate` with the rate of a state in the moving frame; see `Examined`."""
    if frame.shape[1] == 0:
        motion_rate(tau, y, rate, system, forcing)
        return
    s, v, a = frame_motion(frame, forcing.start + tau)
    relative = y.copy()
    for c in range(system.mass.size):
        # In the frame y holds u + s and v + s', whose rates have s' and s'' on top.
        relative[system.iq[c]] -= s
        relative[system.iv[c]] -= v
    motion_rate(tau, relative, rate, system, forcing)
    for c in range(system.mass.size):
        rate[system.iq[c]] += v
        rate[system.iv[c]] += a


@kernel
def _between(tau: float, tau_0: float, tau_1: float, first: int, e: Examination) -> Floats:
    """Relative state inside a step: Hermite interpolation of the motion in the frame."""
    y, rate, system = e.y, e.rate, e.dynamics.system
    frame, start = e.frame, e.forcing.start
    h = tau_1 - tau_0
    x = (tau - tau_0) / h
    last = 1 - first
    state = np.empty(system.size)
    for i in range(system.size):
        state[i] = cubic_at(y[first, i], rate[first, i], y[last, i], rate[last, i], h, x)
    s_0, v_0, a_0 = frame_motion(frame, start + tau_0)
    s_1, v_1, a_1 = frame_motion(frame, start + tau_1)
    s, v, _ = frame_motion(frame, start + tau)
    for c in range(system.mass.size):
        iq, iv = system.iq[c], system.iv[c]
        # In the frame the motion is smooth over samples, and its second rate is known at both ends.
        q, q_rate = quintic_at(
            (y[first, iq] + s_0, y[first, iv] + v_0, rate[first, iv] + a_0),
            (y[last, iq] + s_1, y[last, iv] + v_1, rate[last, iv] + a_1),
            h,
            x,
        )
        state[iq], state[iv] = q - s, q_rate - v
    return state


@kernel
def _inspect_between_samples(tau_0: float, tau_1: float, first: int, e: Examination) -> bool:
    """Inspect a step over samples from each to the next."""
    forcing, mode = e.forcing, e.dynamics
    origin, dt = forcing.coefficients[0] - forcing.start, forcing.coefficients[1]
    rate = np.empty(mode.system.size)
    low, before = tau_0, e.observations[first]
    row = 2
    k = int(np.floor((tau_0 - origin) / dt)) + 1
    while origin + k * dt < tau_1 - SAME_SAMPLE * dt:
        tau = origin + k * dt
        k += 1
        # The sample at which the step starts, but for rounding.
        if tau <= low + SAME_SAMPLE * dt:
            continue
        y = _between(tau, tau_0, tau_1, first, e)
        middle = e.observations[row]
        observe_motion(tau, y, rate, mode.system, mode.bodies, forcing, middle)
        if inspect_step(before, middle, tau - low, mode.guards, e.record.running, e.marks):
            return True
        # The two observations between take turns: 2, 3, 2 ...
        low, before, row = tau, middle, 5 - row
    after = e.observations[1 - first]
    return inspect_step(before, after, tau_1 - low, mode.guards, e.record.running, e.marks)


@kernel
def examine(
    tau_0: float, tau_1: float, first: int, z_allowed: float, e: Examination
) -> tuple[int, float]:
    """Observe the end of a step and say whether the step can be left at that.

    Parameters
    ----------
    tau_0, tau_1 : float
        Both ends (s, local).
    first : int
        Row of `observations`, `y` and `rate` that holds the start; the other holds
        the state at the end, and receives what is observed there.
    z_allowed : float
        By how much a |z| may exceed its bound.
    e : Examination
        The segment.

    Returns
    -------
    verdict : int
        One of those above; where it is CLEAR the extremes are brought up to date.
    excess : float
        Largest |z| less its bound, -1 where there is none.
    """
    mode, last = e.dynamics, 1 - first
    after = e.observations[last]
    y, rate = e.y[last], e.rate[last]
    observe_motion(tau_1, y, rate, mode.system, mode.bodies, e.forcing, after)
    excess = -1.0
    for h in range(e.z_bound.size):
        excess = max(excess, abs(after.z[0, h]) - e.z_bound[h])
    for i in range(y.size):
        if not np.isfinite(y[i]) or not np.isfinite(rate[i]):
            return NOT_FINITE, excess
    if excess > z_allowed:
        return BEYOND_BOUND, excess
    if e.frame.shape[1] == 0:
        before = e.observations[first]
        marked = inspect_step(before, after, tau_1 - tau_0, mode.guards, e.record.running, e.marks)
    else:
        marked = _inspect_between_samples(tau_0, tau_1, first, e)
    if marked:
        return MARKED, excess
    # A marked step may end sooner, and takes its extremes where it is searched.
    update_extremes(after, e.forcing.start + tau_1, e.record.running)
    return CLEAR, excess


@scalar_kernel
def broken_contact(observed: Observed, guards: Guards, length_noise: float) -> int:
    """The first contact that penetrates or pulls although no event was found, or -1.

    `length_noise`: gaps below this have no sign (m).
    """
    for j in range(observed.gap.shape[1]):
        # Far beyond what a search may leave, which has found no event here.
        if guards.open_contacts[j] and observed.gap[0, j] < -GAP_NOISE * length_noise:
            return j
    for j in range(observed.gap.shape[1]):
        margin = margin_at_rest(j, guards, observed.contact_force)[0]
        if guards.unlocked[j] and margin < -PULLED * guards.force_noise:
            return j
    return -1


def contact_error(
    t: float, j: int, observed: Observed, guards: Guards, names: Sequence[str]
) -> ComputationError:
    """What to raise of contact j, which `broken_contact` names, those of sliders included."""
    name = names[j]
    if guards.open_contacts[j]:
        depth = -float(observed.gap[0, j])
        return ComputationError(
            f"contact {name!r} penetrates by {depth:.3g} m; try a smaller rtol", t
        )
    pull = -float(in_python(margin_at_rest)(j, guards, observed.contact_force)[0])
    if guards.presses[j] >= 0:
        return ComputationError(
            f"{name!r} sticks with {pull:.3g} N more than friction can; try a smaller rtol", t
        )
    if guards.force_low[j] < 0.0 or guards.force_high[j] < np.inf:
        return ComputationError(
            f"slider {name!r} sticks with {pull:.3g} N more than it can; try a smaller rtol", t
        )
    return ComputationError(
        f"resting contact {name!r} pulls with {pull:.3g} N; try a smaller rtol", t
    )


def check_energy(t: float, energy: Energy, rtol: float) -> None:
    """Stop where the energy ledger does not close.

    Raises
    ------
    ComputationError
        With the error as part of the largest term.
    """
    if not abs(energy.closure) <= ENERGY_ERROR * rtol:
        raise ComputationError(
            f"the energy ledger fails to close by {energy.closure:.3g} of its largest term; "
            "try a smaller rtol",
            t,
        )
