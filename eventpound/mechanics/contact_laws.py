"""Contact elements as numbers: every law is ``F = E(d) + C(d) d'`` of the overlap d = -g.

    linear        E = k d          C = 0
    kelvin-voigt  E = k d          C = c = 2 ζ sqrt(k m)
    hertz         E = k d^(3/2)    C = 0
    hertz-damp    E = k d^(3/2)    C = (a k / d'_0) d^(3/2)
    jankowski     E = k d^(3/2)    C = 2 ξ sqrt(k m) d^(1/4) while the bodies approach, else 0

(`eventpound.scene.contact_law` has the sources.) Without tension the force of a Kelvin-Voigt
element is cut at zero. The first two continue beyond d = 0 as they are, so that a step that ends
a contact is smooth up to there; the others have no force there.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.mechanics.contact_elements import CUT, FIRST_CODE, NO_LAW, Elements
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel
from eventpound.scene.contact_law import Element

_HERTZ = int(Element.HERTZ)
_HERTZ_DAMP = int(Element.HERTZ_DAMP)
_JANKOWSKI = int(Element.JANKOWSKI)
_CUT = int(CUT)


@scalar_kernel
def element_parts(
    kind: int, stiffness: float, damping: float, overlap: float, approaching: bool
) -> tuple[float, float, float, float]:
    """E, dE/dd, C and dC/dd of an element.

    Parameters
    ----------
    kind : int
        An `Element`.
    stiffness, damping : float
        Those of `Elements`, that of hertz-damp divided by d'_0.
    overlap : float
        d (m).
    approaching : bool
        Whether the bodies approach, which Jankowski's law asks for.
    """
    if kind < _HERTZ or kind == _CUT:
        return stiffness * overlap, stiffness, damping, 0.0
    if overlap <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    root = math.sqrt(overlap)
    force, slope = stiffness * overlap * root, 1.5 * stiffness * root
    if kind == _HERTZ_DAMP:
        return force, slope, damping * overlap * root, 1.5 * damping * root
    if kind == _JANKOWSKI and approaching:
        fourth = math.sqrt(root)
        return force, slope, damping * fourth, 0.25 * damping * fourth / overlap
    return force, slope, 0.0, 0.0


@scalar_kernel
def element_exponents(kind: int, approaching: bool) -> tuple[float, float]:
    """Powers of d that E and C are; -1 for a C that is none."""
    if kind < _HERTZ or kind == _CUT:
        return 1.0, 0.0
    if kind == _HERTZ_DAMP:
        return 1.5, 1.5
    return 1.5, 0.25 if kind == _JANKOWSKI and approaching else -1.0


@scalar_kernel
def element_pull(
    code: int, stiffness: float, preload: float, damping: float, x: float, x_rate: float, way: float
) -> tuple[float, float, float]:
    """The force of a closed element as that of a link, and its slopes.

    Parameters
    ----------
    code : int
        `FIRST_CODE` less its kind.
    stiffness, preload, damping : float
        k, ``k gap`` and the number of C, SI: ``d = -(k x + f)/k``.
    x, x_rate : float
        Elongation (m) and its rate (m/s), d' = -x'.
    way : float
        The side of its kink that the law keeps to, 0 for its own: the sign of x' of Jankowski's;
        above 0 the force of one that is cut is nothing.

    Returns
    -------
    pull, by_x, by_rate : float
        -F (N), its derivatives by x (N/m) and x' (N s/m).
    """
    kind = FIRST_CODE - code
    overlap = -(stiffness * x + preload) / stiffness
    approaching = way < 0.0 if way != 0.0 else x_rate < 0.0
    force, slope, drag, growth = element_parts(kind, stiffness, damping, overlap, approaching)
    pull = drag * x_rate - force
    if kind == _CUT and (way > 0.0 if way != 0.0 else pull >= 0.0):
        return 0.0, 0.0, 0.0
    # ∂/∂x = -∂/∂d, and C grows with d.
    return pull, slope - growth * x_rate, drag


def contact_forces(elements: Elements, gap: Floats, gap_rate: Floats, closing: Floats) -> Floats:
    """Force of every element (N), shape (K,), 0 under Newton's law.

    Parameters
    ----------
    elements : Elements
        The laws.
    gap, gap_rate : ndarray, shape (K,)
        Gaps (m) and their rates (m/s).
    closing : ndarray, shape (K,)
        Speed with which each contact closed, 0 where it did not (m/s).
    """
    force = np.zeros(gap.size)
    for j in np.flatnonzero((elements.kind != NO_LAW) & (gap < 0.0)):
        damping = elements.damping[j]
        if elements.kind[j] == _HERTZ_DAMP:
            damping = damping / closing[j] if closing[j] > 0.0 else 0.0
        e, _, c, _ = element_parts(
            elements.kind[j], elements.stiffness[j], damping, -gap[j], gap_rate[j] < 0.0
        )
        force[j] = e - c * gap_rate[j]
        if elements.cut[j]:
            force[j] = max(force[j], 0.0)
    return force


def stored(elements: Elements, gap: Floats) -> float:
    """Energy that the elements hold at these gaps, ∫_0^d E dd over all of them (J)."""
    depth = np.where(elements.kind == NO_LAW, 0.0, np.maximum(-gap, 0.0))
    power = np.where(elements.kind >= _HERTZ, 1.5, 1.0)
    return float(np.sum(elements.stiffness * depth ** (power + 1.0) / (power + 1.0)))
