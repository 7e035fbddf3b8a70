"""What many runs return: arrays with a row for each variant, and one table of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.contact.event import STRIKES
from eventpound.errors import ComputationError
from eventpound.numerics.arrays import Floats
from eventpound.quantities.lookup import tabled, values_of
from eventpound.quantities.runs import (
    Impacts,
    Runs,
    blank_numbers,
    impacts_of,
    numbers_of_contacts,
    of_recordings,
)
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes, Recording

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.solvers.fast.columns import VariantArrays
    from eventpound.solvers.fast.many import Kept


@dataclass(frozen=True)
class BatchResponse(Runs):
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
    smallest_gap, largest_gap : ndarray, shape (n, K)
        Extremes of each gap (m).
    impacts, resting_time : ndarray, shape (n, K)
        Impacts of each contact, and the time it rested (s).
    steps : ndarray of int, shape (n,)
        Steps taken.
    acceleration, base_shear : Extremes, optional
        Of the absolute accelerations (n, N) and of the base shear (n, 1), where
        they were asked for.
    further : mapping of str to ndarray, shape (n,)
        Quantities that were named, by their names.
    recordings : sequence of Recording
        All of the runs, where that was kept.
    scales : ScaleColumns, optional
        Of the ground motions, where they are known.
    free : callable, optional
        Gives values of a quantity, by its name, of the same scenes without contact.
    between : callable, optional
        Gives quantities of one run that need rows close together (`eventpound.quantities.between`).
    apart : callable, optional
        Given the numbers of some contacts, gives the gaps (m) with which they would not have
        closed, (n, their number), from runs in which only these cannot close.
    stated : Stated
        Numbers of ``[run]`` that quantities need.
    struck : ContactNumbers, optional
        Impulses and speeds of the impacts at each contact, (n, K) each, where asked for.
    """

    def __repr__(self) -> str:
        failed = np.count_nonzero(~self.success)
        over = ", ".join(self.parameters)
        return f"<BatchResponse: {self.t.size} runs over {over}, {failed} failed>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self))}</p>" + str(self.table.to_html(max_rows=10, max_cols=12))

    def values_of(self, name: str) -> Floats | None:
        """Values of a quantity by its name, shape (n,); None where the scene has none."""
        return values_of(self, name)

    @property
    def table(self) -> pd.DataFrame:
        """Everything as one table, a row a variant.

        First the parameters by their keys, then success and message, then quantities by
        their names (page "quantities" of the docs), as ``peaks.deck.max``.
        """
        import pandas as pd

        columns: dict[str, Any] = dict(self.parameters)
        columns |= {"success": self.success, "message": self.message}
        columns |= {named.name: named.of(self) for named in tabled(self)}
        columns |= self.further
        return pd.DataFrame(columns, index=pd.RangeIndex(self.t.size, name="variant"))


def blank_many(
    scene: Scene,
    parameters: Mapping[str, Floats],
    accelerations: bool,
    named: Sequence[str] = (),
    *,
    count: int | None = None,
    impacts: bool = False,
) -> BatchResponse:
    """Room for the responses of `count` variants, as many as there are values or one.

    With the numbers of their `impacts` where they are wanted, and for `named` quantities.
    """
    if count is None:
        count = len(next(iter(parameters.values()))) if parameters else 1

    def blank(*width: int) -> Floats:
        return np.full((count, *width), np.nan)

    def extremes(width: int) -> Extremes:
        return Extremes(blank(width), blank(width), blank(width), blank(width))

    bodies, springs, contacts = len(scene.bodies), len(scene.springs), len(scene.contacts)
    internal = len(scene.memory)
    return BatchResponse(
        scene=scene,
        parameters=parameters,
        success=np.zeros(count, np.bool_),
        message=[""] * count,
        t=blank(),
        u=blank(bodies),
        v=blank(bodies),
        z=blank(internal),
        displacement=extremes(bodies),
        elongation=extremes(springs),
        smallest_gap=blank(contacts),
        largest_gap=blank(contacts),
        impacts=blank(contacts),
        resting_time=blank(contacts),
        steps=np.zeros(count, np.int64),
        acceleration=extremes(bodies) if accelerations else None,
        base_shear=extremes(1) if accelerations else None,
        further={name: blank() for name in named},
        struck=blank_numbers(count, contacts) if impacts else None,
    )


