"""State and scratch arrays at the start of a run."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.model import WORK_OF_SUPPORTS, without_rounding
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.polynomial import root_work
from eventpound.solvers.events.cascade import INTERVAL, RESTED_AT, SINCE_IMPACT, T
from eventpound.solvers.fast.run import (
    CLOCK_SIZE,
    COUNT_SIZE,
    CURVE_PLACES,
    DUE,
    GUESS,
    MORE_TERMS,
    REST_TERMS,
    SETTLED_AT,
    Contacts,
    Happened,
    Plan,
    Series,
    Single,
    State,
)
from eventpound.solvers.fast.sampled.exact import blank_tables

MOST_TURNS = 40
"""Turning points looked for in one step."""
SINGLE_SIZE = 512
"""Room for the numbers of a single body (`eventpound.solvers.fast.single.body`)."""


def blank_happened(links: int, hysteretic: int, contacts: int, laws: int = 0) -> Happened:
    """Marks of nothing."""
    sizes = (contacts, contacts, contacts, links, hysteretic, hysteretic, laws)
    return Happened(*(np.zeros(size, np.bool_) for size in sizes))


def blank_state(
    plan: Plan, u0: Floats, v0: Floats, z0: Floats, start: float, ledger: int = WORK_OF_SUPPORTS
) -> State:
    """State arrays at the start of a run, or with a leading axis of many.

    Parameters
    ----------
    plan : Plan
        Constants of the run; with a leading axis where the others have one.
    u0, v0 : ndarray, shape (..., N)
        Displacements (m) and velocities (m/s).
    z0 : ndarray, shape (..., H)
        Hysteretic variables.
    start : float
        Time (s).
    ledger : int
        Entries of the energy ledger.
    """
    contacts, limits, runs = plan.contacts, plan.limits, u0.shape[:-1]
    gap = without_rounding(contacts.gap + _rates(contacts, u0), contacts.gap, u0, limits.length)
    clock = np.zeros((*runs, CLOCK_SIZE))
    clock[..., T], clock[..., GUESS] = start, limits.time
    clock[..., INTERVAL] = limits.time
    clock[..., SINCE_IMPACT] = limits.time
    clock[..., RESTED_AT] = clock[..., SETTLED_AT] = -np.inf
    counts = np.zeros((*runs, COUNT_SIZE), np.int64)
    counts[..., DUE] = 1
    return State(
        u0.copy(),
        v0.copy(),
        np.zeros(z0.shape),
        np.zeros(z0.shape),
        z0 / plan.hysteresis.bound,
        np.zeros(z0.shape, np.int64),
        gap,
        _rates(contacts, v0),
        np.zeros(gap.shape, np.bool_),
        np.zeros(gap.shape, np.bool_),
        np.zeros(gap.shape, np.bool_),
        np.zeros((*runs, plan.links.ends.shape[0]), np.int64),
        np.zeros((*runs, ledger)),
        clock,
        counts,
    )


def _rates(contacts: Contacts, v: Floats) -> Floats:
    """Rates of the gaps, shape (..., K), for velocities of shape (..., N)."""
    extended = np.concatenate((v, np.zeros((*v.shape[:-1], 1))), axis=-1)
    right, left = (np.take(extended, ends, axis=-1) for ends in (contacts.right, contacts.left))
    return np.asarray(right - left)


def blank_series(
    bodies: int,
    links: int,
    hysteretic: int,
    contacts: int,
    order: int,
    loaded: bool = False,
    laws: int = 0,
    length: float = 0.0,
) -> Series:
    """Scratch arrays of a run."""
    size = order + 3
    most = max(size + MORE_TERMS, REST_TERMS)
    work, turns = in_python(root_work)(most), np.zeros(MOST_TURNS)
    return Series(
        np.zeros((bodies, size)),
        np.zeros((links, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, size)),
        np.zeros((hysteretic, CURVE_PLACES)),
        np.zeros((2, bodies)),
        np.zeros(size),
        np.zeros(links),
        np.zeros(links),
        np.zeros(links),
        np.zeros((links, 2), np.int64),
        np.zeros(bodies, np.int64),
        np.zeros(bodies),
        np.zeros(links, np.int64),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(size),
        np.zeros(size),
        work,
        turns,
        np.zeros(bodies),
        np.zeros((size if loaded else 0, bodies)),
        np.zeros((contacts, size)),
        np.zeros(contacts, np.int64),
        np.zeros((contacts, 4), np.int64),
        np.zeros((contacts, bodies)),
        Single(np.zeros(SINGLE_SIZE), np.zeros(most), turns, work),
        blank_tables(bodies, links),
        np.zeros((4, 2 * bodies + links + 2 * contacts + 1)),
        np.zeros(laws),
        np.zeros(laws),
        np.zeros((laws, 3, size)),
        np.full(1, length),
    )
