"""Newton's impact law in Moreau's form, over all contacts closed at one instant.

    M (v⁺ - v⁻) = W Λ,    0 <= γ⁺ + ε γ⁻ ⊥ Λ >= 0,    γ = Wᵀ v

over the closed contacts that are not separating, resting ones (γ⁻ = 0)
included (Leine, Van Campen and Glocker 2003; taking separating contacts in
would let them penetrate again). If a closed contact then approaches, the
problem is solved again in the same instant by whoever calls.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.contact_problem import Joints, answer, of_members, solve_contacts
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import CANCELLED, QUIET


@kernel
def impact_law(
    joints: Joints, mass: Floats, restitution: Floats, closed: Bools, gap_rate: Floats, v: Floats
) -> tuple[Floats, Bools, float, bool]:
    """Velocities after the impact at the closed contacts.

    Parameters
    ----------
    joints : Joints
        All contacts, (K,), between N coordinates.
    mass : ndarray, shape (N,)
        Their masses (kg), inf of supports.
    restitution : ndarray, shape (K,)
        ε of each contact.
    closed : ndarray of bool, shape (K,)
        Contacts whose gap is zero.
    gap_rate : ndarray, shape (K,)
        γ of every contact (m/s); overwritten with γ⁺.
    v : ndarray, shape (N,)
        Velocities of the coordinates (m/s); overwritten.

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
    # w = γ⁺ + ε γ⁻ = G Λ + (1 + ε) γ⁻, which Moreau's form asks to be complementary to Λ.
    q = (1.0 + restitution[members]) * before
    noise = QUIET * np.max(-before)
    x, w, solved = solve_contacts(of_members(joints, members), q, noise)
    impulse[members] = x
    rounding = take_impulses(joints, mass, members, x, closed, gap_rate, v)
    opening = np.where(w > rounding[members], w, 0.0)
    lost = rates_after(members, before, restitution, noise, impulse, opening, gap_rate)
    return impulse, involved, lost, solved


@kernel
def take_impulses(
    joints: Joints,
    mass: Floats,
    members: Ints,
    x: Floats,
    closed: Bools,
    gap_rate: Floats,
    v: Floats,
) -> Floats:
    """Change velocities (N,) and rates of gaps (K,) by impulses x (k,) of some of the joints.

    Returned is the rounding of these rates. What is closed, and neither opens nor approaches but
    for that, stands still.
    """
    # Changes of velocities stand by themselves. Rates of gaps are variables of their own and take
    # these alone: so one far below the rounding of velocities keeps its digits.
    change, left, right = np.zeros(v.size), joints.left, joints.right
    size = np.zeros(v.size if joints.compliance.size > 0 else 0)
    for i in range(members.size):
        j = members[i]
        if joints.compliance.size > 0:
            for b in range(v.size):
                own = answer(joints, b, left[j], right[j]) * x[i]
                change[b] += own
                size[b] += abs(own)
            continue
        if left[j] >= 0:
            change[left[j]] -= x[i] / mass[left[j]]
        if right[j] >= 0:
            change[right[j]] += x[i] / mass[right[j]]
    for b in range(size.size):
        # Both ends of an edge that strike alike turn no deck, to the last bit.
        if abs(change[b]) <= CANCELLED * size[b]:
            change[b] = 0.0
    v += change
    rounding = np.zeros(gap_rate.size)
    for j in range(gap_rate.size):
        terms = abs(gap_rate[j])
        for end, sign in ((left[j], -1.0), (right[j], 1.0)):
            if end >= 0:
                gap_rate[j] += sign * change[end]
                terms += abs(change[end])
        rounding[j] = CANCELLED * terms
        if closed[j] and abs(gap_rate[j]) <= rounding[j]:
            gap_rate[j] = 0.0
    return rounding


@scalar_kernel
def rates_after(
    members: Ints,
    before: Floats,
    restitution: Floats,
    noise: float,
    impulse: Floats,
    opening: Floats,
    gap_rate: Floats,
) -> float:
    """Rates of gaps (K,) after an impact, free of rounding; the kinetic energy lost (J).

    Parameters
    ----------
    members : ndarray of int, shape (k,)
        Contacts of the problem.
    before, opening : ndarray, shape (k,)
        Their γ⁻, and ``γ⁺ + ε γ⁻`` of the solution (m/s).
    noise : float
        Speeds below this (m/s) are none.
    restitution, impulse, gap_rate : ndarray, shape (K,)
        ε, Λ (N s), and the rates (m/s), overwritten.
    """
    energy_lost = 0.0
    for i in range(members.size):
        j, eps = members[i], restitution[members[i]]
        after = opening[i] - eps * before[i]
        # Touched by no impulse and left by none: still at rest, not opening at rounding speed.
        gap_rate[j] = 0.0 if before[i] == 0.0 and after <= noise else after
        # Λ (γ⁻ + γ⁺)/2 with Λ > 0 only where γ⁺ = -ε γ⁻: exactly none for ε = 1.
        energy_lost -= 0.5 * impulse[j] * (1.0 - eps) * before[i]
    return energy_lost


@scalar_kernel
def newton(before: float, restitution: float, inverse: float) -> tuple[float, float, float]:
    """Newton's law at a single contact that approaches: γ⁺ = -ε γ⁻.

    Parameters
    ----------
    before, restitution : float
        γ⁻ (m/s) and ε.
    inverse : float
        1/m of its bodies together (1/kg), see `inverse_mass`.

    Returns
    -------
    after, impulse, energy_lost : float
        γ⁺ (m/s), Λ (N s) and the kinetic energy lost (J).
    """
    impulse = -(1.0 + restitution) * before / inverse
    # -Λ (γ⁻ + γ⁺)/2, not below zero as γ⁻ is.
    return -restitution * before, impulse, 0.5 * impulse * (restitution - 1.0) * before


@scalar_kernel
def inverse_mass(left: int, right: int, mass: Floats) -> float:
    """Delassus' matrix of a single contact, 1/m of its bodies together (1/kg); -1: a barrier."""
    inverse = 1.0 / mass[left] if left >= 0 else 0.0
    return inverse + (1.0 / mass[right] if right >= 0 else 0.0)


@scalar_kernel
def push_apart(
    j: int, impulse: float, mass: Floats, left: Ints, right: Ints, gap_rate: Floats, v: Floats
) -> None:
    """Give the bodies of contact j its impulse (N s), and all gaps (K,) the rates that follow.

    gap_rate and v are overwritten; the others are as of `impact_law`.
    """
    on_left = -impulse / mass[left[j]] if left[j] >= 0 else 0.0
    on_right = impulse / mass[right[j]] if right[j] >= 0 else 0.0
    if left[j] >= 0:
        v[left[j]] += on_left
    if right[j] >= 0:
        v[right[j]] += on_right
    for i in range(gap_rate.size):
        for end, sign in ((left[i], -1.0), (right[i], 1.0)):
            if end >= 0 and end == left[j]:
                gap_rate[i] += sign * on_left
            elif end >= 0 and end == right[j]:
                gap_rate[i] += sign * on_right
