"""A scene as OpenSees's zero-length elements: which material between which nodes.

Node 1 is the ground (and every barrier), fixed; node b + 2 is body b with its mass. The
strain of an element is the displacement of its second node less that of its first, which
is our elongation and, for a contact, the opening of its gap.

Bouc-Wen: OpenSees has ``F = α K_0 x + (1 - α) K_0 w`` with ``w' = x' - (γ' |x'| w |w|^(n-1)
+ β' x' |w|^n)``, w a length; with ``w = u_y z`` this is ours for ``K_0 = k + Q/u_y``,
``α = k/K_0``, ``β' = β/u_y^n``, ``γ' = γ/u_y^n``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from eventpound.errors import InputError
from eventpound.mechanics.model import Model
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BilinearElastic, BoucWen, Spring
from eventpound.solvers.opensees.contacts import (
    ContactChoice,
    Material,
    contact_material,
    element_material,
)
from eventpound.tolerances import OPENSEES_FAR, OPENSEES_LARGEST

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
        f"dashpot {' - '.join(d.between)}: its Viscous material is not negative"
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
    first, second = (place.get(end, 0.0) for end in spring.between)
    found = []
    if law.initial_z != 0.0:
        found.append(f"spring {spring.name}: its Bouc-Wen material starts from z = 0")
    if first != second:
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
    law = spring.law
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
