"""What an instant demands of a scene with sliders, whose friction is set-valued.

With f the friction of a slider, F its bound and x' the rate of its elongation

    x' > 0: f = F,    x' < 0: f = -F,    x' = 0: |f| <= F, and x'' = 0 where |f| < F

A slider that slips in a direction σ is a link with the constant force σ F, until x' vanishes. One
that sticks rests as a contact does, from its first end to its second, whose force λ is what
friction lacks: ``f = σ F - λ``, ``0 <= σ λ <= 2 F``.

Accelerations are those of Gauss: with μ the forces of what may stick and rest, each in its bounds,
``½ μᵀ G μ + qᵀ μ`` is least, q being the accelerations without them. Where ground and supports hold
a body between them, G is singular and q tells no more as soon as they have no acceleration beside
each other; then the first derivative that they have says which contact or slider gives way
(`eventpound.numerics.box`). Only where they move alike all hold, and forces are not unique.
With that a slider has a side, and what these forces leave open, an order of the motion
further, is that of contacts alone (`eventpound.contact.rest`).

Friction is bounded and has no impulse: in impacts the gap of every slider counts as infinite, and a
slider sticks on where they leave it no rate. It ends what bounces without a loss as long as rates
have a sign: slower impacts are plastic.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.impacts import DONE, clusters_of, put_as_one
from eventpound.contact.instant import any_may_rest, take_rests
from eventpound.contact.kinks import still_rate
from eventpound.contact.rest import ORDER, Touching, free_accelerations, rest_contacts, touching_of
from eventpound.contact.state import Instant, between_now
from eventpound.mechanics.clusters import ContactEnds
from eventpound.mechanics.followers import rows_of, supports_of
from eventpound.mechanics.link_law import STRENGTH
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.box import BoxJoints, least_in_box, unless_rounding
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.tolerances import TAKEN_OVER


@deferred_kernel
def begin_beside_sliders(force: Floats, kinked: Bools, sliders: Ints, at: Instant) -> None:
    """Put sliders that let go on the side on which they do, and stop those whose slip has ended.

    To impacts, which follow, their gaps are infinite.

    Parameters
    ----------
    force : ndarray, shape (K,)
        Forces of the contacts as the instant begins (N).
    kinked : ndarray of bool, shape (L,)
        Links whose branch has just ended: sliders whose slip has.
    sliders : ndarray of int, shape (J,)
        Links of the sliders, whose contacts are the last J.
    at : Instant
        The instant.
    """
    if at.now[0].here > 0:
        # An instant that had to pause for more room goes on with its impacts.
        return
    own, stopped = at.gap.size - sliders.size, False
    held = at.resting.copy()
    for i in range(sliders.size):
        a, j = sliders[i], own + i
        if at.released[j] and force[j] * at.branch[a] > at.law.memory[a, STRENGTH]:
            at.branch[a] *= -1
        held[j] |= kinked[a]
        stopped |= kinked[a]
    if stopped:
        # What a support carries goes on with it where a slip beside it ends.
        put_as_one(clusters_of(held, at.resting, at), False, at.mass, at.v)
    at.gap[own:] = np.inf


@deferred_kernel
def decide_sticks(z: Floats, forcing: Forcing, noise: float, sliders: Ints, at: Instant) -> int:
    """Who sticks and who rests after the impacts of an instant; ends as `take_rests`.

    Parameters
    ----------
    z : ndarray, shape (H,)
        Hysteretic variables.
    forcing : Forcing
        The ground motion from now on.
    noise : float
        Contact forces below this (N) have no meaningful sign.
    sliders : ndarray of int, shape (J,)
        Links of the sliders, whose contacts are the last J.
    at : Instant
        The instant, its impacts over.
    """
    _offer(sliders, at)
    # Branches of sliders are decided here.
    at.now[0].stale = True
    if not any_may_rest(at):
        # A cascade of impacts between what slips needs no more.
        return DONE
    touching = touching_of(between_now(at), z, forcing, at)
    members = np.flatnonzero(touching.undecided)
    force, found = _forces(members, touching, sliders, at)
    if not found:
        return take_rests(touching.undecided, at.pressed, False, at)
    pressed = _take_sides(members, force, noise, sliders, at)
    # Who rests beside what is known to be pressed.
    touching = touching_of(_directed(sliders, at), z, forcing, at)
    copy_numbers(touching.undecided & ~pressed, touching.undecided)
    copy_numbers(pressed, touching.pressed)
    resting, pressed, solved = rest_contacts(touching)
    ended = take_rests(resting, pressed, solved, at)
    for j in range(at.gap.size - sliders.size, at.gap.size):
        at.gap[j] = at.gap[j] if at.resting[j] else np.inf
    return ended


@scalar_kernel
def _offer(sliders: Ints, at: Instant) -> None:
    """Let sliders that stand still take part in the acceleration problem, others slip."""
    own, still = at.gap.size - sliders.size, still_rate(at.length, at.time)
    for i in range(sliders.size):
        a, j = sliders[i], own + i
        rate = difference(at.v, at.ends[a, 0], at.ends[a, 1])
        at.gap_rate[j], at.gap[j] = 0.0, 0.0
        if abs(rate) > still:
            at.branch[a] = 1 if rate > 0.0 else -1
            at.gap_rate[j], at.gap[j] = rate, np.inf
        elif not at.resting[j]:
            at.opening[j] = -difference(at.u, at.ends[a, 0], at.ends[a, 1])


@kernel
def _forces(members: Ints, touching: Touching, sliders: Ints, at: Instant) -> tuple[Floats, bool]:
    """Forces of these contacts (N), from -F to F those of sliders, and whether there are any.

    They are the least of Gauss's function. Where ground and supports hold several, who carries is
    told by the way in which these are about to part.
    """
    own = at.gap.size - sliders.size
    low, high = np.zeros(members.size), np.full(members.size, np.inf)
    start = np.zeros(members.size)
    for i in range(members.size):
        if members[i] >= own:
            link = sliders[members[i] - own]
            high[i] = at.law.memory[link, STRENGTH]
            low[i] = -high[i]
            # What slips along its branch is pulled by that force.
            start[i] = low[i] * at.branch[link]
    rows = rows_of(at.left[members], at.right[members], at.mass.size, at.weights)
    acceleration, noise = _accelerations(touching, rows.shape[1])
    mass = at.mass[: noise.size]
    return least_in_box(BoxJoints(rows, mass, acceleration, noise, low, high, start))


@kernel
def _accelerations(touching: Touching, bodies: int) -> tuple[Floats, Floats]:
    """Accelerations of the bodies without contacts (m/s²), (i, bodies), and their rounding.

    Behind the first row stand the Taylor coefficients of those of supports, where not all vanish:
    they may be less than the rounding of a sum, and still tell who gives way.
    """
    supports = supports_of(touching.at.mass).size
    found, noise = free_accelerations(ORDER if supports > 0 else 1, touching)
    rows, count = np.zeros((1 + found.shape[0], bodies)), 1
    rows[0] = found[0, :bodies]
    for k in range(found.shape[0]):
        moves = False
        for b in range(supports):
            rows[count, b] = unless_rounding(found[k, b], noise[k, b])
            moves |= rows[count, b] != 0.0
        if k == 0:
            rows[0, :supports] = rows[count, :supports]
        count += moves
    return rows[:count], noise[0, :bodies]


@kernel
def _take_sides(members: Ints, force: Floats, noise: float, sliders: Ints, at: Instant) -> Bools:
    """Put sliders on the sides of their forces (N); contacts (K,) that something presses."""
    own = at.gap.size - sliders.size
    pressed = np.zeros(at.gap.size, np.bool_)
    for i in range(members.size):
        j = members[i]
        if j < own:
            pressed[j] = force[i] > noise and not at.released[j]
            continue
        link = sliders[j - own]
        bound = at.law.memory[link, STRENGTH]
        # One that has just come to its bound may stick on where others take over its share.
        pressed[j] = bound - abs(force[i]) > (TAKEN_OVER * bound if at.released[j] else noise)
        if not pressed[j]:
            at.branch[link] = int(-np.sign(force[i]))
    return pressed


@kernel
def _directed(sliders: Ints, at: Instant) -> ContactEnds:
    """What the contacts are between, those of sliders in the directions of their slips."""
    left, right, opening = at.left.copy(), at.right.copy(), at.opening.copy()
    for i in range(sliders.size):
        j = at.gap.size - sliders.size + i
        if at.branch[sliders[i]] < 0:
            left[j], right[j], opening[j] = at.right[j], at.left[j], -at.opening[j]
    return ContactEnds(left, right, opening, at.mass, at.weights, left.size)
