"""What the steppers work on and record: a scene, both ends of a step, extremes, rows, events.

Extremes are those of the ends of the steps, and a row of the history lies on the
straight line between the two steps around it: these methods know no more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.event_rows import EVENT_WIDTH
from eventpound.contact.rubbing import AMBIGUOUS, GAINING
from eventpound.contact.state import Now
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.model import Model
from eventpound.mechanics.monitored import (
    Running,
    Sizes,
    blank_extremes,
    places_in,
    running_of,
    update_extremes,
)
from eventpound.mechanics.observables import Observed, difference
from eventpound.numerics.arrays import Floats, Ints, Records
from eventpound.numerics.compiled import in_python, step_kernel
from eventpound.numerics.records import NamedNumbers
from eventpound.scene.elastic_laws import ElasticLaws
from eventpound.solvers.events.recorder import columns_of, row_width
from eventpound.solvers.events.scales import SceneScales


class Structure(NamedTuple):
    """N bodies, D points, L links (S of them springs), H hysteretic ones, K contacts.

    The masses are those of the bodies; points, which are coordinates behind them, move by `weights`
    (D, N + D). A contact with `friction` (K,) slides along the coordinates `tangent` (K, 2),
    and strikes by Poisson's law where that is so.
    The links pull as `elastic` and `law` have it, and a part `on_ground` at the ground; `z_of_link`
    is -1 without hysteresis, `bound` (L,) the largest |z| that loading can reach. `theta` is
    that of the time-stepping rule; `bandwidth` the number of sub-diagonals of the coupling;
    `speed` the scene's own (m/s).
    """

    mass: Floats
    ends: Ints
    on_ground: Floats
    elastic: ElasticLaws
    law: LinkLaw
    bound: Floats
    z_of_link: Ints
    weights: Floats
    left: Ints
    right: Ints
    gap: Floats
    restitution: Floats
    friction: Floats
    tangent: Ints
    by_poisson: bool
    springs: int
    bandwidth: int
    theta: float
    speed: float


class FixedStepState(NamedTuple):
    """What is known at one end of a step.

    u, v, f (N + D,): displacement (m), velocity (m/s), force of the links on each
    body (N). z (H,). link (L,): force of each link without its dashpot (N).
    contact, rubbing (K,): contact forces, and those of friction (N).
    """

    u: Floats
    v: Floats
    f: Floats
    z: Floats
    link: Floats
    contact: Floats
    rubbing: Floats


class Equations(NamedTuple):
    """Room for the equations of a step.

    residual, terms (N + D,): what is missing in the balance of momentum, and the sum of
    the sizes of its terms (N s). increment (N + D,), band (N, b + 1): Newton's
    equations. slope (L,): ∂F/∂x of each link. pressing (K,): ∂(h θ force)/∂(closing speed) of
    each contact (N s²/m). load (2, N + D): loads on the bodies by the rule of the step and at its
    end (N).
    """

    residual: Floats
    terms: Floats
    increment: Floats
    band: Floats
    slope: Floats
    pressing: Floats
    load: Floats


def structure_of(model: Model, scales: SceneScales, theta: float) -> Structure:
    """Arrays of a scene for the steppers.

    Parameters
    ----------
    model : Model
        The scene.
    scales : SceneScales
        Its scales.
    theta : float
        Of the time-stepping rule.
    """
    bound = np.ones(model.links)
    bound[model.hysteretic] = scales.z_bound
    pairs = np.concatenate((model.link_ends, np.column_stack((model.left, model.right))))
    # What acts on a point acts on all bodies that carry it.
    wide = bool((model.link_ends >= model.bodies).any())
    pairs = pairs[((pairs >= 0) & (pairs < model.bodies)).all(axis=1)]
    reach = model.bodies - 1 if wide else np.abs(pairs[:, 0] - pairs[:, 1]).max(initial=0)
    return Structure(
        mass=model.mass[: model.bodies],
        ends=model.link_ends,
        on_ground=model.on_ground,
        elastic=model.elastic,
        law=model.law,
        bound=bound,
        z_of_link=model.z_of_link,
        weights=model.weights,
        left=model.left,
        right=model.right,
        gap=model.gap,
        restitution=model.restitution,
        friction=model.friction,
        tangent=model.tangent,
        by_poisson=model.by_poisson,
        springs=model.springs,
        bandwidth=int(reach),
        theta=theta,
        speed=scales.speed,
    )


def initial_instant(model: Model) -> FixedStepState:
    """The start, forces not yet computed."""
    N, L, K, _ = model.counts
    u, v, z = model.u0.copy(), model.v0.copy(), model.z0.copy()
    return FixedStepState(u, v, np.zeros(N), z, np.zeros(L), np.zeros(K), np.zeros(K))


def blank_equations(model: Model, bandwidth: int) -> Equations:
    """Room for a step."""
    N, L, K, _ = model.counts
    residual, terms, increment = np.zeros((3, N))
    band, load = np.zeros((model.bodies, bandwidth + 1)), np.zeros((2, N))
    return Equations(residual, terms, increment, band, np.zeros(L), np.zeros(K), load)


DONE, NO_ROOM, NOT_CONVERGED, NOT_SOLVED, NOT_UNIQUE, GAINED = range(6)
"""All steps taken; too little room for the events of the next; Newton's iteration or the
complementarity problem of the next fails, or has several answers, or one that gains energy."""
_IN_STEP = ", in a step of {step:.6g} s: {contacts}; try less friction there"
MESSAGES = {
    DONE: "reached the end of the run in steps of at most {step:.6g} s",
    NOT_CONVERGED: "Newton's iteration of a step of {step:.6g} s does not converge; "
    "try a smaller time_step",
    NOT_SOLVED: "the complementarity problem of a step of {step:.6g} s is not solved; "
    "try a smaller time_step",
    NOT_UNIQUE: AMBIGUOUS + _IN_STEP,
    GAINED: GAINING + _IN_STEP,
}
INPUT, VISCOUS, HYSTERETIC, CONTACT, FRICTION = range(5)
"""Places of `FixedStepRecord.work` (J)."""


class FixedStepProgress(NamedNumbers):
    """What a method counts itself."""

    steps: int  # steps so far
    evaluations: int  # of the forces of the links
    rows: int  # rows of the history


class FixedStepRecord(NamedTuple):
    """Room for a run: events (e, EVENT_WIDTH), output times (n,), rows and the last two steps.

    A row (w,) is that of `eventpound.solvers.events.recorder`; `observed` holds views of the last
    one; `running` are the extremes. work (5,): energies (J). now (1,): a `Now`, of
    which the events count only; progress (1,).
    """

    events: Floats
    times: Floats
    rows: Floats
    last: Floats
    observed: Observed
    running: Running
    work: Floats
    now: Records
    progress: Records


class Stepping(NamedTuple):
    """What the kernels of a method work on: the last step ended at `state`, the next at `trial`."""

    structure: Structure
    state: FixedStepState
    trial: FixedStepState
    equations: Equations
    record: FixedStepRecord


class Span(NamedTuple):
    """Steps of one length h (s), by their numbers from the start of the forcing.

    first: that of the first. last: that of the one not taken.
    """

    first: int
    last: int
    h: float


def blank_record(model: Model, times: Floats, scales: Sizes, room: int) -> FixedStepRecord:
    """Room for a run with so many events at first."""
    width, at = row_width(model), places_in(model)
    last = np.zeros((2, width))
    _, ground, u, v, a, z, force, gap, contact = columns_of(last[1:], model)
    elongation, shear = np.zeros((1, model.springs)), np.zeros(1)
    # Of motion, force and gap only: no second rates, and no pulls.
    observed = u[0], v[0], np.zeros(0), z, force, a, contact, shear, gap, elongation, ground[0]
    return FixedStepRecord(
        np.zeros((room, EVENT_WIDTH)),
        times,
        np.zeros((times.size, width)),
        last,
        Observed(*observed, np.zeros((0, 0))),
        in_python(running_of)(blank_extremes(at, scales), at),
        np.zeros(5),
        np.zeros(1, Now.layout),
        np.zeros(1, FixedStepProgress.layout),
    )


@step_kernel
def copy_values(source: Floats, target: Floats) -> None:
    """Copy a row; an assignment of slices would make an array."""
    for i in range(source.size):
        target[i] = source[i]


@step_kernel
def pull_together(values: Floats, first: int, second: int, force: float) -> None:
    """Add a force to the first end and take it from the second."""
    if first >= 0:
        values[first] += force
    if second >= 0:
        values[second] -= force


@step_kernel
def hand_on(weights: Floats, force: Floats) -> None:
    """Put what acts on points, the last D of N + D coordinates, on the bodies that carry them."""
    first = force.size - weights.shape[0]
    for d in range(weights.shape[0]):
        for b in range(first):
            force[b] += weights[d, b] * force[first + d]
        force[first + d] = 0.0


@step_kernel
def hand_on_sizes(weights: Floats, size: Floats) -> None:
    """The same of sizes of forces."""
    first = size.size - weights.shape[0]
    for d in range(weights.shape[0]):
        for b in range(first):
            size[b] += abs(weights[d, b]) * size[first + d]
        size[first + d] = 0.0


@step_kernel
def add_to_ends(values: Floats, first: int, second: int, value: float) -> None:
    """Add a value at both ends."""
    if first >= 0:
        values[first] += value
    if second >= 0:
        values[second] += value


@step_kernel
def gap_rate(structure: Structure, j: int, v: Floats) -> float:
    """Rate of a gap (m/s)."""
    return difference(v, structure.left[j], structure.right[j])


@step_kernel
def slip_rate(structure: Structure, j: int, v: Floats) -> float:
    """Rate at which a contact slides (m/s)."""
    return difference(v, structure.tangent[j, 0], structure.tangent[j, 1])


@step_kernel
def gap_of(structure: Structure, j: int, u: Floats) -> float:
    """A gap (m)."""
    return structure.gap[j] + difference(u, structure.left[j], structure.right[j])


@step_kernel
def _observe_present(
    t: float,
    ground: float,
    load: Floats,
    structure: Structure,
    state: FixedStepState,
    record: FixedStepRecord,
) -> None:
    """Fill `observed`, and so the last row, from the present state and its loads (N)."""
    observed, acceleration = record.observed, record.observed.acceleration[0]
    record.last[1, 0], observed.ground[0], observed.shear[0] = t, ground, 0.0
    copy_values(state.u, observed.u)
    copy_values(state.v, observed.v)
    copy_values(state.z, observed.z[0])
    copy_values(state.f, acceleration)
    copy_values(state.contact, observed.contact_force[0])
    for j in range(structure.gap.size):
        observed.gap[0, j] = gap_of(structure, j, state.u)
        # A contact pushes its bodies apart.
        pull_together(acceleration, structure.left[j], structure.right[j], -state.contact[j])
        first, second = structure.tangent[j, 0], structure.tangent[j, 1]
        pull_together(acceleration, first, second, -state.rubbing[j])
    hand_on(structure.weights, acceleration)
    for b in range(structure.mass.size):
        acceleration[b] = (acceleration[b] + load[b]) / structure.mass[b]
    place_points(structure.weights, acceleration)
    for link in range(structure.bound.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        if link < structure.springs:
            observed.elongation[0, link] = difference(state.u, first, second)
            observed.force[0, link] = state.link[link]
        part = structure.on_ground[link]
        if part != 0.0:
            rate = difference(state.v, first, second)
            force = state.link[link] + structure.law.damping[link] * rate
            # What a link pulls at the ground, from either end.
            observed.shear[0] += part * force


@step_kernel
def record_step(t: float, ground: float, stepping: Stepping) -> None:
    """Record the present state: its extremes, and the rows up to it.

    Parameters
    ----------
    t : float
        Time of the state (s).
    ground : float
        Ground acceleration there (m/s²).
    stepping : Stepping
        With the state; `record.last[1]` is that before, or anything at the start.
    """
    record = stepping.record
    before, now = record.last[0], record.last[1]
    copy_values(now, before)
    _observe_present(
        t, ground, stepping.equations.load[1], stepping.structure, stepping.state, record
    )
    update_extremes(record.observed, t, record.running)
    i = record.progress[0].rows
    while i < record.times.size and record.times[i] <= t:
        share = 1.0
        if t > before[0] and record.times[i] > before[0]:
            share = (record.times[i] - before[0]) / (t - before[0])
        for k in range(now.size):
            record.rows[i, k] = now[k] if share == 1.0 else before[k] + share * (now[k] - before[k])
        record.rows[i, 0] = record.times[i]
        i += 1
    record.progress[0].rows = i
