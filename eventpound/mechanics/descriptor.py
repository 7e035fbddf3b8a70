"""A contact mode in descriptor form: coordinates of every body, contact forces as unknowns.

    y = [u (N), v (N), z (H), λ (R), ledger]

    u' = v                                                          (free bodies)
    M v' + Σ_l B_l F_l - W λ + M 1 a_g = 0,   x = B_lᵀ u
    F and z' by `eventpound.mechanics.elements`
    g = δ + Wᵀ u = 0,   γ = Wᵀ v = 0                               (a dependent body each)
    γ' = Wᵀ M⁻¹ (-Σ_l B_l F_l + W λ) - Wᵀ 1 a_g = 0                (λ)

over the R resting contacts that are independent. Each of them takes one body
as dependent, whose position and velocity the gap and its rate determine in the
place of its differential equations (Wehage and Haug 1982, "Generalized
coordinate partitioning"). So the gap, its rate and its acceleration are all
equations of the system, whose index is one; W is constant, and so is the choice
of dependent bodies as long as the mode lasts.

Nothing here is taken from `eventpound.mechanics.reduced` but the laws of the
springs; the matrices follow from the `Model` and who rests.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import Clusters
from eventpound.mechanics.elements import memory_on_branches
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import in_python


class Descriptor(NamedTuple):
    """Arrays of a mode: N bodies, L links, H hysteretic, K contacts, R independent resting ones.

    size: of y. hysteretic: H. ledger: place of the first ledger entry or -1. z_of_link (L,):
    number of the z of a link or -1. dependent (R,): bodies. resting: all resting contacts.
    carrying (R,): those with the forces λ. framed (N,): 1 for bodies that a moving frame
    carries, 0 for those at rest on a barrier. B (L, N), W (R, N): rows are directions of
    elongations and gaps, opening (R,) the gaps at u = 0 (m).
    all_gaps (K, N), all_openings (K,): those of every contact.
    ledger_weight: factor of the rows of the ledger, which determine nothing else: no such row
    must become the pivot of another unknown, as it does where energies are large numbers.
    """

    size: int
    hysteretic: int
    ledger: int
    z_of_link: Ints
    dependent: Ints
    resting: Ints
    carrying: Ints
    mass: Floats
    framed: Floats
    stiffness: Floats
    preload: Floats
    damping: Floats
    memory: Floats
    B: Floats
    W: Floats
    opening: Floats
    all_gaps: Floats
    all_openings: Floats
    ledger_weight: float


def contact_rows(model: Model) -> Floats:
    """Directions of the gaps of all contacts in the bodies, shape (K, N): Wᵀ."""
    return np.ascontiguousarray(model.rates(np.eye(model.bodies)).T)


def descriptor_form(
    model: Model, clusters: Clusters, branch: Ints, *, ledger: int, ledger_weight: float = 1.0
) -> Descriptor:
    """Descriptor form of a mode.

    Parameters
    ----------
    model : Model
        The scene.
    clusters : Clusters
        Of its bodies: which contacts rest, and how.
    branch : ndarray of int, shape (L,)
        Side of the kink of each link, 0 where it has none.
    ledger : int
        Entries of the energy ledger (`Model.ledger_entries`), 0 where it is not kept.
    ledger_weight : float
        Factor of its equations.
    """
    bodies, hysteretic = model.bodies, model.hysteretic.size
    mass = model.mass[:bodies]
    every = contact_rows(model)
    members = clusters.resting[~clusters.redundant]
    W = every[members]
    size = 2 * bodies + hysteretic + members.size
    stiffness, preload = model.elastic.on_side(branch)
    return Descriptor(
        size=size + ledger,
        hysteretic=hysteretic,
        ledger=size if ledger > 0 else -1,
        z_of_link=model.z_of_link,
        dependent=_dependent(W, model.supports),
        resting=clusters.resting,
        carrying=members,
        mass=mass,
        framed=np.where(clusters.of_body[:bodies] < 0, 0.0, 1.0),
        stiffness=stiffness,
        preload=preload,
        damping=model.law.damping,
        memory=in_python(memory_on_branches)(model.law.memory, branch),
        B=np.ascontiguousarray(model.elongations(np.eye(bodies)).T),
        W=W,
        opening=model.gap[members],
        all_gaps=every,
        all_openings=model.gap,
        ledger_weight=ledger_weight,
    )


def _dependent(W: Floats, supports: int) -> Ints:
    """A body for each independent contact such that the gaps determine all of them, shape (R,).

    None of the first ones, which are supports: they move as they do.
    """
    if W.shape[0] == 0:
        return np.empty(0, np.int64)
    from scipy.linalg import qr

    _, _, order = qr(W[:, supports:], mode="economic", pivoting=True)
    return np.asarray(supports + order[: W.shape[0]], np.int64)
