"""What a run returns: tables of peaks, events and history, and the final state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from eventpound.case.case import DEFAULTS, Stated
from eventpound.many_response import Many, blank_many, keep_recording
from eventpound.quantities import SIX, tabled
from eventpound.scene.pi_columns import ScaleColumns
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
    stated : Stated
        Numbers that some quantities are about.
    """

    task: Task
    solver: str
    recording: Recording
    error_estimate: Mapping[str, Any] | None = None
    stated: Stated = DEFAULTS

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
    def runs(self) -> Many:
        """The run as one of many, which quantities are computed from."""
        scales = self.scene.motion.scales()
        many = replace(
            blank_many(self.scene, {}, accelerations=True),
            recordings=(self.recording,),
            scales=None if scales is None else ScaleColumns(scales.a_g, scales.omega_g),
            stated=self.stated,
        )
        keep_recording(many, 0, self.recording)
        return many

    @property
    def summary(self) -> pd.Series[Any]:
        """Every quantity that needs no further run, by its name (docs/quantities.md)."""
        import pandas as pd

        runs = self.runs
        found = {named.name: named.of_one(runs) for named in tabled(runs)}
        return pd.Series(found, dtype=object, name=self.solver)

    @property
    def peaks(self) -> pd.DataFrame:
        """Extremes of the displacements, one row a body.

        Columns max, t_max, min, t_min, abs_max, t_abs_max (m, s): first
        attainments over the whole run, located exactly.
        """
        import pandas as pd

        runs = self.runs
        return pd.DataFrame(
            {
                word: [float(pick(runs.displacement, i)[0]) for i in range(runs.u.shape[1])]
                for word, (_, pick) in SIX.items()
            },
            index=pd.Index([body.name for body in self.scene.bodies], name="body"),
        )

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
