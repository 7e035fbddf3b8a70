"""The forces of locked contacts that are told: the smallest that press.

Forces of locked contacts stay in balance with self-stresses added, which are the null space of W.
Every locked contact lies on a cycle along which equal pressures balance each other, so enough of
these make all forces pressures: there always are some. The smallest, by ``Σ λ²``, are unique,
and the same whichever forces in balance they are found from.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.followers import held_closed
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import in_python
from eventpound.numerics.graph import on_directed_cycles
from eventpound.tolerances import DEPENDENT


def press_locked(gap: Floats, force: Floats, unique: Bools, model: Model) -> None:
    """Give locked contacts the smallest forces that are in balance and do not pull, in place.

    Parameters
    ----------
    gap, force : ndarray, shape (n, K)
        Gaps (m), zero at rest, and forces in balance (N) of all contacts at n instants.
    unique : ndarray of bool, shape (K,)
        Contacts whose force was unique at all of them.
    model : Model
        Whose contacts.
    """
    shared, every = np.flatnonzero(~unique), contact_rows(model)
    resting = (force[:, shared] != 0.0).any(axis=1)
    shut = (gap[:, shared] == 0.0) & resting[:, None]
    # What is given balances any force.
    every[:, : model.supports] = 0.0
    for group in np.unique(shut[shut.any(axis=1)], axis=0):
        members = shared[group]
        locked = members[_locked(members, every, model)]
        if locked.size > 0:
            at = np.ix_((shut == group).all(axis=1), locked)
            force[at] = smallest_pressures(every[locked], force[at])


def _locked(members: Ints, every: Floats, model: Model) -> Bools:
    """Which of these contacts at rest cannot open."""
    if model.weights.size > 0:
        return in_python(held_closed)(every[members])
    # All barriers, and supports, are one node, which stands behind the bodies.
    tail, head = (
        np.where(side < model.supports, model.bodies, side)
        for side in (model.left[members], model.right[members])
    )
    return in_python(on_directed_cycles)(tail, head, model.bodies + 1)


def smallest_pressures(W: Floats, force: Floats) -> Floats:
    """The smallest forces without a pull that put the same on the bodies as those given.

    Least distance programming (C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974,
    chapter 23): the least c with ``λ + Z c >= 0``, λ the part without self-stress.

    Parameters
    ----------
    W : ndarray, shape (R, N)
        Rows of the contacts, all of them locked.
    force : ndarray, shape (n, R)
        Forces in balance (N), instant by instant.
    """
    from scipy.linalg import null_space
    from scipy.optimize import nnls

    Z = null_space(W.T, DEPENDENT)
    found = force - (force @ Z) @ Z.T
    last = np.append(np.zeros(Z.shape[1]), 1.0)
    for row in np.flatnonzero(found.min(axis=1) < 0.0):
        size = np.abs(found[row]).max() * np.sqrt(found.shape[1])
        bounds = np.vstack((Z.T, -found[row] / size))
        weights = nnls(bounds, last)[0]
        left = bounds @ weights - last
        found[row] -= Z @ left[:-1] * (size / left[-1])
        # A bound that holds the others back is attained.
        found[row, weights > 0.0] = 0.0
    return np.maximum(found, 0.0)
