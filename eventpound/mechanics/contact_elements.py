"""Contact elements as arrays: which law each contact has, and its constants.

Their forces are in `eventpound.mechanics.contact_laws`; this module compiles nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene

NO_LAW = -1
"""Kind of a contact under Newton's law."""
CUT = len(Element)
"""Kind of a Kelvin-Voigt element without tension, where it is a link."""
FIRST_CODE = -2
"""What stands in a closed element, as a link, in the place of its number of z: this less its
kind. -1 is a link without hysteresis."""
SMOOTH_CODES = FIRST_CODE - int(Element.KELVIN_VOIGT)
"""From this code up the force of a closed element is a smooth function of d and d'."""
APPROACH_CODE = FIRST_CODE - int(Element.JANKOWSKI)
"""That of the element whose force depends on the sign of d'."""
CUT_CODE = FIRST_CODE - CUT
"""That of the element whose force is cut at zero."""


class Elements(NamedTuple):
    """Laws of the contacts, shape (K,).

    kind: an `Element`, or `NO_LAW`. stiffness: k (N/m or N/m^(3/2)). damping: c; a k; or
    2 ξ sqrt(k m), SI. cut: whether the force is cut at zero.
    """

    kind: Ints
    stiffness: Floats
    damping: Floats
    cut: Ints


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
    if all(contact.law is None for contact in scene.contacts):
        return Elements(kind, stiffness, damping, cut)
    effective = effective_masses(mass, left, right)
    for j, contact in enumerate(scene.contacts):
        law = contact.law
        if law is not None:
            kind[j], stiffness[j], cut[j] = law.element, law.stiffness, not law.tension
            damping[j] = drag(
                law.element, contact.damping or 0.0, law.stiffness, float(effective[j])
            )
    return Elements(kind, stiffness, damping, cut)
