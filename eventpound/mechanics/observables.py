"""Everything a user or an event asks of a state: forces, accelerations, contact forces.

With F_l the force of a link (`eventpound.mechanics.elements`) and
``f_b = -Σ_l B_bl F_l`` what the links put on a body, the absolute
acceleration of a cluster is ``Σ f_b / Σ m_b``, or ``A Σ f_b + (1 - r) a_g`` where some follow
others (`eventpound.mechanics.followers`), and its contact forces balance
``W λ = m (u'' + a_g) - f`` body by body. Each of these is known with its rate.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import Clusters
from eventpound.mechanics.contact_laws import element_pull
from eventpound.mechanics.elements import contact_code, link_force, link_force_rate
from eventpound.mechanics.followers import answers, drive, own_mass, place_points
from eventpound.mechanics.link_law import STRENGTH
from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing, Reduced, rate_on_ground
from eventpound.mechanics.reduced_loads import placed
from eventpound.motion.forcing import ground_taylor
from eventpound.motion.loads import LOADED, add_load_series
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import in_python, kernel, scalar_kernel
from eventpound.numerics.small_systems import dot
from eventpound.tolerances import EPS


class Bodies(NamedTuple):
    """Arrays of a mode at the level of coordinates (N), links (L), contacts (K), rests (R).

    on_ground (L,): what of their forces counts in the base shear.
    z_of_link: below -1 the code of a closed contact element. laws (P,): contacts whose elements
    are the last P links. weights (D, N): of the `Model`. compliance, carried: of the `Reduced`.
    sliders (J,): links of sliders, whose contacts are the last J. rubbing (F,), friction (K,): as
    the `Model` has them. slips (S, 2): of contacts that slip the normal and the tangential one,
    drag (S,): ``-σ μ`` there. rubbed (5, F): of the whole run, what `eventpound.contact.friction`
    keeps.
    """

    mass: Floats
    link_ends: Ints
    on_ground: Floats
    stiffness: Floats
    preload: Floats
    damping: Floats
    memory: Floats
    z_of_link: Ints
    of_body: Ints
    offset: Floats
    cluster_mass: Floats
    iq: Ints
    iv: Ints
    z_of: Ints
    frozen_z: Floats
    elimination: Ints
    resting: Ints
    force_map: Floats
    left: Ints
    right: Ints
    gap: Floats
    laws: Ints
    weights: Floats
    compliance: Floats
    carried: Floats
    sliders: Ints
    rubbing: Ints
    friction: Floats
    slips: Ints
    drag: Floats
    rubbed: Floats


class Observed(NamedTuple):
    """Values at one instant; those with a second row carry their rate in it.

    u, v, a (N,): relative displacement, velocity, acceleration. z (2, H).
    force (2, L): links. acceleration (2, N): absolute. contact_force (2, K).
    shear (2,): sum of the link forces on the ground. gap (3, K): with first
    and second rate. elongation (3, L): likewise. ground (2,): a_g and its rate.
    pull (2, N): of links and loads on a body, where `observe` finds it; of a support its
    acceleration.
    """

    u: Floats
    v: Floats
    a: Floats
    z: Floats
    force: Floats
    acceleration: Floats
    contact_force: Floats
    shear: Floats
    gap: Floats
    elongation: Floats
    ground: Floats
    pull: Floats


def bodies_of(
    model: Model,
    clusters: Clusters,
    system: Reduced,
    stiffness: Floats,
    preload: Floats,
    frozen_z: Floats,
) -> Bodies:
    """Arrays for `observe` in a mode; `frozen_z` holds every z, used where a link is rigid."""
    z_of_link = model.z_of_link
    damping = model.law.damping.copy()
    for link in range(model.plain, model.links):
        if stiffness[link] != 0.0:
            z_of_link[link] = in_python(contact_code)(link, model.law.memory)
        else:
            damping[link] = 0.0
    return Bodies(
        mass=model.mass,
        link_ends=model.link_ends,
        on_ground=model.on_ground,
        stiffness=stiffness,
        preload=preload,
        damping=damping,
        memory=model.law.memory,
        z_of_link=z_of_link,
        of_body=clusters.of_body,
        offset=clusters.offset,
        cluster_mass=system.mass,
        iq=system.iq,
        iv=system.iv,
        z_of=system.z_of,
        frozen_z=frozen_z,
        elimination=clusters.elimination,
        resting=clusters.resting,
        force_map=clusters.force_map,
        left=model.left,
        right=model.right,
        gap=model.gap,
        laws=model.laws,
        weights=model.weights,
        compliance=system.compliance,
        carried=system.carried,
        sliders=model.sliders,
        rubbing=model.rubbing,
        friction=model.friction,
        slips=np.zeros((0, 2), np.int64),
        drag=np.zeros(0),
        rubbed=np.zeros((5, 0)),
    )


def blank_observed(bodies: int, links: int, contacts: int, hysteretic: int) -> Observed:
    """Empty arrays for `observe` to fill."""
    return Observed(
        u=np.zeros(bodies),
        v=np.zeros(bodies),
        a=np.zeros(bodies),
        z=np.zeros((2, hysteretic)),
        force=np.zeros((2, links)),
        acceleration=np.zeros((2, bodies)),
        contact_force=np.zeros((2, contacts)),
        shear=np.zeros(2),
        gap=np.zeros((3, contacts)),
        elongation=np.zeros((3, links)),
        ground=np.zeros(2),
        pull=np.zeros((2, bodies)),
    )


@kernel
def bodies_motion(y: Floats, bodies: Bodies, u: Floats, v: Floats) -> None:
    """Displacements (m) and velocities (m/s) of the bodies from the state of the clusters."""
    for b in range(bodies.mass.size):
        c = bodies.of_body[b]
        u[b], v[b] = bodies.offset[b], 0.0
        if c >= 0:
            u[b] += y[bodies.iq[c]]
            v[b] = y[bodies.iv[c]]
    # Points come last and from the bodies, whatever cluster they are in.
    place_points(bodies.weights, u)
    place_points(bodies.weights, v)


@kernel
def _expand(y: Floats, rate: Floats, bodies: Bodies, out: Observed) -> None:
    """Bodies' motion and every z from the state of the clusters."""
    bodies_motion(y, bodies, out.u, out.v)
    for b in range(bodies.mass.size):
        c = bodies.of_body[b]
        out.a[b] = rate[bodies.iv[c]] if c >= 0 else 0.0
    for h in range(bodies.z_of.size):
        place = bodies.z_of[h]
        # A link whose ends move as one has no place in the state: its z stays as it was.
        out.z[0, h] = y[place] if place >= 0 else bodies.frozen_z[h]
        out.z[1, h] = rate[place] if place >= 0 else 0.0


