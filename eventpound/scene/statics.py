"""Where a scene stands still under its forces: from there a run may start.

The forces of springs and contacts balance those on the bodies; that is where a convex potential
is least (`eventpound.scene.equilibrium`). A Bouc-Wen spring is loaded straight from its initial
state. Of many equilibria the scene takes the nearest to where its bodies are given.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.check import starts_of_supports
from eventpound.scene.elastic_laws import ElasticLaws, as_arrays, elastic_force
from eventpound.scene.equilibrium import NoEquilibriumError, Potential, equilibrium
from eventpound.scene.loaded_straight import Loops, not_convex
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Hysteretic


def in_equilibrium(scene: Scene, start: float = 0.0) -> Scene:
    """The scene with its bodies, and z of its springs, where the forces at the start hold them.

    Parameters
    ----------
    scene : Scene
        A checked scene, whose contacts may be penetrated. Velocities and the ground motion play
        no part.
    start : float
        When the run starts (s): forces and supports are those of that time.

    Raises
    ------
    InputError
        Where there is no equilibrium, as of a body that nothing holds.
    """
    _check(scene)
    springs = _Springs.of(scene)
    given = np.array([body.displacement for body in scene.bodies], float)
    potential = _potential(scene, springs, given, start)
    try:
        u = equilibrium(potential, given)
    except NoEquilibriumError as error:
        raise _none(scene, error) from None
    return _standing(scene, springs, potential.springs @ (u - given), u)


def _refused(found: str, accepted: str) -> InputError:
    return InputError(f'start: found "equilibrium", {found}; accepted: {accepted}')


def _none(scene: Scene, error: NoEquilibriumError) -> InputError:
    """Why a scene has no equilibrium."""
    if error.loose:
        names = ", ".join(repr(scene.bodies[i].name) for i in error.loose)
        return _refused(
            f"but nothing holds the body {names} against its forces",
            '"initial", or a spring or a contact that holds it',
        )
    if error.overlapping:
        names = ", ".join(scene.contacts[i].name for i in error.overlapping)
        return _refused(f"but contacts leave bodies no room ({names})", '"initial", or wider gaps')
    return _refused("which was not found", '"initial"')


def _check(scene: Scene) -> None:
    """Refuse what no convex potential describes."""
    soft = [contact.name for contact in scene.contacts if contact.law is not None]
    if soft:
        raise _refused(
            f"beside the contact {soft[0]!r}, which has a law of its own", "contacts that are rigid"
        )
    for spring in scene.springs:
        if isinstance(spring.law, Hysteretic):
            why = not_convex(spring.law)
            if why:
                raise _refused(f"with the spring {spring.name!r}, which {why[0]}", why[1])


@dataclass(frozen=True)
class _Springs:
    """Springs (S,) as arrays: elastic parts and, of those with a memory, loops."""

    elastic: ElasticLaws
    hysteretic: Ints
    loops: Loops

    @classmethod
    def of(cls, scene: Scene) -> _Springs:
        """Those of a scene."""
        laws = [spring.law for spring in scene.springs]
        loops = {i: law for i, law in enumerate(laws) if isinstance(law, Hysteretic)}
        return cls(
            as_arrays(laws),
            np.array([*loops], np.int64),
            # No other law passes the check.
            Loops.of([law for law in loops.values() if isinstance(law, BoucWen)]),
        )

    def answer(self, x: Floats, x_0: Floats) -> tuple[Floats, Floats]:
        """Forces (N) and slopes (N/m) at elongations, loaded from others (m), all (S,)."""
        force, slope = elastic_force(self.elastic, x)
        pull, growth = self.loops.pull((x - x_0)[self.hysteretic])
        force[self.hysteretic] += pull
        slope[self.hysteretic] += growth
        return force, slope

    @property
    def stiffness(self) -> Floats:
        """The largest of each (N/m)."""
        found = np.maximum(self.elastic.compression, self.elastic.extension)
        found[self.hysteretic] += self.loops.steepest
        return found

    @property
    def far(self) -> Floats:
        """Forces far in compression and far in extension (N), shape (2, S)."""
        sides = np.array((self.elastic.compression, self.elastic.extension))
        found = np.where(sides > 0.0, np.inf, 0.0)
        found[:, self.hysteretic] += self.loops.largest
        return found * np.array([[-1.0], [1.0]])

    @property
    def slack(self) -> Floats:
        """Elongations between which there is no force (m), shape (2, S)."""
        e = self.elastic
        found = np.array(
            (
                np.where(e.compression == 0.0, -np.inf, e.offset),
                np.where(e.extension == 0.0, np.inf, e.offset),
            )
        )
        found[:, self.hysteretic[self.loops.largest > 0.0]] = 0.0
        return found


def _potential(scene: Scene, springs: _Springs, given: Floats, start: float) -> Potential:
    """The potential of a scene whose bodies are given at these displacements (N,)."""
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    placed = starts_of_supports(scene, start)

    def rows(ends: Iterable[Iterable[tuple[str, float]]]) -> tuple[Floats, Floats]:
        of_bodies, by_supports = [], []
        for pairs in ends:
            row = np.zeros(len(index))
            moved = 0.0
            for end, weight in pairs:
                if end in index:
                    row[index[end]] += weight
                moved += weight * placed.get(end, 0.0)
            of_bodies.append(row)
            by_supports.append(moved)
        return np.array(of_bodies).reshape(-1, len(index)), np.array(by_supports)

    B, moved = rows(zip(s.between, (-1.0, 1.0), strict=True) for s in scene.springs)
    W, shifted = rows(contact.direction for contact in scene.contacts)
    gap = np.array([c.gap for c in scene.contacts], float) + shifted
    load = np.zeros(len(index))
    for force in scene.forces:
        i = index[force.body]
        factor = scene.bodies[i].mass if force.per_mass else 1.0
        load[i] += factor * float(force.history.acceleration(np.array(start)))
    x_0 = moved + B @ given
    lengths = (given, gap, x_0, springs.elastic.offset, springs.loops.knee)
    return Potential(
        B,
        W,
        moved,
        gap,
        load,
        lambda x: springs.answer(x, x_0),
        springs.stiffness,
        springs.far,
        springs.slack,
        max(float(np.abs(each).max(initial=0.0)) for each in lengths),
    )


def _standing(scene: Scene, springs: _Springs, travel: Floats, u: Floats) -> Scene:
    """The scene at displacements (N,), its springs loaded by a travel (S,)."""
    z = springs.loops.loaded(travel[springs.hysteretic])[0]
    laws = list(scene.springs)
    for i, each in zip(springs.hysteretic, z, strict=True):
        law = laws[i].law
        if isinstance(law, BoucWen):
            laws[i] = replace(laws[i], law=replace(law, initial_z=float(each)))
    bodies = tuple(
        replace(body, displacement=float(each)) for body, each in zip(scene.bodies, u, strict=True)
    )
    return replace(scene, bodies=bodies, springs=tuple(laws))
