"""A scene as the steppers see it, what they carry from step to step, how they are compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import F, compile_with
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.scene.elastic_laws import ElasticLaws
from eventpound.solvers.events.scales import SceneScales


def step_kernel(function: F) -> F:
    """Compile a part of every step, which makes no arrays, into whoever calls it.

    A call copies the groups of arrays it is given, which costs more than the part.
    """
    return compile_with(function, counted=False, inlined=True)


def step_loop(function: F) -> F:
    """Compile a loop over steps with its parts in it."""
    return compile_with(function, counted=False, recipe=SMALL)


class Structure(NamedTuple):
    """N bodies, L links (S of them springs), H hysteretic ones, K contacts.

    The links pull as `elastic` and `law` have it; `z_of_link`
    is -1 without hysteresis, `bound` (L,) the largest |z| that loading can reach. `theta` is
    that of the time-stepping rule; `bandwidth` the number of sub-diagonals of the coupling;
    `speed` the scene's own (m/s).
    """

    mass: Floats
    ends: Ints
    elastic: ElasticLaws
    law: LinkLaw
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


class FixedStepState(NamedTuple):
    """What is known at one end of a step.

    u, v, f (N,): displacement (m), velocity (m/s), force of the links on each
    body (N). z (H,). link (L,): force of each link without its dashpot (N).
    contact (K,): contact forces (N).
    """

    u: Floats
    v: Floats
    f: Floats
    z: Floats
    link: Floats
    contact: Floats


class Equations(NamedTuple):
    """Room for the equations of a step.

    residual, terms (N,): what is missing in the balance of momentum, and the sum of
    the sizes of its terms (N s). increment (N,), band (N, b + 1): Newton's
    equations. slope (L,): ∂F/∂x of each link. pressing (K,): ∂(h θ force)/∂(closing speed) of
    each contact (N s²/m).
    """

    residual: Floats
    terms: Floats
    increment: Floats
    band: Floats
    slope: Floats
    pressing: Floats


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
    bound = np.ones(model.links)
    bound[model.hysteretic] = scales.z_bound
    pairs = np.concatenate((model.link_ends, np.column_stack((model.left, model.right))))
    pairs = pairs[(pairs >= 0).all(axis=1)]
    return Structure(
        model.mass,
        model.link_ends,
        model.elastic,
        model.law,
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


def initial_instant(model: Model) -> FixedStepState:
    """The start, forces not yet computed."""
    N, L, K, _ = model.counts
    u, v, z = model.u0.copy(), model.v0.copy(), model.z0.copy()
    return FixedStepState(u, v, np.zeros(N), z, np.zeros(L), np.zeros(K))


def blank_equations(model: Model, bandwidth: int) -> Equations:
    """Room for a step."""
    N, L, K, _ = model.counts
    residual, terms, increment = np.zeros((3, N))
    band = np.zeros((N, bandwidth + 1))
    return Equations(residual, terms, increment, band, np.zeros(L), np.zeros(K))