@kernel
def difference(values: Floats, first: int, second: int) -> float:
    """Value at the second end less that at the first; the ground's is zero."""
    result = 0.0
    if second >= 0:
        result = values[second]
    if first >= 0:
        result -= values[first]
    return result


@scalar_kernel
def gap_rounding(at_zero: Floats, u: Floats, length: float) -> float:
    """Size of a gap that is rounding of the coordinates, or of the scene's own length (m).

    Parameters
    ----------
    at_zero : ndarray, shape (K,)
        Gaps at no displacement (m).
    u : ndarray, shape (N,)
        Displacements (m). A scene may penetrate by their rounding (`eventpound.scene.check`).
    length : float
        The scene's own (m).
    """
    largest, moved = 0.0, 0.0
    for gap in at_zero:
        largest = max(largest, abs(gap))
    for each in u:
        moved = max(moved, abs(each))
    # A gap is summed from an opening and two displacements.
    return EPS * max(4.0 * (largest + 2.0 * moved), 64.0 * length)


def initial_gaps(model: Model, length: float) -> Floats:
    """Gaps at the start (m), shape (K,), zero within rounding; `length` (m) is the scene's own."""
    gap = model.gaps(model.u0)
    rounding = in_python(gap_rounding)(model.gap, model.u0, length)
    return np.where(np.abs(gap) <= rounding, 0.0, gap)


