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
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import scalar_kernel
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene

NO_LAW = -1
"""Kind of a contact under Newton's law."""
_HERTZ, _HERTZ_DAMP = int(Element.HERTZ), int(Element.HERTZ_DAMP)
_JANKOWSKI = int(Element.JANKOWSKI)


class Elements(NamedTuple):
    """Laws of the contacts, shape (K,).

    kind: an `Element`, or `NO_LAW`. stiffness: k (N/m or N/m^(3/2)). damping: c; a k; or
    2 ξ sqrt(k m), SI. cut: whether the force is cut at zero. mass: m (kg).
    """

    kind: Ints
    stiffness: Floats
    damping: Floats
    cut: Ints
    mass: Floats


def effective_masses(mass: Floats, left: Ints, right: Ints) -> Floats:
    """M of each contact (kg), shape (K,); -1 is a barrier."""
    inverse = np.append(1.0 / mass, 0.0)
    return np.asarray(1.0 / (inverse[left] + inverse[right]))


def drag(element: Element, constant: float, stiffness: float, mass: float) -> float:
    """The number of C for ζ, a or ξ; that of hertz-damp is yet to be divided by d'_0."""
    if element is Element.HERTZ_DAMP:
        return constant * stiffness
    return 2.0 * constant * math.sqrt(stiffness * mass)


def elements_of(scene: Scene, mass: Floats, left: Ints, right: Ints) -> Elements:
    """Laws of the contacts of a scene, whose masses and ends are given as arrays."""
    count = len(scene.contacts)
    kind, cut = np.full(count, NO_LAW, np.int64), np.zeros(count, np.int64)
    stiffness, damping = np.zeros(count), np.zeros(count)
    effective = effective_masses(mass, left, right)
    for j, contact in enumerate(scene.contacts):
        law = contact.law
        if law is not None:
            kind[j], stiffness[j], cut[j] = law.element, law.stiffness, not law.tension
            damping[j] = drag(
                law.element, contact.damping or 0.0, law.stiffness, float(effective[j])
            )
    return Elements(kind, stiffness, damping, cut, effective)


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
    if kind < _HERTZ:
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
