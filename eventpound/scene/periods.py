"""Periods of a scene at rest without damping and contacts, before its springs yield and after.

Springs count as `eventpound.scene.at_rest` says; those that have yielded with their post-yield
stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.at_rest import at_rest, stiffness_of
from eventpound.scene.ends import Direction
from eventpound.scene.grounded import ends_on_ground, grounded
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Spring
from eventpound.scene.structures import joined_groups

# Squared frequencies this far below the largest are rigid motions: rounding
# leaves some N eps of the largest, and a structure spans far fewer decades.
RIGID = 1.0e-12
T_1 = "T1"
"""What a case calls the longest initial period of its scene."""


def longest_period(scene: Scene, yielded: bool = False) -> float | None:
    """Longest period of a scene without damping and contacts, T_1.

    Parameters
    ----------
    scene : Scene
        Without problems.
    yielded : bool
        Whether hysteretic springs have their post-yield stiffness.

    Returns
    -------
    float or None
        T_1 (s); None where no spring resists anything.

    Raises
    ------
    InputError
        Where a stiffness over a mass is no double.
    """
    if not scene.bodies:
        return None
    scene = grounded(at_rest(scene))
    root_mass = np.sqrt([body.mass for body in scene.bodies])
    names = [body.name for body in scene.bodies]
    squares = np.linalg.eigvalsh(over_mass(names, scene.springs, root_mass, yielded))
    elastic = squares[squares > RIGID * squares[-1]]
    return 2.0 * math.pi / math.sqrt(elastic[0]) if elastic.size else None


def over_mass(
    bodies: Sequence[str], springs: Iterable[Spring], root_mass: Floats, yielded: bool
) -> Floats:
    """Stiffnesses at rest over roots of masses, whose eigenvalues are omega^2, shape (N, N)."""
    stiffness = joined(bodies, [(s.direction, stiffness_of(s, yielded)) for s in springs])
    with np.errstate(all="ignore"):
        matrix = stiffness / np.outer(root_mass, root_mass)
    if not np.isfinite(matrix).all():
        raise InputError("stiffness over mass is too large to be computed with")
    return np.asarray(matrix)


def period_called(scene: Scene, word: str) -> float:
    """Initial period that a case names, ``"T1"`` or ``"T1 of BODY"``.

    That of the whole scene is its longest. Of a body it is the longest of all that swings with
    it: bodies that springs join to it which resist at rest, but for springs between two that the
    ground holds by others, as segments of a bridge; the far ends of these are kept still.

    Parameters
    ----------
    scene : Scene
        Without problems.
    word : str
        As a case has it.

    Returns
    -------
    float
        In s.

    Raises
    ------
    InputError
        Where there is no such body, or no spring resists.
    """
    scene = grounded(at_rest(scene))
    names = [body.name for body in scene.bodies]
    group = set(names)
    if word != T_1:
        name = word.removeprefix(f"{T_1} of ")
        if name not in names:
            raise InputError(f"found {word!r}; accepted: {T_1}, or {T_1} of {', '.join(names)}")
        resisting = [s.ends for s in scene.springs if stiffness_of(s) != 0.0]
        held = {end for between in resisting if GROUND in between for end in between}
        joints = [between for between in resisting if not held.issuperset(between)]
        group = next(set(each) for each in joined_groups(names, joints) if name in each)
    others = set(names) - group
    springs = [
        replace(s, between=ends_on_ground(s.between, others))
        for s in scene.springs
        if group.intersection(s.ends)
    ]
    bodies = tuple(body for body in scene.bodies if body.name in group)
    period = longest_period(Scene(bodies, tuple(springs)))
    if period is None:
        raise InputError(f"found {word!r}, but no spring resists; accepted: a period (s)")
    return period


def joined(bodies: Sequence[str], links: Iterable[tuple[Direction, float]]) -> Floats:
    """Stiffness or damping matrix of bodies, shape (N, N).

    Parameters
    ----------
    bodies : sequence of str
        Their names.
    links : iterable
        Direction of each link, in bodies and the ground, and its stiffness or coefficient.
    """
    index = {name: i for i, name in enumerate(bodies)}
    matrix = np.zeros((len(index), len(index)))
    for direction, k in links:
        ends = [(index[end], weight) for end, weight in direction if end != GROUND]
        for i, weight_i in ends:
            for j, weight_j in ends:
                matrix[i, j] += weight_i * weight_j * k
    return matrix


def period_of(mass: float, stiffness: float) -> float:
    """Period (s) of a mass (kg) on a spring (N/m); infinite where it is not held."""
    return 2.0 * math.pi * math.sqrt(mass / stiffness) if stiffness > 0.0 else math.inf


def local_periods(scene: Scene) -> dict[str, float]:
    """Period (s) of each body of a scene at rest while all others are held."""
    scene = grounded(at_rest(scene))
    held = dict.fromkeys((body.name for body in scene.bodies), 0.0)
    for spring in scene.springs:
        for end, weight in spring.direction:
            if end != GROUND:
                held[end] += weight**2 * stiffness_of(spring)
    return {body.name: period_of(body.mass, held[body.name]) for body in scene.bodies}
