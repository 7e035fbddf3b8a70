"""From a scene to what a run of it begins with: its constants, state and scratch arrays."""

from __future__ import annotations

from functools import lru_cache
from itertools import accumulate
from typing import Any

import numpy as np

from eventpound.contact.state import Now, begin
from eventpound.mechanics.backbone import hysteresis_of
from eventpound.mechanics.elements import CURVE_PLACES
from eventpound.mechanics.link_law import YIELD, yielding
from eventpound.mechanics.model import WORK_OF_SUPPORTS, Model
from eventpound.mechanics.monitored import distances_of, places_of
from eventpound.motion.base import Piece
from eventpound.motion.parametric import Parametric
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import in_python
from eventpound.numerics.polynomial import root_work
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import SceneScales, tolerances
from eventpound.solvers.fast.compiled import compiled_noinline
from eventpound.solvers.fast.locate import clear_located
from eventpound.solvers.fast.reused import JoinedArrays, Reuse, made_anew
from eventpound.solvers.fast.run import (
    MORE_TERMS,
    REST_TERMS,
    Contacts,
    FastLocated,
    FastObserved,
    FastPlan,
    FastProgress,
    FastSeries,
    FastState,
    FollowedMemories,
    Ground,
    Limits,
    Links,
    MovingLink,
    Sdof,
)
from eventpound.solvers.fast.sdof.body import SdofBody, oscillator_of
from eventpound.tolerances import OF_BACKBONE

HYSTERESIS_SHARE = 0.01
"""Part of the tolerance by which Φ may differ from a line, or from saturation, unseen."""


def links_of(model: Model) -> Links:
    """Links of an assembled scene."""
    grounded = np.full(model.coordinates, -1, np.int64)
    for h, link in enumerate(model.hysteretic):
        if model.link_ends[link].min() < 0:
            grounded[model.link_ends[link].max()] = h
    return Links(
        ends=model.link_ends,
        on_ground=model.on_ground,
        law=model.law,
        compression=model.elastic.compression,
        extension=model.elastic.extension,
        offset=model.elastic.offset,
        z_of_link=model.z_of_link,
        springs=model.springs,
        kinked=bool((model.elastic.compression != model.elastic.extension).any()),
        grounded=grounded,
        sliders=model.sliders,
    )


def contacts_of(model: Model, gap: Floats, restitution: Floats) -> Contacts:
    """Contacts of an assembled scene, or of many variants with such gaps and restitutions."""
    ends = model.left, model.right, gap, restitution, model.weights
    return Contacts(*ends, model.rubbing, model.friction)


def small_difference(
    rtol: float, memory: Floats, mass: Floats, acceleration: Floats | float
) -> Floats:
    """Difference of Φ from a line, or from saturation, that does not count.

    Parameters
    ----------
    rtol : float
        Relative tolerance.
    memory : ndarray, shape (..., L, constants)
        Of the links; with leading axes, of many variants.
    mass : ndarray, shape (..., N)
        Of the bodies (kg).
    acceleration : float or ndarray
        The scene's own, L/T² (m/s²).
    """
    # A strong spring turns a small error of z into a large acceleration.
    force = yielding(memory).force
    lightest = np.where(mass > 0.0, mass, np.inf).min(axis=-1, keepdims=True)
    strongest = (force / lightest).max(axis=-1, initial=0.0)
    with np.errstate(divide="ignore"):
        weak = np.minimum(1.0, acceleration / strongest)
    return np.maximum(HYSTERESIS_SHARE * rtol * weak, OF_BACKBONE)


def ground_of(pieces: list[Piece]) -> Ground:
    """Pieces of a ground motion as flat arrays."""
    return Ground(
        ends=np.array([piece.end for piece in pieces]),
        family=np.array([int(piece.family) for piece in pieces], np.int64),
        coefficients=np.concatenate([piece.coefficients for piece in pieces]),
        first=_starts([piece.coefficients.size for piece in pieces]),
        samples=np.concatenate([piece.samples for piece in pieces]),
        first_sample=_starts([piece.samples.size for piece in pieces]),
    )


