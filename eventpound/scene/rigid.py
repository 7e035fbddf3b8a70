"""The rigid law that contact elements stand for: Newton's, with the restitution that is meant.

A law with a `restitution` means that; one with ζ, a or ξ what the formula of
`eventpound.scene.contact_law` has for it, inverted; one without damping, 1.
"""

from __future__ import annotations

import math
from dataclasses import replace

from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene


def meant_restitution(contact: Contact) -> float:
    """Coefficient of restitution that a contact with a law stands for, or that of Newton's.

    Parameters
    ----------
    contact : Contact
        A checked one.
    """
    if contact.restitution is not None:
        return contact.restitution
    if contact.law is None or contact.law.damping is None:
        return 1.0
    return restitution_of(contact.law.element, contact.law.damping)


def restitution_of(element: Element, constant: float) -> float:
    """Coefficient of restitution whose formula gives this ζ, a or ξ; 0 beyond its end."""
    if element is Element.KELVIN_VOIGT:
        if constant >= 1.0:
            return 0.0
        return math.exp(-math.pi * constant / math.sqrt(1.0 - constant**2))
    if element is Element.HERTZ_DAMP:
        return math.sqrt(max(0.0, 1.0 - constant / 0.75))
    if element is Element.JANKOWSKI:
        # A quadratic of e, in the form that does not cancel where it has a small root.
        lead = 4.5 * math.sqrt(5.0)
        square = lead + constant * (9.0 * math.pi - 16.0)
        return lead / (8.0 * constant + math.sqrt(64.0 * constant**2 + square * lead))
    return 1.0


def rigid(scene: Scene, restitution: float | None = None) -> Scene:
    """The scene with Newton's law in the place of every other.

    Parameters
    ----------
    scene : Scene
        Checked.
    restitution : float, optional
        ε of the contacts that have a law (`meant_restitution`).
    """

    def changed(contact: Contact) -> Contact:
        if contact.law is None:
            return contact
        e = meant_restitution(contact) if restitution is None else restitution
        return replace(contact, restitution=e, law=None)

    return replace(scene, contacts=tuple(map(changed, scene.contacts)))
