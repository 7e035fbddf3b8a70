"""What moved at every row of a run, as the columns of ``history.csv``, and its events as rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.rows import Rerun, rows_at
from eventpound.scene.plan_point import ACROSS
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Event, Recording, Task
from eventpound.solvers.supported import ground_accelerations, of_ground

if TYPE_CHECKING:
    import pandas as pd

EVENT_COLUMNS = Event._fields
_UNITS = {
    **{"t": "s", "a_g": "m/s^2", "a_across": "m/s^2", "u": "m", "v": "m/s", "a": "m/s^2"},
    **{"force": "N", "gap": "m", "lambda": "N", "s": "m", "sv": "m/s", "sf": "N"},
    "logged": "m/s^2",
}
"""Of columns, by what stands before the name; a memory's have none."""


def history_columns(scene: Scene, recording: Recording) -> dict[str, Floats]:
    """Columns of a history, by their names (SI)."""
    h = recording.history
    columns = {"t": h.t, "a_g": h.ground}
    if scene.in_plan:
        columns["a_across"] = ground_accelerations(scene, ACROSS, h)
    springs = [i for i, spring in enumerate(scene.springs) if spring.frame is None]
    bodies, contacts = ([part.name for part in parts] for parts in (scene.bodies, scene.contacts))
    groups = [("u", h.u, bodies), ("v", h.v, bodies), ("a", h.a, bodies)]
    groups += [(name, h.z[:, [i]], [of]) for i, (of, name) in enumerate(scene.memory)]
    groups += [("force", h.force[:, springs], [scene.springs[i].name for i in springs])]
    groups += [("gap", h.gap, contacts), ("lambda", h.contact_force, contacts)]
    for prefix, values, names in groups:
        columns |= {f"{prefix}.{name}": values[:, i] for i, name in enumerate(names)}
    if (moved := recording.supports) is not None:
        for i, support in enumerate(scene.supports):
            for prefix, values in (("s", moved.s), ("sv", moved.sv), ("sf", moved.force)):
                columns[f"{prefix}.{support.name}"] = values[:, i]
    return columns


def history_table(scene: Scene, recording: Recording) -> pd.DataFrame:
    """Columns of a history as a table, with their units in ``attrs``."""
    return _tabled(history_columns(scene, recording))


def _tabled(columns: Mapping[str, Floats]) -> pd.DataFrame:
    import pandas as pd

    table = pd.DataFrame(columns)
    table.attrs["units"] = {name: _UNITS.get(name.partition(".")[0], "") for name in table}
    return table


def history_at(
    task: Task, rerun: Rerun, times: Floats, side: str, interval: float | None
) -> pd.DataFrame:
    """Rows of a run at some times, each with what an accelerometer shows there.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task.
    times : ndarray, shape (n,)
        Times of the run (s).
    side : str
        As of `rows_at`.
    interval : float or None
        Between two samples of the accelerometer (s); without one it shows nothing.

    Raises
    ------
    InputError
        As `rows_at` does.
    """
    scene = task.scene
    earlier = np.empty(0) if interval is None else np.maximum(times - interval, task.start)
    both = np.concatenate([times, earlier])
    recording, places = rows_at(task, rerun, both, side)
    rows = {name: values[places] for name, values in history_columns(scene, recording).items()}
    shown = {name: values[: times.size] for name, values in rows.items()} | {"t": times}
    for body in scene.bodies if earlier.size else ():
        speed = rows[f"v.{body.name}"] + of_ground(scene, body.direction, "velocity", both)
        gained, taken = speed.reshape(2, -1), times - earlier
        smooth = shown[f"a.{body.name}"].copy()
        mean = np.divide(gained[0] - gained[1], taken, out=smooth, where=taken > 0.0)
        shown[f"logged.{body.name}"] = mean
    return _tabled(shown)


def event_rows(scene: Scene, recording: Recording) -> list[tuple[Any, ...]]:
    """Rows of events in the order of their times, by `EVENT_COLUMNS`; contacts are named."""
    names = [contact.name for contact in scene.contacts]
    listed: Sequence[Event] = recording.events
    if recording.slides:
        listed = sorted((*listed, *recording.slides), key=lambda e: e.t)
    return [(e.t, e.kind.value, e.group, names[e.contact], *e[4:]) for e in listed]


def event_table(scene: Scene, recording: Recording) -> pd.DataFrame:
    """Events as a table."""
    import pandas as pd

    return pd.DataFrame(event_rows(scene, recording), columns=list(EVENT_COLUMNS))
