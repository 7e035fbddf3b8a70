"""Impacts with friction by Poisson's law: compression, then expansion, in one instant.

Compression is the impact with ε = 0, from γ⁻ to γᶜ with impulses Λᶜ. In expansion each contact
gives back ε of its normal impulse, or more where others press it together again:

    0 <= γ_N⁺ ⊥ (Λ_Nᵉ - ε Λ_Nᶜ) >= 0,   Λ_Tᵉ ∈ -μ Λ_Nᵉ Sgn(γ_T⁺)

(Ch. Glocker, F. Pfeiffer, Nonlinear Dynamics 7, 1995, 471-497). With one ε for all contacts no
impact gains kinetic energy. With ``ΔT = Λᶜ·γᶜ - Λᶜ·G Λᶜ/2 + Λᵉ·γ⁺ - Λᵉ·G Λᵉ/2`` that follows from
``Λᶜ·γᶜ <= 0`` and

    γ_N⁺·Λ_Nᵉ = ε γ_N⁺·Λ_Nᶜ = ε (γ⁺ - γᶜ)·Λᶜ + ε γᶜ·Λᶜ - ε γ_T⁺·Λ_Tᶜ <= ε Λᵉ·G Λᶜ - γ_T⁺·Λ_Tᵉ

since ``-ε γ_T⁺·Λ_Tᶜ <= μ |γ_T⁺| ε Λ_Nᶜ <= μ |γ_T⁺| Λ_Nᵉ``: what is left is at most
``-|Λᶜ|²/2 - |Λᵉ|²/2 + ε Λᵉ·Λᶜ`` in the norm of G.

What is given back rubs, whether its contact opens or not. It is the force of a further contact,
which a push along a direction of its own holds closed: that slides as its contact does, and
moves nothing by its normal force. So expansion is a problem of `eventpound.numerics.coulomb`, too.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import deferred_kernel, kernel
from eventpound.numerics.coulomb import ANSWERED, NO_ANSWER, SEVERAL, Rubbing, solve_rubbing


@deferred_kernel
def compress_and_expand(
    problem: Rubbing, restitution: Floats, x: Floats, w: Floats, state: Ints
) -> int:
    """Solve an impact of k contacts by Poisson's law.

    Parameters
    ----------
    problem : Rubbing
        Of the compression, q = γ⁻.
    restitution : ndarray, shape (k,)
        ε of each contact.
    x, w : ndarray, shape (2k,)
        Impulses of both phases together, and γ⁺; overwritten.
    state : ndarray of int, shape (k,)
        Of the compression; overwritten.

    Returns
    -------
    int
        As of `eventpound.numerics.coulomb.solve_rubbing`, the worst of both phases.
    """
    k = restitution.size
    compressed = solve_rubbing(problem, x, w, state)
    given = restitution * x[:k]
    if compressed in (NO_ANSWER, SEVERAL) or not given.any():
        return compressed
    expanded = _expand(np.arange(k), given, problem, x, w)
    if expanded == NO_ANSWER:
        # Lemke's method may end without an answer. Mostly none is pressed together again.
        expanded = _expand(np.flatnonzero(given == 0.0), given, problem, x, w)
        expanded = max(expanded, ANSWERED)
    return max(compressed, expanded)


@kernel
def _expand(own: Ints, given: Floats, problem: Rubbing, x: Floats, w: Floats) -> int:
    """Expand from impulses x and rates w (2k,), which are changed; ends as `solve_rubbing`.

    own: contacts that may be pressed by more than is `given` back (k,).
    """
    k, rubs = given.size, np.flatnonzero(given * problem.friction)
    m, n = own.size, own.size + rubs.size
    force, rate, states = np.zeros(2 * n), np.zeros(2 * n), np.zeros(n, np.int64)
    found = solve_rubbing(_expansion(own, rubs, given, problem, w), force, rate, states)
    if found in (NO_ANSWER, SEVERAL):
        return found
    back, after = np.concatenate((given, np.zeros(k))), w.copy()
    back[own] += force[:m]
    back[k + own] += force[n : n + m]
    back[k + rubs] += force[n + m :]
    for a in range(2 * k):
        for b in range(2 * k):
            after[a] += problem.G[a, b] * back[b]
    after[own], after[k + own], after[k + rubs] = rate[:m], rate[n : n + m], rate[n + m :]
    if m < k and (after[:k] < -problem.noise[:k]).any():
        return NO_ANSWER
    x += back
    w[:] = after
    return found


@kernel
def _expansion(own: Ints, rubs: Ints, given: Floats, problem: Rubbing, w: Floats) -> Rubbing:
    """The problem of what some contacts expand beyond what is `given` back (k,), from rates w.

    Behind these, its `own`, are those whose forces are given, of the contacts `rubs`.
    """
    k, m, every = given.size, own.size, np.concatenate((own, rubs))
    n = every.size
    G, q, noise = np.zeros((2 * n, 2 * n)), np.zeros(2 * n), np.zeros(2 * n)
    # Which row of the problem each one is; none of a force that is given.
    rows = np.concatenate((every, k + every))
    for a in range(2 * n):
        if m <= a < n:
            G[a, a] = problem.G[rows[a], rows[a]]
            q[a] = -G[a, a] * given[rows[a]]
            continue
        q[a], noise[a] = w[rows[a]], problem.noise[rows[a]]
        for i in range(k):
            q[a] += problem.G[rows[a], i] * given[i]
        for b in range(2 * n):
            if not m <= b < n:
                G[a, b] = problem.G[rows[a], rows[b]]
    return Rubbing(G, q, problem.friction[every], np.zeros(n, np.int64), noise)