def _starts(sizes: list[int]) -> Ints:
    """Where each of some arrays begins in all of them together, and where the last ends."""
    return np.array(list(accumulate(sizes, initial=0)), np.int64)


def plan_of(task: Task, model: Model, scales: SceneScales, keep: Reuse = made_anew) -> FastPlan:
    """Constants of a run.

    Parameters
    ----------
    task : Task
        The run.
    model : Model
        Its scene, assembled.
    scales : SceneScales
        The scene's own.
    keep : Reuse
        Gives what follows from a part of this.
    """
    atol, motion = tolerances(task, scales), task.scene.motion
    memory, elastic = model.law.memory, model.elastic
    small = float(small_difference(task.rtol, memory, model.mass, scales.acceleration))
    links = keep(
        ("links", elastic.compression.tobytes(), elastic.extension.tobytes()),
        lambda: links_of(model),
    )
    hysteresis = keep(
        # A backbone does not depend on the force that stands before these.
        ("hysteresis", memory[:, YIELD:].tobytes(), small),
        lambda: hysteresis_of(memory, model.hysteretic, small),
    )

    def ground() -> Ground:
        return ground_of(motion.pieces())

    return FastPlan(
        mass=model.mass,
        links=links,
        hysteresis=hysteresis,
        contacts=keep(("contacts",), lambda: contacts_of(model, model.gap, model.restitution)),
        # These two are equal where all their numbers are the same, which cannot change.
        ground=keep(("ground", motion), ground)
        if isinstance(motion, Parametric | Record)
        else ground(),
        limits=Limits(
            end=float(task.end),
            rtol=float(task.rtol),
            atol_u=np.asarray(atol["displacement"]),
            atol_v=np.asarray(atol["velocity"]),
            length=scales.length,
            time=scales.time,
            mass=scales.mass,
            order=order_for(task.rtol),
            hysteresis=small,
            ledger=task.energy,
            atol_z=np.asarray(atol["z"]),
        ),
        # Those of a task may be written to.
        output_times=np.array(task.output_times, np.float64),
        oscillator=oscillator_of(model, scales.length, links, energy=task.energy),
        distances=keep(("distances",), lambda: distances_of(model)),
    )


@lru_cache
def order_for(rtol: float) -> int:
    """Order of the series: a radius of convergence divided by about e² a step."""
    return min(max(round(2.0 - 0.6 * np.log(rtol)), 8), 24)


MOST_TURNS = 40
"""Turning points looked for in one step."""


def blank_located(plan: FastPlan) -> FastLocated:
    """Marks of nothing."""
    links, hysteretic = plan.links.ends.shape[0], plan.hysteresis.link.size
    contacts = plan.contacts.left.size
    sizes = (contacts, contacts, links, hysteretic, hysteretic)
    joined = JoinedArrays([np.zeros(size, np.bool_) for size in sizes])
    return FastLocated(*(*joined.arrays, joined.data, np.zeros(contacts, np.bool_)))


def zero_state(
    counts: tuple[int, int, int, int],
    ledger: int = WORK_OF_SUPPORTS,
    rubbing: int = 0,
    runs: tuple[int, ...] = (),
) -> FastState:
    """A state of zeros; `counts`: N, L, K and H, `rubbing`: F, `runs`: the leading axes."""
    bodies, links, contacts, hysteretic = ((*runs, count) for count in counts)
    return FastState(
        u=np.zeros(bodies),
        v=np.zeros(bodies),
        sigma=np.zeros(hysteretic),
        x_r=np.zeros(hysteretic),
        xi_r=np.zeros(hysteretic),
        part=np.zeros(hysteretic, np.int64),
        gap=np.zeros(contacts),
        gap_rate=np.zeros(contacts),
        resting=np.zeros(contacts, np.bool_),
        pressed=np.zeros(contacts, np.bool_),
        unlocked=np.zeros(contacts, np.bool_),
        branch=np.zeros(links, np.int64),
        ledger=np.zeros((*runs, ledger)),
        rubbed=np.zeros((*runs, 5, rubbing)),
        now=np.zeros((*runs, 1), Now.layout),
        progress=np.zeros((*runs, 1), FastProgress.layout),
    )


