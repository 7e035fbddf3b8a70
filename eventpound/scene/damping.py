"""Dashpots from damping ratios.

    one dashpot        c = 2 xi sqrt(k m) = 2 xi m omega
    Rayleigh damping   C = a M + b K, so that xi = a / (2 omega) + b omega / 2;
                       the same xi at omega_1 and omega_2 needs
                       a = 2 xi omega_1 omega_2 / (omega_1 + omega_2)
                       b = 2 xi / (omega_1 + omega_2)

c coefficient (N s/m), xi ratio of critical damping, k stiffness (N/m), m mass
(kg), omega angular frequencies (rad/s), a in 1/s and b in s. Source: A. K.
Chopra, Dynamics of Structures, sections 2.2 and 11.4.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

from eventpound.scene.at_rest import stiffness_of
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.spring import GROUND, Spring


def ratio_coefficient(ratio: float, stiffness: float, mass: float) -> float:
    """Coefficient of a dashpot with a given ratio of critical damping.

    Parameters
    ----------
    ratio : float
        xi.
    stiffness : float
        k (N/m).
    mass : float
        m (kg).

    Returns
    -------
    float
        c = 2 xi sqrt(k m) (N s/m).
    """
    return 2.0 * ratio * math.sqrt(stiffness * mass)


def rayleigh_coefficients(ratio: float, omega_1: float, omega_2: float) -> tuple[float, float]:
    """Coefficients of Rayleigh damping with the same ratio at two frequencies.

    Parameters
    ----------
    ratio : float
        xi at both frequencies.
    omega_1, omega_2 : float
        Angular frequencies (rad/s).

    Returns
    -------
    tuple of float
        a (1/s) and b (s).
    """
    total = omega_1 + omega_2
    return 2.0 * ratio * omega_1 * omega_2 / total, 2.0 * ratio / total


def rayleigh_dashpots(
    bodies: Iterable[Body],
    springs: Iterable[Spring],
    mass_coefficient: float,
    stiffness_coefficient: float,
    supports: Collection[str] = (),
    ground: str = GROUND,
) -> tuple[Dashpot, ...]:
    """Dashpots that damp a group of bodies by C = a M + b K.

    K is made of the stiffnesses of the springs of the group at rest.

    Parameters
    ----------
    bodies : iterable of Body
        The group.
    springs : iterable of Spring
        Springs of the scene; those inside the group and to the ground count.
    mass_coefficient, stiffness_coefficient : float
        a (1/s) and b (s).
    supports : collection of str
        Names of supports, which count as the ground.
    ground : str
        From which the mass part acts: the ground or a support.

    Returns
    -------
    tuple of Dashpot
        a m_i to the ground and b k_s beside each spring, without the zero ones.
    """
    group = tuple(bodies)
    names = [*(body.name for body in group), *supports]
    dashpots = [Dashpot((ground, body.name), mass_coefficient * body.mass) for body in group]
    return (
        *(dashpot for dashpot in dashpots if dashpot.coefficient != 0.0),
        *dashpots_beside(springs_of_group(names, springs), stiffness_coefficient),
    )


def dashpots_beside(springs: Iterable[Spring], coefficient: float) -> tuple[Dashpot, ...]:
    """Dashpots that damp springs by b times their stiffnesses at rest.

    Parameters
    ----------
    springs : iterable of Spring
        Of a scene at rest.
    coefficient : float
        b (s).

    Returns
    -------
    tuple of Dashpot
        Without the zero ones.
    """
    dashpots = [Dashpot(spring.between, coefficient * stiffness_of(spring)) for spring in springs]
    return tuple(dashpot for dashpot in dashpots if dashpot.coefficient != 0.0)


def springs_of_group(names: Collection[str], springs: Iterable[Spring]) -> list[Spring]:
    """Springs with both ends among `names` and the ground."""
    ends = {GROUND, *names}
    return [spring for spring in springs if ends.issuperset(spring.ends)]
