"""Structures written in Π-terms alone, and their scenes.

A row of oscillators of one kind, each on a spring of its own to the ground,
perhaps with a rigid barrier at an end. Oscillator 0 is the one looked at.

    elastic         omega_s                     linear spring
    elastoplastic   uy, Q                       Bouc-Wen without stiffness after yield (eq. 4)
    bilinear        omega_s, uy, Q              Bouc-Wen (eqs 10 to 12)

Neighbours have the terms ``m.1``, ``omega_s.1``, ``uy.1``, ``Q.1``, ... (eqs 14 to
16); without them, the mass, strength and yield displacement of oscillator 0, as
in the founding paper's section 5. Any a_g and omega_g give the same Π_um.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.scene.body import Body
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.parameters import number_places, with_values
from eventpound.scene.pi_columns import Numbers, numbers_with_terms
from eventpound.scene.pi_terms import OTHERS, of_all, pi_terms
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Linear, Spring


class Kind(Enum):
    """Kind of the structures of a row; the value is its word and the terms it needs."""

    ELASTIC = ("elastic", ("omega_s",))
    ELASTOPLASTIC = ("elastoplastic", ("uy", "Q"))
    BILINEAR = ("bilinear", ("omega_s", "uy", "Q"))

    @property
    def word(self) -> str:
        """As a case names it."""
        return self.value[0]

    @property
    def needed(self) -> tuple[str, ...]:
        """Terms of an oscillator."""
        return self.value[1]


@dataclass(frozen=True)
class PiStructure:
    """A row of structures, without its terms.

    Parameters
    ----------
    kind : Kind
        Of all of them.
    row : tuple of str
        From left to right: numbers of oscillators, ``"0"`` among them, and
        ``"barrier"`` at an end or both. What stands side by side can touch.

    Raises
    ------
    InputError
        For another row.
    """

    kind: Kind
    row: tuple[str, ...]

    def __post_init__(self) -> None:
        numbers = [place for place in self.row if place != BARRIER]
        expected = {str(i) for i in range(len(numbers))}
        if BARRIER in self.row[1:-1] or not numbers or set(numbers) != expected:
            raise InputError(
                f"row: found {list(self.row)}; accepted: the oscillators 0, 1, ... from left to "
                f'right, each once, "{BARRIER}" at either end'
            )

    @property
    def oscillators(self) -> tuple[str, ...]:
        """Names in the order of their numbers."""
        return tuple(sorted((p for p in self.row if p != BARRIER), key=int))

    @property
    def needed(self) -> tuple[str, ...]:
        """Terms without which there is no scene."""
        needed = list(self.kind.needed)
        if "omega_s" in needed:
            needed += [f"omega_s.{i}" for i in self.oscillators[1:]]
        return (*needed, *(("delta", "epsilon") if len(self.row) > 1 else ()))

    def skeleton(self, motion: GroundMotion, mass: float = 1.0) -> Scene:
        """Scene of this row in which all terms have some value.

        Parameters
        ----------
        motion : GroundMotion
            The ground motion.
        mass : float
            m_0 (kg).
        """
        law: Linear | BoucWen
        match self.kind:
            case Kind.ELASTIC:
                law = Linear(mass)
            case Kind.ELASTOPLASTIC:
                law = BoucWen(0.0, mass, 1.0)
            case Kind.BILINEAR:
                law = BoucWen(mass, mass, 1.0)
        return Scene(
            tuple(Body(name, mass) for name in self.oscillators),
            tuple(Spring(name, (GROUND, name), law) for name in self.oscillators),
            (),
            tuple(
                Contact(f"{left}-{right}", left, right, 1.0, 1.0)
                for left, right in pairwise(self.row)
            ),
            motion,
        )

    def resolved(self, scene: Scene, terms: Mapping[str, Numbers]) -> dict[str, Numbers]:
        """Every term of the row, those of neighbours that are not given like oscillator 0's.

        Parameters
        ----------
        scene : Scene
            The skeleton or any scene of this row.
        terms : mapping
            Given terms; ``omega_s.i`` and the like for all neighbours.

        Raises
        ------
        InputError
            For every term that is missing or that this row does not have.
        """
        defaults: dict[str, Numbers] = {f"m.{OTHERS}": 1.0} if len(self.oscillators) > 1 else {}
        for term in ("uy", "Q"):
            if term in terms and len(self.oscillators) > 1:
                defaults[f"{term}.{OTHERS}"] = terms[term]
        resolved = of_all(scene, defaults | dict(terms))
        given = of_all(scene, dict.fromkeys(terms, 0.0))
        present = pi_terms(scene)
        if self.kind is Kind.ELASTOPLASTIC:
            present = {key: v for key, v in present.items() if key.partition(".")[0] != "omega_s"}
        needed = of_all(scene, dict.fromkeys(self.needed, 0.0))
        problems = [
            f"{key}: missing; this structure needs it" for key in needed if key not in given
        ]
        problems += [
            f"{key}: this structure has no such term; it has {', '.join(present)}"
            for key in given
            if key not in present
        ]
        if problems:
            raise InputError(problems)
        return resolved

    def scene(self, motion: GroundMotion, terms: Mapping[str, float], mass: float = 1.0) -> Scene:
        """Scene with given Π-terms.

        Parameters
        ----------
        motion : GroundMotion
            A motion with scales a_g and omega_g, any.
        terms : mapping
            Π-terms by the keys of `eventpound.scene.pi_terms`.
        mass : float
            m_0 (kg), any.

        Raises
        ------
        InputError
            For every term that is missing or that this row does not have, and
            for a motion without scales.
        """
        if motion.scales() is None:
            raise InputError("the ground motion has no scales, so Π-terms give no scene")
        skeleton = self.skeleton(motion, mass)
        numbers = numbers_with_terms(skeleton, self.resolved(skeleton, terms))
        places = number_places(skeleton)
        return with_values(skeleton, {places[key]: float(v) for key, v in numbers.items()})
