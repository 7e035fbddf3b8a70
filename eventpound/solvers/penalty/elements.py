"""Contact elements of a run with fixed steps: constants, and their forces within a step.

`eventpound.mechanics.contact_laws` has the formulas; forces are as published, so that
kelvin-voigt and hertz-damp pull where they say so, as towards the end of a contact. A contact
with a law has its own element; one under Newton's law is a Kelvin-Voigt element here, whose
damping follows from its coefficient of restitution and whose stiffness is

    k = 100 max(largest stiffness of a spring, m / T²)

m is the largest effective mass of a contact, T the scene's own time. With ``contact_steps`` it is
as stiff as the step resolves, so that the error of the spring falls with the step instead of
staying: the time in contact goes as k^(-1/2).

The dashpots of Kelvin-Voigt and Jankowski set in with a jump or without a finite
slope, so that an implicit step that just touches would have no solution that
numbers can hold; in the step that closes the gap they count for the share of the
step in which it is closed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.contact_elements import effective_masses
from eventpound.mechanics.contact_laws import element_parts
from eventpound.mechanics.model import Model, assemble
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import step_kernel
from eventpound.scene.contact_law import ContactLaw, Element
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Task
from eventpound.solvers.events.law_contacts import DRAG, TOUCH_ROWS
from eventpound.solvers.events.run import Laws
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.settings import Settings, number
from eventpound.solvers.timestepping.steps import checked_choices, largest_stiffness

_KELVIN_VOIGT, _JANKOWSKI = int(Element.KELVIN_VOIGT), int(Element.JANKOWSKI)

STIFFER = 100.0
"""Multiple of the stiffest spring that a contact is by default."""
HERTZ_TIME = 2.943275
"""Length of an undamped Hertz contact in units of its depth over its closing speed,
2 ∫_0^1 dx / sqrt(1 - x^(5/2)) = (4/5) √π Γ(2/5) / Γ(9/10)."""


class PenaltyElements(NamedTuple):
    """The contact elements of a run.

    stiffness, cut (K,): of `eventpound.mechanics.contact_elements.Elements`. laws: what else
    they are, and what they do, every contact one of them. origin (N,): room for velocities.
    """

    stiffness: Floats
    cut: Ints
    laws: Laws
    origin: Floats


def elements_of(scene: Scene, stiffness: float) -> PenaltyElements:
    """The elements of all contacts.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    stiffness : float
        k of the contacts under Newton's law (N/m).
    """
    law = ContactLaw(Element.KELVIN_VOIGT.word, stiffness)
    contacts = tuple(c if c.law else replace(c, law=law) for c in scene.contacts)
    model = assemble(replace(scene, contacts=contacts))
    kind, k, damping, cut = model.elements
    laws = Laws(np.arange(kind.size), kind, damping, np.zeros((TOUCH_ROWS, kind.size)))
    return PenaltyElements(k, cut, laws, np.zeros(model.bodies))


@step_kernel
def element_force(
    j: int, elements: PenaltyElements, penetration: float, rate: float, open_before: float
) -> tuple[float, float, float]:
    """Force of an element and its slopes.

    Parameters
    ----------
    j : int
        Which.
    elements : PenaltyElements
        All of them.
    penetration, rate : float
        d (m) and d' (m/s).
    open_before : float
        Gap at the start of the step (m), 0 where it was closed.

    Returns
    -------
    force : float
        F (N).
    by_penetration, by_rate : float
        ∂F/∂d (N/m) and ∂F/∂d' (N s/m).
    """
    if penetration <= 0.0:
        return 0.0, 0.0, 0.0
    kind, damping = elements.laws.kind[j], elements.laws.touch[DRAG, j]
    force, slope, c, growth = element_parts(
        kind, elements.stiffness[j], damping, penetration, rate > 0.0
    )
    if kind in (_KELVIN_VOIGT, _JANKOWSKI):
        # The share s of the step in which the gap is closed, and ∂s/∂d.
        share = penetration / (penetration + open_before)
        growth = share * growth + share * (1.0 - share) / penetration * c
        c = share * c
    force += c * rate
    if elements.cut[j] and force <= 0.0:
        return 0.0, 0.0, 0.0
    return force, slope + growth * rate, c


def contact_steps(settings: Settings) -> float | None:
    """``contact_steps``, the steps that a contact lasts; None where it is not given.

    Raises
    ------
    InputError
        Where it is not positive, or says nothing beside the other settings.
    """
    steps = number(settings, "contact_steps", "a positive number of steps", 0.0)
    if steps is not None and "time_step" not in settings:
        raise InputError(f"[solver]: contact_steps = {steps:g}; accepted: with time_step")
    return steps


def contact_stiffness(task: Task, model: Model, scales: SceneScales) -> float:
    """Stiffness of the contacts under Newton's law (N/m)."""
    masses = effective_masses(model.mass, model.left, model.right)
    mass = float(masses.max(initial=float(model.mass.max())))
    k = STIFFER * float(largest_stiffness(model).max(initial=mass / scales.time**2))
    steps, (step, _) = contact_steps(task.settings), checked_choices(task.settings)
    if steps is None or step is None or model.contacts == 0:
        return k
    shortest = contact_period(float(masses.min()), scales.speed, Element.KELVIN_VOIGT, k)
    return k * max(shortest / (2.0 * steps * step), 1.0) ** 2


def contact_period(mass: float, speed: float, element: Element, stiffness: float) -> float:
    """Twice the time in contact at a speed (s), without damping."""
    if not element.hertzian:
        return 2.0 * math.pi * math.sqrt(mass / stiffness)
    depth = (1.25 * mass * speed**2 / stiffness) ** 0.4
    return 2.0 * HERTZ_TIME * depth / speed


def shortest_period(model: Model, scales: SceneScales, elements: PenaltyElements) -> float:
    """The shortest `contact_period` at the scene's own speed (s), inf without contacts."""
    masses = effective_masses(model.mass, model.left, model.right).tolist()
    kinds = elements.laws.kind.tolist()
    return min(
        (
            contact_period(mass, scales.speed, Element(kind), stiffness)
            for mass, kind, stiffness in zip(
                masses, kinds, elements.stiffness.tolist(), strict=True
            )
        ),
        default=math.inf,
    )
