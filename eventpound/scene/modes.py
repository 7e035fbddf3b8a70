"""Modes of a structure: periods, participation and damping, before its springs yield and after.

    K phi = omega^2 M phi,    T = 2 pi/omega
    share of the mass   (phi' M 1)^2 / (phi' M phi  1' M 1)
    damping ratio       phi' C phi / (2 omega phi' M phi)

The shares of all modes of a structure that the ground holds add up to one. C need not be
proportional: what the modes exchange through it is left out. Source: A. K. Chopra, Dynamics
of Structures, sections 10.2, 11.4 and 13.2. Springs count as in `eventpound.scene.at_rest`.

What stands on isolators is damped by dashpots beside its own springs, C = b K_own, with b from
the first mode of the isolated structure in which they work: the second. Dashpots to the ground
(Rayleigh damping) damp the isolated mode, too, which no storey does. Source: K. L. Ryan and
J. Polanco, Problems with Rayleigh damping in base-isolated buildings, J. Struct. Eng. 134(11),
2008, 1780-1784; on the mode: H. Anajafi, R. A. Medina and E. Santini-Bell, Effects of the
improper modeling of viscous damping on the first-mode and higher-mode dominated responses of
base-isolated buildings, Earthquake Engng Struct. Dyn. 49(1), 2020, 51-73.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from eventpound.basics.given import checked, number
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.at_rest import at_rest, stiffness_of
from eventpound.scene.body import Body
from eventpound.scene.damping import dashpots_beside, rayleigh_coefficients, rayleigh_dashpots
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.grounded import grounded
from eventpound.scene.periods import RIGID, joined, over_mass
from eventpound.scene.plan_point import ACROSS, ALONG
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Linear, Spring
from eventpound.scene.structures import joined_groups
from eventpound.units import Dimension


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
        Part of the mass that takes part in a motion along the line.
    damping : ndarray, shape (n,)
        Ratio of critical damping, NaN where the period is infinite.
    shape : ndarray, shape (N, n)
        Displacements of the bodies, the largest of a mode is 1.
    share_across : ndarray, shape (n,), optional
        Part of the mass that takes part in a motion across; of a structure in plan.
    """

    bodies: tuple[str, ...]
    period: Floats
    share: Floats
    damping: Floats
    shape: Floats
    share_across: Floats | None = None


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
    scene = grounded(at_rest(scene))
    own = [b for name in bodies for b in scene.bodies if b.name == name]
    mass = np.array([b.mass for b in own])
    ends = {GROUND, *bodies}
    springs = [s for s in scene.springs if ends.issuperset(s.ends)]
    dashpots = [d for d in scene.dashpots if ends.issuperset(d.ends)]
    damping = joined(bodies, [(d.direction, d.coefficient) for d in dashpots])
    root = np.sqrt(mass)
    squares, vectors = np.linalg.eigh(over_mass(bodies, springs, root, yielded))
    # Rounding leaves some of a rigid motion; its square is zero.
    squares = np.where(squares > RIGID * squares[-1], squares, 0.0)
    shape = vectors / root[:, None]
    omega = np.sqrt(squares)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.einsum("ij,ik,kj->j", shape, damping, shape) / (2.0 * omega)
    largest = shape[np.argmax(np.abs(shape), axis=0), np.arange(mass.size)]
    with np.errstate(divide="ignore"):
        period = 2.0 * np.pi / omega
    # Relative to the largest, because the sum of masses may be no double.
    relative = mass / mass.max()

    def taking_part(direction: str) -> Floats:
        moved = relative * np.array([b.direction == direction for b in own])
        share = (moved @ (shape * root.max())) ** 2 / (moved.sum() or 1.0)
        # What rounding leaves of a mode in which the masses balance is nothing, too.
        return np.where(share > RIGID, share, 0.0)

    return Modes(
        tuple(bodies),
        period,
        taking_part(ALONG),
        np.where(omega > 0.0, ratio, np.nan),
        shape / largest,
        taking_part(ACROSS) if any(b.direction != ALONG for b in own) else None,
    )


@checked
def rayleigh(
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    ratio: float | str,
    *,
    modes: tuple[int, int] | None = None,
    periods: tuple[float | str, float | str] | None = None,
) -> tuple[Dashpot, ...]:
    """Dashpots that give a group of bodies one damping ratio at two periods.

    Parameters
    ----------
    bodies : sequence of Body
        The group.
    springs : sequence of Spring
        Springs of the scene; those inside the group and to the ground count, as at rest without
        forces.
    ratio : float
        Of critical damping, 0.05 or ``"5 %"``.
    modes : tuple of int, optional
        Numbers of two modes of the group at rest, from 1.
    periods : tuple of float, optional
        Two periods (s) instead.

    Returns
    -------
    tuple of Dashpot
        For `Scene`.

    Raises
    ------
    InputError
        Where not exactly one of modes and periods is given, or it is not two of them.

    Examples
    --------
    >>> bodies = [Body("floor", "100 t"), Body("roof", "100 t")]
    >>> storeys = [
    ...     Spring("lower", ("ground", "floor"), Linear("50 MN/m")),
    ...     Spring("upper", ("floor", "roof"), Linear("50 MN/m")),
    ... ]
    >>> [dashpot.between for dashpot in rayleigh(bodies, storeys, "5 %", modes=(1, 2))]
    [('ground', 'floor'), ('ground', 'roof'), ('ground', 'floor'), ('floor', 'roof')]
    """
    if (modes is None) == (periods is None):
        raise InputError("rayleigh: accepted: one of modes and periods")
    springs = at_rest(Scene(tuple(bodies), tuple(springs))).springs
    if periods is not None:
        first, second = (number("periods", period, Dimension.TIME) for period in periods)
    else:
        assert modes is not None
        if not 1 <= min(modes) <= max(modes) <= len(bodies):
            raise InputError(f"modes: found {modes!r}; accepted: numbers from 1 to {len(bodies)}")
        names = [body.name for body in bodies]
        found = modes_of(Scene(tuple(bodies), springs), names).period
        first, second = (float(found[mode - 1]) for mode in modes)
    if not 0.0 < min(first, second) <= max(first, second) < math.inf:
        raise InputError(f"rayleigh: found periods {first:g} s, {second:g} s; accepted: two finite")
    omegas = 2.0 * math.pi / first, 2.0 * math.pi / second
    a, b = rayleigh_coefficients(number("ratio", ratio, Dimension.NUMBER), *omegas)
    return rayleigh_dashpots(bodies, springs, a, b)


