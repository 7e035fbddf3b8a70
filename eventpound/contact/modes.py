"""The table of contact modes and transitions, written down once.

A contact is open or resting. What an instant demands of it, with g its gap
and γ the rate of the gap:

    before    g    γ      duty                  after
    open      > 0  any    none                  open
    open      = 0  > 0    none                  open
    open      = 0  < 0    impact                γ⁺ = -ε γ⁻, or more
    open      = 0  = 0    acceleration problem  resting (rest) or open
    resting   = 0  = 0    impact elsewhere      γ⁺ > 0: open (separation)
    resting   = 0  = 0    acceleration problem  open (detachment) or resting

A contact with a law is neither: its element is a link with a kink, and closes and opens by its
branch. Its gap counts as infinite here.

Impacts come first and are repeated until no closed contact approaches; the
acceleration problem over all contacts with g = γ = 0 follows. It is solved at
the start of a run, after every impact, where a contact force reaches zero,
and where the ground acceleration jumps.
"""

from __future__ import annotations

from eventpound.numerics.compiled import scalar_kernel
from eventpound.tolerances import RELEASED_AT

NONE, IMPACT, ACCELERATION = range(3)
"""What an instant demands of a contact: nothing, an impact, the acceleration problem."""


@scalar_kernel
def duty(gap: float, gap_rate: float) -> int:
    """What an instant demands of a contact, from g (m) and γ (m/s)."""
    if gap == 0.0 and gap_rate < 0.0:
        return IMPACT
    return ACCELERATION if gap == 0.0 and gap_rate == 0.0 else NONE


@scalar_kernel
def transition_code(was_resting: bool, rests: bool, gap_rate: float) -> int:
    """How a contact changed its mode: 0 not, 1 a rest began, 2 detachment, 3 separation.

    Parameters
    ----------
    was_resting, rests : bool
        Mode before and after.
    gap_rate : float
        γ after (m/s).
    """
    if was_resting == rests:
        return 0
    if rests:
        return 1
    return 3 if gap_rate > 0.0 else 2


@scalar_kernel
def ends_of_stick(slip: float) -> tuple[float, float]:
    """Contact forces between which a slider sticks (N), from the force of its slip on its branch.

    From that friction is taken back by up to twice its bound.
    """
    return min(2.0 * slip, 0.0), max(2.0 * slip, 0.0)


@scalar_kernel
def force_vanishes(force: float, rate: float, level: float, slowest: float, time: float) -> bool:
    """Whether a contact force (N) vanishes in the instant in which others do.

    Such forces do so within rounding of each other, the smaller one first to be no more than that:
    the instant is known to the time in which the slowest of the others passes its own. One that
    dies away is small, but does not vanish. rate (N/s); level: rounding of the forces (N);
    slowest: smallest |rate| of the others (N/s); time: the scene's own (s).
    """
    near = abs(force) <= level or abs(force) * slowest <= level * abs(rate)
    return near and abs(force) <= abs(rate) * RELEASED_AT * time
