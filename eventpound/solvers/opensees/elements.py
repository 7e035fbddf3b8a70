"""A scene as OpenSees's zero-length elements: which material between which nodes.

Node 1 is the ground (and every barrier), fixed; node b + 2 is body b with its mass. The
strain of an element is the displacement of its second node less that of its first, which
is our elongation and, for a contact, the opening of its gap.

Bouc-Wen: OpenSees has ``F = α K_0 x + (1 - α) K_0 w`` with ``w' = x' - (γ' |x'| w |w|^(n-1)
+ β' x' |w|^n)``, w a length; with ``w = u_y z`` this is ours for ``K_0 = k + Q/u_y``,
``α = k/K_0``, ``β' = β/u_y^n``, ``γ' = γ/u_y^n``.

Contacts have the parameters that stand for Newton's restitution. For an indentation d > 0 and its
rate d', with the effective mass ``m = m_1 m_2 / (m_1 + m_2)`` (of a body at a barrier its own) and
the coefficient ε:

    linear        ElasticPPGap     F = k d
    kelvin-voigt  ViscoelasticGap  F = k d + c d',  c = 2 ζ sqrt(k m),
                                   ζ = -ln ε / sqrt(π² + ln² ε)   (Anagnostopoulos 1988)
    hertz         Hertzdamp        F = k d^(3/2)
    hertz-damp    Hertzdamp        F = k d^(3/2) (1 + a d'/d'_0),  a = 3 (1 - ε²) / 4
                                                       (Muthukumar and DesRoches 2006)
    jankowski     JankowskiImpact  F = k d^(3/2) + 2 ξ sqrt(k sqrt(d) m) d' while d' > 0,
                                   ξ = (9 √5 / 2) (1 - ε²) / (ε (ε (9 π - 16) + 16))
                                                                      (Jankowski 2006)
    impact        ImpactMaterial   bilinear with hysteresis: with the largest indentation
                                   d_m, K = k sqrt(d_m), E = 2 k d_m^(5/2) (1 - ε²) / 5,
                                   d_y = d_m / 10, K_1 = K + E / (d_y d_m),
                                   K_2 = K - E / ((d_m - d_y) d_m)
                                                       (Muthukumar and DesRoches 2006)

k is in N/m for the first two and in N/m^(3/2) for the others. A linear or Hertz contact
gives all energy back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import assert_never

from eventpound.errors import InputError
from eventpound.mechanics.contact_elements import drag
from eventpound.mechanics.model import Model
from eventpound.scene.contact_law import BY_WORD, Element, damping_constant
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.ends import label_of, opening
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BilinearElastic, BoucWen, Spring
from eventpound.solvers.settings import Settings, number, word
from eventpound.tolerances import OPENSEES_FAR, OPENSEES_LARGEST, OPENSEES_NEVER

Material = tuple[str | float, ...]
"""Arguments of ``uniaxialMaterial``, its tag left out."""
STEPS_IN_CONTACT = 20
YIELDED = 0.1
"""Part of the largest indentation at which ImpactMaterial yields."""


class ContactKind(StrEnum):
    """What stands for a contact."""

    LINEAR = "linear"
    KELVIN_VOIGT = "kelvin-voigt"
    HERTZ = "hertz"
    HERTZ_DAMP = "hertz-damp"
    JANKOWSKI = "jankowski"
    IMPACT = "impact"


DEFAULT = ContactKind.KELVIN_VOIGT


@dataclass(frozen=True)
class ContactChoice:
    """What the settings say of contacts.

    Parameters
    ----------
    kind : ContactKind
        The material.
    stiffness : float or None
        k (N/m or N/m^(3/2)); None for a contact that lasts `STEPS_IN_CONTACT` steps.
    indentation : float or None
        d_m of ImpactMaterial (m).
    """

    kind: ContactKind
    stiffness: float | None
    indentation: float | None


def contact_choice(settings: Settings) -> ContactChoice:
    """What the settings say of contacts.

    Raises
    ------
    InputError
        Where a value is not accepted or one is missing.
    """
    kind = ContactKind(word(settings, "contact", tuple(ContactKind), DEFAULT))
    stiffness = number(settings, "contact_stiffness", "a positive number", 0.0)
    indentation = number(settings, "indentation", "a positive number", 0.0)
    if stiffness is None and kind not in (ContactKind.LINEAR, ContactKind.KELVIN_VOIGT):
        raise InputError(f"[solver]: contact = {kind.value!r} needs contact_stiffness (N/m^1.5)")
    if indentation is None and kind is ContactKind.IMPACT:
        raise InputError("[solver]: contact = 'impact' needs indentation, the largest one (m)")
    return ContactChoice(kind, stiffness, indentation)


def contact_material(
    choice: ContactChoice, mass: float, restitution: float, gap: float, step: float
) -> Material:
    """The material of a contact.

    Parameters
    ----------
    choice : ContactChoice
        What the settings say.
    mass : float
        Effective mass m (kg).
    restitution : float
        ε.
    gap : float
        Opening at zero displacement (m).
    step : float
        Time step (s).
    """
    k = choice.stiffness or mass * (math.pi / (STEPS_IN_CONTACT * step)) ** 2
    if choice.kind is ContactKind.IMPACT:
        return _impact_material(k, choice.indentation or math.nan, restitution, gap)
    element = BY_WORD[choice.kind]
    if element is Element.JANKOWSKI and restitution == 0.0:
        raise InputError("[solver]: contact = 'jankowski' has no damping for ε = 0")
    return element_material(element, k, damping_constant(element, restitution), mass, gap)


def element_material(
    element: Element, stiffness: float, constant: float, mass: float, gap: float
) -> Material:
    """The material of a contact element.

    Parameters
    ----------
    element : Element
        Which.
    stiffness, constant : float
        k, and ζ, a or ξ, 0 for one without.
    mass, gap : float
        Effective mass (kg) and opening at zero displacement (m).
    """
    match element:
        case Element.LINEAR:
            return ("ElasticPPGap", stiffness, -OPENSEES_NEVER, -gap, 0.0)
        case Element.KELVIN_VOIGT:
            return ("ViscoelasticGap", stiffness, drag(element, constant, stiffness, mass), -gap)
        case Element.JANKOWSKI:
            return ("JankowskiImpact", stiffness, constant, mass, -gap, 1.5)
        case Element.HERTZ | Element.HERTZ_DAMP:
            return ("Hertzdamp", stiffness, constant, -gap, 1.5)
    assert_never(element)


def _impact_material(k: float, deepest: float, e: float, gap: float) -> Material:
    secant = k * math.sqrt(deepest)
    energy = 0.4 * k * deepest**2.5 * (1.0 - e**2)
    yields = YIELDED * deepest
    first = secant + energy / (yields * deepest)
    second = secant - energy / ((deepest - yields) * deepest)
    return ("ImpactMaterial", first, second, -yields, -gap)


GROUND_NODE = 1


@dataclass(frozen=True)
class ZeroLength:
    """A zero-length element.

    Parameters
    ----------
    first, second : int
        Its nodes.
    material : tuple
        Arguments of ``uniaxialMaterial``, the tag left out.
    """

    first: int
    second: int
    material: Material


def elements_of(scene: Scene, model: Model, choice: ContactChoice, step: float) -> list[ZeroLength]:
    """Springs in the order of the scene, then dashpots, then contacts.

    Raises
    ------
    InputError
        Where OpenSees has no material for something; all of it is named.
    """
    problems = [problem for spring in scene.springs for problem in _problems(spring, scene)]
    problems += _law_problems(scene, model)
    problems += [
        f"dashpot {' - '.join(map(label_of, d.sides))}: its Viscous material is not negative"
        for d in scene.dashpots
        if d.coefficient < 0.0
    ]
    if problems:
        raise InputError([f"solver = 'opensees': {problem}" for problem in problems])
    ends = [(int(first) + 2, int(second) + 2) for first, second in model.link_ends]
    found = [
        ZeroLength(*ends[i], _spring_material(spring)) for i, spring in enumerate(scene.springs)
    ]
    # Viscous material: force c x'^1; a spring's dashpot is an element beside it.
    found += [
        ZeroLength(*ends[i], ("Viscous", float(c), 1.0))
        for i, c in enumerate(model.law.damping)
        if c != 0.0
    ]
    for j, contact in enumerate(scene.contacts):
        sides = [int(side[j]) for side in (model.left, model.right)]
        inverse = sum(1.0 / float(model.mass[b]) for b in sides if b >= 0)
        mass, law = 1.0 / inverse, contact.law
        if law is None:
            restitution = float(model.restitution[j])
            material = contact_material(choice, mass, restitution, contact.gap, step)
        else:
            constant = contact.damping or 0.0
            material = element_material(law.element, law.stiffness, constant, mass, contact.gap)
        found.append(ZeroLength(sides[0] + 2, sides[1] + 2, material))
    return found


def _problems(spring: Spring, scene: Scene) -> list[str]:
    """What OpenSees cannot express of a spring."""
    law = spring.law
    if not isinstance(law, BoucWen):
        return []
    place = {body.name: body.displacement for body in scene.bodies}
    x = opening(spring, 0.0, dict.fromkeys(spring.ends, 0.0) | place)
    found = []
    if law.initial_z != 0.0:
        found.append(f"spring {spring.name}: its Bouc-Wen material starts from z = 0")
    if x != 0.0:
        found.append(f"spring {spring.name}: its Bouc-Wen material starts from no elongation")
    if math.log10(law.yield_displacement) * -law.exponent > math.log10(OPENSEES_LARGEST):
        found.append(f"spring {spring.name}: 1/u_y^n is too large a number for it")
    if law.strength == law.stiffness == 0.0:
        found.append(f"spring {spring.name}: has no stiffness")
    return found


def _law_problems(scene: Scene, model: Model) -> list[str]:
    """What OpenSees cannot express of contacts with laws of their own."""
    found = []
    for contact, gap in zip(scene.contacts, model.gaps(model.u0), strict=True):
        if contact.law is None:
            continue
        if not contact.law.tension:
            found.append(f"contact {contact.name}: its ViscoelasticGap material may pull")
        if gap < 0.0:
            found.append(f"contact {contact.name}: its material starts from an open gap")
    return found


def _spring_material(spring: Spring) -> Material:
    law = spring.acting
    if isinstance(law, BoucWen):
        initial = law.initial_stiffness
        size = law.yield_displacement**law.exponent
        alpha = law.stiffness / initial
        return (
            "BoucWen", alpha, initial, law.exponent, law.gamma / size, law.beta / size,
            1.0, 0.0, 0.0, 0.0,
        )  # fmt: skip
    return _elastic_material(reduced(law))


def _elastic_material(law: BilinearElastic) -> Material:
    if law.compression == law.extension and law.offset == 0.0:
        return ("Elastic", law.compression)
    far = OPENSEES_FAR + abs(law.offset)
    strain = (law.offset - far, law.offset, law.offset + far)
    stress = (-law.compression * far, 0.0, law.extension * far)
    return ("ElasticMultiLinear", "-strain", *strain, "-stress", *stress)
