"""What an instant demands of a single body: impact, and rest or detachment.

The rules are those of `eventpound.solvers.events.modes` for the two barriers, of
which one at most is closed. Newton's law is ``v⁺ = -ε v⁻``. A body that stands
still at a barrier moves, once let go, as ``u'' = A - a_g`` with A a constant as
long as it has not moved, so of ``0 <= g'' ⊥ λ >= 0`` and all higher orders there
remain the Taylor coefficients of A - a_g: the first that differs from zero decides.
"""

from __future__ import annotations

from eventpound.motion.forcing import decay_time, ground_taylor
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events.cascade import (
    FASTEST,
    IN_A_ROW,
    LISTED_SPEED,
    SINCE_IMPACT,
    T,
    is_plastic,
)
from eventpound.solvers.events.event_rows import (
    EventRow,
    kind_of_impact,
    new_group,
    write_change,
    write_event,
)
from eventpound.solvers.events.modes import transition_code
from eventpound.solvers.events.rest import DIRECT
from eventpound.solvers.events.rest import ORDER as MOST_DECIDING
from eventpound.solvers.fast.backbone_parts import CORE
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.run import RESTING
from eventpound.solvers.fast.single import absolute_acceleration, spring_state
from eventpound.solvers.fast.single_parts import turn_round
from eventpound.solvers.fast.single_places import (
    HELD_BACK,
    LEFT,
    LEFT_GAP,
    MASS,
    NO_ACCELERATION,
    OF_W,
    OWN_SPEED,
    PART,
    RELEASED,
    RESTS_ON,
    RIGHT,
    RIGHT_GAP,
    ROOM,
    SIGMA,
    STILL,
    A,
    U,
    V,
    Z,
)
from eventpound.solvers.fast.single_run import SingleRun


@compiled
def side_closed(w: Floats) -> float:
    """1 for the barrier on the right, -1 for that on the left, 0 where both are open."""
    if w[RIGHT] == 0.0:
        return 1.0
    return -1.0 if w[LEFT] == 0.0 else 0.0


@compiled
def acceleration_level(w: Floats) -> float:
    """Rounding of the relative acceleration (m/s²), as the acceleration problem has it."""
    return max(DIRECT * abs(w[A]), w[NO_ACCELERATION])


@compiled_apart
def impact_at_barrier(
    side: float,
    j: int,
    restitution: float,
    clock: Floats,
    count: Ints,
    events: Floats,
    w: Floats,
) -> None:
    """Newton's law at the barrier on one side, contact j, which the body has met."""
    before = -side * w[V]
    clock[FASTEST] = max(clock[FASTEST], -before)
    count[IN_A_ROW] += 1
    plastic = is_plastic(-before, clock[FASTEST], w[OWN_SPEED], count[IN_A_ROW], 1)
    listed = -before >= LISTED_SPEED * clock[FASTEST]
    kind = kind_of_impact(listed, plastic, before, restitution)
    if plastic:
        restitution = 0.0
    after = -restitution * before
    impulse = -(1.0 + restitution) * before * w[MASS]
    lost = 0.5 * impulse * (restitution - 1.0) * before
    w[V] = -side * after
    if not listed:
        w[HELD_BACK] = 1.0
    clock[SINCE_IMPACT] = 0.0
    group = new_group(count)
    row = EventRow(clock[T], kind, group, j, before, after, impulse, lost, 1)
    write_event(row, count, events)


@compiled_deferred
def stays_closed(
    side: float,
    t: float,
    time: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    w: Floats,
) -> bool:
    """Whether a body that stands still at a barrier without a contact force stays there.

    Parameters
    ----------
    side : float
        1 for a barrier on the right, -1 for one on the left.
    t, time : float
        Present time, and the scene's own (s).
    family, coefficients, samples
        The ground motion from now on.
    w : ndarray
        Places of `eventpound.solvers.fast.single_places`.
    """
    ground, level = w[OF_W : OF_W + ROOM], w[NO_ACCELERATION]
    ground_taylor(family, coefficients, samples, t, MOST_DECIDING, ground)
    time = min(time, decay_time(family, coefficients, t))
    for k in range(1, MOST_DECIDING):
        level /= time * k
        if abs(ground[k]) > level:
            return side * ground[k] < 0.0
    return True


@compiled
def put_on_barrier(side: float, w: Floats) -> None:
    """Make the displacement agree with a gap of zero."""
    if side > 0.0:
        w[U] = w[RIGHT_GAP]
    elif side < 0.0:
        w[U] = -w[LEFT_GAP]


@compiled
def settle_single(
    g: float, family: int, coefficients: Floats, samples: Floats, run: SingleRun
) -> None:
    """Do the duties of the present instant; `g` is the acceleration of the ground (m/s²)."""
    w, clock, count, events = run.w, run.clock, run.count, run.events
    side = side_closed(w)
    j = run.right if side > 0.0 else run.left
    put_on_barrier(side, w)
    w[Z] = spring_state(w[U], run.table, w)
    if side * w[V] > 0.0:
        impact_at_barrier(side, j, run.restitution[j], clock, count, events, w)
    if w[PART] != CORE and w[SIGMA] * w[V] < -w[STILL]:
        turn_round(w[U], run.table, w)
    w[A] = absolute_acceleration(w[U], w[V], w[Z], w)
    rests = 0.0
    if side != 0.0 and w[V] == 0.0:
        pull = w[A] - g
        stays = side * pull > 0.0
        if w[RELEASED] != 0.0 or abs(pull) <= acceleration_level(w):
            stays = stays_closed(side, clock[T], run.time, family, coefficients, samples, w)
        rests = side if stays else 0.0
    if rests != w[RESTS_ON]:
        rate = -side * w[V]
        code = transition_code(rests == 0.0, rests != 0.0, rate)
        write_change(code, j, new_group(count), rate, clock[T], count, events)
    w[RESTS_ON], w[RELEASED] = rests, 0.0
    count[RESTING] = 1 if rests != 0.0 else 0
