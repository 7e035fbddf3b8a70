"""The stiffness of the contact elements, where a case does not give it, and their period.

    linear, kelvin-voigt   k = 100 max(largest stiffness of a spring, m / T²)
    the others             k_h = (5/4) k / sqrt(δ), δ = V sqrt(m/k)

m is the largest effective mass of a contact, T and V = L/T the scene's own time and
speed. k_h stores the same energy at the depth to which a closing speed V drives k. With
``contact_steps`` it is as stiff as the step resolves, so that the error of the spring falls
with the step instead of staying: the time in contact goes as k^(-1/2), for Hertz contacts as
k^(-2/5).
"""

from __future__ import annotations

import math

from eventpound.errors import InputError
from eventpound.mechanics.contact_laws import effective_masses
from eventpound.mechanics.model import Model
from eventpound.scene.contact_law import Element
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.penalty.elements import Elements
from eventpound.solvers.settings import Settings, number
from eventpound.solvers.timestepping.choices import checked_choices, largest_stiffness

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


def contact_steps(settings: Settings) -> float | None:
    """``contact_steps``, the steps that a contact lasts; None where it is not given.

    Raises
    ------
    InputError
        Where it is not positive, or says nothing beside the other settings.
    """
    steps = number(settings, "contact_steps", "a positive number of steps", 0.0)
    if steps is not None and ("contact_stiffness" in settings or "time_step" not in settings):
        raise InputError(
            f"[solver]: contact_steps = {steps:g}; accepted: with time_step, "
            "and without contact_stiffness"
        )
    return steps


def contact_stiffness(task: Task, model: Model, scales: SceneScales, element: Element) -> float:
    """Stiffness of the elements (N/m, or N/m^(3/2)).

    Raises
    ------
    InputError
        Where the case gives one that is not positive.
    """
    given, steps = given_stiffness(task.settings, element), contact_steps(task.settings)
    if given is not None:
        return given
    masses = effective_masses(model.mass, model.left, model.right)
    mass = float(masses.max(initial=float(model.mass.max())))
    stiffest = float(largest_stiffness(model).max(initial=mass / scales.time**2))
    k = STIFFER * stiffest
    if element.hertzian:
        k *= 1.25 / math.sqrt(scales.speed * math.sqrt(mass / k))
    step, _ = checked_choices(task.settings)
    if steps is None or step is None or model.contacts == 0:
        return k
    lightest = float(masses.min())
    shorter = contact_period(lightest, scales.speed, element, k) / (2.0 * steps * step)
    return k * max(shorter, 1.0) ** (2.5 if element.hertzian else 2.0)


def contact_period(mass: float, speed: float, element: Element, stiffness: float) -> float:
    """Twice the time in contact at a speed (s), without damping."""
    if not element.hertzian:
        return 2.0 * math.pi * math.sqrt(mass / stiffness)
    depth = (1.25 * mass * speed**2 / stiffness) ** 0.4
    return 2.0 * HERTZ_TIME * depth / speed


def shortest_period(model: Model, scales: SceneScales, elements: Elements) -> float:
    """The shortest `contact_period` at the scene's own speed (s), inf without contacts."""
    masses = effective_masses(model.mass, model.left, model.right).tolist()
    kinds = elements.kind.tolist()
    return min(
        (
            contact_period(mass, scales.speed, Element(kind), stiffness)
            for mass, kind, stiffness in zip(
                masses, kinds, elements.stiffness.tolist(), strict=True
            )
        ),
        default=math.inf,
    )
