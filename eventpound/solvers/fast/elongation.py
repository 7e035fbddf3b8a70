"""Elongations of links and gaps of contacts, from the motion of the bodies."""

from __future__ import annotations

from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.run import Contacts


@compiled
def elongations(ends: Ints, u: Floats, v: Floats, x: Floats, x_rate: Floats) -> None:
    """Elongations of all links (m) and their rates (m/s), into `x` and `x_rate` (L,)."""
    for a in range(ends.shape[0]):
        x[a], x_rate[a] = elongation(ends[a, 0], ends[a, 1], u, v)


@compiled
def elongation(first: int, second: int, u: Floats, v: Floats) -> tuple[float, float]:
    """Elongation of a link between two bodies (m) and its rate (m/s)."""
    return difference(u, first, second), difference(v, first, second)


@compiled
def gap_of(j: int, contacts: Contacts, u: Floats, v: Floats) -> tuple[float, float]:
    """Gap of a contact (m) and its rate (m/s)."""
    left, right = contacts.left[j], contacts.right[j]
    gap, rate = contacts.gap[j], 0.0
    if right >= 0:
        gap, rate = gap + u[right], v[right]
    if left >= 0:
        gap, rate = gap - u[left], rate - v[left]
    return gap, rate
