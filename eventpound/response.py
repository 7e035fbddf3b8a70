"""What a run returns: tables of peaks, events and history, and the final state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eventpound.scene.scene import Scene
from eventpound.solvers.base import Energy, EventKind, Recording, Task, Work

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Response:
    """The motion of a scene, as tables.

    Parameters
    ----------
    task : Task
        What was asked.
    solver : str
        Name of the solver.
    recording : Recording
        What it returned.
    error_estimate : mapping, optional
        Errors of peaks and final values, where they were estimated (docs/results.md).
    """

    task: Task
    solver: str
    recording: Recording
    error_estimate: Mapping[str, Any] | None = None

    @property
    def scene(self) -> Scene:
        """What moved."""
        return self.task.scene

    @property
    def success(self) -> bool:
        """Whether the run reached its end."""
        return self.recording.success

    @property
    def message(self) -> str:
        """One sentence on how the run ended."""
        return self.recording.message

    @property
    def work(self) -> Work:
        """What the run cost."""
        return self.recording.work

    @property
    def energy(self) -> Energy | None:
        """The energy ledger, where it was asked for."""
        return self.recording.energy

    @property
    def peaks(self) -> pd.DataFrame:
        """Extremes of the displacements, one row a body.

        Columns max, t_max, min, t_min, abs_max, t_abs_max (m, s): first
        attainments over the whole run, located exactly.
        """
        import pandas as pd

        names = [body.name for body in self.scene.bodies]
        x = self.recording.displacement
        table = pd.DataFrame(
            {
                "max": x.maximum,
                "t_max": x.time_of_maximum,
                "min": x.minimum,
                "t_min": x.time_of_minimum,
            },
            index=pd.Index(names, name="body"),
        )
        above = (table["max"] > -table["min"]) | (
            (table["max"] == -table["min"]) & (table["t_max"] <= table["t_min"])
        )
        table["abs_max"] = table["max"].where(above, -table["min"])
        table["t_abs_max"] = table["t_max"].where(above, table["t_min"])
        return table

    @property
    def events(self) -> pd.DataFrame:
        """Every impact, accumulation, rest, detachment and separation.

        One row a contact, columns as in ``events.csv``; contacts are named.
        """
        import pandas as pd

        names = [contact.name for contact in self.scene.contacts]
        rows = [
            (
                e.t,
                e.kind.value,
                e.group,
                names[e.contact],
                e.gap_velocity_before,
                e.gap_velocity_after,
                e.impulse,
                e.energy_lost,
                e.count,
            )
            for e in self.recording.events
        ]
        return pd.DataFrame(rows, columns=list(EVENT_COLUMNS))

    @property
    def history(self) -> pd.DataFrame:
        """State at the output times and events, columns as in ``history.csv``."""
        import pandas as pd

        h = self.recording.history
        columns = {"t": h.t, "a_g": h.ground}
        for prefix, values, names in (
            ("u", h.u, [b.name for b in self.scene.bodies]),
            ("v", h.v, [b.name for b in self.scene.bodies]),
            ("a", h.a, [b.name for b in self.scene.bodies]),
            ("z", h.z, self.scene.hysteretic_springs),
            ("force", h.force, [s.name for s in self.scene.springs]),
            ("gap", h.gap, [c.name for c in self.scene.contacts]),
            ("lambda", h.contact_force, [c.name for c in self.scene.contacts]),
        ):
            for column, name in enumerate(names):
                columns[f"{prefix}.{name}"] = values[:, column]
        return pd.DataFrame(columns)

    @property
    def final(self) -> Mapping[str, Mapping[str, float]]:
        """Final state: {body: {u, v}, spring: {z}} (m, m/s, -)."""
        r = self.recording
        state: dict[str, dict[str, float]] = {
            body.name: {"u": float(r.u[i]), "v": float(r.v[i])}
            for i, body in enumerate(self.scene.bodies)
        }
        for i, name in enumerate(self.scene.hysteretic_springs):
            state.setdefault(name, {})["z"] = float(r.z[i])
        return state

    @property
    def impacts(self) -> int:
        """Number of impact rows, with the impacts that accumulations stand for."""
        return sum(
            e.count
            for e in self.recording.events
            if e.kind in (EventKind.IMPACT, EventKind.ACCUMULATION)
        )


EVENT_COLUMNS = (
    "t",
    "kind",
    "group",
    "contact",
    "gap_velocity_before",
    "gap_velocity_after",
    "impulse",
    "energy_lost",
    "count",
)
