"""Reversals of links within a step, at which its integrator begins anew.

At a reversal the rate of z has a kink (`eventpound.mechanics.elements`). A multistep
method that passes it corrects with a rate of the other branch, and does not see the error.
So each link keeps its *direction*, the sign of x', in the equations that the integrator
is given: they stay smooth beyond the reversal. It is located on the polynomial of the
step, which ends there, and the next step begins with the other direction.

So it is with the end of an approach under Jankowski's law, and where a contact element would
pull that cannot: its direction is the sign of the pull.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.contact_elements import APPROACH_CODE, CUT_CODE
from eventpound.mechanics.elements import reversal_jump
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.reduced import Reduced, link_motion
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.location import PARTS, Bracket, turning_point
from eventpound.tolerances import EPS, HELD_BELOW, REVERSAL_WITHIN

NEGLIGIBLE = 0.01
"""Part of rtol by which z may err at a reversal that is passed over."""


@scalar_kernel
def _side(a: int, y: Floats, system: Reduced) -> float:
    """Of the kink of link a, from a state (m/s, or N)."""
    x, x_rate = link_motion(a, y, system)
    return _side_at(a, x, x_rate, system)


@scalar_kernel
def _side_at(a: int, x: float, x_rate: float, system: Reduced) -> float:
    """`_side` from the elongation x (m) and its rate (m/s); of a cut force, were it not cut."""
    if system.iz[a] != CUT_CODE:
        return x_rate
    return float(system.stiffness[a] * x + system.preload[a] + system.damping[a] * x_rate)


@scalar_kernel
def _side_rate(a: int, rate: Floats, system: Reduced) -> float:
    """The rate of `_side`, from that of a state."""
    x_rate, x_second = link_motion(a, rate, system)
    if system.iz[a] != CUT_CODE:
        return x_second
    return system.stiffness[a] * x_rate + system.damping[a] * x_second


@kernel
def take_directions(y: Floats, system: Reduced, rtol: float, direction: Floats) -> None:
    """Give every link with a kink, where it has no direction yet, the one in which it moves.

    None to a hysteretic link where rtol is not below `HELD_BELOW`.

    Parameters
    ----------
    y : ndarray, shape (size,)
        State, relative to the ground.
    system : Reduced
        The mode.
    rtol : float
        Relative tolerance of the motion.
    direction : ndarray, shape (A,)
        Of each link, 0 for none; updated.
    """
    # The kink of a contact element is one of its force, and no tolerance hides it.
    for a in range(0 if rtol < HELD_BELOW else system.plain, direction.size):
        kinked = system.iz[a] >= 0 or system.iz[a] == APPROACH_CODE or system.iz[a] == CUT_CODE
        if kinked and direction[a] == 0.0:
            direction[a] = np.sign(_side(a, y, system))


@kernel
def may_reverse(
    before: Floats,
    rate: Floats,
    after: Floats,
    h: float,
    system: Reduced,
    direction: Floats,
    allowed: float,
) -> bool:
    """Whether a link may reverse within a step in a way that matters.

    Where none does, those that reverse change their directions. By how much z errs,
    the jump of dz/dx times ``|x'| h`` bounds. x' is bounded by the end of the step and, for one
    that reverses twice, by the Bernstein coefficient in the middle of the parabola through both
    ends.

    Parameters
    ----------
    before, rate, after : ndarray, shape (size,)
        State and its rate at the start, state at the end, relative to the ground.
    h : float
        Length of the step (s).
    system : Reduced
        The mode.
    direction : ndarray, shape (A,)
        Of each link; updated.
    allowed : float
        By how much z may err.
    """
    for a in range(direction.size):
        if direction[a] == 0.0:
            continue
        end = direction[a] * _side(a, after, system)
        start = direction[a] * _side(a, before, system)
        lowest = min(end, start + 0.5 * h * direction[a] * _side_rate(a, rate, system))
        if lowest >= 0.0:
            continue
        if system.iz[a] < 0:
            # A dashpot ends or begins.
            return True
        z = max(abs(before[system.iz[a]]), abs(after[system.iz[a]]))
        jump = reversal_jump(a, system.memory, z, after[system.beside[a]])
        if -lowest * h * jump > allowed:
            # The other directions wait: the step may end before their links reverse.
            return True
    for a in range(direction.size):
        if direction[a] * _side(a, after, system) < 0.0:
            direction[a] = -direction[a]
    return False


@kernel
def _side_on(tau: float, a: int, dense: Dense, origin: float, system: Reduced) -> float:
    """`_side` of link a at a time on the polynomial of a step, local to `origin` (s)."""
    Y, after, x, rate = dense.Y, tau - dense.center, 0.0, 0.0
    for k in range(Y.shape[0] - 1, -1, -1):
        x_k, rate_k = link_motion(a, Y[k], system)
        x, rate = x * after + x_k, rate * after + rate_k
    place, speed = 0.0, 0.0
    if dense.frame.shape[1] > 0:
        place, speed, _ = frame_motion(dense.frame, origin + tau)
        # Between bodies the frame cancels; an end on the ground does not go with it.
        rate += (speed if system.ends[a, 0] >= 0 else 0.0) - (
            speed if system.ends[a, 1] >= 0 else 0.0
        )
    x += (place if system.ends[a, 0] >= 0 else 0.0) - (place if system.ends[a, 1] >= 0 else 0.0)
    return _side_at(a, x, rate, system)


@scalar_kernel
def _instant(dense: Dense) -> float:
    """Time within which reversals in a step are one (s)."""
    return max(REVERSAL_WITHIN * (dense.end - dense.start), 4.0 * EPS * abs(dense.end))


@kernel
def _reversal(a: int, way: float, dense: Dense, origin: float, system: Reduced) -> float:
    """When link a, which moves in the direction `way`, reverses in a step (s); or inf."""
    low, high, end = dense.start, dense.start, dense.end
    at_low, at_high = max(way * _side_on(low, a, dense, origin, system), 0.0), 0.0
    # Part by part, for a link may turn twice within the step.
    for i in range(PARTS):
        high = dense.start + (end - dense.start) * (i + 1) / PARTS if i + 1 < PARTS else end
        at_high = way * _side_on(high, a, dense, origin, system)
        if at_high < 0.0:
            break
        low, at_low = high, at_high
    if at_high >= 0.0:
        return np.inf
    bracket = Bracket(low, at_low, high, at_high)
    return turning_point(_ahead, (way, a, dense, origin, system), bracket, _instant(dense))


@kernel
def _ahead(tau: float, of: tuple[float, int, Dense, float, Reduced]) -> float:
    """`_side_on` along the direction in which the link moves."""
    way, a, dense, origin, system = of
    return way * _side_on(tau, a, dense, origin, system)


@kernel
def first_reversal(
    dense: Dense, last: float, origin: float, system: Reduced, direction: Floats
) -> float:
    """The first reversal in a step, after which the links that have part in it go the other way.

    Parameters
    ----------
    dense : Dense
        The step.
    last : float
        Reversals after this local time (s) are left alone.
    origin : float
        Start of its local times (s).
    system : Reduced
        The mode.
    direction : ndarray, shape (A,)
        Of each link; updated.

    Returns
    -------
    float
        Local time (s); inf where no link reverses until the last.
    """
    first, times = np.inf, np.full(direction.size, np.inf)
    for a in range(direction.size):
        if direction[a] != 0.0:
            times[a] = _reversal(a, direction[a], dense, origin, system)
            first = min(first, times[a])
    if first > last:
        return np.inf
    together = _instant(dense)
    for a in range(direction.size):
        if times[a] <= first + together:
            direction[a] = -direction[a]
    # No step is as short as rounding, neither up to a reversal nor behind it.
    first = max(first, dense.start + together)
    return first if first < dense.end - together else dense.end
