"""Everything the event loop asks of a state in descriptor form."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.clusters import is_support
from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    accelerations,
    body_loads,
    contact_forces,
    ledger_rates,
    link_states,
    loaded_powers,
)
from eventpound.mechanics.elements import link_force
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.observables import Observed, observe_friction
from eventpound.motion.forcing import ground_taylor
from eventpound.motion.loads import LOADED, add_load_series
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot


@kernel
def _link_rates(d: Descriptor, a: Floats, z_rates: Floats, out: Observed) -> None:
    """Second rates of the elongations, and the rates of the forces."""
    memory = d.law.memory
    for link in range(d.stiffness.size):
        x_rate, x_second = out.elongation[1, link], dot(d.B[link], a)
        h, k, c = d.z_of_link[link], d.stiffness[link], d.law.damping[link]
        z_rate = z_rates[h] if h >= 0 else 0.0
        out.elongation[2, link] = x_second
        out.force[1, link] = link_force(link, memory, k, 0.0, c, x_rate, x_second, z_rate)


@kernel
def _observe_contacts(d: Descriptor, contact: Floats, contact_rate: Floats, out: Observed) -> None:
    for j in range(d.all_openings.size):
        out.gap[0, j] = d.all_openings[j] + dot(d.all_gaps[j], out.u)
        out.gap[1, j] = dot(d.all_gaps[j], out.v)
        out.gap[2, j] = dot(d.all_gaps[j], out.a)
    # What is left of these is the drift, which is told by itself.
    for i in range(d.resting.size):
        out.gap[:, d.resting[i]] = 0.0
    out.contact_force[:] = 0.0
    for i in range(d.carrying.size):
        out.contact_force[0, d.carrying[i]] = contact[i]
        out.contact_force[1, d.carrying[i]] = contact_rate[i]


@kernel
def _observe_points(weights: Floats, out: Observed) -> None:
    """Displacements, velocities and accelerations of points from those of the bodies."""
    place_points(weights, out.u)
    place_points(weights, out.v)
    place_points(weights, out.a)
    for row in range(2):
        acceleration = out.acceleration[row]
        if weights.shape[0] > 0:
            # A point may hang on the ground, too, whose weight is left out: so the mean is of what
            # is relative to it.
            acceleration -= out.ground[row]
            place_points(weights, acceleration)
            acceleration += out.ground[row]


@kernel
def observe_descriptor(
    tau: float, y: Floats, problem: DescriptorProblem, rate: Floats, out: Observed
) -> None:
    """Everything known of a state, and the rates of its unknowns.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate : ndarray, shape (size,)
        Unknowns, relative to the ground; their rates, overwritten.
    problem : DescriptorProblem
        Whose equations.
    out : Observed
        Overwritten; gaps of resting contacts are zero, as the event loop counts them.
    """
    d, forcing = problem.d, problem.forcing
    N, H, R = d.mass.size, d.hysteretic, d.opening.size
    ground_taylor(forcing, forcing.start + tau, 2, out.ground)
    contact, contact_rate = y[2 * N + H : 2 * N + H + R], rate[2 * N + H : 2 * N + H + R]
    loads, load_rates = np.empty(N), np.empty(N)
    a, a_rate, pulled = np.empty(N), np.empty(N), np.empty(N)
    pushed = np.zeros((2, N if forcing.family == LOADED else 0))
    link_states(d, y, out.elongation, rate[2 * N : 2 * N + H], out.force[0])
    body_loads(d, out.force[0], loads)
    # The ground takes what the links give all bodies together.
    out.shear[0] = -np.sum(loads)
    if forcing.family == LOADED:
        add_load_series(forcing, forcing.start + tau, 2, np.empty(2), pushed)
        for b in range(N):
            pulled[b] = loads[b]
            loads[b] = pushed[0, b] + (0.0 if is_support(b, d.mass) else loads[b])
    accelerations(d, loads, contact, out.ground[0], a)
    _link_rates(d, a, rate[2 * N : 2 * N + H], out)
    body_loads(d, out.force[1], load_rates)
    out.shear[1] = -np.sum(load_rates)
    # Of a support the rate of the given acceleration, in the place of that of a force.
    for b in range(pushed.shape[1]):
        load_rates[b] = pushed[1, b] + (0.0 if is_support(b, d.mass) else load_rates[b])
    # W is constant, so rates of contact forces follow from rates of loads by the same equations.
    contact_forces(d, load_rates, out.ground[1], contact_rate)
    accelerations(d, load_rates, contact_rate, out.ground[1], a_rate)
    for b in range(N):
        rate[b], rate[N + b] = y[N + b], a[b]
        out.u[b], out.v[b], out.a[b] = y[b], y[N + b], a[b]
        out.acceleration[0, b] = a[b] + out.ground[0]
        out.acceleration[1, b] = a_rate[b] + out.ground[1]
    _observe_points(d.weights, out)
    for h in range(H):
        out.z[0, h], out.z[1, h] = y[2 * N + h], rate[2 * N + h]
    if d.ledger >= 0:
        ledger_rates(d, y, out.elongation[1], out.ground[0], rate[d.ledger :])
        if forcing.family == LOADED:
            loaded_powers(tau, y, problem, pulled, rate[d.ledger :])
    _observe_contacts(d, contact, contact_rate, out)
    if d.sliders.size > 0:
        observe_friction(d.sliders, d.z_of_link, d.law.memory, d.link_ends, out)
