"""Where bodies are and how fast they move: gaps and elongations without any force.

What an event function asks of a state in which no contact rests, at a fraction of what all
of `eventpound.mechanics.observables` costs.
"""

from __future__ import annotations

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import dot
from eventpound.mechanics.held import add_points
from eventpound.mechanics.observables import Bodies, Observed, bodies_motion, difference
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel


@kernel
def observe_positions(y: Floats, bodies: Bodies, out: Observed) -> None:
    """Fill u, v and the values and first rates of gaps and elongations from the state.

    `y` (size,): that of the clusters, relative to the ground.
    """
    bodies_motion(y, bodies, out.u, out.v)
    for link in range(bodies.stiffness.size):
        first, second = bodies.link_ends[link, 0], bodies.link_ends[link, 1]
        out.elongation[0, link] = difference(out.u, first, second)
        out.elongation[1, link] = difference(out.v, first, second)
    for j in range(bodies.gap.size):
        left, right = bodies.left[j], bodies.right[j]
        out.gap[0, j] = bodies.gap[j] + difference(out.u, left, right)
        out.gap[1, j] = difference(out.v, left, right)
    if bodies.points.size > 0:
        add_points(bodies.points, bodies.spread, out.u, out.gap[0])
        add_points(bodies.points, bodies.spread, out.v, out.gap[1])


@kernel
def observe_unknown_positions(y: Floats, d: Descriptor, out: Observed) -> None:
    """`observe_positions` from the unknowns of the descriptor form."""
    N = d.mass.size
    u, v = y[:N], y[N : 2 * N]
    for link in range(d.stiffness.size):
        out.elongation[0, link] = dot(d.B[link], u)
        out.elongation[1, link] = dot(d.B[link], v)
    for j in range(d.all_openings.size):
        out.gap[0, j] = d.all_openings[j] + dot(d.all_gaps[j], u)
        out.gap[1, j] = dot(d.all_gaps[j], v)
