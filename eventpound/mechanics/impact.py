"""Newton's impact law in Moreau's form, over all contacts closed at one instant.

    M (v⁺ - v⁻) = W Λ,    0 <= γ⁺ + ε γ⁻ ⊥ Λ >= 0,    γ = Wᵀ v

over the closed contacts that are not separating, resting ones (γ⁻ = 0)
included (Leine, Van Campen and Glocker 2003; taking separating contacts in
would let them penetrate again). If a closed contact then approaches, the
problem is solved again in the same instant by whoever calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from eventpound.mechanics.contact_problem import solve_contacts
from eventpound.numerics.arrays import Bools, Floats, Ints

QUIET = 1e-13
"""Speeds an impact leaves below this part of the fastest approach count as none."""


@njit(cache=True)
def impact_law(
    mass: Floats,
    left: Ints,
    right: Ints,
    restitution: Floats,
    closed: Bools,
    gap_rate: Floats,
    v: Floats,
) -> tuple[Floats, Bools, float, bool]:
    """Velocities after the impact at the closed contacts.

    Parameters
    ----------
    mass : ndarray, shape (N,)
        Masses (kg).
    left, right : ndarray of int, shape (K,)
        Bodies of the contacts, -1 for a barrier.
    restitution : ndarray, shape (K,)
        ε of each contact.
    closed : ndarray of bool, shape (K,)
        Contacts whose gap is zero.
    gap_rate : ndarray, shape (K,)
        γ of every contact (m/s); overwritten with γ⁺.
    v : ndarray, shape (N,)
        Velocities of the bodies (m/s); overwritten.

    Returns
    -------
    impulse : ndarray, shape (K,)
        Λ (N s).
    involved : ndarray of bool, shape (K,)
        Contacts of the problem.
    energy_lost : float
        Kinetic energy lost (J).
    solved : bool
        False where the complementarity problem was not solved.
    """
    impulse = np.zeros(gap_rate.size)
    involved = closed & (gap_rate <= 0.0)
    members = np.flatnonzero(involved)
    before = gap_rate[members]
    q = (1.0 + restitution[members]) * before
    x, w, solved = solve_contacts(left[members], right[members], 1.0 / mass, q)
    change = np.zeros(v.size)
    for i in range(members.size):
        j = members[i]
        impulse[j] = x[i]
        if left[j] >= 0:
            change[left[j]] -= x[i] / mass[left[j]]
        if right[j] >= 0:
            change[right[j]] += x[i] / mass[right[j]]
    v += change
    for j in range(gap_rate.size):
        if right[j] >= 0:
            gap_rate[j] += change[right[j]]
        if left[j] >= 0:
            gap_rate[j] -= change[left[j]]
    noise = QUIET * np.max(-before)
    energy_lost = 0.0
    for i in range(members.size):
        after = w[i] - restitution[members[i]] * before[i]
        # Touched by no impulse and left by none: still at rest, not opening at rounding speed.
        gap_rate[members[i]] = 0.0 if before[i] == 0.0 and after <= noise else after
        energy_lost -= 0.5 * x[i] * (before[i] + after)
    return impulse, involved, energy_lost, solved
