"""Where a scene stands still under its forces: from there a run may start.

The forces of springs and contacts balance those on the bodies; that is where a convex potential
is least (`eventpound.scene.equilibrium`). A spring with a memory is loaded straight from its
initial state; a slider sticks there as long as its friction holds it. Of many equilibria the scene
takes the nearest to where its bodies are given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.elastic_laws import ElasticLaws, as_arrays, elastic_force
from eventpound.scene.equilibrium import CERTAIN, NoEquilibriumError, Potential, equilibrium
from eventpound.scene.linkage import Linkage, linkage_of
from eventpound.scene.loaded_straight import Loops, Soils, Worn
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Backfill, BoucWen, DegradingBoucWen, Law, Slider
from eventpound.scene.stability import gives_way


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
    link = linkage_of(scene, start)
    given = np.array([body.displacement for body in scene.bodies], float)
    springs = _Springs.of(scene, link.moved + link.springs @ given)
    _check_softest(scene, springs.softest, link.springs)
    potential = _potential(scene, springs, link, given)
    try:
        u = equilibrium(potential, given)
    except NoEquilibriumError as error:
        raise _none(scene, error, springs.softened()) from None
    if past := springs.softened(potential.elongations(u)):
        raise _none(scene, NoEquilibriumError(), past)
    laws = springs.loaded(potential.elongations(u))
    return replace(
        scene,
        bodies=tuple(
            replace(body, displacement=float(at)) for body, at in zip(scene.bodies, u, strict=True)
        ),
        springs=tuple(
            replace(spring, law=law) for spring, law in zip(scene.springs, laws, strict=True)
        ),
    )


def placed_again(scene: Scene, start: float) -> Scene:
    """The scene in an equilibrium of its own, after its contacts became others.

    It stays as it is where it has none: what only a contact held moves from the start.
    """
    try:
        return in_equilibrium(scene, start)
    except InputError:
        return scene


def _refused(found: str, accepted: str) -> InputError:
    return InputError(f'start: found "equilibrium", {found}; accepted: {accepted}')


def _none(scene: Scene, error: NoEquilibriumError, softened: Sequence[int]) -> InputError:
    """Why a scene has no equilibrium, where springs perhaps lost too much of their strength."""
    if softened:
        names = ", ".join(repr(scene.springs[i].name) for i in softened)
        found = f"but forces go beyond what degrading springs bear ({names})"
        return _refused(found, '"initial", or smaller forces')
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
        law = spring.law
        if isinstance(law, BoucWen) and law.gamma < 0.0:
            found = f"which unloads with a negative stiffness (gamma = {law.gamma!r})"
            raise _refused(f"with the spring {spring.name!r}, {found}", "gamma >= 0")


def _check_softest(scene: Scene, softest: Floats, springs: Floats) -> None:
    """Refuse negative stiffnesses that leave the potential other than convex, or no bodies held.

    softest (S,): smallest stiffnesses (N/m); springs (S, N): what displacements elongate.
    """
    if not (softest < 0.0).any():
        return
    K, whole = ((springs.T * each) @ springs for each in (softest, abs(softest)))
    held, joined = (np.linalg.matrix_rank(each, CERTAIN * whole.max()) for each in (K, whole))
    if gives_way(K, whole.diagonal()) is not None or held < joined:
        names = ", ".join(repr(scene.springs[i].name) for i in np.flatnonzero(softest < 0.0)[:8])
        raise _refused(
            f"beside negative stiffnesses ({names}) that may be more than what others keep after "
            "they yield or are slack",
            '"initial"',
        )


@dataclass(frozen=True)
class _Springs:
    """Springs (S,) as arrays: elastic parts, and those with a memory, loaded straight from x_0."""

    laws: Sequence[Law]
    elastic: ElasticLaws
    x_0: Floats
    yielding: Ints
    loops: Loops
    worn: Mapping[int, tuple[Worn, Worn]]
    soil: Ints
    soils: Soils

    @classmethod
    def of(cls, scene: Scene, x_0: Floats) -> _Springs:
        """Those of a scene, at elongations from which they are loaded (m)."""
        laws = [spring.acting for spring in scene.springs]
        loops = {i: law for i, law in enumerate(laws) if isinstance(law, BoucWen)}
        soils = {i: law for i, law in enumerate(laws) if isinstance(law, Backfill)}
        soil = np.array([*soils], np.int64)
        return cls(
            [spring.law for spring in scene.springs],
            as_arrays(laws),
            x_0,
            np.array([*loops], np.int64),
            Loops.of(list(loops.values())),
            {
                j: (Worn(law, 1.0), Worn(law, -1.0))
                for j, law in enumerate(loops.values())
                if isinstance(law, DegradingBoucWen)
            },
            soil,
            Soils.of(list(soils.values()), x_0[soil]),
        )

    def answer(self, x: Floats) -> tuple[Floats, Floats]:
        """Forces (N) and slopes (N/m) at elongations (m), all (S,)."""
        force, slope = elastic_force(self.elastic, x)
        for which, (pull, growth) in (
            (self.yielding, self.loops.strength * self._loaded(x)[:2]),
            (self.soil, self.soils.pull(x[self.soil])),
        ):
            force[which] += pull
            slope[which] += growth
        return force, slope

    def _loaded(self, x: Floats) -> Floats:
        """The z of those that yield, its slope (1/m) and epsilon, at elongations (m)."""
        travel = (x - self.x_0)[self.yielding]
        found = np.array((*self.loops.loaded(travel), np.zeros(travel.size)))
        for j, ways in self.worn.items():
            found[:, j] = ways[int(travel[j] < 0.0)].at(float(travel[j]))
        return found

    def softened(self, x: Floats | None = None) -> list[int]:
        """Which springs are loaded past their largest force, or were if no elongations are told."""
        past = []
        for j, ways in self.worn.items():
            i = int(self.yielding[j])
            end = np.inf if x is None else abs(x - self.x_0)[i] / self.loops.yield_displacement[j]
            if any(way.last < end for way in ways):
                past.append(i)
        return past

    @property
    def softest(self) -> Floats:
        """The smallest stiffness of each, yielded or slack (N/m)."""
        return np.minimum(self.elastic.compression, self.elastic.extension)

    @property
    def stiffness(self) -> Floats:
        """The largest of each (N/m)."""
        found = np.maximum(self.elastic.compression, self.elastic.extension)
        found[self.yielding] += self.loops.steepest
        found[self.soil] += self.soils.stiffness
        return found

    @property
    def far(self) -> Floats:
        """Forces far in compression and far in extension (N), shape (2, S)."""
        sides = np.array((self.elastic.compression, self.elastic.extension))
        found = np.where(sides > 0.0, np.inf, 0.0)
        found[:, self.yielding] += self.loops.largest
        found[0, self.soil] = self.soils.strength
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
        found[:, self.yielding[self.loops.largest > 0.0]] = 0.0
        found[0, self.soil] = self.soils.touched
        return found

    def loaded(self, x: Floats) -> list[Law]:
        """The laws at elongations (m), with what they then remember."""
        laws = list(self.laws)
        z, _, epsilon = self._loaded(x)
        for i, each, lost in zip(self.yielding, z.tolist(), epsilon.tolist(), strict=True):
            law = laws[i]
            if isinstance(law, DegradingBoucWen):
                laws[i] = law.going_on(float(x[i]), {"z": each, "epsilon": lost})
            elif isinstance(law, BoucWen):
                laws[i] = replace(law, initial_z=each)
        for i, each in zip(self.soil, self.soils.loaded(x[self.soil]).tolist(), strict=True):
            law = laws[i]
            assert isinstance(law, Backfill)
            if (
                law.residual_gap(float(x[i]), each)
                > -law.touched + CERTAIN * law.yield_displacement
            ):
                laws[i] = law.going_on(float(x[i]), {"z": each})
        return laws


def _potential(scene: Scene, springs: _Springs, link: Linkage, given: Floats) -> Potential:
    """The potential of a scene whose bodies are given at these displacements (N,)."""
    sliders = {i: law.strength for i, law in enumerate(springs.laws) if isinstance(law, Slider)}
    slides, friction = list(sliders), np.array([*sliders.values()])
    lengths = (given, link.gap, springs.x_0, springs.elastic.offset, springs.loops.knee)
    return Potential(
        link.springs,
        np.vstack((link.contacts, link.springs[slides])),
        link.moved,
        np.append(link.gap, (link.moved - springs.x_0)[slides]),
        link.load,
        springs.answer,
        springs.stiffness,
        springs.far,
        springs.slack,
        max(float(np.abs(each).max(initial=0.0)) for each in lengths),
        np.append(np.zeros(link.gap.size), -friction),
        np.append(np.full(link.gap.size, np.inf), friction),
    )
