"""What an instant demands of a scene with sliders, whose friction is set-valued.

With f the friction of a slider, F its bound and x' the rate of its elongation

    x' > 0: f = F,    x' < 0: f = -F,    x' = 0: |f| <= F, and x'' = 0 where |f| < F

A slider that slips in a direction σ is a link with the constant force σ F, until x' vanishes. One
that sticks rests as a contact does, from its first end to its second, whose force λ is what
friction lacks: ``f = σ F - λ``, ``0 <= σ λ <= 2 F``. So long as σ λ stays below 2 F the
acceleration problem is that of contacts (`eventpound.contact.rest`), and decides as theirs what
an order of the motion leaves open, and who carries where forces are not unique. Where a σ λ is
larger, that slider is taken on its other side, and all is solved again: the problem is a minimum
over box-shaped bounds of which each side leaves out one a slider, and each turn raises it, so none
comes back.

Friction is bounded and has no impulse: in impacts the gap of every slider counts as infinite, and a
slider sticks on where they leave it no rate. An instant is run by Python, some milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice, product

import numpy as np

from eventpound.contact.cascade import STALE
from eventpound.contact.impacts import DONE, put_as_one
from eventpound.contact.instant import any_may_rest, settle_impacts, take_rests, touching_of
from eventpound.contact.kinks import still_rate
from eventpound.contact.rest import Touching, rest_contacts
from eventpound.mechanics.clusters import form_clusters
from eventpound.mechanics.link_law import STRENGTH
from eventpound.mechanics.model import Model
from eventpound.motion.forcing import CurrentPiece
from eventpound.numerics.arrays import Bools, Ints
from eventpound.numerics.compiled import in_python
from eventpound.solvers.base import LawRecording, Recording
from eventpound.solvers.events.instant import settle_in_python
from eventpound.solvers.events.present import forcing_now, make_ready
from eventpound.solvers.events.underway import Underway

MOST_SIDES = 1000
"""Choices of sides after which an instant has no solution."""


def settle_sliders(now: Underway, piece: CurrentPiece) -> int:
    """Impacts of the present instant, and who rests and sticks after them; ends as `proceed` does.

    Parameters
    ----------
    now : Underway
        The run.
    piece : CurrentPiece
        The ground motion.
    """
    return settle_in_python(now.run, partial(_impacts, now), partial(_rests, now, piece))


def _impacts(now: Underway) -> int:
    _end_sticks_and_slips(now)
    at = now.run.instant
    at.gap[now.model.own_contacts :] = np.inf
    return int(in_python(settle_impacts)(at))


def _rests(now: Underway, piece: CurrentPiece) -> int:
    _offer(now)
    ended = _decide(now, piece)
    if ended == DONE:
        run = now.run
        run.state.count[STALE] |= bool((run.instant.branch != now.mode.branch).any())
    return ended


def _end_sticks_and_slips(now: Underway) -> None:
    """Put sliders that let go on the side on which they do, and stop those whose slip has ended."""
    run, at, model = now.run, now.run.instant, now.model
    own, links = model.own_contacts, model.sliders
    # The last look is at the event.
    force = run.looks[2].contact_force[0, own:] * at.branch[links]
    turned = links[at.released[own:] & (force > model.law.memory[links, STRENGTH])]
    at.branch[turned] *= -1
    stopped = run.happened.kinked[links]
    if stopped.any():
        tied = at.resting.copy()
        tied[own:] |= stopped
        none = np.zeros_like(tied)
        clusters = in_python(form_clusters)(at.left, at.right, at.opening, tied, none, at.mass.size)
        in_python(put_as_one)(clusters.of_body, np.zeros(at.mass.size), at.mass, at.v)


def _offer(now: Underway) -> None:
    """Let sliders that stand still take part in the acceleration problem, others slip."""
    at, model = now.run.instant, now.model
    own, links = model.own_contacts, model.sliders
    x, rate = (model.elongations(values)[links] for values in (at.u, at.v))
    moving = np.abs(rate) > still_rate(at.length, at.time)
    at.branch[links[moving]] = np.sign(rate[moving])
    at.gap_rate[own:] = np.where(moving, rate, 0.0)
    at.gap[own:] = np.where(moving, np.inf, 0.0)
    begins = ~moving & ~at.resting[own:]
    at.opening[own:][begins] = -x[begins]


def _decide(now: Underway, piece: CurrentPiece) -> int:
    """The acceleration problem, on the sides of sliders on which it holds; ends as `take_rests`."""
    at, model = now.run.instant, now.model
    own, links = model.own_contacts, model.sliders
    offered = links[at.gap[own:] == 0.0]
    if not in_python(any_may_rest)(at):
        # A cascade of impacts between what slips needs no more.
        return DONE
    others, tried = _all_sides(offered.size), set[bytes]()
    while True:
        tried.add(at.branch.tobytes())
        touching = in_python(touching_of)(now.state.z, forcing_now(piece, now.t), at)
        resting, pressed, solved = in_python(rest_contacts)(_on_sides(touching, at.branch, model))
        turned = _overloaded(resting, pressed, now, piece) if solved else offered[:0]
        if solved and turned.size == 0:
            break
        at.branch[turned] *= -1
        while at.branch.tobytes() in tried:
            sides = next(others, None)
            if sides is None:
                return int(in_python(take_rests)(resting, pressed, False, at))
            at.branch[offered] = sides
    ended = in_python(take_rests)(resting, pressed, True, at)
    at.gap[own:][~at.resting[own:]] = np.inf
    return int(ended)


def _all_sides(sliders: int) -> Iterator[tuple[int, ...]]:
    """Choices of sides of so many sliders, no more than can be waited for."""
    return islice(product((1, -1), repeat=sliders), MOST_SIDES)


def _on_sides(touching: Touching, branch: Ints, model: Model) -> Touching:
    """The acceleration problem with the contacts of sliders in the directions of their slips."""
    left, right, gap = touching.left.copy(), touching.right.copy(), touching.gap.copy()
    back = model.own_contacts + np.flatnonzero(branch[model.sliders] < 0)
    left[back], right[back], gap[back] = right[back], left[back], -gap[back]
    return touching._replace(left=left, right=right, gap=gap)


def _overloaded(resting: Bools, pressed: Bools, now: Underway, piece: CurrentPiece) -> Ints:
    """Links of sliders that cannot hold what sticks, with these contacts (K,) at rest."""
    run, at, model = now.run, now.run.instant, now.model
    own, links = model.own_contacts, model.sliders
    mode = now.table.mode(resting, at.branch, pressed, at.opening)
    now.take_closing_speeds(mode)
    in_python(make_ready)(run, mode.dynamics, piece)
    force = run.looks[0].contact_force[0, own:] * at.branch[links]
    most = 2.0 * model.law.memory[links, STRENGTH] + now.table.force_noise
    return np.asarray(links[mode.watched.unlocked[own:] & (force > most)])


def own_recording(recording: Recording, model: Model) -> Recording:
    """A recording without the contacts that stand for sliders, and with every z at its end."""
    own = model.own_contacts
    h, laws, z = recording.history, recording.laws, recording.z.copy()
    of_sliders = model.z_of_link[model.sliders]
    if h.t.size > 0:
        z[of_sliders] = h.z[-1, of_sliders]
    if laws is not None:
        laws = LawRecording(laws.smallest_force[:own], laws.longest_contact[:own])
    assert recording.largest_gap is not None
    return replace(
        recording,
        z=z,
        history=replace(h, gap=h.gap[:, :own], contact_force=h.contact_force[:, :own]),
        events=tuple(event for event in recording.events if event.contact < own),
        smallest_gap=recording.smallest_gap[:own],
        largest_gap=recording.largest_gap[:own],
        resting_time=recording.resting_time[:own],
        max_force=recording.max_force[:own],
        unique_forces=recording.unique_forces[:own],
        laws=laws,
    )
