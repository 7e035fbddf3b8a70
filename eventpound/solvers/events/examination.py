"""One compiled call after every step: observe, audit, inspect, keep the extremes.

Most steps hold no event, so this is all that they cost; only where the
inspection leaves a mark is the step looked at again, on the integrator's own
interpolant. A step over samples of a record is inspected from sample to
sample, on the Hermite polynomial of the smooth motion in the moving frame
(`eventpound.mechanics.ground_frame`).
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.observables import Bodies, observe
from eventpound.mechanics.packing import (
    unpack_bodies,
    unpack_observed,
    unpack_system,
)
from eventpound.mechanics.reduced import Forcing, Reduced, motion_rate
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.borrowing import borrow
from eventpound.numerics.compiled import kernel
from eventpound.numerics.hermite import cubic_at, quintic_at
from eventpound.solvers.events.inspection import (
    Found,
    Running,
    Watched,
    inspect_step,
    update_extremes,
)
from eventpound.solvers.events.journal import Journal, borrowed_journal


class Verdict(IntEnum):
    """What an examination says of a step."""

    CLEAR = 0
    NOT_FINITE = 1
    BEYOND_BOUND = 2
    """A |z| exceeds its bound by more than is allowed."""
    MARKED = 3
    """Something may have happened."""
    HAPPENED = 4
    """An event was found by the integrator, and the step ends at it."""


# Plain integers for compiled code and for comparisons made often.
CLEAR, MARKED, HAPPENED = int(Verdict.CLEAR), int(Verdict.MARKED), int(Verdict.HAPPENED)
NOT_FINITE, BEYOND_BOUND = int(Verdict.NOT_FINITE), int(Verdict.BEYOND_BOUND)


class Examined(NamedTuple):
    """What an examination works on, kept from step to step of a segment.

    ints, floats: the mode (`eventpound.mechanics.packing`). family,
    coefficients, samples, start: the forcing. frame: the moving frame. watch
    (2, K): open and unlocked contacts. kinks (2, L). looks (5, k): flat
    `Observed` of both ends, of two instants between, and of any other.
    y, rate (2, size): both ends. running (5, M): extremes. marks: closing (K),
    detaching (K), kink (L), peak (M). z_bound (H,); z_allowed: by how much a |z| may
    exceed it at the end of any step. journal: the history.
    """

    ints: Ints
    floats: Floats
    family: int
    coefficients: Floats
    samples: Floats
    start: float
    frame: Floats
    watch: Bools
    kinks: Floats
    force_noise: float
    springs: int
    looks: Floats
    y: Floats
    rate: Floats
    running: Floats
    marks: Bools
    z_bound: Floats
    z_allowed: float
    journal: Journal


@kernel
def borrowed(e: Examined) -> Examined:
    """The same without a share in its arrays; see `eventpound.numerics.borrowing`."""
    return Examined(
        borrow(e.ints),
        borrow(e.floats),
        e.family,
        borrow(e.coefficients),
        borrow(e.samples),
        e.start,
        borrow(e.frame),
        borrow(e.watch),
        borrow(e.kinks),
        e.force_noise,
        e.springs,
        borrow(e.looks),
        borrow(e.y),
        borrow(e.rate),
        borrow(e.running),
        borrow(e.marks),
        borrow(e.z_bound),
        e.z_allowed,
        borrowed_journal(e.journal),
    )


@kernel
def unpack_marks(marks: Bools, contacts: int, links: int) -> Found:
    """Marks as views of the flat array."""
    k = 2 * contacts
    return Found(marks[:contacts], marks[contacts:k], marks[k : k + links], marks[k + links :])


@kernel
def unpack_running(table: Floats) -> Running:
    """Extremes as views of the rows of a table (5, M)."""
    return Running(table[0], table[1], table[2], table[3], table[4])


@kernel
def rate_at(
    tau: float,
    y: Floats,
    rate: Floats,
    ints: Ints,
    floats: Floats,
    family: int,
    coefficients: Floats,
    samples: Floats,
    start: float,
    frame: Floats,
) -> None:
    """Fill `rate` with the rate of a state in the moving frame; see `Examined`."""
    system = unpack_system(ints, floats)
    forcing = Forcing(family, coefficients, samples, start)
    if frame.shape[1] == 0:
        motion_rate(tau, y, rate, system, forcing)
        return
    s, v, a = frame_motion(frame, start + tau)
    relative = y.copy()
    for c in range(system.mass.size):
        relative[system.iq[c]] -= s
        relative[system.iv[c]] -= v
    motion_rate(tau, relative, rate, system, forcing)
    for c in range(system.mass.size):
        rate[system.iq[c]] += v
        rate[system.iv[c]] += a


@kernel
def _between(
    tau: float,
    tau_0: float,
    tau_1: float,
    y: Floats,
    rate: Floats,
    first: int,
    system: Reduced,
    frame: Floats,
    start: float,
) -> Floats:
    """Relative state inside a step: Hermite interpolation of the motion in the frame."""
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
        q, q_rate = quintic_at(
            y[first, iq] + s_0,
            y[first, iv] + v_0,
            rate[first, iv] + a_0,
            y[last, iq] + s_1,
            y[last, iv] + v_1,
            rate[last, iv] + a_1,
            h,
            x,
        )
        state[iq], state[iv] = q - s, q_rate - v
    return state


@kernel
def _inspect_between_samples(
    tau_0: float,
    tau_1: float,
    first: int,
    e: Examined,
    system: Reduced,
    bodies: Bodies,
    forcing: Forcing,
    watched: Watched,
    running: Running,
    found: Found,
) -> bool:
    """Inspect a step over samples from each to the next."""
    N, L, K, H = e.ints[2], e.ints[3], e.ints[4], e.ints[5]
    origin, dt = e.coefficients[0] - e.start, e.coefficients[1]
    rate = np.empty(system.size)
    low, before = tau_0, unpack_observed(e.looks[first], N, L, K, H)
    row = 2
    k = int(np.floor((tau_0 - origin) / dt)) + 1
    while origin + k * dt < tau_1 - 1e-9 * dt:
        tau = origin + k * dt
        k += 1
        if tau <= low + 1e-9 * dt:
            continue
        y = _between(tau, tau_0, tau_1, e.y, e.rate, first, system, e.frame, e.start)
        motion_rate(tau, y, rate, system, forcing)
        middle = unpack_observed(e.looks[row], N, L, K, H)
        observe(tau, y, rate, bodies, forcing, middle)
        if inspect_step(before, middle, tau - low, watched, running, found):
            return True
        low, before, row = tau, middle, 5 - row
    after = unpack_observed(e.looks[1 - first], N, L, K, H)
    return inspect_step(before, after, tau_1 - low, watched, running, found)


@kernel
def examine(
    tau_0: float,
    tau_1: float,
    first: int,
    z_allowed: float,
    e: Examined,
    system: Reduced,
    bodies: Bodies,
) -> tuple[int, float]:
    """Observe the end of a step and say whether the step can be left at that.

    Parameters
    ----------
    tau_0, tau_1 : float
        Both ends (s, local).
    first : int
        Row of `looks`, `y` and `rate` that holds the start; the other holds
        the state at the end, and receives what is observed there.
    z_allowed : float
        By how much a |z| may exceed its bound.
    e : Examined
        The segment, borrowed.
    system, bodies : Reduced and Bodies
        Its mode.

    Returns
    -------
    verdict : int
        A `Verdict`; where it is CLEAR the extremes are brought up to date.
    excess : float
        Largest |z| less its bound, -1 where there is none.
    """
    forcing = Forcing(e.family, e.coefficients, e.samples, e.start)
    N, L, K, H = e.ints[2], e.ints[3], e.ints[4], e.ints[5]
    last = 1 - first
    after = unpack_observed(e.looks[last], N, L, K, H)
    motion_rate(tau_1, e.y[last], e.rate[last], system, forcing)
    observe(tau_1, e.y[last], e.rate[last], bodies, forcing, after)
    excess = -1.0
    for h in range(H):
        excess = max(excess, abs(after.z[0, h]) - e.z_bound[h])
    for i in range(system.size):
        if not np.isfinite(e.y[last, i]) or not np.isfinite(e.rate[last, i]):
            return NOT_FINITE, excess
    if excess > z_allowed:
        return BEYOND_BOUND, excess
    watched = Watched(e.watch[0], e.watch[1], e.kinks[0], e.kinks[1], e.force_noise, e.springs)
    running, found = unpack_running(e.running), unpack_marks(e.marks, K, L)
    if e.frame.shape[1] == 0:
        before = unpack_observed(e.looks[first], N, L, K, H)
        marked = inspect_step(before, after, tau_1 - tau_0, watched, running, found)
    else:
        marked = _inspect_between_samples(
            tau_0, tau_1, first, e, system, bodies, forcing, watched, running, found
        )
    if marked:
        return MARKED, excess
    update_extremes(after, e.springs, e.start + tau_1, running)
    return CLEAR, excess


@kernel
def examine_step(
    tau_0: float, tau_1: float, first: int, z_allowed: float, examined: Examined
) -> tuple[int, float]:
    """`examine` for a single step."""
    e = borrowed(examined)
    system = unpack_system(e.ints, e.floats)
    bodies = unpack_bodies(e.ints, e.floats, system)
    return examine(tau_0, tau_1, first, z_allowed, e, system, bodies)
