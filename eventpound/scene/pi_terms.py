"""Dimensionless Π-terms of a scene; `pi_columns` has the scene with given ones.

With the acceleration a_g (m/s^2) and the angular frequency omega_g (rad/s) of
the ground motion, and so the length L_e = a_g / omega_g^2 (m):

    Pi_delta   = delta / L_e          gap of a contact                    (eq. 8)
    Pi_eps     = epsilon              its coefficient of restitution      (eq. 8)
    Pi_uy      = u_y / L_e            yield displacement                  (eq. 8)
    Pi_Q       = Q / (m a_g)          strength                            (eq. 8)
    Pi_omega_s = omega_s / omega_g    post-yield angular frequency        (eq. 12)

and for every further oscillator i, with 0 the one looked at,

    Pi_m,i = m_0 / m_i,    Pi_omega_s,i = omega_s,0 / omega_s,i           (eq. 16)

beside its own Pi_uy,i and Pi_Q,i. Source: the founding paper, section 2 to 4. A support that moves
later by a time tau has

    Pi_tau     = tau omega_g

Keys are ``omega_s``, ``uy``, ``Q`` for the oscillator looked at and
``m.<body>``, ``omega_s.<body>``, ``uy.<body>``, ``Q.<body>`` for the others;
``delta`` and ``epsilon`` for the only contact of a scene, ``delta.<contact>``
and ``epsilon.<contact>`` for one of several; ``delay`` and ``delay.<support>`` likewise. A support
with a motion of its own has no term: its numbers stay as they are.

An oscillator's own spring is its only linear or Bouc-Wen spring to the ground or to a support:
a body with none of them, or with several, has no omega_s, u_y and Q, nor has one with P-Delta or
in a frame. A perfectly plastic one has Pi_omega_s = 0; a ratio with it is left out. Beside decks
in plan, which are no oscillators, contacts alone have terms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeVar

from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Linear, Spring
from eventpound.scene.support import Support

OTHERS = "i"
"""What stands in a key for the name of every oscillator but the one looked at."""
_OF_CONTACTS = ("delta", "epsilon")
_OF_SUPPORTS = "delay"
Value = TypeVar("Value")


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
    first = looked_at(scene, oscillator)
    terms: dict[str, float] = {}
    for body in sorted(scene.bodies, key=lambda body: body is not first):
        terms |= {} if scene.decks else _oscillator_terms(scene, body, first)
    for contact in scene.contacts:
        terms |= _contact_terms(scene, contact)
    scales = scene.motion.scales()
    if scales is not None:
        delays = {support_key(scene, s): s.delay for s in scene.supports if s.delay is not None}
        terms |= {key: delay * scales.omega_g for key, delay in delays.items()}
    return terms


def number_of_terms(scene: Scene) -> int | None:
    """How many Π-terms govern the peak of a body, with that of the peak itself.

    None of a scene without scales, or with decks in plan, whose terms are not all known.

    5 of an elasto-plastic oscillator beside a barrier (eq. 6), 10 and 14 of two and three bilinear
    ones in a row (eq. 14): a gap or a restitution that all contacts share is one term, and a
    perfectly plastic spring has no omega_s.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    if scene.decks or scene.motion.scales() is None:
        return None
    terms = pi_terms(scene)
    shared = {
        (stem, terms[key])
        for contact in scene.contacts
        for stem in _OF_CONTACTS
        if (key := contact_key(scene, stem, contact)) in terms
    }
    keys = {contact_key(scene, stem, c) for c in scene.contacts for stem in _OF_CONTACTS}
    others = [key for key in terms if key not in keys and (key, terms[key]) != ("omega_s", 0.0)]
    return 1 + len(others) + len(shared)


