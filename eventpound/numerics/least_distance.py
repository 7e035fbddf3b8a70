"""The point of a polyhedron that is nearest to another."""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from eventpound.numerics.arrays import Floats
from eventpound.tolerances import INSIDE


def least_distance(A: Floats, b: Floats) -> Floats:
    """The least x with ``A x >= b``, of a system that has solutions.

    The problem LDP of C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974,
    chapter 23: the residual of a non-negative least-squares problem.

    Parameters
    ----------
    A, b : ndarray, shape (m, n), (m,)
        The system.

    Returns
    -------
    ndarray, shape (n,)
        Zero where that is a solution.
    """
    size = np.abs(b).max(initial=0.0)
    if not (b > INSIDE * size).any():
        return np.zeros(A.shape[1])
    system = np.vstack((A.T, b / size))
    wanted = np.append(np.zeros(A.shape[1]), 1.0)
    residual = system @ nnls(system, wanted)[0] - wanted
    return np.asarray(residual[:-1] / -residual[-1] * size)
