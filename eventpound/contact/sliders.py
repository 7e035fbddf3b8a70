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
have a sign: slower impacts are plastic. An instant is run by Python, some milliseconds.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.impacts import DONE, put_as_one
from eventpound.contact.instant import any_may_rest, settle_impacts, take_rests, touching_of
from eventpound.contact.kinks import still_rate
from eventpound.contact.rest import (
    ORDER,
    Touching,
    accelerations,
    noise_of,
    rest_contacts,
    round_as_the_scene,
    system_of,
)
from eventpound.contact.state import Instant
from eventpound.mechanics.clusters import Clusters, form_clusters, form_clusters_of_few
from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.link_law import STRENGTH
from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.box import least_in_box, without_rounding
from eventpound.numerics.compiled import in_python
from eventpound.tolerances import LCP_ROUNDING, TAKEN_OVER


def settle_beside_sliders(force: Floats, kinked: Bools, at: Instant, model: Model) -> int:
    """Impacts of an instant of a scene with sliders; ends as `settle_impacts`.

    Parameters
    ----------
    force : ndarray, shape (K,)
        Forces of the contacts as the instant begins (N).
    kinked : ndarray of bool, shape (L,)
        Links whose branch has just ended: sliders whose slip has.
    at : Instant
        The instant.
    model : Model
        The scene, its sliders with contacts of their own.
    """
    _end_sticks_and_slips(force, kinked, at, model)
    at.gap[model.own_contacts :] = np.inf
    return int(in_python(settle_impacts)(at))


def decide_sticks(z: Floats, forcing: Forcing, noise: float, at: Instant, model: Model) -> int:
    """Who sticks and who rests after the impacts of an instant; ends as `take_rests`.

    Parameters
    ----------
    z : ndarray, shape (H,)
        Hysteretic variables.
    forcing : Forcing
        The ground motion from now on.
    noise : float
        Contact forces below this (N) have no meaningful sign.
    at : Instant
        The instant, its impacts over.
    model : Model
        The scene, its sliders with contacts of their own.
    """
    _offer(at, model)
    # Branches of sliders are decided here.
    at.now[0].stale = True
    if not in_python(any_may_rest)(at):
        # A cascade of impacts between what slips needs no more.
        return DONE
    own = model.own_contacts
    touching = in_python(touching_of)(z, forcing, at)
    members = np.flatnonzero(touching.undecided)
    force = _forces(members, touching, at, model)
    if force is None:
        return int(in_python(take_rests)(touching.undecided, at.pressed, False, at))
    pressed = _take_sides(members, force, noise, at, model)
    # Who rests beside what is known to be pressed.
    touching = in_python(touching_of)(z, forcing, at)
    touching = touching._replace(undecided=touching.undecided & ~pressed, pressed=pressed)
    found = in_python(rest_contacts)(_on_sides(touching, at.branch, model))
    ended = in_python(take_rests)(*found, at)
    at.gap[own:][~at.resting[own:]] = np.inf
    return int(ended)


def _end_sticks_and_slips(force: Floats, kinked: Bools, at: Instant, model: Model) -> None:
    """Put sliders that let go on the side on which they do, and stop those whose slip has ended."""
    own, links = model.own_contacts, model.sliders
    lacking = force[own:] * at.branch[links]
    turned = links[at.released[own:] & (lacking > model.law.memory[links, STRENGTH])]
    at.branch[turned] *= -1
    stopped = kinked[links]
    if stopped.any():
        held = at.resting.copy()
        held[own:] |= stopped
        # What a support carries goes on with it where a slip beside it ends.
        clusters = in_python(form_clusters)(
            at.left, at.right, at.opening, held, at.resting, at.mass
        )
        in_python(put_as_one)(clusters.of_body, np.zeros(at.mass.size), at.mass, at.v)


def _offer(at: Instant, model: Model) -> None:
    """Let sliders that stand still take part in the acceleration problem, others slip."""
    own, links = model.own_contacts, model.sliders
    x, rate = (model.elongations(values)[links] for values in (at.u, at.v))
    moving = np.abs(rate) > still_rate(at.length, at.time)
    at.branch[links[moving]] = np.sign(rate[moving])
    at.gap_rate[own:] = np.where(moving, rate, 0.0)
    at.gap[own:] = np.where(moving, np.inf, 0.0)
    begins = ~moving & ~at.resting[own:]
    at.opening[own:][begins] = -x[begins]