def of_all(scene: Scene, terms: Mapping[str, Value]) -> dict[str, Value]:
    """Terms with those said of all written out for each.

    Parameters
    ----------
    scene : Scene
        Whose bodies and contacts they are.
    terms : mapping
        By the keys of this module, and by ``m.i``, ``omega_s.i``, ``uy.i`` and
        ``Q.i`` for all oscillators but the one looked at, and ``delta`` and
        ``epsilon`` for all contacts, ``delay`` for all supports that have one. A term said of
        one goes before. The body looked at is the first one.

    Returns
    -------
    dict
        Terms by the keys of this module only.
    """
    others = [body.name for body in scene.bodies[1:]]
    written: dict[str, Value] = {}
    for key, value in terms.items():
        stem, _, which = key.partition(".")
        if which == OTHERS and OTHERS not in others:
            keys = [f"{stem}.{name}" for name in others]
        elif not which and stem in _OF_CONTACTS:
            keys = [contact_key(scene, stem, contact) for contact in scene.contacts] or [key]
        elif key == _OF_SUPPORTS:
            keys = [support_key(scene, each) for each in delayed_supports(scene)] or [key]
        else:
            keys = [key]
        written |= {each: value for each in keys if each == key or each not in terms}
    return written


def looked_at(scene: Scene, oscillator: str | None) -> Body:
    """The body that terms are seen from: the first one, or that of a name."""
    if oscillator is None:
        return scene.bodies[0]
    for body in scene.bodies:
        if body.name == oscillator:
            return body
    names = ", ".join(body.name for body in scene.bodies)
    raise InputError(f"oscillator {oscillator!r}: no body has this name; bodies are {names}")


def own_spring(scene: Scene, body: str) -> Spring | None:
    """The only linear or Bouc-Wen spring of a body to what moves it; None without, or with more."""
    fixed = {GROUND} | {support.name for support in scene.supports}
    own = [
        spring
        for spring in scene.springs
        if body in spring.ends
        and not spring.at_point
        and not fixed.isdisjoint(spring.ends)
        and isinstance(spring.law, Linear | BoucWen)
        and spring.weight is None
        and spring.frame is None
        and spring.law.stiffness >= 0.0
    ]
    return own[0] if len(own) == 1 else None


def _angular_frequency(scene: Scene, body: Body) -> float:
    """omega_s (rad/s) of a body on its own spring; zero where it has none."""
    spring = own_spring(scene, body.name)
    if spring is None or not isinstance(spring.law, Linear | BoucWen):
        return 0.0
    return math.sqrt(spring.law.stiffness / body.mass)


def _key(term: str, body: str, first: str) -> str:
    return term if body == first else f"{term}.{body}"


def contact_key(scene: Scene, term: str, contact: Contact) -> str:
    """Key of a term of a contact, which is not named where it is the only one."""
    return term if len(scene.contacts) == 1 else f"{term}.{contact.name}"


def delayed_supports(scene: Scene) -> list[Support]:
    """Supports that have a delay, perhaps none."""
    return [support for support in scene.supports if support.delay is not None]


def support_key(scene: Scene, support: Support) -> str:
    """Key of the delay of a support, which is not named where it is the only one."""
    return "delay" if len(delayed_supports(scene)) == 1 else f"delay.{support.name}"


def _oscillator_terms(scene: Scene, body: Body, first: Body) -> dict[str, float]:
    terms: dict[str, float] = {}
    scales = scene.motion.scales()
    spring = own_spring(scene, body.name)
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
        inertia = body.mass * scales.a_g  # zero where the product is too small for a double
        strength = law.strength / inertia if inertia > 0.0 else math.inf
        terms[_key("Q", body.name, first.name)] = strength
    return terms


def _contact_terms(scene: Scene, contact: Contact) -> dict[str, float]:
    terms = {}
    scales = scene.motion.scales()
    if scales is not None:
        terms[contact_key(scene, "delta", contact)] = contact.gap / scales.length
    if contact.law is None and contact.restitution is not None:
        terms[contact_key(scene, "epsilon", contact)] = contact.restitution
    return terms
