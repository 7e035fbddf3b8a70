"""What an instant demands: impacts, the acceleration problem, the mode that follows.

The rules are those of `eventpound.solvers.events.modes` and `cascade`, and the
impact law and acceleration problem are the same compiled functions.
"""

from __future__ import annotations

from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events import noise
from eventpound.solvers.events.cascade import SINCE_IMPACT, T
from eventpound.solvers.events.impacts import DONE, NO_FORCES, Closed, end_impacts, settle_closed
from eventpound.solvers.fast.backbone_parts import CORE, reverse, set_curve
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.law_record import turn_laws
from eventpound.solvers.fast.resting import any_rest, enter_mode, rest
from eventpound.solvers.fast.run import (
    SETTLED_AT,
    Contacts,
    Happened,
    Run,
    State,
)


@compiled_apart
def choose_branches(acceleration: Floats, ground: float, onset: float, run: Run) -> None:
    """Side of the kink of links that have none yet: on it by the first of its rates that tells.

    `acceleration` (N,) is absolute, `ground` that of the ground (m/s²). Where a link has no
    relative acceleration either, it goes as the ground moves away from its body: `onset` is
    `eventpound.motion.forcing.ground_onset`. Later a link changes its branch where it falls
    below zero on it.
    """
    plan, state, series = run.plan, run.state, run.series
    links = plan.links
    near = noise.LENGTH * plan.limits.length
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    for a in range(links.offset.size):
        if links.compression[a] == links.extension[a] or state.branch[a] != 0:
            continue
        side = series.x[a] - links.offset[a]
        if abs(side) <= near:
            side = series.x_rate[a]
            first, second = links.ends[a, 0], links.ends[a, 1]
            if side == 0.0:
                side = acceleration[second] if second >= 0 else ground
                side -= acceleration[first] if first >= 0 else ground
            if side == 0.0:
                side = (0.0 if second >= 0 else onset) - (0.0 if first >= 0 else onset)
        state.branch[a] = -1 if side < 0.0 else 1


@compiled_apart
def turn_at_kinks(run: Run) -> None:
    """Put every link that is on its kink on the side to which it moves after an impact."""
    plan, state, series = run.plan, run.state, run.series
    links, limits = plan.links, plan.limits
    near = noise.LENGTH * limits.length
    still = noise.SPEED * limits.length / limits.time
    elongations(links.ends, state.u, state.v, series.x, series.x_rate)
    for a in range(links.offset.size):
        on_kink = state.branch[a] != 0 and abs(series.x[a] - links.offset[a]) <= near
        if on_kink and abs(series.x_rate[a]) > still:
            state.branch[a] = -1 if series.x_rate[a] < 0.0 else 1


@compiled
def choose_directions(run: Run) -> None:
    """Turn round every hysteretic link whose elongation rate changed its sign in an impact."""
    plan, state, series = run.plan, run.state, run.series
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    still = noise.SPEED * plan.limits.length / plan.limits.time
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        if state.part[h] != CORE and state.sigma[h] * series.x_rate[a] < -still:
            reverse(h, series.x[a], hysteresis, state)


@compiled_apart
def mark_together(tau: float, run: Run) -> None:
    """Close the gaps that do so in the same instant to rounding."""
    plan, state, happened = run.plan, run.state, run.happened
    limits = plan.limits
    instant = min(noise.TOGETHER * limits.time, 1e-9 * state.clock[SINCE_IMPACT])
    instant = max(instant, noise.SAME_INSTANT * tau)
    if not happened.closing.any():
        return
    for j in range(state.gap.size):
        closes = not state.resting[j] and state.gap_rate[j] < 0.0
        if closes and state.gap[j] <= -instant * state.gap_rate[j]:
            state.gap[j] = 0.0


@compiled
def _mark_vanished(before: Floats, contacts: Contacts, state: State, happened: Happened) -> None:
    """Contacts whose force has vanished in this instant, and that its impacts spared.

    What presses the others is another matter after the impact.
    """
    released, vanished, v = happened.released, happened.vanished, state.v
    clock = state.clock
    for j in range(released.size):
        if clock[SETTLED_AT] != clock[T]:
            vanished[j] = False
        released[j] = released[j] or vanished[j]
        for end in (contacts.left[j], contacts.right[j]):
            if end >= 0 and v[end] != before[end]:
                released[j] = False
        vanished[j] = released[j]
    clock[SETTLED_AT] = clock[T]


@compiled
def _closed_of(run: Run) -> Closed:
    """What impacts work on."""
    plan, state, record = run.plan, run.state, run.record
    contacts, limits = plan.contacts, plan.limits
    return Closed(
        plan.mass,
        state.u,
        state.v,
        contacts.left,
        contacts.right,
        contacts.gap,
        contacts.restitution,
        state.gap,
        state.gap_rate,
        state.clock,
        state.count,
        record.events,
        limits.length,
        limits.time,
    )


@compiled
def settle(forcing: Forcing, z: Floats, run: Run) -> int:
    """Do the duties of the present instant; `z` (H,) is overwritten."""
    plan, state, series, happened = run.plan, run.state, run.series, run.happened
    before = series.travel
    for b in range(before.size):
        before[b] = state.v[b]
    ended = settle_closed(_closed_of(run))
    # It goes on where it stopped once there is more room.
    _mark_vanished(before, plan.contacts, state, happened)
    if ended != DONE:
        return ended
    end_impacts(state.clock, state.count)
    choose_directions(run)
    turn_at_kinks(run)
    if series.drag.size > 0:
        turn_laws(run)
    if any_rest(state):
        if not rest(forcing, happened.released, z, run):
            return NO_FORCES
        enter_mode(run)
    return DONE


@compiled_apart
def start(run: Run) -> None:
    """The first mode of a run, and its hysteretic links on their curves."""
    plan, state, series = run.plan, run.state, run.series
    enter_mode(run)
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    hysteresis = plan.hysteresis
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        y = state.xi_r[h]
        sigma = -1.0 if series.x_rate[a] < 0.0 else 1.0
        set_curve(h, series.x[a], sigma, sigma * y, hysteresis, state)
