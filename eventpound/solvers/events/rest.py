"""The acceleration problem: which contacts with g = γ = 0 stay closed.

``0 <= g'' ⊥ λ >= 0``, ``g'' = G λ + q`` with q the accelerations of the gaps
without contact forces. Where g'' and λ both vanish the first derivative that
does not decides: the same problem is solved order by order on the Taylor
coefficients of the motion, over the contacts still undecided, with those
found pressed moving as one. What no order decides stays closed.
"""

from __future__ import annotations

from math import factorial

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.contact_problem import solve_contacts
from eventpound.mechanics.reduced import Forcing
from eventpound.mechanics.series import motion_series
from eventpound.numerics.arrays import Bools, Floats
from eventpound.solvers.events.modes import Mode, ModeTable, State
from eventpound.solvers.events.scales import SceneScales

ORDER = 12
"""Highest Taylor coefficient looked at."""
UNDECIDED = 1e-10
"""Coefficients below this part of the largest of their order decide nothing."""

ACCELERATION_NOISE = 1e-13
"""Accelerations of gaps below this part of L/T² have no meaningful sign; their derivatives
below this part of the same in the scene's own time."""


def decide_rest(
    state: State,
    table: ModeTable,
    forcing: Forcing,
    released: Bools,
    speed_noise: float,
    scales: SceneScales,
) -> tuple[Bools, Bools]:
    """Contacts at rest after the acceleration problem.

    Parameters
    ----------
    state : State
        No closed contact approaches.
    table : ModeTable
        Modes of the scene.
    forcing : Forcing
        The ground motion from now on, its start at the time of the state.
    released : ndarray of bool, shape (K,)
        Contacts whose force has just been found to pass zero: for them the
        order zero has vanished by definition.
    speed_noise : float
        Elongation rates without a meaningful sign (m/s).
    scales : SceneScales
        The scene's own.

    Returns
    -------
    resting, pressed : ndarray of bool, shape (K,)
        The resting contacts, and those of them that were found pressed.
    """
    undecided = state.closed & (state.gap_rate == 0.0)
    pressed = np.zeros(undecided.size, np.bool_)
    kept = pressed.copy()
    while undecided.any():
        mode = table.mode(pressed, state.branch, pressed)
        order, relative, level = _first_deciding(
            mode, state, table, forcing, undecided, released, speed_noise, scales
        )
        if order < 0:
            break
        members = np.flatnonzero(undecided)
        ends = np.append(mode.clusters.of_body, -1)
        left, right = ends[table.model.left[members]], ends[table.model.right[members]]
        inside = left == right
        kept[members[inside]] = True
        undecided[members[inside]] = False
        members, left, right = members[~inside], left[~inside], right[~inside]
        force, opening, solved = solve_contacts(
            left, right, 1.0 / mode.system.mass, relative[members]
        )
        if not solved:
            raise ComputationError(
                f"the forces of resting contacts could not be found (contacts {members.tolist()})",
                state.t,
            )
        opens = opening > level
        holds = (force > 0.0) & ~opens
        if order == 0:
            opens[released[members]] = holds[released[members]] = False
        undecided[members[opens | holds]] = False
        pressed[members[holds]] = True
        if not (opens | holds).any():
            break
    return pressed | kept | undecided, pressed


def _first_deciding(
    mode: Mode,
    state: State,
    table: ModeTable,
    forcing: Forcing,
    undecided: Bools,
    released: Bools,
    speed_noise: float,
    scales: SceneScales,
) -> tuple[int, Floats, float]:
    """Lowest order at which an undecided gap accelerates, its accelerations, and their noise."""
    y = mode.pack(state)
    of_body = np.append(mode.clusters.of_body, mode.clusters.count)
    for highest in (1, ORDER):
        Y = motion_series(0.0, y, mode.system, forcing, highest, speed_noise)
        for order in range(highest):
            coefficient = np.append(Y[order + 1, mode.system.iv], 0.0)
            body = coefficient[np.where(of_body < 0, mode.clusters.count, of_body)]
            relative = body[table.model.right] - body[table.model.left]
            level = UNDECIDED * np.max(np.abs(coefficient), initial=0.0)
            # Rounding of an order whose terms cancel, or vanish for every body.
            rounding = ACCELERATION_NOISE * scales.acceleration / scales.time**order
            level = max(level, rounding / factorial(order))
            relative[np.abs(relative) <= level] = 0.0
            deciding = undecided & ~released if order == 0 else undecided
            if relative[deciding].any():
                return order, relative, level
    return -1, np.empty(0), 0.0
