"""The root functions of a state of CVODE or IDA, whichever way SUNDIALS asks for them."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import DescriptorProblem
from eventpound.mechanics.observables import (
    Bodies,
    Observed,
    observe_motion,
)
from eventpound.mechanics.reduced import Forcing, Reduced
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot
from eventpound.solvers.sundials.callback_data import Roots, evaluate
from eventpound.solvers.sundials.descriptor_steps import observe_interpolated


@kernel
def cluster_roots(
    tau: float,
    state: Floats,
    system: Reduced,
    bodies: Bodies,
    forcing: Forcing,
    roots: Roots,
    out: Floats,
) -> None:
    """Fill `out` (2 n,) with the functions of a state of the clusters, relative to the ground."""
    observe_motion(tau, state, np.empty(state.size), system, bodies, forcing, roots.observed)
    evaluate(roots, out)


@kernel
def descriptor_roots(
    tau: float, y: Floats, problem: DescriptorProblem, roots: Roots, out: Floats
) -> None:
    """Fill `out` (2 n,) from unknowns relative to the ground, whose λ is overwritten."""
    if roots.forces:
        observe_interpolated(tau, y, problem, roots.observed)
    else:
        _observe_bodies(y, problem.d, roots.observed)
    evaluate(roots, out)


@kernel
def _observe_bodies(y: Floats, d: Descriptor, out: Observed) -> None:
    """Fill the values and first rates of gaps and elongations from the unknowns."""
    N = d.mass.size
    u, v = y[:N], y[N : 2 * N]
    for link in range(d.stiffness.size):
        out.elongation[0, link] = dot(d.B[link], u)
        out.elongation[1, link] = dot(d.B[link], v)
    for j in range(d.all_openings.size):
        out.gap[0, j] = d.all_openings[j] + dot(d.all_gaps[j], u)
        out.gap[1, j] = dot(d.all_gaps[j], v)