LEAST_SHARE = 0.5
"""Of the strain energy of a mode, held by the springs whose damping ratio it has."""


@checked
def stiffness_proportional(
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    damped: Sequence[str],
    ratio: float | str,
    *,
    mode: int | None = None,
    period: float | str | None = None,
) -> tuple[Dashpot, ...]:
    """Dashpots beside some springs, such as the storeys of a building on isolators.

    Parameters
    ----------
    bodies, springs : sequence
        Those of the scene.
    damped : sequence of str
        Names of the springs: each has a dashpot b times its stiffness at rest.
    ratio : float
        Of critical damping, 0.02 or ``"2 %"``.
    mode : int, optional
        Where the ratio holds: a mode of the structure, from 1, with these springs as at rest and
        all others at their post-yield stiffness. On isolators the second.
    period : float, optional
        A period (s) instead: b = ratio period/pi.

    Returns
    -------
    tuple of Dashpot
        For `Scene`.

    Raises
    ------
    InputError
        Where not exactly one of mode and period is given, a spring is not there or does not
        resist at rest, or they hold too little of the mode's strain energy for it to be theirs.

    Examples
    --------
    >>> deck = Body("deck", "1000 t")
    >>> piers = Spring("piers", ("ground", "deck"), Linear("100 MN/m"))
    >>> (beside,) = stiffness_proportional([deck], [piers], ["piers"], "5 %", mode=1)
    >>> round(beside.coefficient)
    1000000
    """
    springs = at_rest(Scene(tuple(bodies), tuple(springs))).springs
    by_name = {spring.name: spring for spring in springs}
    unknown = [name for name in damped if name not in by_name]
    if unknown or not damped:
        found = repr(unknown[0]) if unknown else "none"
        raise InputError(f"damped: found {found}; accepted: some of {', '.join(by_name)}")
    idle = [name for name in damped if stiffness_of(by_name[name]) == 0.0]
    if idle:
        raise InputError(f"damped: found {idle[0]!r}; accepted: springs that resist at rest")
    if (mode is None) == (period is None):
        raise InputError("stiffness_proportional: accepted: one of mode and period")
    xi = number("ratio", ratio, Dimension.NUMBER)
    if period is not None:
        b = xi * number("period", period, Dimension.TIME) / math.pi
    else:
        b = coefficient_at_mode(bodies, springs, damped, xi, mode)
    if not 0.0 <= b < math.inf:
        raise InputError(f"stiffness_proportional: found {b:g} s K; accepted: none negative")
    return dashpots_beside([by_name[name] for name in dict.fromkeys(damped)], b)


def coefficient_at_mode(
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    damped: Sequence[str],
    ratio: float,
    mode: object,
) -> float:
    """Coefficient b (s) of springs that gives a mode its damping ratio.

    Parameters
    ----------
    bodies, springs, damped
        As of `stiffness_proportional`, of a scene at rest.
    ratio : float
        Of critical damping.
    mode : object
        Number of the mode, from 1.

    Raises
    ------
    InputError
        Where there is no such mode, or the springs have too small a part in it.
    """
    chosen = [spring for spring in springs if spring.name in set(damped)]
    ends = {end for spring in chosen for end in spring.ends}
    structures = joined_groups([body.name for body in bodies], [s.ends for s in springs])
    joined_by = [group for group in structures if ends.intersection(group)]
    if len(joined_by) != 1:
        raise InputError(f"found {mode!r} of {len(joined_by)} structures; accepted: springs of one")
    standing = tuple(replace(s, law=Linear(stiffness_of(s))) if s in chosen else s for s in springs)
    scene = Scene(tuple(bodies), standing, dashpots_beside(chosen, 1.0))
    modes = modes_of(scene, joined_by[0], yielded=True)
    # phi' K_own phi/(omega^2 phi' M phi), with the ratio phi' K_own phi/(2 omega phi' M phi).
    share = np.nan_to_num(modes.damping * modes.period / math.pi)
    theirs = [i for i, part in enumerate(share.tolist(), 1) if part > LEAST_SHARE]
    if isinstance(mode, bool) or not isinstance(mode, int) or mode not in theirs:
        accepted = ", ".join(map(str, theirs[:8])) + (", ..." if len(theirs) > 8 else "")
        raise InputError(
            f"found {mode!r}; accepted: a mode in which these springs hold more than half of "
            f"the strain energy: {accepted or 'there is none'}"
        )
    return ratio / float(modes.damping[mode - 1])
