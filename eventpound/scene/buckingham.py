"""Buckingham's theorem applied to a scene: its Π-terms found from units alone.

n variables with r independent dimensions make n - r dimensionless products
(E. Buckingham, Physical Review 4 (1914), 345-376). Pint's `pi_theorem` gives
one basis of them; here it is turned into the basis in which every variable
but the repeating ones a_g, omega_g and m_0 stands in one product only, to the
power one: u_max omega_g^2 / a_g, delta omega_g^2 / a_g, Q / (m_0 a_g), ...,
as in the founding paper's eqs 6, 8 and 14.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound.errors import InputError
from eventpound.scene.pi_terms import (
    contact_key,
    delayed_supports,
    looked_at,
    own_spring,
    support_key,
)
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Linear
from eventpound.units import registry

REPEATING = ("a_g", "omega_g", "m")
"""Variables that make the others dimensionless; m is the mass of the oscillator looked at."""
PEAK = "u_max"
"""The variable asked for; it has no value in a scene."""


@dataclass(frozen=True)
class Variable:
    """A dimensional variable of a problem.

    Parameters
    ----------
    unit : str
        Its SI unit.
    value : float or None
        In this unit; None for the one asked for.
    """

    unit: str
    value: float | None


@dataclass(frozen=True)
class Product:
    """A dimensionless product of variables.

    Parameters
    ----------
    exponents : mapping of str to float
        Of the variables in it; that of the variable it is named after is 1.
    value : float or None
        None where the one asked for is in it.
    """

    exponents: Mapping[str, float]
    value: float | None


def variables_of(scene: Scene, oscillator: str | None = None) -> dict[str, Variable]:
    """Variables that the peak displacement of a body depends on, and the peak itself.

    Parameters
    ----------
    scene : Scene
        Oscillators on springs of their own, perhaps with contacts.
    oscillator : str, optional
        Name of the body looked at; the first one by default.

    Returns
    -------
    dict
        By the keys of the Π-terms, without their numbers of no dimension.

    Raises
    ------
    InputError
        For a motion without scales.
    """
    scales = scene.motion.scales()
    if scales is None:
        raise InputError("the ground motion has no scales a_g and omega_g")
    first = looked_at(scene, oscillator)
    variables = {
        PEAK: Variable("m", None),
        "a_g": Variable("m/s^2", scales.a_g),
        "omega_g": Variable("1/s", scales.omega_g),
    }
    for body in scene.bodies:
        which = "" if body is first else f".{body.name}"
        variables[f"m{which}"] = Variable("kg", body.mass)
        spring = own_spring(scene, body.name)
        law = None if spring is None else spring.law
        if isinstance(law, Linear | BoucWen):
            omega_s = float(np.sqrt(law.stiffness / body.mass))
            variables[f"omega_s{which}"] = Variable("1/s", omega_s)
        if isinstance(law, BoucWen):
            variables[f"uy{which}"] = Variable("m", law.yield_displacement)
            variables[f"Q{which}"] = Variable("N", law.strength)
    for contact in scene.contacts:
        variables[contact_key(scene, "delta", contact)] = Variable("m", contact.gap)
    for support in delayed_supports(scene):
        variables[support_key(scene, support)] = Variable("s", support.delay)
    return variables


def pi_products(variables: Mapping[str, Variable]) -> dict[str, Product]:
    """Dimensionless products, one for each variable that does not repeat.

    Parameters
    ----------
    variables : mapping of str to Variable
        Those that repeat among them.

    Returns
    -------
    dict
        By the names of the variables they are named after; as many as there
        are variables less independent dimensions.

    Raises
    ------
    InputError
        Where the repeating variables cannot make the others dimensionless.
    """
    units: Any = registry()
    names = list(variables)
    basis = units.pi_theorem({name: units.Unit(v.unit) for name, v in variables.items()})
    exponents = np.array([[float(group.get(name, 0)) for name in names] for group in basis])
    others = [i for i, name in enumerate(names) if name not in REPEATING]
    square = exponents[:, others]
    if square.shape[0] != square.shape[1] or abs(np.linalg.det(square)) < 1e-9:
        raise InputError(f"{', '.join(REPEATING)} do not make the other variables dimensionless")
    solved = np.linalg.solve(square, exponents)
    products = {}
    for row, name in zip(solved, (names[i] for i in others), strict=True):
        # Exponents are ratios of small whole numbers; solving leaves roundings on them.
        powers = {n: round(float(p), 9) for n, p in zip(names, row, strict=True) if abs(p) > 1e-9}
        products[name] = Product(powers, _value(variables, powers))
    return products


def _value(variables: Mapping[str, Variable], powers: Mapping[str, float]) -> float | None:
    """Value of a product, by quantities with units: a product with a dimension is an error."""
    units = registry()
    product = units.Quantity(1.0, "")
    for name, power in powers.items():
        value = variables[name].value
        if value is None:
            return None
        product = product * units.Quantity(value, variables[name].unit) ** power
    return float(product.to("dimensionless").magnitude)
