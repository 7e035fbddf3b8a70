"""What no solver locates: extremes of velocities, of some forces and shears, and work.

An extreme is looked for among rows close together of a run that is made again. Where a row may
hide a larger value beside it than any that is known, the next run has rows closer yet, until what
may be hidden is no more than a part `SETTLED` of the largest. Every value is the solver's own: no
law is told a second time.

Work is summed over rows by the trapezoidal rule with its end correction,
``h (f_0 + f_1)/2 + h^2 (f_0' - f_1')/12``, error O(h^4). Where a hysteretic spring turns, its power
``Q z x'`` has two continuous derivatives: what breaks in them is multiplied by x' = 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from eventpound.mechanics.link_law import link_law, yielding
from eventpound.numerics.arrays import Floats, Ints
from eventpound.quantities.loops import z_by_x
from eventpound.quantities.owners import owners_of
from eventpound.quantities.rows import Rerun, close_times, first_step, settled, warn_unsettled
from eventpound.scene.deck import CORNERS, Deck
from eventpound.scene.ends import Joining, opening
from eventpound.scene.plan_point import ACROSS, ALONG, TURN, PlanPoint
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Hysteretic
from eventpound.scene.structures import structure_names, structures_of
from eventpound.solvers.base import Extremes, History, Recording, Task
from eventpound.solvers.supported import link_force_on, relative_accelerations

SETTLED = 1e-9
"""Part of the largest value that may be hidden between rows, where rtol is not larger."""
WORK_SETTLED = 1e-6
"""Part of what flows through a spring or dashpot by which its work may still change."""
_ROUNDS = 8
_MOST_PLACES = 200
"""Places that a run looks at more closely for one extreme: those that may hide the largest."""
_CLOSER = np.concatenate([[0.0], 0.5 ** np.arange(36, 6, -1), np.arange(1, 65) / 64.0])
"""Parts of the way to a row beside; the least tell an extreme that is at a row, as at an impact."""


@dataclass(frozen=True)
class Between:
    """What rows close together tell of a task, by names of quantities.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task; a failure is a ComputationError.
    """

    task: Task
    rerun: Rerun

    def extremes(self, name: str) -> Extremes:
        """Extremes of what has a name as ``velocity.deck.*``, each of one entry.

        Warns
        -----
        AccuracyWarning
            Where they are not known to a part `SETTLED` of their size.
        """
        found, hidden = self._located[name]
        warn_unsettled(name, hidden, self._aim)
        return found

    def work(self, name: str) -> float:
        """Energy dissipated in a spring or dashpot (J), by the name of that quantity.

        Warns
        -----
        AccuracyWarning
            Where rows that are doubled still change it by more than `WORK_SETTLED`.
        """
        found, apart = self._works
        warn_unsettled(name, apart[name], WORK_SETTLED)
        return float(found[name][0][0])

    @property
    def _aim(self) -> float:
        return max(SETTLED, self.task.rtol)

    @cached_property
    def _works(self) -> tuple[Mapping[str, tuple[Floats, Floats]], Mapping[str, float]]:
        return settled(self.task, self.rerun, lambda run: works_of(self.task.scene, run))

    @cached_property
    def _located(self) -> dict[str, tuple[Extremes, float]]:
        """Extremes, and the part of their size that may be hidden between rows."""
        step, close = first_step(self.task)
        times = close_times(self.task, step)
        found: dict[str, tuple[Extremes, float]] = {}
        for _ in range(_ROUNDS):
            run = self.rerun(replace(self.task, energy=False, output_times=times))
            t, closer = run.history.t, [times]
            for name, signal in signals_of(self.task.scene, run).items():
                size = float(np.abs(signal).max())
                # Soil that is left has no pull but by rounding: its largest force is the first 0.
                values = np.where(np.abs(signal) > SETTLED * size, signal, 0.0)
                high, low = int(np.argmax(values)), int(np.argmin(values))
                found[name] = Extremes(values[[high]], t[[high]], values[[low]], t[[low]]), 0.0
                for signed in (values, -values):
                    places, hidden = _hiding(t, signed, self._aim * size)
                    if places.size:
                        found[name] = found[name][0], max(found[name][1], hidden / size)
                        closer += [_around(t, places, way) for way in (-1, 1)]
            if len(closer) == 1:
                break
            times = np.unique(np.concatenate(closer))
        return found if close else {name: (each, np.inf) for name, (each, _) in found.items()}


def _hiding(t: Floats, values: Floats, least: float) -> tuple[Ints, float]:
    """Rows beside which a value may be larger than any known, by more than `least`, and how much.

    A smooth value is larger than a row that both others beside it stay below by no more than a
    quarter of how far the lower one does. Over an instant it jumps and hides nothing.
    """
    step = np.where(np.diff(t) > 0.0, np.diff(values), 0.0)
    before, after = np.append(0.0, step), np.append(-step, 0.0)
    excess = np.maximum(before, after)
    may = values + excess > values.max() + least
    places = np.flatnonzero((before >= 0.0) & (after >= 0.0) & (excess > least) & may)
    most = np.argsort((values + excess)[places])[-_MOST_PLACES:]
    return places[most], float(excess[places].max(initial=0.0))


def _around(t: Floats, places: Ints, way: int) -> Floats:
    """Times between some rows and those before or after them."""
    beside = np.clip(places + way, 0, t.size - 1)
    return np.ravel(t[places, None] + (t[beside] - t[places])[:, None] * _CLOSER)


def signals_of(scene: Scene, recording: Recording) -> dict[str, Floats]:
    """Values at every row of what no solver locates (SI), by names."""
    h = recording.history
    found = {
        f"velocity.{body.name}.*": h.v[:, i]
        for i, body in enumerate(scene.bodies)
        if body.direction != TURN
    }
    for i, spring in enumerate(scene.springs):
        if isinstance(spring.law, Hysteretic):
            found[f"springs.{spring.name}.*_force"] = h.force[:, i]
    rate = {end: v for end, (v, _) in _motions(scene, recording).items()}
    ground = {GROUND} | {support.name for support in scene.supports if not support.moves_apart}
    u = _displacements(scene, recording) if scene.seats else {}
    for seat in scene.seats:
        left, right = seat.between
        found[f"seats.{seat.name}.*_opening"] = u[right] - u[left]
    if scene.in_plan:
        found |= dict(signals_in_plan(scene, h, rate))
    else:
        for name, group in zip(structure_names(scene), structures_of(scene), strict=True):
            shear = link_force_on(ground, scene, h.force, rate, group)
            found[f"structures.{name}.*_base_shear"] = shear
    for support in scene.supports:
        shear = link_force_on({support.name}, scene, h.force, rate)
        found[f"supports.{support.name}.*_shear"] = shear
    return found


def works_of(scene: Scene, recording: Recording) -> dict[str, tuple[Floats, Floats]]:
    """Energy dissipated in Bouc-Wen springs and dashpots, and what flows through them (J)."""
    found, motions, h = {}, _motions(scene, recording), recording.history
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, BoucWen) and not law.beyond_bouc_wen:
            z = h.z[:, scene.hysteretic_springs.index(spring.name)]
            rate, second = _elongating(spring, motions)
            own = link_law([law], [0.0]).memory
            slope = z_by_x(own, z, rate) * rate**2 + z * second
            (force,), (yields,) = yielding(own).force, yielding(own).displacement
            cells = force * _cells(h.t, z * rate, slope)
            stored = 0.5 * force * yields * (z[-1] ** 2 - z[0] ** 2)
            found[f"springs.{spring.name}.dissipated_energy"] = cells, stored
    for name, dashpot in zip(owners_of(scene, "dashpot"), scene.dashpots, strict=True):
        rate, second = _elongating(dashpot, motions)
        cells = dashpot.coefficient * _cells(h.t, rate**2, 2.0 * rate * second)
        found[f"dashpots.{name}.dissipated_energy"] = cells, 0.0
    return {
        name: (cells.sum(keepdims=True) - stored, np.abs(cells).sum(keepdims=True))
        for name, (cells, stored) in found.items()
    }


def _cells(t: Floats, values: Floats, slopes: Floats) -> Floats:
    """Integrals between rows."""
    h = np.diff(t)
    return h * (values[:-1] + values[1:]) / 2.0 + h**2 * (slopes[:-1] - slopes[1:]) / 12.0


def _displacements(scene: Scene, recording: Recording) -> dict[str, Floats]:
    """Of all ends of seats, relative to the ground (m)."""
    found = {GROUND: np.zeros_like(recording.history.t)}
    found |= {body.name: recording.history.u[:, i] for i, body in enumerate(scene.bodies)}
    for i, support in enumerate(scene.supports):
        assert recording.supports is not None
        found[support.name] = recording.supports.s[:, i]
    return found


def _motions(scene: Scene, recording: Recording) -> dict[str, tuple[Floats, Floats]]:
    """Velocity and acceleration relative to the ground of all ends of springs."""
    h, a = recording.history, relative_accelerations(scene, recording.history)
    found = {GROUND: (np.zeros_like(h.t), np.zeros_like(h.t))}
    found |= {body.name: (h.v[:, i], a[:, i]) for i, body in enumerate(scene.bodies)}
    for i, support in enumerate(scene.supports):
        assert recording.supports is not None
        acceleration = support.moved_by(scene.motion).acceleration(h.t) - h.ground
        found[support.name] = recording.supports.sv[:, i], acceleration
    return found


def _elongating(
    link: Joining, motions: Mapping[str, tuple[Floats, Floats]]
) -> tuple[Floats, Floats]:
    """Rate of an elongation (m/s), and the rate of that (m/s^2)."""
    rates, seconds = ({end: of[i] for end, of in motions.items()} for i in range(2))
    return np.asarray(opening(link, 0.0, rates)), np.asarray(opening(link, 0.0, seconds))


WAYS = {"along": (1.0, 0.0), "across": (0.0, 1.0)}
"""Directions of the displacements of corners, by what quantities call them."""


def corners_of(scene: Scene) -> list[tuple[str, Deck, tuple[float, float]]]:
    """Name of every corner, its deck, and where it is from the centre (m)."""
    return [
        (f"{deck.name}.{word}", deck, at)
        for deck in scene.decks
        for word, at in zip(CORNERS, deck.corners, strict=True)
    ]


def displacement_at(end: PlanPoint, scene: Scene, u: Floats) -> Floats:
    """Displacement of a place of a deck in a direction (m), (n,), by those of all bodies (n, N)."""
    place = {body.name: b for b, body in enumerate(scene.bodies)}
    total: Floats = sum(weight * u[:, place[name]] for name, weight in end.parts)  # type: ignore[assignment]
    return total


def part_on_ground(link: Joining, direction: str, scene: Scene) -> float:
    """What the ground takes of the pull of a link in a direction; none of one to something else."""
    if GROUND not in link.sides:
        return 0.0
    other = link.sides[1 - link.sides.index(GROUND)]
    # What pulls the first end to the right pulls the second to the left.
    way = 1.0 if link.sides[0] == GROUND else -1.0
    if isinstance(other, PlanPoint):
        return way * dict(zip((ALONG, ACROSS), other.normal, strict=True))[direction]
    own = next((body.direction for body in scene.bodies if body.name == other), "")
    return way if own == direction else 0.0


def signals_in_plan(
    scene: Scene, h: History, rate: Mapping[str, Floats]
) -> Iterator[tuple[str, Floats]]:
    """What a scene in plan has at every row beside what others have (SI), by names.

    Parameters
    ----------
    scene : Scene
        With decks.
    h : History
        Of its run, n rows.
    rate : mapping of str to ndarray, shape (n,)
        Velocities of all ends (m/s).
    """
    for b, body in enumerate(scene.bodies):
        if body.direction != TURN:
            yield f"acceleration.{body.name}.*", h.a[:, b]
    pulls = [h.force[:, i] for i in range(len(scene.springs))]
    pulls += [np.asarray(d.coefficient * opening(d, 0.0, rate)) for d in scene.dashpots]
    structures = zip(structure_names(scene), structures_of(scene), strict=True)
    groups: list[tuple[str, set[str] | None]] = [("base_shear{}.*", None)]
    groups += [(f"structures.{name}.*_base_shear{{}}", {GROUND, *own}) for name, own in structures]
    for name, among in groups:
        for word, direction in (("", ALONG), ("_across", ACROSS)):
            total = np.zeros(h.t.size)
            for link, pull in zip((*scene.springs, *scene.dashpots), pulls, strict=True):
                if among is None or among.issuperset(link.ends):
                    total += part_on_ground(link, direction, scene) * pull
            yield name.format(word), total
    for corner, deck, at in corners_of(scene):
        for word, direction_of in WAYS.items():
            signal = displacement_at(deck.toward(at, direction_of), scene, h.u)
            yield f"corners.{corner}.*_{word}", signal