@kernel
def _link_forces(bodies: Bodies, out: Observed) -> None:
    """Force of every link and what the links put on each body, with rates."""
    pull, plain = out.pull, bodies.stiffness.size - bodies.laws.size
    pull[:] = 0.0
    out.shear[:] = 0.0
    for link in range(bodies.stiffness.size):
        first, second = bodies.link_ends[link, 0], bodies.link_ends[link, 1]
        x = out.elongation[0, link] = difference(out.u, first, second)
        x_rate = out.elongation[1, link] = difference(out.v, first, second)
        x_second = out.elongation[2, link] = difference(out.a, first, second)
        force, force_rate, h = 0.0, 0.0, bodies.z_of_link[link]
        if link < plain:
            z, z_rate = (out.z[0, h], out.z[1, h]) if h >= 0 else (0.0, 0.0)
            force = link_force(link, bodies, x, x_rate, z)
            force_rate = link_force_rate(link, bodies, x_rate, x_second, z_rate)
        elif h < -1:
            k, preload, c = bodies.stiffness[link], bodies.preload[link], bodies.damping[link]
            force, by_x, by_rate = element_pull(h, k, preload, c, x, x_rate, 0.0)
            force_rate = by_x * x_rate + by_rate * x_second
        out.force[0, link], out.force[1, link] = force, force_rate
        for end, sign in ((first, 1.0), (second, -1.0)):
            if end >= 0:
                pull[0, end] += sign * force
                pull[1, end] += sign * force_rate
        out.shear[0] += bodies.on_ground[link] * force
        out.shear[1] += bodies.on_ground[link] * force_rate


@kernel
def _accelerations(bodies: Bodies, out: Observed) -> None:
    """Absolute acceleration of every body and its rate: its cluster's."""
    if bodies.compliance.size > 0:
        _answer_coupled(bodies, out)
        return
    # Those of the clusters stand in its first places: no number of a body's is beyond its own.
    total, pull = out.acceleration, out.pull
    total[:] = 0.0
    for b in range(bodies.mass.size):
        c = bodies.of_body[b]
        if c >= 0:
            # The mass of a cluster with a support is inf, and makes nothing of any force.
            total[0, c] += pull[0, b] / bodies.cluster_mass[c]
            total[1, c] += pull[1, b] / bodies.cluster_mass[c]
    for row in range(2):
        drive(bodies.of_body, bodies.mass, pull[row], total[row])
    # Backwards: the number of a cluster is at most that of its first body, so its place is
    # read by all its bodies before one of them is put there.
    for b in range(bodies.mass.size - 1, -1, -1):
        c = bodies.of_body[b]
        for row in range(2):
            out.acceleration[row, b] = total[row, c] if c >= 0 else out.ground[row]


@kernel
def _answer_coupled(bodies: Bodies, out: Observed) -> None:
    """`_accelerations` where clusters follow others."""
    force, found = np.empty(bodies.carried.size), np.empty(bodies.carried.size)
    for row in range(2):
        force[:] = 0.0
        for b in range(bodies.mass.size):
            if bodies.of_body[b] >= 0:
                force[bodies.of_body[b]] += out.pull[row, b]
        drive(bodies.of_body, bodies.mass, out.pull[row], force)
        answers(bodies.compliance, force, found)
        for b in range(bodies.mass.size):
            c = bodies.of_body[b]
            # What nothing else carries rests on the ground.
            lifted = 1.0 if c < 0 else 1.0 - bodies.carried[c]
            out.acceleration[row, b] = lifted * out.ground[row]
            if c >= 0:
                out.acceleration[row, b] += found[c]


@kernel
def _contact_forces(bodies: Bodies, out: Observed) -> None:
    """λ of the resting contacts and its rate from ``W λ = m (u'' + a_g) - f``.

    What a support takes, the root of its cluster, is what the others there give.
    """
    out.contact_force[:] = 0.0
    if bodies.resting.size == 0:
        return
    residual = np.empty(out.pull.shape)
    for row in range(2):
        for b in range(bodies.mass.size):
            # What is left at a support, a root, nobody asks for.
            inertia = own_mass(b, bodies.mass) * out.acceleration[row, b]
            residual[row, b] = inertia - out.pull[row, b]
        if bodies.force_map.size > 0:
            for i in range(bodies.resting.size):
                total = dot(bodies.force_map[i], residual[row])
                out.contact_force[row, bodies.resting[i]] = total
            continue
        # Leaves first: what a body lacks its only contact left gives, and the body behind bears it.
        for i in range(bodies.elimination.shape[0]):
            b, j, parent, sign = bodies.elimination[i]
            out.contact_force[row, j] = sign * residual[row, b]
            if parent >= 0:
                residual[row, parent] += residual[row, b]