def begin_state(
    plan: FastPlan, u0: Floats, v0: Floats, z0: Floats, start: float, state: FastState
) -> None:
    """Fill in what of a state of zeros is not zero before a run starts at a time (s).

    u0, v0 (..., N), z0 (..., H): displacements (m), velocities (m/s) and hysteretic variables.
    The run itself opens the gaps.
    """
    progress, time = state.progress[..., 0], plan.limits.time
    state.u[:], state.v[:], state.xi_r[:] = u0, v0, z0 / plan.hysteresis.bound
    begin(state.now[..., 0], start, time)
    progress["trial"], progress["due"] = time, 1


def blank_series(plan: FastPlan, loaded: bool = False) -> FastSeries:
    """Scratch arrays of a run, or of many one after the other; `loaded`: with loads on bodies."""
    bodies, links = plan.mass.shape[-1], plan.links.ends.shape[0]
    hysteretic, contacts = plan.hysteresis.link.size, plan.contacts.left.size
    followed = plan.hysteresis.followed.size
    coupled = bodies if plan.contacts.weights.shape[0] > 0 else 0
    size = plan.limits.order + 3
    most = max(size + MORE_TERMS, REST_TERMS)
    # Each of them is copied into the block.
    arrays = {
        "X": np.zeros((bodies + 1, size)),
        "ground": np.zeros(size),
        "load": np.zeros((size if loaded else 0, bodies)),
        "of_body": np.zeros(bodies, np.int64),
        "weights": np.zeros((2, bodies)),
        "inverse_mass": np.zeros(bodies),
        "force": np.zeros(bodies + 1),
        **dict.fromkeys(("expected", "travel", "swing", "reach", "bend", "end"), np.zeros(bodies)),
        "F": np.zeros((links, size)),
        **dict.fromkeys(("x", "x_rate", "stiffness"), np.zeros(links)),
        "memory": np.zeros(plan.links.law.memory.shape[-2:]),
        "ends": np.zeros((links, 2), np.int64),
        "active": np.zeros(links, np.int64),
        "moving": np.zeros(links, MovingLink.layout),
        **dict.fromkeys(("z", "power", "speed", "weighted"), np.zeros((hysteretic, size))),
        "curve": np.zeros((hysteretic, CURVE_PLACES)),
        "contact_force": np.zeros((contacts, size)),
        "elimination": np.zeros((contacts, 4), np.int64),
        "resting": np.zeros(contacts, np.int64),
        "force_map": np.zeros((contacts, coupled)),
        **dict.fromkeys(("compliance", "free"), np.zeros((coupled, coupled))),
        "carried": np.zeros(coupled),
        "may_stop": np.zeros(plan.contacts.rubbing.size, np.bool_),
        **dict.fromkeys(("c", "d"), np.zeros(most)),
        "work": in_python(root_work)(most),
        "turns": np.zeros(MOST_TURNS),
    }
    block = JoinedArrays(list(arrays.values()))
    own: dict[str, Any] = dict(zip(arrays, block.arrays, strict=True))
    sdof = np.zeros(1, SdofBody.layout), np.zeros(most), own["turns"], own["work"]
    return FastSeries(
        **own,
        block=block.data,
        sdof=Sdof(*sdof),
        followed=FollowedMemories(np.zeros(followed), np.zeros(followed), np.zeros(1)),
        saved=np.zeros((4, in_python(places_of)(bodies, plan.links.springs, contacts).end)),
    )


@compiled_noinline
def clear_scratch(series: FastSeries, located: FastLocated, observed: FastObserved) -> None:
    """Leave nothing of the run before, which may have ended with numbers that are not finite."""
    series.block[:] = 0
    clear_located(located)
    located.vanished[:] = False
    observed.contact_force[:] = 0.0
