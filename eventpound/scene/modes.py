"""Modes of a structure: periods, participation and damping, before its springs yield and after.

    K phi = omega^2 M phi,    T = 2 pi/omega
    share of the mass   (phi' M 1)^2 / (phi' M phi  1' M 1)
    damping ratio       phi' C phi / (2 omega phi' M phi)

The shares of all modes of a structure that the ground holds add up to one. C need not be
proportional: what the modes exchange through it is left out. Source: A. K. Chopra, Dynamics
of Structures, sections 10.2, 11.4 and 13.2. Springs count as in `eventpound.scene.periods`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.periods import RIGID, joined, nominal_stiffness
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND


@dataclass(frozen=True, slots=True)
class Modes:
    """Modes of one structure, the longest period first; n of them, N bodies.

    Parameters
    ----------
    bodies : tuple of str
        Names of its bodies.
    period : ndarray, shape (n,)
        T (s), infinite where nothing resists.
    share : ndarray, shape (n,)
        Part of the mass that takes part.
    damping : ndarray, shape (n,)
        Ratio of critical damping, NaN where the period is infinite.
    shape : ndarray, shape (N, n)
        Displacements of the bodies, the largest of a mode is 1.
    """

    bodies: tuple[str, ...]
    period: Floats
    share: Floats
    damping: Floats
    shape: Floats


def modes_of(scene: Scene, bodies: Sequence[str], yielded: bool = False) -> Modes:
    """Modes of some bodies of a scene; what joins them to others is left out.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    bodies : sequence of str
        Names, as `eventpound.scene.structures` gives them.
    yielded : bool
        Whether hysteretic springs have their post-yield stiffness.

    Raises
    ------
    InputError
        Where a stiffness over a mass is no double.
    """
    mass = np.array([b.mass for name in bodies for b in scene.bodies if b.name == name])
    ends = {GROUND, *bodies}
    springs = [s for s in scene.springs if ends.issuperset(s.between)]
    dashpots = [d for d in scene.dashpots if ends.issuperset(d.between)]
    stiffness = joined(bodies, [(s.between, nominal_stiffness(s, yielded)) for s in springs])
    damping = joined(bodies, [(d.between, d.coefficient) for d in dashpots])
    root = np.sqrt(mass)
    with np.errstate(all="ignore"):
        matrix = stiffness / np.outer(root, root)
    if not np.isfinite(matrix).all():
        raise InputError("stiffness over mass is too large to be computed with")
    squares, vectors = np.linalg.eigh(matrix)
    # Rounding leaves some of a rigid motion; its square is zero.
    squares = np.where(squares > RIGID * squares[-1], squares, 0.0)
    shape = vectors / root[:, None]
    omega = np.sqrt(squares)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.einsum("ij,ik,kj->j", shape, damping, shape) / (2.0 * omega)
    largest = shape[np.argmax(np.abs(shape), axis=0), np.arange(mass.size)]
    with np.errstate(divide="ignore"):
        period = 2.0 * np.pi / omega
    return Modes(
        tuple(bodies),
        period,
        (mass @ shape) ** 2 / mass.sum(),
        np.where(omega > 0.0, ratio, np.nan),
        shape / largest,
    )
