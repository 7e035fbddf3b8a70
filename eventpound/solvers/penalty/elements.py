"""Contact elements of a run with fixed steps: constants, and their forces within a step.

`eventpound.mechanics.contact_laws` has the formulas; forces are as published, so that
kelvin-voigt and hertz-damp pull where they say so, as towards the end of a contact. A contact
with a law has its own element, one under Newton's law the element of the settings. A linear or
Hertz element knows no ε and rebounds with all energy.

The dashpots of Kelvin-Voigt and Jankowski set in with a jump or without a finite
slope, so that an implicit step that just touches would have no solution that
numbers can hold; in the step that closes the gap they count for the share of the
step in which it is closed.

Where a case does not give the stiffness of the elements, it is

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
from typing import NamedTuple

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.contact_elements import NO_LAW, drag, effective_masses
from eventpound.mechanics.contact_laws import element_parts
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.contact_law import BY_WORD, Element, damping_constant
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Task
from eventpound.solvers.events.law_contacts import DRAG, TOUCH_ROWS
from eventpound.solvers.events.run import Laws
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.settings import Settings, number, word
from eventpound.solvers.timestepping.steps import checked_choices, largest_stiffness
from eventpound.solvers.timestepping.structure import step_kernel

_KELVIN_VOIGT, _JANKOWSKI = int(Element.KELVIN_VOIGT), int(Element.JANKOWSKI)

DEFAULT = Element.KELVIN_VOIGT
STIFFER = 100.0
"""Multiple of the stiffest spring that a contact is by default."""
HERTZ_TIME = 2.943275
"""Length of an undamped Hertz contact in units of its depth over its closing speed,
2 ∫_0^1 dx / sqrt(1 - x^(5/2)) = (4/5) √π Γ(2/5) / Γ(9/10)."""


class Elements(NamedTuple):
    """The contact elements of a run.

    stiffness, cut (K,): of `eventpound.mechanics.contact_elements.Elements`. laws: what else
    they are, and what they do, every contact one of them. origin (N,): room for velocities.
    """

    stiffness: Floats
    cut: Ints
    laws: Laws
    origin: Floats


def element_of(settings: Settings) -> Element:
    """The element that ``contact`` names.

    Raises
    ------
    InputError
        Where it names none.
    """
    return BY_WORD[word(settings, "contact", tuple(BY_WORD), DEFAULT.word)]


def elements_for(element: Element, scene: Scene, model: Model, stiffness: float) -> Elements:
    """The elements of all contacts.

    Parameters
    ----------
    element : Element
        Of the contacts without a law.
    scene : Scene
        For the names of its contacts.
    model : Model
        Its arrays.
    stiffness : float
        k of that element (N/m, or N/m^(3/2)).

    Raises
    ------
    InputError
        Where a formula has no value for a coefficient of restitution.
    """
    own = model.elements
    newton = own.kind == NO_LAW
    damping, mass = own.damping.copy(), effective_masses(model.mass, model.left, model.right)
    for j in np.flatnonzero(newton):
        e = float(model.restitution[j])
        if element is Element.JANKOWSKI and e == 0.0:
            raise InputError(
                f"contact {scene.contacts[j].name!r}: restitution = 0 has no damping ratio in "
                "Jankowski's formula, which divides by it; accepted: a positive "
                'restitution, or contact = "kelvin-voigt" or "hertz-damp"'
            )
        constant = damping_constant(element, e)
        damping[j] = drag(element, constant, stiffness, float(mass[j]))
    kind, contacts = np.where(newton, int(element), own.kind), model.contacts
    return Elements(
        np.where(newton, stiffness, own.stiffness),
        own.cut,
        Laws(np.arange(contacts), kind, damping, np.zeros((TOUCH_ROWS, contacts))),
        np.zeros(model.bodies),
    )


@step_kernel
def element_force(
    j: int,
    elements: Elements,
    penetration: float,
    rate: float,
    open_before: float,
) -> tuple[float, float, float]:
    """Force of an element and its slopes.

    Parameters
    ----------
    j : int
        Which.
    elements : Elements
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
