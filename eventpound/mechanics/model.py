"""A scene as arrays: what the compiled kernels work on.

Equation of motion, coordinates u relative to the ground:

    M u'' + C u' + Σ_s B_s F_s(B_sᵀ u, z_s) - W λ = -M 1 a_g(t)

The coordinates are the bodies, and behind them the points that links and contacts are at
(`eventpound.mechanics.coordinates`), without mass, whose ``u = Σ w_b u_b`` follows. A *link*
joins two of them, or one and the ground (index -1), and carries a spring, a dashpot or both: its
elongation is ``x = u_second - u_first`` and its force (`eventpound.mechanics.elements`) pulls the
ends together. Springs come first, in the order of the scene, then dashpots that stand alone, then
links without force, each of which has the second number of a memory as its z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from eventpound.mechanics.contact_elements import CUT, FIRST_CODE, NO_LAW, Elements, elements_of
from eventpound.mechanics.coordinates import Numbered, numbered, parts_on_ground
from eventpound.mechanics.link_law import KIND, SLIDER, LinkLaw, contact_law, link_forces, link_law
from eventpound.motion.loaded import LoadedMotion
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.contact_law import POISSON
from eventpound.scene.elastic_laws import ElasticLaws, as_arrays
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BilinearElastic, Hysteretic

_SLACK = BilinearElastic(0.0, 0.0)
WORK_OF_SUPPORTS = 3
"""Entries of the energy ledger before those of supports: input, viscous and hysteretic work."""


@dataclass(frozen=True)
class Model:
    """Arrays of a scene with N coordinates, L links, S springs and K contacts.

    Parameters
    ----------
    mass : ndarray, shape (N,)
        Masses (kg), inf of supports, none of points.
    u0, v0 : ndarray, shape (N,)
        Initial displacement (m) and velocity (m/s).
    link_ends : ndarray of int, shape (L, 2)
        First and second end of each link; -1 is the ground.
    on_ground : ndarray, shape (L,)
        What of the force of each link counts in the base shear.
    law : LinkLaw
        Laws of the links beside their elastic parts.
    elastic : ElasticLaws
        Elastic parts of the links.
    hysteretic : ndarray of int, shape (H,)
        Links with a number of a memory; z is numbered in this order.
    z0 : ndarray, shape (H,)
        Initial z.
    springs : int
        S; the first S links are the springs.
    left, right : ndarray of int, shape (K,)
        Coordinates of each contact; -1 is a barrier.
    gap, restitution : ndarray, shape (K,)
        Openings at zero displacement (m) and coefficients of restitution, NaN where none is. Of
        contacts along others 1 where impacts follow Poisson's law, else 0 (`with_friction`).
    friction : ndarray, shape (K,)
        μ of each contact.
    by_poisson : bool
        Whether impacts follow Poisson's law, not Newton's.
    tangent : ndarray of int, shape (K, 2)
        Coordinates along which contacts with friction slide, as `left` and `right`; else -1.
    elements : Elements
        Laws of the contacts, shape (K,).
    supports, loads : int
        How many bodies, the first ones, are supports (`eventpound.mechanics.supported`), and
        how many links, the last ones, carry loads instead of a law.
    laws : ndarray of int, shape (P,)
        Contacts whose elements are the last P links (`with_elements`).
    weights : ndarray, shape (D, N)
        Of the points, the last D coordinates: the parts w of bodies in each.
    sliders : ndarray of int, shape (J,)
        Links of sliders, whose last J contacts hold them while they stick (`with_sliders`).
    rubbing : ndarray of int, shape (F,)
        Contacts with friction, along which the last F links are and the last F contacts hold them
        while they stick (`with_friction`); then there are no `laws` and `sliders`.
    """

    mass: Floats
    u0: Floats
    v0: Floats
    link_ends: Ints
    on_ground: Floats
    law: LinkLaw
    elastic: ElasticLaws
    hysteretic: Ints
    z0: Floats
    springs: int
    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats
    friction: Floats
    tangent: Ints
    elements: Elements
    by_poisson: bool = False
    supports: int = 0
    loads: int = 0
    laws: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    weights: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    sliders: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    rubbing: Ints = field(default_factory=lambda: np.zeros(0, np.int64))

    @property
    def coordinates(self) -> int:
        """N."""
        return self.mass.size

    @property
    def bodies(self) -> int:
        """How many of the coordinates, the first ones, are bodies."""
        return self.mass.size - self.weights.shape[0]

    @property
    def links(self) -> int:
        """L."""
        return self.law.damping.size

    @property
    def contacts(self) -> int:
        """K."""
        return self.gap.size

    @property
    def own_contacts(self) -> int:
        """Number of the contacts of the scene, which come first."""
        return self.contacts - self.sliders.size - self.rubbing.size

    @property
    def holding(self) -> Ints:
        """Contacts that rest while those with friction stick (F,), the last."""
        return np.arange(self.contacts - self.rubbing.size, self.contacts)

    @property
    def slides(self) -> Ints:
        """Links along contacts with friction (F,), the last, whose branches are ways of slips."""
        return np.arange(self.links - self.rubbing.size, self.links)

    @property
    def ledger_entries(self) -> int:
        """Entries of the energy ledger, the work of each support and each friction the last."""
        return WORK_OF_SUPPORTS + self.supports + self.rubbing.size

    @property
    def plain(self) -> int:
        """Number of the links that are no contact elements, which come first."""
        return self.links - self.laws.size

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """N, L, K and H: coordinates, links, contacts and hysteretic links."""
        return self.coordinates, self.links, self.contacts, self.hysteretic.size

    @property
    def z_of_link(self) -> Ints:
        """Number of the z of each link, -1 without hysteresis, shape (L,)."""
        places = np.full(self.links, -1, np.int64)
        places[self.hysteretic] = np.arange(self.hysteretic.size)
        return places

    @property
    def felt_mass(self) -> Floats:
        """What a force at each coordinate has to move (kg), shape (N,), ``1/m = Σ w²/m_b``."""
        mass = self.mass.copy()
        if self.weights.size > 0:
            with np.errstate(divide="ignore"):
                each = self.weights[:, : self.bodies] ** 2 / mass[: self.bodies]
                mass[self.bodies :] = 1.0 / each.sum(axis=1)
        return mass

    def with_points(self, values: Floats) -> Floats:
        """Values of the bodies, with or without those of points behind, with those of points."""
        if self.weights.size == 0:
            return values
        own = values[..., : self.bodies]
        return np.concatenate((own, own @ self.weights[:, : self.bodies].T), axis=-1)

    def gaps(self, u: Floats) -> Floats:
        """Gaps ``g = δ + u_right - u_left`` (m), shape (..., K), for u of the bodies (m)."""
        return self.gap + self.rates(u)

    def rates(self, v: Floats) -> Floats:
        """``Wᵀ v``, shape (..., K): rates of the gaps for velocities v of the bodies (m/s)."""
        return differences(self.with_points(v), self.left, self.right)

    def elongations(self, u: Floats) -> Floats:
        """Elongations of the links (m), shape (..., L), for u of the bodies (m)."""
        return differences(self.with_points(u), *self.link_ends.T)

    def link_forces(self, u: Floats, v: Floats, z: Floats) -> tuple[Floats, Floats]:
        """Forces of the links without and with their dashpots (N), shape (..., L) each.

        `z` of shape (..., H).
        """
        x, x_rate = self.elongations(u), self.elongations(v)
        return link_forces(self.elastic, self.law, self.hysteretic, x, x_rate, z)

    def pulled(self, force: Floats) -> Floats:
        """Sum of the forces (..., L) of the links on each body (N), shape (..., bodies)."""
        total = np.zeros((*force.shape[:-1], self.coordinates + 1))
        for link, (first, second) in enumerate(self.link_ends):
            total[..., first] += force[..., link]
            total[..., second] -= force[..., link]
        own = total[..., : self.bodies]
        if self.weights.size > 0:
            own = own + total[..., self.bodies : -1] @ self.weights[:, : self.bodies]
        return own


def differences(values: Floats, first: Ints, second: Ints) -> Floats:
    """Values (..., N) of bodies at each second end less those at the first, shape (..., k).

    End -1 is the ground or a barrier, whose value is zero.
    """
    extended = np.zeros((*values.shape[:-1], values.shape[-1] + 1))
    extended[..., :-1] = values
    # `take` leaves its result in the order of its axes, as compiled code wants it.
    found: Floats = extended.take(second, -1) - extended.take(first, -1)
    return found


def with_elements(model: Model) -> Model:
    """The model with every contact element as a link with a kink at the closing of its gap.

    Below the kink it is closed; then its law of contact acts, whose number is its damping
    (`eventpound.mechanics.contact_laws`). Above it there is no force.
    """
    elements = model.elements
    laws = np.flatnonzero(elements.kind != NO_LAW)
    if laws.size == 0:
        return model
    kind = np.where(elements.cut[laws] != 0, CUT, elements.kind[laws])
    nothing = np.zeros(laws.size)
    added = contact_law(FIRST_CODE - kind * 1.0, elements.damping[laws])
    ends = np.column_stack((model.left[laws], model.right[laws]))
    return replace(
        model,
        link_ends=np.vstack((model.link_ends, ends)),
        # Forces of contact elements on a barrier are no base shear.
        on_ground=np.append(model.on_ground, nothing),
        law=LinkLaw(*map(np.concatenate, zip(model.law, added, strict=True))),
        elastic=ElasticLaws(
            *map(np.append, model.elastic, (elements.stiffness[laws], nothing, -model.gap[laws]))
        ),
        laws=laws,
    )


def with_sliders(model: Model) -> Model:
    """The model with a contact for every slider, from its first end to its second.

    It rests while the slider sticks, and is given what friction lacks of that of a slip.
    """
    sliders = np.flatnonzero(model.law.memory[:, KIND] == SLIDER)
    if sliders.size == 0:
        return model
    return replace(_with_contacts(model, model.link_ends[sliders]), sliders=sliders)


def with_friction(model: Model) -> Model:
    """The model with a link and a contact along every contact with friction.

    The link, which carries no force, tells how far it has slid and whether it still slides; the
    contact rests while that sticks.
    """
    rubbing = np.flatnonzero(model.friction)
    if rubbing.size == 0:
        return model
    nothing, ends = np.zeros(rubbing.size), model.tangent[rubbing]
    slack = as_arrays([_SLACK] * rubbing.size)
    return replace(
        _with_contacts(model, ends),
        restitution=np.append(model.restitution, nothing + model.by_poisson),
        link_ends=np.vstack((model.link_ends, ends)),
        on_ground=np.append(model.on_ground, nothing),
        law=LinkLaw(*map(np.concatenate, zip(model.law, link_law([], nothing), strict=True))),
        elastic=ElasticLaws(*map(np.append, model.elastic, slack)),
        rubbing=rubbing,
    )


def _with_contacts(model: Model, ends: Ints) -> Model:
    """The model with contacts without gaps between such ends (k, 2) behind its own."""
    nothing, none = np.zeros(len(ends)), np.full(len(ends), NO_LAW)
    elements = model.elements
    return replace(
        model,
        left=np.append(model.left, ends[:, 0]),
        right=np.append(model.right, ends[:, 1]),
        gap=np.append(model.gap, nothing),
        restitution=np.append(model.restitution, nothing),
        friction=np.append(model.friction, nothing),
        tangent=np.vstack((model.tangent, np.full(ends.shape, -1))),
        elements=Elements(
            np.append(elements.kind, none),
            np.append(elements.stiffness, nothing),
            np.append(elements.damping, nothing),
            np.append(elements.cut, np.zeros_like(none)),
        ),
    )


def _column(values: list[float]) -> Floats:
    """Numbers as an array."""
    return np.array(values, dtype=np.float64)


def _links_of(
    scene: Scene, at: Numbered, two: list[int]
) -> tuple[list[tuple[int, int]], list[float], dict[int, int]]:
    """Ends of the links, their damping (N s/m), and the further link of each of `two` variables."""
    ends = at.springs + at.dashpots
    damping = [0.0] * len(ends)
    for link, dashpot in zip(at.of_dashpot, scene.dashpots, strict=True):
        damping[link] += dashpot.coefficient
    further = dict(zip(two, range(len(ends), len(ends) + len(two)), strict=True))
    ends += [ends[i] for i in two]
    if isinstance(scene.motion, LoadedMotion):
        ends += [(load.body, -1) for load in scene.motion.loads]
    return ends, damping + [0.0] * (len(ends) - len(damping)), further


def assemble(scene: Scene) -> Model:
    """Arrays of a scene; keeps only what it has.

    Parameters
    ----------
    scene : Scene
        A checked scene. Its supports count as the ground, unless it is `lowered`
        (`eventpound.mechanics.supported`), and has none.

    Returns
    -------
    Model
        A dashpot shares the link of a spring between the same ends.
    """
    at, motion = numbered(scene), scene.motion
    laws = [spring.acting for spring in scene.springs]
    loops = {i: law for i, law in enumerate(laws) if isinstance(law, Hysteretic)}
    ends, damping, further = _links_of(scene, at, [i for i, law in loops.items() if law.second])
    no_mass = [0.0] * at.on_ground.size
    mass, u0, v0 = (
        _column([getattr(b, key) for b in scene.bodies] + no_mass)
        for key in ("mass", "displacement", "velocity")
    )
    first = len(scene.bodies)
    for values in (u0, v0) if at.on_ground.size else ():
        # In the order of `followers.place_points`: a gap has the bits of later steps at the start.
        values[first:] = np.cumsum(at.weights[:, :first] * values[:first], axis=1)[:, -1]
    link_ends = np.array(ends, np.int64).reshape(-1, 2)
    start = differences(u0, *link_ends.T)
    left, right = np.array(at.contacts, np.int64).reshape(-1, 2).T.copy()
    return Model(
        mass=mass,
        u0=u0,
        v0=v0,
        link_ends=link_ends,
        on_ground=parts_on_ground(ends, first, at.on_ground),
        law=link_law(laws, damping, further),
        elastic=as_arrays(laws + [_SLACK] * (len(ends) - len(laws))),
        hysteretic=np.array([*loops, *further.values()], np.int64),
        z0=_column(
            [law.z_at(start[i]) for i, law in loops.items()] + [loops[i].second_at for i in further]
        ),
        springs=len(laws),
        left=left,
        right=right,
        gap=_column([c.gap for c in scene.contacts]),
        restitution=_column(
            [math.nan if c.restitution is None else c.restitution for c in scene.contacts]
        ),
        friction=_column([c.friction for c in scene.contacts]),
        tangent=np.array(at.tangents, np.int64).reshape(-1, 2),
        elements=elements_of(scene, mass, left, right),
        by_poisson=scene.impact_law == POISSON,
        supports=motion.supports if isinstance(motion, LoadedMotion) else 0,
        loads=len(motion.loads) if isinstance(motion, LoadedMotion) else 0,
        weights=at.weights,
    )


def shape_of(model: Model) -> tuple[object, ...]:
    """What arrays of two scenes that differ in numbers only have in common, to be compared.

    Of scenes whose contacts follow Newton's law.
    """
    sizes = model.bodies, model.springs, model.supports, model.loads
    kinds = model.law.memory[:, KIND]
    links = model.link_ends, model.on_ground, model.hysteretic, kinds
    arrays = *links, model.left, model.right, model.weights, model.rubbing, model.friction
    return (*sizes, *((each.size, each.tobytes()) for each in arrays))