@kernel
def observe_friction(
    sliders: Ints, z_of_link: Ints, memory: Floats, on_ground: Floats, out: Observed
) -> None:
    """Take the forces of the contacts of sliders (J,) from those of slips: what friction is."""
    first = out.gap.shape[1] - sliders.size
    for i in range(sliders.size):
        link, stick = sliders[i], out.contact_force[:, first + i]
        slip, h = memory[link, STRENGTH], z_of_link[link]
        # f = σ F - λ in parts of F, with σ F the force of the slip.
        out.z[0, h], out.z[1, h] = (slip - stick[0]) / abs(slip), -stick[1] / abs(slip)
        for row in range(2):
            out.force[row, link] -= stick[row]
            out.shear[row] -= on_ground[link] * stick[row]


@kernel
def observe_gaps(bodies: Bodies, out: Observed) -> None:
    """Gaps and their rates from the motion of the bodies, of resting contacts too."""
    for j in range(bodies.gap.size):
        out.gap[0, j] = bodies.gap[j] + difference(out.u, bodies.left[j], bodies.right[j])
        out.gap[1, j] = difference(out.v, bodies.left[j], bodies.right[j])
        out.gap[2, j] = difference(out.a, bodies.left[j], bodies.right[j])


@kernel
def observe(
    tau: float,
    y: Floats,
    rate: Floats,
    system: Reduced,
    bodies: Bodies,
    forcing: Forcing,
    out: Observed,
) -> None:
    """Fill `out` with everything known of a state.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate : ndarray, shape (size,)
        State and its rate.
    system, bodies : Reduced, Bodies
        The mode.
    forcing : Forcing
        The piece of the ground motion.
    out : Observed
        Overwritten.
    """
    ground_taylor(forcing, forcing.start + tau, 2, out.ground)
    y = placed(forcing.start + tau, y, system, forcing)
    _observe_on_ground(tau, y, rate, bodies, forcing, out)


@kernel
def observe_motion(
    tau: float,
    y: Floats,
    rate: Floats,
    system: Reduced,
    bodies: Bodies,
    forcing: Forcing,
    out: Observed,
) -> None:
    """`motion_rate` and `observe`, for which the ground is looked at once."""
    ground_taylor(forcing, forcing.start + tau, 2, out.ground)
    y = placed(forcing.start + tau, y, system, forcing)
    rate_on_ground(out.ground[0], tau, y, rate, system, forcing)
    _observe_on_ground(tau, y, rate, bodies, forcing, out)


@kernel
def _observe_on_ground(
    tau: float, y: Floats, rate: Floats, bodies: Bodies, forcing: Forcing, out: Observed
) -> None:
    """`observe` where `out.ground` is known."""
    _expand(y, rate, bodies, out)
    _link_forces(bodies, out)
    # After the links: of a support this puts its acceleration in the place of what pulls at it.
    if forcing.family == LOADED:
        add_load_series(forcing, forcing.start + tau, 2, np.empty(2), out.pull)
    _accelerations(bodies, out)
    _contact_forces(bodies, out)
    if bodies.sliders.size > 0:
        observe_friction(bodies.sliders, bodies.z_of_link, bodies.memory, bodies.on_ground, out)
    for s in range(bodies.drag.size):
        # Of one that slips the normal force tells that of friction.
        j, t = bodies.slips[s]
        for row in range(2):
            out.contact_force[row, t] = bodies.drag[s] * out.contact_force[row, j]
    observe_gaps(bodies, out)
    # Bodies in one cluster differ by constants: what is left of their gap is the rounding of these.
    for i in range(bodies.resting.size):
        out.gap[:, bodies.resting[i]] = 0.0
    first_law = bodies.stiffness.size - bodies.laws.size
    # A contact presses where a link pulls.
    for p in range(bodies.laws.size):
        for row in range(2):
            out.contact_force[row, bodies.laws[p]] = -out.force[row, first_law + p]