def keep_rows(many: BatchResponse, low: int, rows: VariantArrays, kept: Kept) -> None:
    """Take in a chunk of compiled runs, from variant `low` on.

    Those that did not reach their end are left without numbers, and marked
    unless they ended for want of room only.
    """
    from eventpound.mechanics.monitored import places_of
    from eventpound.numerics.compiled import in_python
    from eventpound.solvers.events.recorder import extremes_of
    from eventpound.solvers.fast.run import FINISHED, MESSAGES

    part = slice(low, low + kept.ended.size)
    own: Any = np.flatnonzero(kept.ended == FINISHED)
    at: Any = low + own
    if own.size == kept.ended.size:
        # Slices copy at once what an index copies row by row.
        own, at = slice(None), part
    now, progress = rows.state.now[:, 0], rows.state.progress[:, 0]
    many.t[part], many.steps[part] = now["t"], progress["steps"]
    many.message[part] = [MESSAGES[FINISHED]] * kept.ended.size
    for i in (low + np.flatnonzero(kept.ended != FINISHED)).tolist():
        ended = int(kept.ended[i - low])
        if ended in MESSAGES:
            mark_failed(many, i, ComputationError(MESSAGES[ended], float(many.t[i])))
    many.success[at] = True
    # Points between bodies are nobody's to ask for.
    coordinates, bodies = rows.state.u.shape[1], slice(many.u.shape[1])
    u, v = rows.state.u[own], rows.state.v[own]
    many.u[at], many.v[at], many.z[at] = u[:, bodies], v[:, bodies], kept.z[own]
    many.impacts[at], many.resting_time[at] = kept.impacts[own], kept.resting_time[own]
    table, elongations = rows.extremes, many.elongation.maximum.shape[1]
    places = in_python(places_of)(coordinates, elongations, many.impacts.shape[1])
    gap = extremes_of("gap", table[own], places)
    many.smallest_gap[at], many.largest_gap[at] = gap.minimum, gap.maximum

    def found(kind: str) -> Extremes:
        extremes = extremes_of(kind, table[own], places)
        of_bodies = kind in ("displacement", "acceleration")
        return extremes.at(np.s_[:, bodies]) if of_bodies else extremes

    _keep_extremes(many, at, found)
    if many.struck is not None:
        largest = np.maximum(extremes_of("contact_force", table, places).maximum, 0.0)
        threshold = many.threshold
        numbers = numbers_of_contacts(_impacts(kept.log), largest, kept.unique, threshold)
        for column, values in zip(many.struck, numbers, strict=True):
            column[at] = values[own]


def _keep_extremes(many: BatchResponse, at: Any, found: Callable[[str], Extremes]) -> None:
    """Take in the extremes of all kinds that are kept, of the variants `at`."""
    for field in fields(many):
        kept = getattr(many, field.name)
        if isinstance(kept, Extremes):
            kept.put(at, found(field.name))


def _impacts(log: Floats) -> Impacts:
    """Impacts among the events of some runs, in order of run and time."""
    from eventpound.contact.event_rows import DETACHMENT, ERASED, REST, SEPARATION

    log = log[~np.isin(log[:, 2], (REST, DETACHMENT, SEPARATION, ERASED))]
    return impacts_of(np.delete(log, 2, axis=1)[np.lexsort((log[:, 1], log[:, 0]))])


def keep_recording(many: BatchResponse, i: int, recording: Recording) -> None:
    """Take in variant i, which ran by itself."""
    many.success[i], many.message[i] = True, recording.message
    many.t[i], many.steps[i] = recording.t, recording.work.steps
    many.u[i], many.v[i], many.z[i] = recording.u, recording.v, recording.z
    many.smallest_gap[i], many.resting_time[i] = recording.smallest_gap, recording.resting_time
    if recording.largest_gap is not None:
        many.largest_gap[i] = recording.largest_gap
    many.impacts[i] = 0.0
    for event in recording.events:
        if event.kind in STRIKES:
            many.impacts[i, event.contact] += event.count
    if many.struck is not None:
        numbers = of_recordings([recording], many.threshold)
        for column, own in zip(many.struck, numbers, strict=True):
            column[i] = own[0]
    _keep_extremes(many, i, lambda kind: getattr(recording, kind))


def keep_named(many: BatchResponse, i: int, run: BatchResponse) -> None:
    """Take in the quantities that were named of variant i, the only one of `run`."""
    found = {name: values_of(run, name) for name in many.further}
    for name, values in found.items():
        many.further[name][i] = np.nan if values is None else values[0]


def mark_failed(many: BatchResponse, i: int, error: ComputationError) -> None:
    """Say how variant i failed; it keeps no numbers but time and steps."""
    many.message[i], many.t[i] = str(error), error.time
    if error.recording is not None:
        many.steps[i] = error.recording.work.steps
