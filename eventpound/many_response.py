"""What many runs return: arrays with a row for each variant, and one table of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.errors import ComputationError
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen
from eventpound.solvers.base import EventKind, Extremes, Recording

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.solvers.fast.columns import Rows
    from eventpound.solvers.fast.many import Kept


@dataclass(frozen=True)
class Many:
    """Responses of n variants of a scene.

    N bodies, S springs, H of them hysteretic, K contacts. Where a variant
    failed, its numbers are NaN but for `t` and `steps`.

    Parameters
    ----------
    scene : Scene
        What the variants have in common.
    parameters : mapping of str to ndarray, shape (n,)
        What differs, by its keys.
    success : ndarray of bool, shape (n,)
        Whether a run reached its end.
    message : list of str, length n
        One sentence on how each ended.
    t : ndarray, shape (n,)
        Final time (s).
    u, v : ndarray, shape (n, N)
        Final displacement (m) and velocity (m/s).
    z : ndarray, shape (n, H)
        Final hysteretic variables.
    displacement, elongation : Extremes
        Of the bodies (n, N) and of the springs (n, S).
    smallest_gap : ndarray, shape (n, K)
        Smallest value of each gap (m).
    impacts, resting_time : ndarray, shape (n, K)
        Impacts of each contact, and the time it rested (s).
    steps : ndarray of int, shape (n,)
        Steps taken.
    acceleration, base_shear : Extremes, optional
        Of the absolute accelerations (n, N) and of the base shear (n, 1), where
        they were asked for.
    """

    scene: Scene
    parameters: Mapping[str, Floats]
    success: Bools
    message: list[str]
    t: Floats
    u: Floats
    v: Floats
    z: Floats
    displacement: Extremes
    elongation: Extremes
    smallest_gap: Floats
    impacts: Floats
    resting_time: Floats
    steps: Ints
    acceleration: Extremes | None
    base_shear: Extremes | None

    @property
    def table(self) -> pd.DataFrame:
        """Everything as one table, a row a variant.

        First the parameters by their keys, then success, message and the
        numbers by the paths they have in ``summary.json``, as ``peaks.deck.max``.
        """
        import pandas as pd

        columns: dict[str, Any] = dict(self.parameters)
        columns |= {"success": self.success, "message": self.message, "t_final": self.t}
        for name, values in self._results():
            columns[name] = values
        return pd.DataFrame(columns, index=pd.RangeIndex(self.t.size, name="variant"))

    def _results(self) -> Iterator[tuple[str, Floats | Ints]]:
        bodies = [body.name for body in self.scene.bodies]
        for i, name in enumerate(bodies):
            yield from _six(f"peaks.{name}.", "", self.displacement, i)
            if self.acceleration is not None:
                yield from _six(f"acceleration.{name}.", "", self.acceleration, i)
        for i, spring in enumerate(self.scene.springs):
            six = dict(_six(f"springs.{spring.name}.", "_elongation", self.elongation, i))
            yield from six.items()
            if isinstance(spring.law, BoucWen):
                key = f"spring.{spring.name}.yield_displacement"
                limit = self.parameters.get(key, spring.law.yield_displacement)
                largest = six[f"springs.{spring.name}.abs_max_elongation"]
                yield f"springs.{spring.name}.ductility", largest / limit
        if self.base_shear is not None:
            yield from _six("base_shear.", "", self.base_shear, 0)
        yield "impacts", self.impacts.sum(axis=1)
        for i, contact in enumerate(self.scene.contacts):
            yield f"contacts.{contact.name}.impacts", self.impacts[:, i]
            yield f"contacts.{contact.name}.resting_time", self.resting_time[:, i]
            yield f"contacts.{contact.name}.smallest_gap", self.smallest_gap[:, i]
        for i, name in enumerate(bodies):
            yield f"final.{name}.u", self.u[:, i]
            yield f"final.{name}.v", self.v[:, i]
        hysteretic = self.scene.hysteretic_springs
        for i, name in enumerate(hysteretic):
            yield f"final.{name}.z", self.z[:, i]
        yield "work.steps", self.steps


def _six(prefix: str, suffix: str, x: Extremes, i: int) -> Iterator[tuple[str, Floats]]:
    """Both extremes of column i and the larger in size, the earlier one of equals."""
    high, t_high = x.maximum[:, i], x.time_of_maximum[:, i]
    low, t_low = x.minimum[:, i], x.time_of_minimum[:, i]
    upward = (high > -low) | ((high == -low) & (t_high <= t_low))
    for name, values in (
        ("max", high),
        ("t_max", t_high),
        ("min", low),
        ("t_min", t_low),
        ("abs_max", np.where(upward, high, -low)),
        ("t_abs_max", np.where(upward, t_high, t_low)),
    ):
        yield f"{prefix}{name}{suffix}", values


def blank_many(scene: Scene, parameters: Mapping[str, Floats], accelerations: bool) -> Many:
    """Room for the responses of all variants."""
    count = len(next(iter(parameters.values())))

    def room(*width: int) -> Floats:
        return np.full((count, *width), np.nan)

    def extremes(width: int) -> Extremes:
        return Extremes(room(width), room(width), room(width), room(width))

    bodies, springs, contacts = len(scene.bodies), len(scene.springs), len(scene.contacts)
    hysteretic = len(scene.hysteretic_springs)
    return Many(
        scene,
        parameters,
        np.zeros(count, np.bool_),
        [""] * count,
        room(),
        room(bodies),
        room(bodies),
        room(hysteretic),
        extremes(bodies),
        extremes(springs),
        room(contacts),
        room(contacts),
        room(contacts),
        np.zeros(count, np.int64),
        extremes(bodies) if accelerations else None,
        extremes(1) if accelerations else None,
    )


def keep_rows(many: Many, low: int, rows: Rows, kept: Kept) -> None:
    """Take in a chunk of compiled runs, from variant `low` on.

    Those that did not reach their end are left without numbers, and marked
    unless they ended for want of room only.
    """
    from eventpound.solvers.events.cascade import T
    from eventpound.solvers.fast.outcome import FINISHED, MESSAGES
    from eventpound.solvers.fast.plan import STEPS

    part = slice(low, low + kept.ended.size)
    own: Any = np.flatnonzero(kept.ended == FINISHED)
    at: Any = low + own
    if own.size == kept.ended.size:
        # Slices copy at once what an index copies row by row.
        own, at = slice(None), part
    many.t[part], many.steps[part] = rows.state.clock[:, T], rows.state.count[:, STEPS]
    many.message[part] = [MESSAGES[FINISHED]] * kept.ended.size
    for i in (low + np.flatnonzero(kept.ended != FINISHED)).tolist():
        ended = int(kept.ended[i - low])
        if ended in MESSAGES:
            mark_failed(many, i, ComputationError(MESSAGES[ended], float(many.t[i])))
    many.success[at] = True
    many.u[at], many.v[at], many.z[at] = rows.state.u[own], rows.state.v[own], kept.z[own]
    many.impacts[at], many.resting_time[at] = kept.impacts[own], kept.resting_time[own]
    bodies, springs, contacts = (
        many.u.shape[1],
        many.elongation.maximum.shape[1],
        many.impacts.shape[1],
    )
    borders = np.cumsum((bodies, springs, contacts, bodies, 1))
    parts = np.split(rows.extremes[own], borders, axis=2)
    many.smallest_gap[at] = parts[2][:, 2]
    for kind, found in (
        (many.displacement, parts[0]),
        (many.elongation, parts[1]),
        (many.acceleration, parts[3]),
        (many.base_shear, parts[4]),
    ):
        if kind is not None:
            kind.maximum[at], kind.time_of_maximum[at] = found[:, 0], found[:, 1]
            kind.minimum[at], kind.time_of_minimum[at] = found[:, 2], found[:, 3]


def keep_recording(many: Many, i: int, recording: Recording) -> None:
    """Take in variant i, which ran by itself."""
    many.success[i], many.message[i] = True, recording.message
    many.t[i], many.steps[i] = recording.t, recording.work.steps
    many.u[i], many.v[i], many.z[i] = recording.u, recording.v, recording.z
    many.smallest_gap[i], many.resting_time[i] = recording.smallest_gap, recording.resting_time
    many.impacts[i] = 0.0
    for event in recording.events:
        if event.kind in (EventKind.IMPACT, EventKind.ACCUMULATION):
            many.impacts[i, event.contact] += event.count
    for kind, found in (
        (many.displacement, recording.displacement),
        (many.elongation, recording.elongation),
        (many.acceleration, recording.acceleration),
        (many.base_shear, recording.base_shear),
    ):
        if kind is not None:
            kind.maximum[i], kind.time_of_maximum[i] = found.maximum, found.time_of_maximum
            kind.minimum[i], kind.time_of_minimum[i] = found.minimum, found.time_of_minimum


def mark_failed(many: Many, i: int, error: ComputationError) -> None:
    """Say how variant i failed; it keeps no numbers but time and steps."""
    many.message[i], many.t[i] = str(error), error.time
    if error.recording is not None:
        many.steps[i] = error.recording.work.steps
