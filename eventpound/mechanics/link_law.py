"""The laws of links as arrays: constants of their memories, and what NumPy makes of them.

`eventpound.mechanics.elements` has the laws themselves, compiled. This module compiles nothing,
so that to check or to export a scene imports no compiler.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.scene.elastic_laws import ElasticLaws, elastic_force
from eventpound.scene.spring import Backfill, BoucWen, Hysteretic, Law, Slider

CONSTANTS = ("kind", "beside", "strength", "yield_displacement", "exponent", "beta", "gamma",
             "strength_degradation", "stiffness_degradation")  # fmt: skip
"""Columns of `LinkLaw.memory`; but for the first two, fields of `DegradingBoucWen`."""
KIND, BESIDE, STRENGTH, YIELD, EXPONENT, BETA, GAMMA, DELTA_NU, DELTA_ETA = range(len(CONSTANTS))
ELASTIC, BOUC_WEN, BACKFILL, YIELDING_SOIL, SLIDER = 0.0, 1.0, 2.0, 3.0, 4.0
DEGRADING, ITS_ENERGY = 5.0, 6.0
"""Kinds of links; that of a contact element is its code, which is negative."""
_NO_MEMORY = np.array([ELASTIC, 0.0, 0.0, 1.0, 20.0, 0.5, 0.5, 0.0, 0.0])
NONE_FURTHER: Mapping[int, int] = MappingProxyType({})
APART, CLOSED, YIELDING = 1, -1, -2
"""Branches of a link: above its kink, below it, and below it on the backbone of a memory."""


class LinkLaw(NamedTuple):
    """Laws of L links beside their elastic parts; arrays of variants have axes before these.

    damping (L,): c (N s/m). memory (L, constants): of z, Q = 0 where there is none. A memory of
    two numbers has a second link, which carries no force.
    """

    damping: Floats
    memory: Floats


class Yielding(NamedTuple):
    """What memory adds to links, of one shape: stiffness (N/m), force (N), and where it yields (m).

    The stiffness is that at z = 0, the force that at z = 1.
    """

    stiffness: Floats
    force: Floats
    displacement: Floats


def link_law(
    laws: Sequence[Law | Hysteretic], damping: Any, further: Mapping[int, int] = NONE_FURTHER
) -> LinkLaw:
    """Laws of links as arrays; those of which `damping` (N s/m) is longer are dashpots alone.

    But for links with the second number of a memory, which `further` has by the link of the first.
    """
    rows = np.empty((len(damping), len(CONSTANTS)))
    rows[:] = _NO_MEMORY
    rows[:, BESIDE] = np.arange(len(damping))
    for row, law in zip(rows, laws, strict=False):
        if isinstance(law, BoucWen):
            row[KIND] = DEGRADING if law.second else BOUC_WEN
            row[STRENGTH:] = [getattr(law, name, 0.0) for name in CONSTANTS[STRENGTH:]]
        elif isinstance(law, Backfill):
            # Off its backbone dz/dx is constant: eq. 3 with β and γ zero.
            row[KIND] = BACKFILL
            row[STRENGTH:] = law.strength, law.yield_displacement, 1.0, 0.0, 0.0, 0.0, 0.0
        elif isinstance(law, Slider):
            # A z that does not move with x: it is 1, and the sign of Q that of the slip.
            row[KIND] = SLIDER
            row[STRENGTH:] = law.strength, np.inf, 1.0, 0.0, 0.0, 0.0, 0.0
    for first, second in further.items():
        yields = rows[first, YIELD]
        rows[first, BESIDE] = second
        rows[second] = ITS_ENERGY, first, 0.0, yields, 1.0, 0.0, 0.0, 0.0, 0.0
    return LinkLaw(np.array(damping, np.float64), rows)


def contact_law(codes: Floats, damping: Floats) -> LinkLaw:
    """Contact elements of these codes as links (`eventpound.mechanics.contact_laws`)."""
    rows = np.zeros((codes.size, len(CONSTANTS)))
    rows[:, KIND], rows[:, YIELD] = codes, 1.0
    return LinkLaw(damping, rows)


def yielding(memory: Floats) -> Yielding:
    """What memory adds to links; `memory` of shape (..., L, constants)."""
    strength, yields = memory[..., STRENGTH], memory[..., YIELD]
    return Yielding(strength / yields, strength, np.where(np.isinf(yields), 0.0, yields))


def has_backbone(memory: Floats) -> Bools:
    """Which laws are eq. 3 alone, whose time can be eliminated; of constants (..., L, ·)."""
    return np.asarray(memory[..., KIND] == BOUC_WEN)


def z_bound(memory: Floats) -> Floats:
    """Largest |z| that loading can reach, (β + γ)^(-1/n), for constants of shape (..., L, ·).

    It is inf of a law whose z grows with a gap.
    """
    with np.errstate(divide="ignore"):
        found: Floats = (memory[..., BETA] + memory[..., GAMMA]) ** (-1.0 / memory[..., EXPONENT])
    return found


def memory_force(memory: Floats, z: Floats) -> Floats:
    """What memory pulls with (N), for constants (..., H, ·) and z (..., H); soil only pushes."""
    acting = np.where(memory[..., KIND] == BACKFILL, np.minimum(z, 0.0), z)
    return np.asarray(memory[..., STRENGTH] * acting)


def link_forces(
    elastic: ElasticLaws, law: LinkLaw, hysteretic: Ints, x: Floats, x_rate: Floats, z: Floats
) -> tuple[Floats, Floats]:
    """Forces of links without and with the dashpots beside them (N), shape (..., L) each.

    Parameters
    ----------
    elastic, law : ElasticLaws, LinkLaw
        The links.
    hysteretic : ndarray of int, shape (H,)
        Which of them have a memory.
    x, x_rate : ndarray, shape (..., L)
        Elongations (m) and their rates (m/s), perhaps of many instants.
    z : ndarray, shape (..., H)
        Internal variables.
    """
    force = elastic_force(elastic, x)[0]
    force[..., hysteretic] += memory_force(law.memory[hysteretic], z)
    return force, force + law.damping * x_rate
