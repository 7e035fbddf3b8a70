"""Modal damping: a ratio of critical damping for each mode of a structure, as dashpots.

    C = sum_n 2 xi_n omega_n / M_n  (M phi_n)(M phi_n)',    M_n = phi_n' M phi_n

so that phi_n' C phi_n = 2 xi_n omega_n M_n, and modes exchange nothing through C. Source: A. K.
Chopra, Dynamics of Structures, section 11.4; of structures that yield, with C of their initial
stiffness: A. K. Chopra and F. McKenna, Modeling viscous damping in nonlinear response history
analysis of buildings for earthquake excitation, Earthquake Engng Struct. Dyn. 45 (2016) 193-211.

Any symmetric C is that of dashpots: -C_ij between bodies i and j, and sum_j C_ij between i and the
base. With one ratio for all modes C = 2 xi M (M^-1 K)^(1/2), and none of them is negative where no
stiffness is: K then has no positive entry off its diagonal, K 1 is not negative, and both hold of
the root, too (M-matrices). Unlike ratios, or a frame, may ask for some that are negative; together
they dissipate.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from eventpound.basics.given import checked, number
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.at_rest import at_rest, stiffness_of
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.modes import modes_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Spring
from eventpound.scene.structures import joined_groups
from eventpound.tolerances import EPS
from eventpound.units import Dimension

MOST_BODIES = 100
"""Of a group: it gets a dashpot between every two of them."""


@checked
def modal_damping(
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    ratio: float | str | Sequence[float | str],
    *,
    base: str = GROUND,
) -> tuple[Dashpot, ...]:
    """Dashpots that give every mode of a group of bodies its damping ratio.

    Parameters
    ----------
    bodies : sequence of Body
        The group: one structure, at most 100 bodies.
    springs : sequence of Spring
        Springs of the scene; those inside the group, to its base and to the ground count, as at
        rest without forces.
    ratio : float, or sequence of float
        Of critical damping, 0.05 or ``"5 %"``; of several the first is of the longest period, and
        the last also of all modes that follow.
    base : str
        What the group stands on: ``"ground"``, a support, or a body such as the slab on
        isolators, which is at rest in these modes.

    Returns
    -------
    tuple of Dashpot
        For `Scene`. Where ratios differ, some may be negative.

    Raises
    ------
    InputError
        Where a ratio is negative, ratios are more than modes, or springs do not join the group.

    Examples
    --------
    >>> deck = Body("deck", "1000 t")
    >>> piers = Spring("piers", ("ground", "deck"), Linear("100 MN/m"))
    >>> (dashpot,) = modal_damping([deck], [piers], "5 %")
    >>> round(dashpot.coefficient)
    1000000
    """
    given = [ratio] if isinstance(ratio, float | int | str) else ratio
    ratios = [number("ratio", each, Dimension.NUMBER) for each in given]
    if not (0 < len(ratios) <= len(bodies) and min(ratios) >= 0.0):
        raise InputError(
            f"ratio: found {ratio!r}; accepted: one that is not negative, or a list of at most "
            f"{len(bodies)}, one a mode"
        )
    return modal_dashpots(
        bodies, at_rest(Scene(tuple(bodies), tuple(springs))).springs, ratios, base
    )


def modal_dashpots(
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    ratios: Sequence[float],
    base: str,
    supports: Collection[str] = (),
) -> tuple[Dashpot, ...]:
    """Dashpots of `modal_damping` for springs of a scene at rest; `supports` count as the ground.

    Raises
    ------
    InputError
        Where springs do not join the group, or it is too large.
    """
    names, fixed = [body.name for body in bodies], {GROUND, base, *supports}
    own = [
        replace(spring, between=ends_on_ground(spring.between, fixed))
        for spring in springs_on(names, springs, fixed)
        if stiffness_of(spring) != 0.0
    ]
    if len(names) > MOST_BODIES or len(joined_groups(names, [s.ends for s in own])) != 1:
        raise InputError(
            f"bodies: found {len(names)}; accepted: up to {MOST_BODIES}, which springs that "
            "resist at rest join to one structure"
        )
    C = _matrix(bodies, own, [*ratios, *[ratios[-1]] * (len(names) - len(ratios))])
    found = [((base, name), c) for name, c in zip(names, C.sum(axis=1).tolist(), strict=True)]
    found += [
        ((names[i], names[j]), -float(C[i, j])) for i, j in combinations(range(len(names)), 2)
    ]
    rounding = len(names) * EPS * float(C.max())
    return tuple(Dashpot(ends, c) for ends, c in found if abs(c) > rounding)


def springs_on(
    names: Collection[str], springs: Iterable[Spring], fixed: Collection[str]
) -> list[Spring]:
    """Springs inside a group and to what it stands on."""
    group, all_ends = set(names), {*names, *fixed}
    return [s for s in springs if group.intersection(s.ends) and all_ends.issuperset(s.ends)]


def _matrix(bodies: Sequence[Body], springs: Sequence[Spring], ratios: Sequence[float]) -> Floats:
    """C (N s/m), shape (N, N)."""
    modes = modes_of(Scene(tuple(bodies), tuple(springs)), [body.name for body in bodies])
    mass = np.array([body.mass for body in bodies])
    pushed = mass[:, None] * modes.shape
    modal_mass = np.sum(pushed * modes.shape, axis=0)
    weight = 4.0 * math.pi * np.array(ratios) / (modes.period * modal_mass)
    return np.asarray((pushed * weight) @ pushed.T)
