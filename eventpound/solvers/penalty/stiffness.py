"""The stiffness of the contact elements, where a case does not give it, and their period.

    linear, kelvin-voigt   k = 100 max(largest stiffness of a spring, m / T²)
    the others             k_h = (5/4) k / sqrt(δ), δ = V sqrt(m/k)

m is the largest effective mass of a contact, T and V = L/T the scene's own time and
speed. k_h stores the same energy at the depth to which a closing speed V drives k.
"""

from __future__ import annotations

import math

from eventpound.mechanics.model import Model
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.penalty.elements import Element, contact_masses
from eventpound.solvers.settings import Settings, number
from eventpound.solvers.timestepping.choices import largest_stiffness

STIFFER = 100.0
"""Multiple of the stiffest spring that a contact is by default."""
HERTZ_TIME = 2.943275
"""Length of an undamped Hertz contact in units of its depth over its closing speed,
2 ∫_0^1 dx / sqrt(1 - x^(5/2)) = (4/5) √π Γ(2/5) / Γ(9/10)."""


def given_stiffness(settings: Settings, element: Element) -> float | None:
    """``contact_stiffness`` (N/m, or N/m^(3/2)), None where it is not given.

    Raises
    ------
    InputError
        Where it is not positive.
    """
    unit = "N/m^1.5" if element.hertzian else "N/m"
    return number(settings, "contact_stiffness", f"a positive stiffness ({unit})", 0.0)


def contact_stiffness(task: Task, model: Model, scales: SceneScales, element: Element) -> float:
    """Stiffness of the elements (N/m, or N/m^(3/2)).

    Raises
    ------
    InputError
        Where the case gives one that is not positive.
    """
    given = given_stiffness(task.settings, element)
    if given is not None:
        return given
    mass = float(contact_masses(model).max(initial=float(model.mass.max())))
    stiffest = float(largest_stiffness(model).max(initial=mass / scales.time**2))
    k = STIFFER * stiffest
    if not element.hertzian:
        return k
    return 1.25 * k / math.sqrt(scales.speed * math.sqrt(mass / k))


def contact_period(model: Model, scales: SceneScales, element: Element, stiffness: float) -> float:
    """Twice the shortest time in contact at the scene's own speed (s), inf without contacts."""
    if model.contacts == 0:
        return math.inf
    mass = float(contact_masses(model).min())
    if not element.hertzian:
        return 2.0 * math.pi * math.sqrt(mass / stiffness)
    depth = (1.25 * mass * scales.speed**2 / stiffness) ** 0.4
    return 2.0 * HERTZ_TIME * depth / scales.speed
