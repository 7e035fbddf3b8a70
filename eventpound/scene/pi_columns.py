"""Numbers of many scenes from their Π-terms, a column each: the terms of `pi_terms` solved.

    delta = Pi_delta L_e              u_y = Pi_uy L_e           Q = Pi_Q m a_g
    omega_s,0 = Pi_omega_s omega_g    omega_s,i = omega_s,0 / Pi_omega_s,i
    m_i = m_0 / Pi_m,i                k = m omega_s^2           tau = Pi_tau / omega_g

(the founding paper's eqs 8, 12 and 16, with L_e = a_g / omega_g^2). What no
given term describes keeps its number, except that a structure whose mass
changes keeps omega_s and Pi_Q, and one whose neighbour 0 gets another omega_s
keeps their ratio.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.scene.body import Body
from eventpound.scene.parameters import motion_with, number_places, value_at
from eventpound.scene.pi_terms import (
    contact_key,
    delayed_supports,
    looked_at,
    own_spring,
    pi_terms,
    support_key,
)
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Linear, Spring

Numbers = float | Floats
"""One value, or one a variant."""


@dataclass(frozen=True)
class ScaleColumns:
    """a_g (m/s^2) and omega_g (rad/s) of variants, shape (n,) or one for all."""

    a_g: Numbers
    omega_g: Numbers

    @property
    def length(self) -> Numbers:
        """L_e = a_g / omega_g^2 (m)."""
        return self.a_g / self.omega_g**2

    def rows(self, chosen: Ints, count: int) -> ScaleColumns:
        """Those of some of `count` variants."""
        a_g, omega_g = (np.broadcast_to(x, (count,))[chosen] for x in (self.a_g, self.omega_g))
        return ScaleColumns(a_g, omega_g)


def scale_columns(scene: Scene, columns: Mapping[str, Floats]) -> ScaleColumns | None:
    """Scales of the ground motions of variants.

    Parameters
    ----------
    scene : Scene
        What they have in common.
    columns : mapping of str to ndarray, shape (n,)
        Numbers that differ, by their dotted keys.

    Returns
    -------
    ScaleColumns or None
        None for a motion without scales.

    Raises
    ------
    InputError
        Where the motion refuses a number.
    """
    places = number_places(scene) if columns else {}
    shaking = {places[key]: v for key, v in columns.items() if places[key].kind == "excitation"}
    scales = scene.motion.scales()
    if scales is None or not shaking:
        return None if scales is None else ScaleColumns(scales.a_g, scales.omega_g)
    first, which = distinct(list(shaking.values()), len(next(iter(shaking.values()))))
    found = []
    for i in first.tolist():
        of_one = motion_with(scene.motion, {p: float(v[i]) for p, v in shaking.items()}).scales()
        found.append((np.nan, np.nan) if of_one is None else (of_one.a_g, of_one.omega_g))
    a_g, omega_g = np.array(found)[which].T
    return ScaleColumns(a_g, omega_g)


def numbers_with_terms(
    scene: Scene, terms: Mapping[str, Numbers], columns: Mapping[str, Floats] | None = None
) -> dict[str, Numbers]:
    """Numbers that give variants of a scene the given Π-terms.

    Parameters
    ----------
    scene : Scene
        Has to have, with some value, every term that is to be set.
    terms : mapping of str to float or ndarray, shape (n,)
        New values by the keys of `eventpound.scene.pi_terms` (dimensionless).
    columns : mapping of str to ndarray, shape (n,), optional
        Numbers that differ otherwise, by their dotted keys; they come first.

    Returns
    -------
    dict
        New numbers (SI) by dotted keys, those of `columns` not among them
        unless a term changes them.

    Raises
    ------
    InputError
        For every term the scene lacks.
    """
    first = looked_at(scene, None)
    present = pi_terms(scene, first.name)
    unknown = [name for name in terms if name not in present]
    if unknown:
        raise InputError(
            [
                f"Π-term {name!r}: this scene has no such term; it has {', '.join(present)}"
                for name in unknown
            ]
        )
    solving = _Solving(scene, first, terms, columns or {})
    for body in sorted(scene.bodies, key=lambda body: body is not first):
        solving.oscillator(body)
    solving.contacts()
    solving.supports()
    return solving.found


class _Solving:
    """The numbers of one set of terms, found oscillator by oscillator."""

    def __init__(
        self, scene: Scene, first: Body, terms: Mapping[str, Numbers], columns: Mapping[str, Floats]
    ) -> None:
        self.scene, self.first, self.terms = scene, first, terms
        self.columns, self.places = columns, number_places(scene)
        self.scales = scale_columns(scene, columns)
        self.found: dict[str, Numbers] = {}

    def given(self, key: str) -> Numbers:
        """A number as it is without the terms."""
        if key in self.columns:
            return self.columns[key]
        return float(value_at(self.scene, self.places[key]))

    def oscillator(self, body: Body) -> None:
        """Mass, stiffness, strength and yield displacement of one body and its own spring."""
        name, mass_key = body.name, f"body.{body.name}.mass"
        old_mass = mass = self.given(mass_key)
        if f"m.{name}" in self.terms:
            mass = self.given(f"body.{self.first.name}.mass") / self.terms[f"m.{name}"]
            self.found[mass_key] = mass
        spring = own_spring(self.scene, name)
        if spring is None:
            return
        key, suffix = f"spring.{spring.name}", "" if body is self.first else f".{name}"
        omega = self._frequency(body, spring)
        if omega is not None:
            self.found[f"{key}.stiffness"] = mass * omega**2
        if isinstance(spring.law, BoucWen) and self.scales is not None:
            if f"Q{suffix}" in self.terms:
                self.found[f"{key}.strength"] = self.terms[f"Q{suffix}"] * mass * self.scales.a_g
            elif mass_key in self.found:
                self.found[f"{key}.strength"] = self.given(f"{key}.strength") * mass / old_mass
            if f"uy{suffix}" in self.terms:
                length = self.scales.length
                self.found[f"{key}.yield_displacement"] = self.terms[f"uy{suffix}"] * length

    def _frequency(self, body: Body, spring: Spring) -> Numbers | None:
        """New omega_s (rad/s) of a body; None where its stiffness stays."""
        own, new_first = self._old_frequency(body, spring), self._first_frequency()
        if body is self.first:
            return new_first if "omega_s" in self.terms else None
        if f"omega_s.{body.name}" in self.terms:
            return new_first / self.terms[f"omega_s.{body.name}"]
        of_first = own_spring(self.scene, self.first.name)
        if "omega_s" in self.terms and of_first is not None:
            old_first = self._old_frequency(self.first, of_first)
            if np.all(np.asarray(old_first) > 0.0):
                return own * (new_first / old_first)
        return own if f"m.{body.name}" in self.terms else None

    def _first_frequency(self) -> Numbers:
        if "omega_s" in self.terms and self.scales is not None:
            return self.terms["omega_s"] * self.scales.omega_g
        spring = own_spring(self.scene, self.first.name)
        return 0.0 if spring is None else self._old_frequency(self.first, spring)

    def _old_frequency(self, body: Body, spring: Spring) -> Numbers:
        assert isinstance(spring.law, Linear | BoucWen)
        stiffness = self.given(f"spring.{spring.name}.stiffness")
        frequency: Numbers = np.sqrt(stiffness / self.given(f"body.{body.name}.mass"))
        return frequency

    def contacts(self) -> None:
        """Gap and restitution of the contacts."""
        for contact in self.scene.contacts:
            delta = contact_key(self.scene, "delta", contact)
            epsilon = contact_key(self.scene, "epsilon", contact)
            if delta in self.terms and self.scales is not None:
                self.found[f"contact.{contact.name}.gap"] = self.terms[delta] * self.scales.length
            if epsilon in self.terms:
                self.found[f"contact.{contact.name}.restitution"] = self.terms[epsilon]

    def supports(self) -> None:
        """Delays of the supports."""
        for support in delayed_supports(self.scene):
            key = support_key(self.scene, support)
            if key in self.terms and self.scales is not None:
                self.found[f"support.{support.name}.delay"] = self.terms[key] / self.scales.omega_g
