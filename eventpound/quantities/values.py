"""Values of quantities: functions of n runs and the number of an owner."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import SIX, Value, over_capacity, path_of_owner
from eventpound.quantities.runs import Runs
from eventpound.scene.elastic_laws import elastic_force, reduced
from eventpound.scene.ends import opening
from eventpound.scene.joints import joints_of
from eventpound.scene.parameters import number_places, told_of_variants
from eventpound.scene.plan_point import TURN
from eventpound.scene.scene import Scene
from eventpound.scene.separation import correlation, cqc
from eventpound.scene.spring import GROUND, BoucWen, Hysteretic
from eventpound.scene.structures import structures_of
from eventpound.solvers.base import EventKind, Extremes, Recording

ROUNDED_UP = 1e-6
"""Part by which a separation is told too wide, so that rounding closes nothing in a run with it."""


def law_is(kind: type) -> Callable[[Scene, int], bool]:
    """Whether spring i has a law of a kind."""
    return lambda scene, i: isinstance(scene.springs[i].law, kind)


def is_plain_bouc_wen(scene: Scene, i: int) -> bool:
    """Whether it has one that knows nothing but z."""
    law = scene.springs[i].law
    return isinstance(law, BoucWen) and not law.beyond_bouc_wen


def told_by_law(name: str) -> Callable[[Scene, int], bool]:
    """Whether the law of spring i has a number of this name for the end of a run."""
    return lambda scene, i: hasattr(scene.springs[i].law, name)


def is_elastic(scene: Scene, i: int) -> bool:
    """Whether spring i has no memory, and a force of its own, as no coupling of a frame."""
    spring = scene.springs[i]
    return not isinstance(spring.law, Hysteretic) and spring.frame is None


def goes_slack(scene: Scene, i: int) -> bool:
    """Whether spring i pulls only or pushes only."""
    law = scene.springs[i].law
    own = None if isinstance(law, Hysteretic) else reduced(law)
    return own is not None and (own.compression == 0.0) != (own.extension == 0.0)


def slack_left(many: Runs, i: int) -> Floats:
    """What is left of the slack of a spring that pulls only, of the gap of one that pushes (m)."""
    left = np.empty(many.t.shape)
    for n in range(left.size):
        own = reduced(law_of(many, i, n))
        x = many.elongation
        pulled, pushed = own.offset - x.maximum[n, i], x.minimum[n, i] - own.offset
        left[n] = pulled if own.compression == 0.0 else pushed
    return np.where(left < 0.0, 0.0, left)


def demand_over_capacity(many: Runs, _: int) -> Floats:
    """The largest of all demands over their capacities; NaN where one of them is not known."""
    found = ((name, many.values_of(name), held) for name, held in many.stated.capacities)
    parts = [
        over_capacity(name, values, held) for name, values, held in found if values is not None
    ]
    return np.asarray(np.max(parts, axis=0)) if parts else many.t * np.nan


def ductility(many: Runs, i: int) -> Floats:
    """Largest elongation of a Bouc-Wen spring over its yield displacement."""
    spring = many.scene.springs[i]
    law = spring.law
    assert isinstance(law, BoucWen)
    limit = many.parameters.get(f"spring.{spring.name}.yield_displacement", law.yield_displacement)
    return peak_size(many.elongation, i) / limit


def peak_size(extremes: Extremes, i: int) -> Floats:
    """The larger of two extremes in size."""
    return SIX["abs_max"][1](extremes, i)


def z_of(many: Runs, i: int) -> Floats:
    """Hysteretic variable of a spring at the end."""
    return many.z[:, many.scene.hysteretic_springs.index(many.scene.springs[i].name)]


def by_law(name: str) -> Value:
    """A number that a law tells from its elongation (m) and internal variables in the last row."""

    def values(many: Runs, i: int) -> Floats:
        spring, found = many.scene.springs[i], np.full(many.t.shape, np.nan)
        for n, run in enumerate(many.recordings):
            # Of supports a run that was stopped knows no more than its rows.
            x = float(motion_of_spring(many.scene, run, i)[0, -1])
            memory = zip(many.scene.memory, run.history.z[-1].tolist(), strict=True)
            found[n] = getattr(law_of(many, i, n), name)(
                x, *(z for (of, _), z in memory if of == spring.name)
            )
        return found

    return values


def law_of(many: Runs, i: int, n: int) -> Any:
    """The law of spring i in run n."""
    spring = many.scene.springs[i]
    law: Any = spring.law
    changed = {
        field: float(many.parameters[key][n])
        for field in asdict(law)
        if (key := f"spring.{spring.name}.{field}") in many.parameters
    }
    return replace(law, **changed)


def passive_depth(many: Runs, i: int) -> Floats:
    """How far the soil of a backfill was pushed in (m), nothing where it was not touched."""
    return np.array([law.offset - x if law.z_at(x) < 0.0 else 0.0 for law, x in _soils(many, i)])


def passive_force(many: Runs, i: int) -> Floats:
    """Largest force of the soil of a backfill (N), that at its least elongation."""
    return np.array([max(0.0, -law.strength * law.z_at(x)) for law, x in _soils(many, i)])


def _soils(many: Runs, i: int) -> Iterator[tuple[Any, float]]:
    """The law of spring i and its least elongation (m), of each run."""
    return ((law_of(many, i, n), x) for n, x in enumerate(many.elongation.minimum[:, i].tolist()))


def slip_path(many: Runs, i: int) -> Floats:
    """Length of all slips of a slider (m): from row to row, with one wherever it turns or stops."""
    found = np.full(many.t.shape, np.nan)
    for n, run in enumerate(many.recordings):
        found[n] = np.abs(np.diff(motion_of_spring(many.scene, run, i)[0])).sum()
    return found


def motion_of_spring(scene: Scene, recording: Recording, i: int) -> Floats:
    """Elongation of spring i (m) and its rate (m/s) at every row of the history, shape (2, n)."""
    spring = scene.springs[i]
    motions = {end: _motion_of(end, scene, recording) for end in spring.ends}
    return np.asarray(opening(spring, 0.0, motions))


def _motion_of(end: str, scene: Scene, recording: Recording) -> Floats:
    """Displacement (m) and velocity (m/s) of an end of a spring at every row, shape (2, n)."""
    h, moved = recording.history, recording.supports
    for k, body in enumerate(scene.bodies):
        if body.name == end:
            return np.array((h.u[:, k], h.v[:, k]))
    for k, support in enumerate(scene.supports):
        if moved is not None and support.name == end:
            return np.array((moved.s[:, k], moved.sv[:, k]))
    return np.zeros((2, h.t.size))


def friction_work(many: Runs, i: int) -> Floats:
    """Work of the friction of a slider (J)."""
    return slip_path(many, i) * [law_of(many, i, n).strength for n in range(len(many.recordings))]


def peak_term(many: Runs, i: int) -> Floats:
    """Largest displacement of a body over the length scale of the motion."""
    length = np.nan if many.scales is None else many.scales.length
    return peak_size(many.displacement, i) / length


def amplification(many: Runs, i: int) -> Floats:
    """Largest displacement of a body over that without contacts."""
    body = many.scene.bodies[i].name
    # Of the two terms, where there are any, as tables have had it to the last digit.
    name = f"peaks.{body}.abs_max" if many.scales is None else f"pi_um.{body}"
    own = peak_size(many.displacement, i) if many.scales is None else peak_term(many, i)
    free = None if many.free is None else many.free(name)
    if free is None:
        return many.t * np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        return own / free


def has_contacts(scene: Scene, _: int) -> bool:
    """Whether anything can touch."""
    return bool(scene.contacts)


def impacts_faster(many: Runs, _: int) -> Floats:
    """Impacts of all contacts above the threshold."""
    return np.asarray(many.contact_numbers.impacts_faster.sum(axis=1))


def moves_with_bodies(scene: Scene, i: int) -> bool:
    """Whether no end of spring i is a support, which may move on at the end."""
    return not {support.name for support in scene.supports}.intersection(scene.springs[i].ends)


def residual_elongation(many: Runs, i: int) -> Floats:
    """Elongation of spring i at the end (m)."""
    u = {body.name: many.u[:, k] for k, body in enumerate(many.scene.bodies)} | {GROUND: 0.0}
    return np.asarray(opening(many.scene.springs[i], 0.0, u))


def seat_used(many: Runs, i: int) -> Floats:
    """Largest opening of contact i beyond its gap at rest (m)."""
    return np.maximum(many.largest_gap[:, i] - _gap(many, i), 0.0)


def _used(many: Runs) -> Floats:
    """Smallest gaps of all contacts that would have avoided every contact (m), shape (n, K)."""
    every = tuple(range(len(many.scene.contacts)))
    nothing = np.full((many.t.size, len(every)), np.nan)
    return nothing if many.apart is None else many.apart(every)


def separation_needed(many: Runs, i: int) -> Floats:
    """Gap of contact i with which its joint is wide enough, were the others, too (m)."""
    used, own = _used(many), _gap(many, i)
    (joint,) = (each for each in joints_of(many.scene) if i in each)
    widest = np.max([used[:, k] + (own - _gap(many, k)) for k in joint], axis=0)
    return np.asarray(widest + ROUNDED_UP * used[:, joint].max(axis=1))


def _gap(many: Runs, i: int) -> Floats | float:
    """Gap of contact i at rest (m)."""
    contact = many.scene.contacts[i]
    return many.parameters.get(f"contact.{contact.name}.gap", contact.gap)


def avoiding_gap(many: Runs, i: int) -> Floats:
    """Smallest gap that would have avoided contact i, were the others avoided, too (m)."""
    return _used(many)[:, i]


def avoiding_gap_alone(many: Runs, i: int) -> Floats:
    """Smallest gap that would have avoided contact i, those of other ends as they are (m)."""
    turning = {body.name for body in many.scene.bodies if body.direction == TURN}
    ways = [
        tuple(part for part in contact.direction if part[0] not in turning)
        for contact in many.scene.contacts
    ]
    # Corners of one joint open together, or the wider one would need the gap of the other.
    joint = tuple(k for k, way in enumerate(ways) if way == ways[i])
    return many.t * np.nan if many.apart is None else many.apart(joint)[:, joint.index(i)]


def of_peaks(rule: Callable[[Floats, Floats], Any]) -> Value:
    """What a rule makes of the peaks of the ends of contact i without contact (m)."""
    return lambda many, i: rule(*_peaks_of_ends(many, i))


def cqc_of_peaks(many: Runs, i: int) -> Floats:
    """CQC of the peaks of the ends of contact i without contact (m)."""
    return cqc(*_peaks_of_ends(many, i), _correlations(many, i))


def _peaks_of_ends(many: Runs, i: int) -> tuple[Floats, Floats]:
    """Peaks of the left and of the right end of contact i without contact (m)."""
    found = [many.t * 0.0, many.t * 0.0]
    for body, opens in many.scene.contacts[i].direction:
        peak = None if many.free is None else many.free(f"peaks.{body}.abs_max")
        found[opens > 0.0] += np.nan if peak is None else abs(opens) * peak
    return found[0], found[1]


def _correlations(many: Runs, i: int) -> Floats:
    """Correlation of the two structures at contact i in each run."""
    places = number_places(many.scene)
    numbers = {places[key]: v for key, v in many.parameters.items() if key in places}
    still = {
        place: v for place, v in numbers.items() if place.kind in ("body", "spring", "dashpot")
    }
    return told_of_variants(many.scene, still, many.t.size, lambda own: correlation(own, i))


def of_scales(key: str) -> Value:
    """A scale of the ground motion."""
    return lambda many, i: np.nan if many.scales is None else getattr(many.scales, key)


def close_work(path: str) -> Value:
    """Energy dissipated, which only close rows of one run tell, by the path of the quantity."""

    def work(many: Runs, i: int) -> float:
        assert many.between is not None
        return many.between().work(path_of_owner(path, many.scene, i))

    return work


def elastic_force_of(many: Runs, i: int) -> Extremes:
    """Extremes of a force that grows with the elongation, or falls, where that has its own."""
    law, x = many.scene.springs[i].acting, many.elongation
    assert not isinstance(law, Hysteretic)
    own = reduced(law)

    def force(elongation: Floats) -> Floats:
        return elastic_force(own, elongation)[0][:, None]

    longest = force(x.maximum[:, i]), x.time_of_maximum[:, [i]]
    shortest = force(x.minimum[:, i]), x.time_of_minimum[:, [i]]
    if own.extension < 0.0:
        return Extremes(*shortest, *longest)
    return Extremes(*longest, *shortest)


def stands_apart(scene: Scene, i: int) -> bool:
    """Whether a structure is one of several, and held by the ground."""
    groups = structures_of(scene)
    joints = [spring.ends for spring in scene.springs]
    joints += [dashpot.ends for dashpot in scene.dashpots]
    grounded = any(GROUND in ends and set(ends) & set(groups[i]) for ends in joints)
    return grounded and len(groups) > 1


def _of_each(tell: Callable[[Recording, int], float]) -> Value:
    """What each recording tells of owner i."""
    return lambda many, i: np.array([tell(run, i) for run in many.recordings], dtype=np.float64)


def of_ledger(term: str) -> Value:
    """A term of the energy ledger (J), NaN where none is kept."""
    return _of_each(lambda run, _: getattr(run.energy, term, np.nan))


work_of_support = _of_each(lambda run, i: run.energy.supports[i] if run.energy else np.nan)
"""What support i put in (J), NaN where no ledger is kept."""


def has_law(scene: Scene, i: int) -> bool:
    """Whether contact i has a law of its own."""
    return scene.contacts[i].law is not None


def of_laws(name: str) -> Value:
    """A number of what contacts with laws did, NaN where the solver does not tell."""
    return _of_each(lambda run, i: np.nan if run.laws is None else getattr(run.laws, name)[i])


def has_friction(scene: Scene, i: int) -> bool:
    """Whether contact i has friction."""
    return scene.contacts[i].friction > 0.0


def slips(many: Runs, i: int) -> Floats:
    """How often contact i began to slip."""
    return _of_each(
        lambda run, i: sum(e.contact == i and e.kind is not EventKind.STICK for e in run.slides)
    )(many, i)


def of_friction(name: str) -> Value:
    """A number of what friction did at contacts, NaN where the solver does not tell."""
    return _of_each(
        lambda run, i: np.nan if run.friction is None else getattr(run.friction, name)[i]
    )


def estimated_force(many: Runs, i: int) -> Floats:
    """Force of the strongest impact if the contact were a spring of the stated stiffness (N).

    Two bodies of the reduced mass m on a spring k touch for half a period, ``pi sqrt(m/k)``; an
    impulse J in the shape of half a sine has the peak ``J sqrt(k/m) / 2``.
    """
    stiffness, scene = many.stated.contact_stiffness, many.scene
    if stiffness is None:
        return many.t * np.nan
    mass = {b.name: many.parameters.get(f"body.{b.name}.mass", b.mass) for b in scene.bodies}
    direction = scene.contacts[i].direction
    reduced = 1.0 / sum(w * w / mass[end] for end, w in direction if end in mass)
    strongest = many.contact_numbers.max_impulse[:, i]
    return np.asarray(0.5 * strongest * np.sqrt(stiffness / reduced))
