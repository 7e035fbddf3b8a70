"""A scene as the compiled steppers see it, and the state they carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.solvers.events.cascade import COUNT_PLACES
from eventpound.solvers.events.scales import SceneScales

NEWTON_TOLERANCE = 1e-12
"""Part of the scene's speed L/T that the balance of momentum of a step may miss."""
STILL = 1e-9
"""Part of the scene's speed L/T below which a gap rate counts as none."""
STEPS, EVALUATIONS, ROWS = range(COUNT_PLACES, COUNT_PLACES + 3)
"""Places of `State.counters`, behind those of `eventpound.solvers.events.cascade`."""
INPUT, VISCOUS, HYSTERETIC, CONTACT = range(4)
"""Places of `State.work` (J)."""


class Structure(NamedTuple):
    """N bodies, L links (S of them springs), H hysteretic ones, K contacts.

    A link has ``F = k (x - o) + c x' + Q z``, k being `compression` for x < o
    and `extension` above; `z_of_link` is -1 without hysteresis. `theta` is
    that of the time-stepping rule; `bandwidth` the number of sub-diagonals of
    the coupling; `speed` the scene's own (m/s).
    """

    mass: Floats
    ends: Ints
    compression: Floats
    extension: Floats
    offset: Floats
    damping: Floats
    strength: Floats
    yield_displacement: Floats
    exponent: Floats
    beta: Floats
    gamma: Floats
    bound: Floats
    z_of_link: Ints
    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats
    springs: int
    bandwidth: int
    theta: float
    speed: float


class State(NamedTuple):
    """What is known at the end of the last step.

    u, v, f (N,): displacement (m), velocity (m/s), force of the links on each
    body (N). z (H,). link (L,): force of each link without its dashpot (N).
    contact (K,): contact forces (N). work (4,): energies (J). counters (ROWS + 1,).
    """

    u: Floats
    v: Floats
    f: Floats
    z: Floats
    link: Floats
    contact: Floats
    work: Floats
    counters: Ints


class Trial(NamedTuple):
    """The end of the step under way, and room for its equations.

    u, v, f, z, link, contact as in `State`. slope (L,): ∂F/∂x of each link.
    residual, terms (N,): what is missing in the balance of momentum, and the sum of
    the sizes of its terms (N s). increment (N,), band (N, b + 1): Newton's
    equations. pressing (K,): ∂(h θ force)/∂(closing speed) of each contact (N s²/m).
    """

    u: Floats
    v: Floats
    f: Floats
    z: Floats
    link: Floats
    contact: Floats
    slope: Floats
    residual: Floats
    terms: Floats
    increment: Floats
    band: Floats
    pressing: Floats


class Touch(NamedTuple):
    """What each contact is in the middle of, entries (K,).

    closed: it carries a force or an impulse. resting: it does so without moving.
    since (s), approach and before (m/s), impulse (N s), lost (J): of the
    present contact, from its start. longest (s): of all so far.
    """

    closed: Bools
    resting: Bools
    since: Floats
    approach: Floats
    before: Floats
    impulse: Floats
    lost: Floats
    longest: Floats


def structure_of(model: Model, scales: SceneScales, theta: float) -> Structure:
    """Arrays of a scene for the steppers.

    Parameters
    ----------
    model : Model
        The scene.
    scales : SceneScales
        Its scales.
    theta : float
        Of the time-stepping rule.
    """
    law = model.law
    bound = np.ones(model.links)
    bound[model.hysteretic] = scales.z_bound
    pairs = np.concatenate((model.link_ends, np.column_stack((model.left, model.right))))
    pairs = pairs[(pairs >= 0).all(axis=1)]
    return Structure(
        model.mass,
        model.link_ends,
        *model.elastic,
        law.damping,
        law.strength,
        law.yield_displacement,
        law.exponent,
        law.beta,
        law.gamma,
        bound,
        model.z_of_link,
        model.left,
        model.right,
        model.gap,
        model.restitution,
        model.springs,
        int(np.abs(pairs[:, 0] - pairs[:, 1]).max(initial=0)),
        theta,
        scales.speed,
    )


def initial_state(model: Model) -> State:
    """The state at the start, forces not yet computed."""
    return State(
        model.u0.copy(),
        model.v0.copy(),
        np.zeros(model.bodies),
        model.z0.copy(),
        np.zeros(model.links),
        np.zeros(model.contacts),
        np.zeros(4),
        np.zeros(ROWS + 1, np.int64),
    )


def blank_trial(structure: Structure, hysteretic: int) -> Trial:
    """Room for a step."""
    bodies, links, contacts = structure.mass.size, structure.damping.size, structure.gap.size
    return Trial(
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(hysteretic),
        np.zeros(links),
        np.zeros(contacts),
        np.zeros(links),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros(bodies),
        np.zeros((bodies, structure.bandwidth + 1)),
        np.zeros(contacts),
    )


def blank_touch(contacts: int) -> Touch:
    """No contact in the middle of anything."""
    return Touch(
        np.zeros(contacts, np.bool_),
        np.zeros(contacts, np.bool_),
        *(np.zeros(contacts) for _ in range(6)),
    )
