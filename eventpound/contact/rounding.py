"""What of accelerations and their derivatives is rounding, and tells nothing of who rests.

A sum of forces errs by a part of its terms, and by one of the scene's own acceleration, L/T². By
way of springs and dashpots that becomes errors of higher derivatives, large where these are stiff.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.state import Instant
from eventpound.mechanics.contact_elements import FIRST_CODE
from eventpound.mechanics.contact_laws import element_pull
from eventpound.mechanics.elements import drag_slope, memory_stiffness, pull_per_z
from eventpound.mechanics.followers import is_unmoved
from eventpound.mechanics.reduced import Forcing, Reduced, link_motion
from eventpound.motion.base import Family
from eventpound.motion.forcing import decay_time, ground_taylor
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import ACCELERATION, DIRECT, UNDECIDED

_GAUSSIAN = int(Family.GAUSSIAN)


@kernel
def noise_of(
    found: Floats,
    left_over: Floats,
    rough: Bools,
    y: Floats,
    system: Reduced,
    forcing: Forcing,
    at: Instant,
) -> Floats:
    """Noise of Taylor coefficients of accelerations of clusters that are `found`, (orders, C).

    Parameters
    ----------
    found : ndarray, shape (orders, C)
        The coefficients.
    left_over : ndarray, shape (C,)
        What counts as rounding of the first beside its own (m/s²).
    rough : ndarray of bool, shape (C,)
        `round_as_the_scene`.
    y, system : ndarray and Reduced
        The state, and the equations of motion of the clusters.
    forcing : Forcing
        The ground motion from now on.
    at : Instant
        The instant.
    """
    orders = found.shape[0]
    ground, (stiffness, damping) = np.zeros(orders), _slopes(y, system)
    ground_taylor(forcing, forcing.start, orders, ground)
    # In the tails of a pulse high orders are large beside what they are derivatives of.
    time = min(at.time, decay_time(forcing, forcing.start))
    # Rounding of an order whose terms cancel, or vanish for every body.
    noise, rounding = np.empty(found.shape), np.zeros((orders + 2, found.shape[1]))
    own, part = ACCELERATION * (at.length / at.time**2), DIRECT
    for order in range(orders):
        for c in range(found.shape[1]):
            absolute = abs(found[order, c] + ground[order] / (order + 1))
            rounding[order, c] = max(rounding[order, c], own) if rough[c] else 0.0
            noise[order, c] = max(part * absolute, rounding[order, c])
            if order == 0:
                rounding[0, c] = max(rounding[0, c], left_over[c])
        if system.compliance.size > 0:
            _spread(system.compliance, noise[order])
        _pass_on(rounding, order, system, stiffness, damping)
        # As derivatives in the scene's own time go; those of higher orders are no sums of forces.
        own, part = own / (time * (order + 1)), UNDECIDED
    return noise


@kernel
def _spread(compliance: Floats, noise: Floats) -> None:
    """Let accelerations (C,) err as those that they are sums of."""
    own = noise.copy()
    for c in range(noise.size):
        for d in range(noise.size):
            if compliance[c, d] != 0.0:
                noise[c] = max(noise[c], own[d])


@kernel
def _slopes(y: Floats, system: Reduced) -> tuple[Floats, Floats]:
    """Sizes of initial stiffness (N/m) and damping (N s/m) of links, of an element at y, (A,)."""
    stiffness, damping = system.stiffness.copy(), system.damping.copy()
    for a in range(stiffness.size):
        x, x_rate = link_motion(a, y, system)
        if system.iz[a] <= FIRST_CODE:
            code, f = system.iz[a], system.preload[a]
            # The numbers of its law are no stiffness and no dashpot: that of hertz-damp, over a
            # closing speed of 1e-12 m/s, would make all there is rounding.
            slopes = element_pull(code, stiffness[a], f, damping[a], x, x_rate, 0.0)
            stiffness[a], damping[a] = abs(slopes[1]), slopes[2]
        else:
            stiffness[a] = abs(stiffness[a] + memory_stiffness(a, system.memory))
            damping[a] = abs(drag_slope(a, system, x_rate))
    return stiffness, damping


@kernel
def _pass_on(
    rounding: Floats, order: int, system: Reduced, stiffness: Floats, damping: Floats
) -> None:
    """What the rounding of an order makes by way of the links in the next two.

    `rounding` (orders, C) is that of the Taylor coefficients of velocities, the first that of an
    acceleration: of coefficient k + 1 in k. An error e there moves coefficient k + 2 by
    ``c e / (m (k + 2))`` and k + 3 by ``k_l e / (m (k + 2) (k + 3))``. A stiff body
    makes of an acceleration that is rounding a large higher derivative.
    """
    for a in range(stiffness.size):
        error = 0.0
        # Both ends err by the worse of them, for the link pulls at both.
        for c in system.ends[a]:
            if c >= 0:
                error = max(error, rounding[order, c])
        for c in system.ends[a]:
            if is_unmoved(c, system.mass):
                continue
            if system.compliance.size == 0:
                part = error / (system.mass[c] * (order + 2))
                _pass_to(c, part, order, rounding, stiffness[a], damping[a])
            for d in range(system.compliance.shape[0]):
                part = error * abs(system.compliance[d, c]) / (order + 2)
                _pass_to(d, part, order, rounding, stiffness[a], damping[a])


@scalar_kernel
def _pass_to(
    c: int, part: float, order: int, rounding: Floats, stiffness: float, damping: float
) -> None:
    """The same to cluster c, whose coefficient a force of 1 N for an error of 1 moves by `part`."""
    rounding[order + 1, c] += damping * part
    rounding[order + 2, c] += stiffness * part / (order + 3)


@kernel
def round_as_the_scene(system: Reduced, forcing: Forcing) -> Bools:
    """Clusters (C,) of whose accelerations an own part of those of the scene is rounding.

    All, but for those that the tail of a Gaussian pulse alone moves, on which no link acts.
    """
    rough = np.full(system.mass.size, 1.0 if forcing.family != _GAUSSIAN else 0.0)
    for a in range(system.stiffness.size):
        pulls = system.stiffness[a] != 0.0 or drag_slope(a, system, 0.0) != 0.0
        if pulls or pull_per_z(a, system.memory) != 0.0:
            for c in system.ends[a]:
                if c >= 0:
                    rough[c] = 1.0
    if system.compliance.size > 0:
        _spread(system.compliance, rough)
    return rough > 0.0


@scalar_kernel
def acceleration_noise(absolute: float, own: float) -> float:
    """Rounding of the acceleration of a body (m/s²): of a sum of forces, or of the scene, `own`.

    `absolute` is its absolute acceleration. What the ground alone accelerates, which has none,
    errs with its own acceleration only, however small.
    """
    return max(DIRECT * abs(absolute), own) if absolute != 0.0 else 0.0
