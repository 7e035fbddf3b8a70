"""Where bodies are and how fast they move: gaps and elongations without any force.

What an event function asks of a state in which no contact rests, at a fraction of what all
of `eventpound.mechanics.observables` costs.
"""

from __future__ import annotations

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import dot
from eventpound.mechanics.observables import Bodies, Observed
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel


@scalar_kernel
def _between(values: Floats, first: int, second: int) -> float:
    """Value at the second end less that at the first; the ground's is zero."""
    result = values[second] if second >= 0 else 0.0
    return result - values[first] if first >= 0 else result


@kernel
def observe_positions(y: Floats, bodies: Bodies, out: Observed) -> None:
    """Fill u, v and the values and first rates of gaps and elongations from the state.

    `y` (size,): that of the clusters, relative to the ground.
    """
    for b in range(bodies.mass.size):
        c = bodies.of_body[b]
        out.u[b], out.v[b] = bodies.offset[b], 0.0
        if c >= 0:
            out.u[b] += y[bodies.iq[c]]
            out.v[b] = y[bodies.iv[c]]
    for link in range(bodies.stiffness.size):
        first, second = bodies.link_ends[link, 0], bodies.link_ends[link, 1]
        out.elongation[0, link] = _between(out.u, first, second)
        out.elongation[1, link] = _between(out.v, first, second)
    for j in range(bodies.gap.size):
        left, right = bodies.left[j], bodies.right[j]
        out.gap[0, j] = bodies.gap[j] + _between(out.u, left, right)
        out.gap[1, j] = _between(out.v, left, right)


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
