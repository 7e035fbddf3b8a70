"""Dimensionless Π-terms of a scene, and the scene that has given ones.

With the acceleration a_g (m/s^2) and the angular frequency omega_g (rad/s) of
the ground motion, and so the length L_e = a_g / omega_g^2 (m):

    Pi_delta   = delta / L_e          gap of a contact                    (eq. 8)
    Pi_eps     = epsilon              its coefficient of restitution      (eq. 8)
    Pi_uy      = u_y / L_e            yield displacement                  (eq. 8)
    Pi_Q       = Q / (m a_g)          strength                            (eq. 8)
    Pi_omega_s = omega_s / omega_g    post-yield angular frequency        (eq. 12)

and for every further oscillator i, with 0 the one looked at,

    Pi_m,i = m_0 / m_i,    Pi_omega_s,i = omega_s,0 / omega_s,i           (eq. 16)

beside its own Pi_uy,i and Pi_Q,i. Source: the founding paper, section 2 to 4.

Keys are ``omega_s``, ``uy``, ``Q`` for the oscillator looked at and
``m.<body>``, ``omega_s.<body>``, ``uy.<body>``, ``Q.<body>`` for the others;
``delta`` and ``epsilon`` for the only contact of a scene, ``delta.<contact>``
and ``epsilon.<contact>`` for one of several.

An oscillator's own spring is its only linear or Bouc-Wen spring to the ground:
a body with none of them, or with several, has no omega_s, u_y and Q. A
perfectly plastic one has Pi_omega_s = 0; a ratio with it is left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Linear, Spring


def pi_terms(scene: Scene, oscillator: str | None = None) -> dict[str, float]:
    """Π-terms of a scene; only those of what it has.

    Parameters
    ----------
    scene : Scene
        Without a ground motion only the terms that need no scale are given.
    oscillator : str, optional
        Name of the body looked at; the first one by default.

    Returns
    -------
    dict
        Π-terms by the keys of this module (dimensionless).

    Raises
    ------
    InputError
        Where no body has the name `oscillator`.
    """
    first = _looked_at(scene, oscillator)
    terms: dict[str, float] = {}
    for body in (first, *_others(scene, first)):
        terms |= _oscillator_terms(scene, body, first)
    for contact in scene.contacts:
        terms |= _contact_terms(scene, contact)
    return terms


def peak_term(scene: Scene, peak: float) -> float | None:
    """Π_um = u_peak / L_e (eq. 8), or None where no ground motion sets a length.

    Parameters
    ----------
    scene : Scene
        What moves.
    peak : float
        Largest |u| of a body (m).
    """
    scales = scene.motion.scales()
    return None if scales is None else peak / scales.length


def with_pi_terms(scene: Scene, terms: Mapping[str, float], oscillator: str | None = None) -> Scene:
    """Scene with the given Π-terms; its other Π-terms keep their values.

    The ground motion and the mass of the oscillator looked at stay, and so do
    dashpots, initial states and all springs that no Π-term describes.

    Parameters
    ----------
    scene : Scene
        Has to have, with some value, every term that is to be set.
    terms : mapping
        New values by the keys of this module (dimensionless).
    oscillator : str, optional
        Name of the body looked at; the first one by default.

    Raises
    ------
    InputError
        For a body that does not exist and for every term the scene lacks.
    """
    first = _looked_at(scene, oscillator)
    present = pi_terms(scene, first.name)
    unknown = [name for name in terms if name not in present]
    if unknown:
        raise InputError(
            [
                f"Π-term {name!r}: this scene has no such term; it has {', '.join(present)}"
                for name in unknown
            ]
        )
    wanted = present | dict(terms)
    bodies = tuple(
        body if body is first else replace(body, mass=first.mass / wanted[f"m.{body.name}"])
        for body in scene.bodies
    )
    rebuilt = replace(scene, bodies=bodies)
    return replace(
        rebuilt,
        springs=tuple(_rebuilt_spring(rebuilt, s, wanted, first.name) for s in scene.springs),
        contacts=tuple(_rebuilt_contact(scene, c, wanted) for c in scene.contacts),
    )


def _looked_at(scene: Scene, oscillator: str | None) -> Body:
    if oscillator is None:
        return scene.bodies[0]
    for body in scene.bodies:
        if body.name == oscillator:
            return body
    names = ", ".join(body.name for body in scene.bodies)
    raise InputError(f"oscillator {oscillator!r}: no body has this name; bodies are {names}")


def _others(scene: Scene, first: Body) -> tuple[Body, ...]:
    return tuple(body for body in scene.bodies if body is not first)


def _own_spring(scene: Scene, body: str) -> Spring | None:
    own = [
        spring
        for spring in scene.springs
        if set(spring.between) == {GROUND, body} and isinstance(spring.law, Linear | BoucWen)
    ]
    return own[0] if len(own) == 1 else None


def _angular_frequency(scene: Scene, body: Body) -> float:
    """omega_s (rad/s) of a body on its own spring; zero where it has none."""
    spring = _own_spring(scene, body.name)
    if spring is None or not isinstance(spring.law, Linear | BoucWen):
        return 0.0
    return math.sqrt(spring.law.stiffness / body.mass)


def _key(term: str, body: str, first: str) -> str:
    return term if body == first else f"{term}.{body}"


def _contact_key(scene: Scene, term: str, contact: Contact) -> str:
    return term if len(scene.contacts) == 1 else f"{term}.{contact.name}"


def _oscillator_terms(scene: Scene, body: Body, first: Body) -> dict[str, float]:
    terms: dict[str, float] = {}
    scales = scene.motion.scales()
    spring = _own_spring(scene, body.name)
    omega_s = _angular_frequency(scene, body)
    if body is not first:
        terms[f"m.{body.name}"] = first.mass / body.mass
        omega_s0 = _angular_frequency(scene, first)
        if omega_s > 0.0 and omega_s0 > 0.0:
            terms[f"omega_s.{body.name}"] = omega_s0 / omega_s
    elif spring is not None and scales is not None:
        terms["omega_s"] = omega_s / scales.omega_g
    if spring is not None and isinstance(spring.law, BoucWen) and scales is not None:
        law = spring.law
        terms[_key("uy", body.name, first.name)] = law.yield_displacement / scales.length
        terms[_key("Q", body.name, first.name)] = law.strength / (body.mass * scales.a_g)
    return terms


def _contact_terms(scene: Scene, contact: Contact) -> dict[str, float]:
    terms = {}
    scales = scene.motion.scales()
    if scales is not None:
        terms[_contact_key(scene, "delta", contact)] = contact.gap / scales.length
    terms[_contact_key(scene, "epsilon", contact)] = contact.restitution
    return terms


def _rebuilt_spring(scene: Scene, spring: Spring, terms: Mapping[str, float], first: str) -> Spring:
    """Spring whose law has the wanted terms; the bodies have their new masses already."""
    body = next((b for b in scene.bodies if _own_spring(scene, b.name) is spring), None)
    if body is None:
        return spring
    law = spring.law
    scales = scene.motion.scales()
    omega_s = _wanted_frequency(scene, body, terms, first)
    if omega_s is not None and isinstance(law, Linear | BoucWen):
        law = replace(law, stiffness=body.mass * omega_s**2)
    if isinstance(law, BoucWen) and scales is not None:
        law = replace(
            law,
            yield_displacement=terms[_key("uy", body.name, first)] * scales.length,
            strength=terms[_key("Q", body.name, first)] * body.mass * scales.a_g,
        )
    return replace(spring, law=law)


def _wanted_frequency(
    scene: Scene, body: Body, terms: Mapping[str, float], first: str
) -> float | None:
    """omega_s (rad/s) the terms ask of a body; None where they don't say."""
    scales = scene.motion.scales()
    if "omega_s" in terms and scales is not None:
        omega_s0 = terms["omega_s"] * scales.omega_g
    else:
        omega_s0 = _angular_frequency(scene, _looked_at(scene, first))
    if body.name == first:
        return omega_s0 if "omega_s" in terms else None
    key = f"omega_s.{body.name}"
    return omega_s0 / terms[key] if key in terms else None


def _rebuilt_contact(scene: Scene, contact: Contact, terms: Mapping[str, float]) -> Contact:
    scales = scene.motion.scales()
    restitution = terms[_contact_key(scene, "epsilon", contact)]
    if scales is None:
        return replace(contact, restitution=restitution)
    gap = terms[_contact_key(scene, "delta", contact)] * scales.length
    return replace(contact, gap=gap, restitution=restitution)
