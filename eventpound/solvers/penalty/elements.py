"""Contact elements: a force for a penetration δ = -g > 0 and its rate δ'.

    linear        F = k δ
    kelvin-voigt  F = k δ + c δ'
    hertz         F = k δ^(3/2)
    hertz-damp    F = k δ^(3/2) [1 + a δ'/δ'_0]
    jankowski     F = k δ^(3/2) + c_ξ δ^(1/4) δ' while δ' > 0,  F = k δ^(3/2) after

and F = 0 for δ <= 0. With ``m = m_1 m_2 / (m_1 + m_2)`` (the mass of the body
at a barrier) and ε the coefficient of restitution

    c   = 2 ζ sqrt(k m),  ζ = -ln ε / sqrt(π² + ln² ε)
          S. A. Anagnostopoulos, Earthq. Eng. Struct. Dyn. 16, 1988, 443-456
    a   = 3 (1 - ε²) / 4, δ'_0 the rate at which the contact closed
          S. Muthukumar, R. DesRoches, Earthq. Eng. Struct. Dyn. 35, 2006, 811-828
    c_ξ = 2 ξ sqrt(k m), ξ = (9 √5 / 2) (1 - ε²) / (ε (ε (9 π - 16) + 16))
          R. Jankowski, Earthq. Eng. Struct. Dyn. 34, 2005, 595-611 (the element);
          35, 2006, 517-524 (ξ)

as published: kelvin-voigt and hertz-damp pull where the formula says so, as towards
the end of a contact. A linear or Hertz element knows no ε and rebounds with all energy.

The dashpots of Kelvin-Voigt and Jankowski set in with a jump or without a finite
slope, so that an implicit step that just touches would have no solution that
numbers can hold; in the step that closes the gap they count for the share of the
step in which it is closed.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.solvers.settings import Settings, word
from eventpound.solvers.timestepping.compiled import step_kernel


class Element(IntEnum):
    """The contact elements."""

    LINEAR = 0
    KELVIN_VOIGT = 1
    HERTZ = 2
    HERTZ_DAMP = 3
    JANKOWSKI = 4

    @property
    def word(self) -> str:
        """What a case calls it."""
        return self.name.lower().replace("_", "-")

    @property
    def hertzian(self) -> bool:
        """Whether its stiffness is in N/m^(3/2)."""
        return self >= Element.HERTZ


_HERTZ = int(Element.HERTZ)
_HERTZ_DAMP = int(Element.HERTZ_DAMP)
_JANKOWSKI = int(Element.JANKOWSKI)


DEFAULT = Element.KELVIN_VOIGT


def element_of(settings: Settings) -> Element:
    """The element that ``contact`` names.

    Raises
    ------
    InputError
        Where it names none.
    """
    by_word = {element.word: element for element in Element}
    return by_word[word(settings, "contact", tuple(by_word), DEFAULT.word)]


def contact_masses(model: Model) -> Floats:
    """Effective mass m of each contact (kg), shape (K,)."""
    inverse = np.append(1.0 / model.mass, 0.0)
    return np.asarray(1.0 / (inverse[model.left] + inverse[model.right]))


def damping_constants(element: Element, scene: Scene, model: Model, stiffness: float) -> Floats:
    """c, a or c_ξ of each contact, zero for an element without, shape (K,).

    Parameters
    ----------
    element : Element
        Which.
    scene : Scene
        For the names of its contacts.
    model : Model
        Its arrays.
    stiffness : float
        k (N/m, or N/m^(3/2)).

    Raises
    ------
    InputError
        Where a formula has no value for a coefficient of restitution.
    """
    eps = model.restitution
    mass = contact_masses(model)
    if element is Element.KELVIN_VOIGT:
        ratio = np.array([kelvin_voigt_ratio(float(e)) for e in eps])
        return np.asarray(2.0 * ratio * np.sqrt(stiffness * mass))
    if element is Element.HERTZ_DAMP:
        return np.asarray(0.75 * (1.0 - eps**2))
    if element is Element.JANKOWSKI:
        for contact in scene.contacts:
            if contact.restitution == 0.0:
                raise InputError(
                    f"contact {contact.name!r}: restitution = 0 has no damping ratio in "
                    "Jankowski's formula, which divides by it; accepted: a positive "
                    'restitution, or contact = "kelvin-voigt" or "hertz-damp"'
                )
        ratio = np.array([jankowski_ratio(float(e)) for e in eps])
        return np.asarray(2.0 * ratio * np.sqrt(stiffness * mass))
    return np.zeros(model.contacts)


def kelvin_voigt_ratio(restitution: float) -> float:
    """ζ of Anagnostopoulos (1988); 1, its limit, for ε = 0."""
    if restitution == 0.0:
        return 1.0
    logarithm = math.log(restitution)
    return -logarithm / math.hypot(math.pi, logarithm)


def jankowski_ratio(restitution: float) -> float:
    """ξ of Jankowski (2006) for a positive ε."""
    e = restitution
    return 4.5 * math.sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))


@step_kernel
def element_force(
    element: int,
    stiffness: float,
    damping: float,
    penetration: float,
    rate: float,
    approach: float,
    open_before: float,
) -> tuple[float, float, float]:
    """Force of an element and its slopes.

    Parameters
    ----------
    element : int
        An `Element`.
    stiffness, damping : float
        k, and the entry of `damping_constants`.
    penetration, rate : float
        δ (m) and δ' (m/s).
    approach : float
        δ'_0 (m/s); where it is not positive nothing is damped by it.
    open_before : float
        Gap at the start of the step (m), 0 where it was closed.

    Returns
    -------
    force : float
        F (N).
    by_penetration, by_rate : float
        ∂F/∂δ (N/m) and ∂F/∂δ' (N s/m).
    """
    if penetration <= 0.0:
        return 0.0, 0.0, 0.0
    # The share s of the step in which the gap is closed, and ∂s/∂δ.
    share = penetration / (penetration + open_before)
    growth = share * (1.0 - share) / penetration
    if element < _HERTZ:
        c = share * damping
        return stiffness * penetration + c * rate, stiffness + growth * damping * rate, c
    root = math.sqrt(penetration)
    force, slope = stiffness * penetration * root, 1.5 * stiffness * root
    if element == _HERTZ_DAMP and approach > 0.0:
        factor = 1.0 + damping * rate / approach
        return force * factor, slope * factor, force * damping / approach
    if element == _JANKOWSKI and rate > 0.0:
        c = damping * math.sqrt(root)
        slope += (0.25 * share / penetration + growth) * c * rate
        return force + share * c * rate, slope, share * c
    return force, slope, 0.0
