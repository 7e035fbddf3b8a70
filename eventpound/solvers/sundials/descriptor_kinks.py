"""Kinks of contact laws in a step of IDA: ends of approach, and where one that is cut would pull.

As `eventpound.solvers.events.reversals` does for CVODE, each law keeps to the side of its kink on
which it is (`Descriptor.way`), and a step ends where it leaves that.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.contact_laws import side_of_kink
from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import dot
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python, kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.reversals import HELD_BELOW, first_reversal, take_directions


def take_ways(y: Floats, system: Reduced, d: Descriptor) -> None:
    """Let the law of every closed element with a kink keep to its present side.

    `y` (size,): state of the event loop, whose mode `system` is.
    """
    direction = np.zeros(system.link.size)
    in_python(take_directions)(y, system, HELD_BELOW, direction)
    d.way[system.link[system.plain :] - d.plain] = direction[system.plain :]


@kernel
def may_pass_kink(before: Observed, y: Floats, h: float, d: Descriptor) -> bool:
    """Whether a law may leave its side within a step.

    Parameters
    ----------
    before : Observed
        What was seen at the start of the step.
    y : ndarray, shape (size,)
        Unknowns at its end, relative to the ground.
    h : float
        Its length (s).
    d : Descriptor
        The mode.
    """
    N = d.mass.size
    for p in range(d.way.size):
        link, way = d.plain + p, d.way[p]
        if way == 0.0:
            continue
        law = d.z_of_link[link], d.stiffness[link], d.preload[link], d.damping[link]
        x, x_rate = before.elongation[0, link], before.elongation[1, link]
        x_second = before.elongation[2, link]
        # The middle of the parabola through both ends: what leaves its side twice is seen.
        ahead = side_of_kink(*law, x + 0.5 * h * x_rate, x_rate + 0.5 * h * x_second)
        end = side_of_kink(*law, dot(d.B[link], y[:N]), dot(d.B[link], y[N : 2 * N]))
        if min(way * ahead, way * end) < 0.0:
            return True
    return False


@kernel
def first_kink(dense: Dense, last: float, origin: float, system: Reduced, d: Descriptor) -> float:
    """When in a step a law first leaves its side, and then keeps to the other (s).

    Parameters
    ----------
    dense, last, origin, system
        As of `eventpound.solvers.events.reversals.first_reversal`; inf where none does.
    d : Descriptor
        The mode.
    """
    direction = np.zeros(system.link.size)
    for a in range(system.plain, direction.size):
        direction[a] = d.way[system.link[a] - d.plain]
    tau = first_reversal(dense, last, origin, system, direction)
    for a in range(system.plain, direction.size):
        d.way[system.link[a] - d.plain] = direction[a]
    return tau
