"""The motion within a step as a polynomial of its state (dense output), and what it shows.

After an event it is the local Taylor series, which tells the rates and the gaps itself.
Otherwise it is the integrator's own polynomial of its last step; the equations of motion
then tell the rates. Either way everything that may happen is looked for on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import Observed, observe
from eventpound.mechanics.reduced import Forcing, motion_rate
from eventpound.mechanics.series import evaluate_series
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.events.run import Dynamics
from eventpound.tolerances import OF_DENSE_OUTPUT

NO_GAPS = np.empty((0, 0))
"""The gaps of a step whose polynomial does not tell them."""

_DEGREE = 12
"""The highest of SUNDIALS' methods."""
NODES = 0.5 * (1.0 + np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE))
"""Chebyshev's points of a step, as parts of it counted back from its end, descending."""


class Dense(NamedTuple):
    """The motion over a step; times are local, from the start of the forcing.

    Y (p + 1, size): coefficients of ``Σ Y_k (τ - center)^k`` in the moving `frame`.
    start, end: of the step (s). own: whether the polynomial tells the rates and `gaps`
    (K, p + 1) those of the contacts.
    """

    Y: Floats
    center: float
    start: float
    end: float
    frame: Floats
    own: bool
    gaps: Floats


class DenseStep(NamedTuple):
    """A step of motion in one mode that can be observed anywhere; observed: the last of it."""

    dense: Dense
    dynamics: Dynamics
    forcing: Forcing
    observed: Observed


@kernel
def state_at(tau: float, step: DenseStep) -> Floats:
    """State vector at `tau` (s), relative to the ground."""
    dense = step.dense
    Y, x = dense.Y, tau - dense.center
    y = Y[Y.shape[0] - 1].copy()
    for k in range(Y.shape[0] - 2, -1, -1):
        for i in range(y.size):
            y[i] = y[i] * x + Y[k, i]
    if dense.frame.shape[1] > 0:
        system = step.dynamics.system
        to_frame(dense.frame, step.forcing.start + tau, -1.0, system.iq, system.iv, y)
    return y


@kernel
def observe_at(tau: float, step: DenseStep) -> None:
    """Everything observed at `tau` (s), into `step.observed`."""
    dense, mode, observed = step.dense, step.dynamics, step.observed
    if dense.own:
        y, rate = evaluate_series(dense.Y, tau)
    else:
        y = state_at(tau, step)
        rate = np.empty(y.size)
        motion_rate(tau, y, rate, mode.system, step.forcing)
    observe(tau, y, rate, mode.system, mode.bodies, step.forcing, observed)
    if dense.own:
        for j in range(observed.gap.shape[1]):
            # By their own variables, whose digits differences of displacements do not have.
            if mode.guards.open_contacts[j]:
                observed.gap[0, j], observed.gap[1, j] = value_and_slope(dense.gaps[j], tau)


def from_values(values: Floats, start: float, end: float, frame: Floats) -> Dense:
    """The polynomial of a step from its values.

    Parameters
    ----------
    values : ndarray, shape (13, size)
        State vectors in the frame, at `NODES` back from the end.
    start, end : float
        Of the step (s).
    frame : ndarray
        The moving frame.
    """
    x = 1.0 - 2.0 * NODES
    coefficients = np.linalg.solve(chebyshev.chebvander(x, _DEGREE), values)
    # A power series magnifies what is rounding in the highest of them.
    coefficients[np.abs(coefficients) < OF_DENSE_OUTPUT * np.abs(values).max(axis=0)] = 0.0
    powers = np.zeros_like(coefficients)
    for i in range(values.shape[1]):
        found = chebyshev.cheb2poly(coefficients[:, i])
        powers[: found.size, i] = found
    half = 0.5 * (end - start)
    Y = powers / half ** np.arange(_DEGREE + 1.0)[:, None]
    return Dense(Y, 0.5 * (start + end), start, end, frame, False, NO_GAPS)