def _forces(members: Ints, touching: Touching, at: Instant, model: Model) -> Floats | None:
    """Forces of these contacts (N), from -F to F those of sliders; None where there are none.

    They are the least of Gauss's function. Where ground and supports hold several, who carries is
    told by the way in which these are about to part.
    """
    W = contact_rows(model)[members]
    low, high = np.zeros(members.size), np.full(members.size, np.inf)
    (a, noise, given), start = _accelerations(touching, model.supports), low.copy()
    of_sliders = members >= model.own_contacts
    links = model.sliders[members[of_sliders] - model.own_contacts]
    high[of_sliders] = model.law.memory[links, STRENGTH]
    low[of_sliders] = -high[of_sliders]
    start[of_sliders] = low[of_sliders] * np.sign(at.branch[links])
    # What slips along its branch has been pulled by that force.
    a -= W.T @ start / model.mass
    noise += LCP_ROUNDING * (np.abs(W.T) @ np.abs(start)) / model.mass
    first = without_rounding(W @ a, np.abs(W) @ noise)
    # Those of supports may be less than the rounding of a sum, and still tell who gives way.
    q = np.column_stack((first, W[:, : model.supports] @ given.T))
    return least_in_box(W / model.mass @ W.T, q, low, high, start)


def _accelerations(touching: Touching, supports: int) -> tuple[Floats, Floats, Floats]:
    """Accelerations of the bodies (N,) without contacts (m/s²), and their rounding.

    And the Taylor coefficients of those of supports, without rounding, where not all vanish.
    """
    mass, none = touching.mass, np.zeros_like(touching.undecided)
    clusters = form_clusters_of_few(touching.left, touching.right, touching.gap, none, none, mass)
    system, y = in_python(system_of)(touching, clusters)
    found = in_python(accelerations)(y, system, ORDER if supports else 1, touching)
    rough = in_python(round_as_the_scene)(system, touching.forcing)
    noise = in_python(noise_of)(found, np.zeros(mass.size), rough, y, system, touching)
    found[:, :supports] = given = without_rounding(found[:, :supports], noise[:, :supports])
    return found[0], noise[0], given[given.any(axis=1)]


def _take_sides(members: Ints, force: Floats, noise: float, at: Instant, model: Model) -> Bools:
    """Put sliders on the sides of their forces (N); contacts (K,) that something presses."""
    own = model.own_contacts
    pressed = np.zeros(model.contacts, np.bool_)
    for j, value in zip(members, force, strict=True):
        if j < own:
            pressed[j] = value > noise and not at.released[j]
            continue
        link = model.sliders[j - own]
        bound = model.law.memory[link, STRENGTH]
        # One that has just come to its bound may stick on where others take over its share.
        pressed[j] = bound - abs(value) > (TAKEN_OVER * bound if at.released[j] else noise)
        if not pressed[j]:
            at.branch[link] = -np.sign(value)
    return pressed


def _on_sides(touching: Touching, branch: Ints, model: Model) -> Touching:
    """The acceleration problem with the contacts of sliders in the directions of their slips."""
    left, right, gap = touching.left.copy(), touching.right.copy(), touching.gap.copy()
    back = model.own_contacts + np.flatnonzero(branch[model.sliders] < 0)
    left[back], right[back], gap[back] = right[back], left[back], -gap[back]
    return touching._replace(left=left, right=right, gap=gap)


def locked_beside_sliders(model: Model, resting: Bools, clusters: Clusters) -> Bools:
    """Resting contacts (R,) that cannot open: a slider gives way in either direction."""
    own = resting.copy()
    own[model.own_contacts :] = False
    alone = form_clusters_of_few(model.left, model.right, model.gap, own, own, model.mass)
    locked = np.zeros(model.contacts, np.bool_)
    locked[alone.resting] = alone.locked
    return locked[clusters.resting]
